"""Limits of tilting an object, and the travel of a finger that tilts it.

Model: the object pivots about a base edge that does not slide. Seen along that edge: base length L
along the push, the finger on the rear face at height h, the pivot at the leading edge, b from the
centre of mass to the pivot.
"""

from __future__ import annotations

from math import asin, atan2, cos, hypot, pi, sin, sqrt, tan
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.vector_arrays import require_amount

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody


def angle_of_no_return(model: PushedBody, direction: ArrayLike, sigmas: float) -> float:
    """Angle atan(b / c_z) past which the object falls by itself [rad].

    Args:
        model: the object.
        direction: horizontal direction in B, shape (3,); it tips over the base edge that looks
            most along it.
        sigmas: take the centre of mass at so many standard deviations towards an earlier fall
            (negative: towards a later one).
    """
    n = _leading_edge(model, direction)
    b = float(model.base.extent(n)) - n @ np.array(model.com[:2])
    b -= sigmas * (np.abs(n) @ np.array(model.com_sd[:2]))
    c_z = model.com[2] + sigmas * model.com_sd[2]
    # A worst case may leave the object: it then falls at once, or only once it lies on its side.
    return atan2(max(b, 0.0), max(c_z, 0.0))


def return_probability(model: PushedBody, direction: ArrayLike, angle: float) -> float:
    """Probability that the object falls back onto its base from a tilt of that angle [rad].

    It does while b − c_z tan θ is positive, which is normal as b and c_z are.
    """
    b, b_sd, c_z, c_z_sd = _weight_lever(model, direction)
    t = tan(angle)
    left, unsure = b - c_z * t, hypot(b_sd, c_z_sd * t)
    return NormalDist().cdf(left / unsure) if unsure > 0.0 else float(left > 0.0)


def largest_return(model: PushedBody, direction: ArrayLike, probability: float) -> float:
    """Largest tilt from which it falls back with at least a probability above a half [rad]."""
    b, b_sd, c_z, c_z_sd = _weight_lever(model, direction)
    z = NormalDist().inv_cdf(probability)
    if b <= z * b_sd:
        return 0.0
    # The smaller root of (b − c t)² = z² (σ_b² + t² σ_c²), in a form that c = z σ_c leaves whole.
    root = sqrt((b * c_z_sd) ** 2 + (c_z * b_sd) ** 2 - (z * b_sd * c_z_sd) ** 2)
    return atan2(b * b - (z * b_sd) ** 2, b * c_z + z * root)


def topple_stroke(model: PushedBody, direction: ArrayLike, height: float, angle: float) -> float:
    """Travel of the finger that tilts the object by an angle, whether it slips or sticks [m].

    It pushes along a horizontal direction in B (3,), at a height of the face [m], to a tilt [rad].
    """
    if not 0.0 <= angle < np.pi / 2:
        raise ModelError(
            "bad_value",
            f"angle {angle} rad is not between 0 and π/2",
            suggestions=("give it in radians: `np.radians(degrees)`",),
        )
    length = _length_pushed(model, direction, height)
    return max(stroke_level(height, length, angle), stroke_stuck(height, length, angle))


def stroke_tilt(
    model: PushedBody, direction: ArrayLike, height: float, travel: float
) -> tuple[float, float]:
    """Tilts after a travel of the finger if it stays level or sticks, the smaller first [rad]."""
    require_amount(travel, "a travel of", "give a length in metres")
    length = _length_pushed(model, direction, height)
    tilts = tilt_level(height, length, travel), tilt_stuck(height, length, travel)
    return min(tilts), max(tilts)


def tilt_level(height: float, length: float, travel: float) -> float:
    """Inverse of `stroke_level`; π/2 if the finger passes over the object before [rad].

    With t = tan(θ/2) it is 2 h t − 2 L t² = d (1 − t²), whose smaller root counts.
    """
    a, b, c = 2.0 * length - travel, 2.0 * height, travel
    inside = b * b - 4.0 * a * c
    return pi / 2.0 if inside < 0.0 else 2.0 * atan2(2.0 * c, b + sqrt(inside))


def tilt_stuck(height: float, length: float, travel: float) -> float:
    """Inverse of `stroke_stuck`; π/2 if it is beyond [rad]."""
    sine = (travel - length) / hypot(height, length)
    return min(atan2(length, height) + asin(sine), pi / 2.0) if sine < 1.0 else pi / 2.0


def stroke_level(height: float, length: float, angle: float) -> float:
    """Travel d = h tan θ − L (sec θ − 1) of a finger that stays at its height [m]."""
    return height * tan(angle) - length * (1.0 / cos(angle) - 1.0)


def stroke_stuck(height: float, length: float, angle: float) -> float:
    """Travel d = h sin θ + L (1 − cos θ) of a finger that sticks to the face [m]."""
    return height * sin(angle) + length * (1.0 - cos(angle))


def _length_pushed(model: PushedBody, direction: ArrayLike, height: float) -> float:
    """The length along a push, if its height is one on the object."""
    if not 0.0 < height <= model.top:
        raise ModelError(
            "bad_value",
            f"height {height} m is not on the object",
            suggestions=(f"take one above 0 and up to {model.top:g} m",),
        )
    return length_along(model, direction)


def length_along(model: PushedBody, direction: ArrayLike) -> float:
    """From the leading edge to the side behind, which may stand out beyond the base [m]."""
    n = _leading_edge(model, direction)
    return float(model.base.extent(n)) + float((model.outline @ -n).max())


def _weight_lever(model: PushedBody, direction: ArrayLike) -> tuple[float, float, float, float]:
    """Lengths b and c_z, each with its standard deviation [m]."""
    n = _leading_edge(model, direction)
    b = float(model.base.extent(n)) - float(n @ np.array(model.com[:2]))
    return b, float(np.hypot(*(n * model.com_sd[:2]))), model.com[2], model.com_sd[2]


def _leading_edge(model: PushedBody, direction: ArrayLike) -> Array:
    """Outward normal of the base edge that looks most along a horizontal direction, (2,)."""
    u = np.asarray(direction, dtype=np.float64)
    if u.shape not in ((2,), (3,)) or not np.isfinite(u).all() or not u[:2].any():
        raise ModelError(
            "bad_array",
            f"direction {u} is not a horizontal direction",
            suggestions=("give [x, y] or [x, y, 0], not all zero",),
        )
    return model.base.facing_normal(u[:2] / np.hypot(*u[:2]))
