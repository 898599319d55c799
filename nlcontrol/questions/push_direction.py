"""The direction of a push that is asked about: as a unit vector, and in words."""

from __future__ import annotations

import numpy as np

from nlcontrol.errors import error
from planner.problem.directions import HEADINGS, angle_between


def unit_direction(direction: tuple[float, float, float]) -> np.ndarray:
    """A direction as a unit vector, shape (3,).

    Raises:
        ControlError: `bad_push` if it is none.
    """
    v = np.asarray(direction, dtype=np.float64)
    if v.shape != (3,) or not np.isfinite(v).all() or not v.any():
        raise error(
            "bad_push",
            f"{direction} is no direction",
            suggestions=("give three numbers of which one is not 0, like 1,0,0 for away",),
        )
    return np.asarray(v / np.linalg.norm(v))


def heading_text(heading: float) -> str:
    """A heading in words: the nearest name, and the angle off it."""
    off = {name: angle_between(heading, value) for name, value in HEADINGS.items()}
    name = min(off, key=lambda key: abs(off[key]))
    degrees = np.degrees(off[name])
    if abs(degrees) < 0.5:
        return name
    return f"{abs(degrees):.0f}° {'left' if degrees > 0 else 'right'} of '{name}'"
