"""Vectors in the table plane: their last axis holds x and y."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def dot(a: Array, b: Array) -> Array:
    """Scalar product a·b, shape (...); faster than a product with a stride."""
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1])


def cross(a: Array, b: Array) -> Array:
    """Vertical part of a × b, shape (...)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def left_of(v: Array) -> Array:
    """ẑ × v, shape (..., 2)."""
    return np.stack((-v[..., 1], v[..., 0]), axis=-1)


def rotate(v: Array, angle: Array) -> Array:
    """Vectors (n, 2) turned counter-clockwise by angles (n,) [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack((c * v[:, 0] - s * v[:, 1], s * v[:, 0] + c * v[:, 1]))
