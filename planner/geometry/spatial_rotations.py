"""Rotations about any axis in space."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

_HALF_TURN = 1e-6  # an angle so near to half a turn has its axis from the symmetric part [rad]


def rotation_about(axis: ArrayLike, angles: ArrayLike) -> Array:
    """Rotations about a unit axis, shape (..., 3, 3), by angles of shape (...) [rad]."""
    x, y, z = np.asarray(axis, float).tolist()
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    angle = np.asarray(angles, float)[..., None, None]
    return np.asarray(np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K))


def axis_and_angle(R: Array) -> tuple[Array, float]:
    """Unit axis, shape (3,), and angle from 0 to π of a rotation, shape (3, 3), that is none [rad].

    Of half a turn the axis may be either way round.
    """
    angle = math.acos(float(np.clip((np.trace(R) - 1.0) / 2.0, -1.0, 1.0)))
    if math.pi - angle < _HALF_TURN:
        squares = 0.5 * (R + np.eye(3))
        axis = squares[:, int(np.argmax(np.diag(squares)))]
    else:
        axis = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return axis / np.linalg.norm(axis), angle
