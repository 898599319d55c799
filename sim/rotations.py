"""Rotations about the coordinate axes and about given ones, for whole arrays of angles."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objectmodels.geometry.rotations import spatial_cross

Array = NDArray[np.float64]


def axis_rotation(axis: ArrayLike, angle: ArrayLike) -> Array:
    """Rotation by an angle about a unit axis (Rodrigues' formula).

    Args:
        axis: unit vectors, shape (..., 3).
        angle: shape (...) [rad].

    Returns:
        Shape (..., 3, 3).
    """
    a = np.asarray(axis, dtype=float)
    t = np.asarray(angle, dtype=float)[..., None, None]
    K = spatial_cross(np.eye(3), a[..., None, :])
    return np.asarray(np.eye(3) + np.sin(t) * K + (1.0 - np.cos(t)) * (K @ K))


def _about(axis: int, angle: ArrayLike) -> Array:
    """Rotation about a coordinate axis; filled in directly, since control makes many of them."""
    t = np.asarray(angle, dtype=float)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = np.zeros((*t.shape, 3, 3))
    R[..., axis, axis] = 1.0
    R[..., i, i] = R[..., j, j] = np.cos(t)
    R[..., j, i] = np.sin(t)
    R[..., i, j] = -R[..., j, i]
    return R


def rot_x(angle: ArrayLike) -> Array:
    """Rotation about x, shape (..., 3, 3) for angles of shape (...)."""
    return _about(0, angle)


def rot_y(angle: ArrayLike) -> Array:
    """Rotation about y, shape (..., 3, 3) for angles of shape (...)."""
    return _about(1, angle)


def rot_z(angle: ArrayLike) -> Array:
    """Rotation about z, shape (..., 3, 3) for angles of shape (...)."""
    return _about(2, angle)


def quaternion(R: Array) -> Array:
    """Quaternions (w, x, y, z) of rotations, shape (..., 4) for shape (..., 3, 3)."""
    # Each row of 4 q qᵀ is the quaternion times four of its components; the longest is used.
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = np.moveaxis(R, (-2, -1), (0, 1))
    rows = np.array(
        [
            [1.0 + xx + yy + zz, zy - yz, xz - zx, yx - xy],
            [zy - yz, 1.0 + xx - yy - zz, xy + yx, xz + zx],
            [xz - zx, xy + yx, 1.0 - xx + yy - zz, yz + zy],
            [yx - xy, xz + zx, yz + zy, 1.0 - xx - yy + zz],
        ]
    )
    rows = np.moveaxis(rows, (0, 1), (-2, -1))
    longest = np.einsum("...ii->...i", rows).argmax(axis=-1)[..., None, None]
    q = np.take_along_axis(rows, longest, axis=-2)[..., 0, :]
    return np.asarray(q / np.linalg.norm(q, axis=-1, keepdims=True))


def from_quaternion(q: Array) -> Array:
    """Rotations of unit quaternions (w, x, y, z), shape (..., 3, 3) for shape (..., 4)."""
    K = spatial_cross(np.eye(3), q[..., None, 1:])
    return np.asarray(np.eye(3) + 2.0 * (q[..., :1, None] * K + K @ K))


def yaw_of(R: ArrayLike) -> Array:
    """Heading of a rotation's x axis in the horizontal plane, shape (...) [rad]."""
    matrix = np.asarray(R, dtype=float)
    return np.asarray(np.arctan2(matrix[..., 1, 0], matrix[..., 0, 0]))


def wrap(angle: ArrayLike) -> Array:
    """Angle brought into [−π, π) [rad]."""
    return (np.asarray(angle, dtype=float) + np.pi) % (2.0 * np.pi) - np.pi
