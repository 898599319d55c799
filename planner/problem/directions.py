"""Directions and faces as people name them.

The robot stands at the table's −x edge and looks along +x, so away is W's +x and left its +y.
Faces are named by where they look now: the front face's outward normal points at the robot.
Headings are counter-clockwise from W's x axis, seen from above.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from objectmodels.geometry.base_shapes import Array
from planner.types.actions import FaceName

HEADINGS: dict[str, float] = {
    "away": 0.0,
    "left": math.pi / 2,
    "toward": math.pi,
    "right": -math.pi / 2,
}
"""Heading of each named direction [rad]."""

NAMED = math.radians(5.0)
"""A direction is called by a name that is at most so far off [rad]."""

FACE_HEADINGS: dict[FaceName, float] = {
    "back": 0.0,
    "left": math.pi / 2,
    "front": math.pi,
    "right": -math.pi / 2,
}
"""Where each named face looks [rad]."""

FACE_OF_PUSH: dict[str, FaceName] = {
    "away": "front",
    "toward": "back",
    "left": "right",
    "right": "left",
}
"""The face that a push in a named direction touches."""


def unit(heading: float) -> Array:
    """Horizontal unit vector in W along a heading [rad], shape (3,)."""
    return np.array([math.cos(heading), math.sin(heading), 0.0])


def heading_of(v: Array) -> float:
    """Heading of a vector's horizontal part [rad], in (−π, π]."""
    return math.atan2(v[1], v[0])


def angle_between(a: float, b: float) -> float:
    """Signed angle from heading b to heading a [rad], in [−π, π]."""
    return math.remainder(a - b, math.tau)


def bisector(names: Sequence[str]) -> float | None:
    """Heading of a list of direction names [rad]; None if they cancel ("left and right")."""
    total = sum((unit(HEADINGS[name]) for name in names), start=np.zeros(3))
    return heading_of(total) if np.linalg.norm(total) > 1e-9 else None


def phrase(heading: float) -> str:
    """A heading in words, as a place to move to: "away", "to the left", "at heading 30°".

    A direction within `NAMED` of a named one bears its name.
    """
    words = {"away": "away", "toward": "toward the robot", "left": "to the left"}
    for name, exact in HEADINGS.items():
        if abs(angle_between(heading, exact)) < NAMED:
            return words.get(name, "to the right")
    return f"at heading {math.degrees(heading):.0f}°"


def face_name(normal_W: Array) -> tuple[FaceName, float]:
    """Name of a face by where it looks now.

    Args:
        normal_W: outward unit normal in W, shape (3,), horizontal.

    Returns:
        The name, and the angle by which the face is turned from the direction that the name
        means [rad], signed, in [−π/4, π/4].
    """
    looks = heading_of(normal_W)
    off = {name: angle_between(looks, named) for name, named in FACE_HEADINGS.items()}
    name = min(off, key=lambda n: abs(off[n]))
    return name, off[name]
