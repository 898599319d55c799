"""Rotations and vectors as arrays.

Arrays of vectors: products in the table plane, checks of what callers hand in, tuples.

Vectors in the table plane hold x and y in their last axis, those in space z, too.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objectmodels.errors import ModelError

Array = NDArray[np.float64]

UNIT = 1e-6
"""Share by which the length of a unit vector may be off."""

_UNIT_LENGTH = "divide each by its length: `v / np.linalg.norm(v, axis=1, keepdims=True)`"


total = np.add.reduce
"""Sum over the first axis; `np.sum` takes longer to begin than a few points take to be added."""


def dot(a: Array, b: Array) -> Array:
    """Scalar product a·b, shape (...); faster than a product with a stride."""
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1])


def cross(a: Array, b: Array) -> Array:
    """Vertical part of a × b, shape (...)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def spatial_cross(a: Array, b: Array) -> Array:
    """A × b of vectors (..., 3); several times as fast as numpy's for single ones."""
    a_x, a_y, a_z = a[..., 0], a[..., 1], a[..., 2]
    b_x, b_y, b_z = b[..., 0], b[..., 1], b[..., 2]
    c = np.array([a_y * b_z - a_z * b_y, a_z * b_x - a_x * b_z, a_x * b_y - a_y * b_x])
    return c.transpose(*range(1, c.ndim), 0)


def left_of(v: Array) -> Array:
    """ẑ × v, shape (..., 2)."""
    return np.stack((-v[..., 1], v[..., 0]), axis=-1)


def circle_around(corners: Array) -> tuple[Array, float]:
    """Middle, shape (2,), and radius of a circle around points of the plane, shape (k, 2)."""
    middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    return middle, float(np.hypot(*(corners - middle).T).max())


def rotate(v: Array, angle: Array) -> Array:
    """Vectors (n, 2) turned counter-clockwise by angles (n,) [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack((c * v[:, 0] - s * v[:, 1], s * v[:, 0] + c * v[:, 1]))


def unique_rows(rows: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Index of the first of each different row, in the rows' order, and which of these each row is.

    As `np.unique`, which loads numpy's masked arrays besides.
    """
    order = np.lexsort(rows.T[::-1])
    first = np.ones(min(len(rows), 1), dtype=np.bool_)
    begins = np.append(first, np.any(rows[order[1:]] != rows[order[:-1]], axis=1))
    which = np.empty(len(rows), dtype=np.intp)
    which[order] = np.cumsum(begins) - 1
    return order[begins], which


def checked_pairs(points: ArrayLike, vectors: ArrayLike) -> tuple[Array, Array]:
    """Two finite arrays of equal shape (n, 3), or a `ModelError`.

    Each component of the points lies in a row: numpy is much faster on such arrays.
    """
    p = np.asarray(points, dtype=np.float64, order="F")
    v = np.asarray(vectors, dtype=np.float64)
    if p.ndim != 2 or p.shape[1] != 3 or p.shape != v.shape:
        raise ModelError(
            "bad_array",
            f"expected two arrays of one shape (n, 3), found {p.shape} and {v.shape}",
            suggestions=("a single push is an array of shape (1, 3)",),
        )
    require_finite(p, v)
    return p, v


def checked_rotation(R: ArrayLike) -> Array:
    """A rotation matrix, shape (3, 3), or a `ModelError`."""
    matrix = np.asarray(R, dtype=np.float64)
    orthogonal = matrix.shape == (3, 3) and np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-6)
    if not orthogonal or np.linalg.det(matrix) < 0:
        raise ModelError(
            "bad_array",
            "R_WB must be a rotation matrix, shape (3, 3)",
            suggestions=("`np.eye(3)` is the one of an object that stands",),
        )
    return matrix


def require_finite(*arrays: Array) -> None:
    """Refuses arrays in which something is no number."""
    if not all(np.isfinite(a).all() for a in arrays):
        raise ModelError(
            "bad_array",
            "arrays must hold finite numbers only",
            suggestions=("leave out rows with nan or inf: `a[np.isfinite(a).all(axis=-1)]`",),
        )


def require_amount(value: float, name: str, hint: str) -> None:
    """Refuses what is no number from 0 on; `hint` says what would be one."""
    if np.ndim(value) or not 0.0 <= value < np.inf:
        raise ModelError(
            "bad_value", f"found {name} {value}, expected a number from 0 on", suggestions=(hint,)
        )


def require_units(u: Array) -> None:
    """Refuses directions that are not unit vectors, shape (n, 3)."""
    # Near one the square is off by twice as much, and takes no root.
    x, y, z = u.T
    square = x * x + y * y + z * z
    if u.size and (square.max() > 1.0 + 2.0 * UNIT or square.min() < 1.0 - 2.0 * UNIT):
        raise ModelError(
            "bad_array", "directions must be unit vectors", suggestions=(_UNIT_LENGTH,)
        )


def require_normals(n: Array) -> None:
    """Refuses normals that are not those of side faces, shape (n, 3)."""
    if np.any(np.abs(np.linalg.norm(n, axis=1) - 1.0) > UNIT) or np.any(np.abs(n[:, 2]) > 0.99):
        raise ModelError(
            "bad_array",
            "normals must be unit vectors of side faces",
            suggestions=("take `face.normal` of one of `model.faces`", _UNIT_LENGTH),
        )


def vector_tuple(v: Array) -> tuple[float, float, float]:
    """Three plain numbers of an array, shape (3,)."""
    x, y, z = v.tolist()
    return x, y, z


def as_tuple(value: Any) -> Any:
    """A list or an array as a tuple; anything else as it is."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return tuple(value) if isinstance(value, list) else value


def as_tuples(value: Any) -> Any:
    """The same, and for the lists in it."""
    value = as_tuple(value)
    return tuple(map(as_tuple, value)) if isinstance(value, tuple) else value


def axis_and_angle(R: Array) -> tuple[Array, float]:
    """Unit axis, shape (3,), and angle from 0 to π of a rotation, shape (3, 3), that is none [rad].

    Of half a turn the axis may be either way round.
    """
    angle = math.acos(float(np.clip((np.trace(R) - 1.0) / 2.0, -1.0, 1.0)))
    # An angle so near to half a turn has its axis from the symmetric part [rad].
    if math.pi - angle < 1e-6:
        squares = 0.5 * (R + np.eye(3))
        axis = squares[:, int(np.argmax(np.diag(squares)))]
    else:
        axis = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return axis / np.linalg.norm(axis), angle


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
