"""How a base carries its object: the friction radius c̄ of a support.

c̄ = m_max / f_max [m] is the largest friction moment about the vertical over the largest friction
force, for the object's centre of pressure at the middle of its base. It is all that the
ellipsoidal limit surface needs to know about the support (Howe and Cutkosky 1996).
"""

from __future__ import annotations

from math import asinh, hypot
from typing import Literal

Support = Literal["corners", "uniform"]


def friction_radius(support: Support, a: float, b: float) -> float:
    """Friction radius c̄ [m] of a rectangular base of sides a and b [m].

    Args:
        support: `corners` for four equal corner loads, `uniform` for uniform pressure.
        a: one side of the base [m].
        b: the other side [m].
    """
    if support == "corners":
        return hypot(a, b) / 2.0
    # Mean distance of a rectangle's points from its centre.
    return (a**3 * asinh(b / a) + b**3 * asinh(a / b) + 2.0 * a * b * hypot(a, b)) / (12.0 * a * b)
