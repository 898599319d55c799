"""How far a box can be tilted, and how far a finger travels to tilt it.

Model: the box pivots about a base edge that does not slide. Seen along that edge: base length L
along the push, the finger on the rear face at height h, the pivot at the leading edge, b from the
centre of mass to the pivot.
"""

from __future__ import annotations

from math import atan2, cos, sin, tan
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.errors import ModelError
from objectmodels.thresholds import EDGE_NORMALS, edge_offsets

if TYPE_CHECKING:
    from objectmodels.box import BoxModel


def angle_of_no_return(model: BoxModel, direction: ArrayLike, sigmas: float) -> float:
    """Angle atan(b / c_z) past which the box falls by itself [rad]."""
    k = _leading_edge(direction)
    n = EDGE_NORMALS[k]
    b = edge_offsets(model.size)[k] - n @ np.array(model.com[:2])
    b -= sigmas * (np.abs(n) @ np.array(model.com_sd[:2]))
    c_z = model.com[2] + sigmas * model.com_sd[2]
    # A worst case may leave the box: it then falls at once, or only once it lies on its side.
    return atan2(max(b, 0.0), max(c_z, 0.0))


def topple_stroke(model: BoxModel, direction: ArrayLike, height: float, angle: float) -> float:
    """Travel of the finger that tilts the box by an angle, whether it slips or sticks [m]."""
    if not 0.0 < height <= model.size[2]:
        raise ModelError("bad_value", f"height {height} m is not on the box")
    if not 0.0 <= angle < np.pi / 2:
        raise ModelError("bad_value", f"angle {angle} rad is not between 0 and π/2")
    length = 2.0 * float(edge_offsets(model.size)[_leading_edge(direction)])
    return max(stroke_level(height, length, angle), stroke_stuck(height, length, angle))


def stroke_level(height: float, length: float, angle: float) -> float:
    """Travel d = h tan θ − L (sec θ − 1) of a finger that stays at its height [m]."""
    return height * tan(angle) - length * (1.0 / cos(angle) - 1.0)


def stroke_stuck(height: float, length: float, angle: float) -> float:
    """Travel d = h sin θ + L (1 − cos θ) of a finger that sticks to the face [m]."""
    return height * sin(angle) + length * (1.0 - cos(angle))


def _leading_edge(direction: ArrayLike) -> int:
    """The base edge that looks most along a horizontal direction."""
    u = np.asarray(direction, dtype=np.float64)
    if u.shape not in ((2,), (3,)) or not np.isfinite(u).all() or not u[:2].any():
        raise ModelError("bad_array", f"direction {u} is not a horizontal direction")
    return int(np.argmax(EDGE_NORMALS @ u[:2]))
