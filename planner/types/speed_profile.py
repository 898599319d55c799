"""How fast hand and fingertips become; over a stroke evenly faster, then slower with what remains.

Model: from rest v² = 2 a s after a way s, and v = b (L − s) before the end of the stroke L. So the
largest speed v solves v² / 2a + v / b = L. A push that is to be faster than usual brakes later
where it would not come to its speed otherwise, and speeds up as much as it takes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class SpeedProfile:
    """Speeding up and slowing down.

    Attributes:
        acceleration: at first [m/s²].
        braking: speed per remaining distance near the end [1/s].
    """

    acceleration: float
    braking: float

    def largest_speed(self, stroke: float) -> float:
        """Largest speed over a stroke [m], if nothing else limits it [m/s]."""
        a, per_braking = self.acceleration, 1.0 / self.braking
        return a * (math.sqrt(per_braking**2 + 2.0 * stroke / a) - per_braking)


USUAL = SpeedProfile(acceleration=0.1, braking=1.5)

FORCE_BAND = 0.2
"""Share of a push's force limit below it over which its speed falls to zero."""

LIFT_SPEED = 0.06
"""At which what is held goes up and down, at most [m/s]."""

_USUAL_SPEED = 0.05  # up to which short pushes may stay slower than they could be [m/s]
_BRAKING = 3.0  # of a push that is to be fast [1/s]
_ACCELERATION = 0.2  # of it, at most: a fingertip's spring makes it overtake its speed [m/s²]


def speed_profile(speed: float, stroke: float) -> SpeedProfile:
    """The profile of a push with a largest speed [m/s] over a stroke [m]."""
    if speed <= _USUAL_SPEED or USUAL.largest_speed(stroke) >= speed:
        return USUAL
    speeding_up = max(stroke - speed / _BRAKING, 1e-9)
    needed = speed**2 / (2.0 * speeding_up)
    return SpeedProfile(min(max(needed, USUAL.acceleration), _ACCELERATION), _BRAKING)


def reached_speed(speed: float, stroke: float) -> float:
    """Speed to which a push comes with a largest one [m/s] over a stroke [m], in [m/s]."""
    return min(speed, speed_profile(speed, stroke).largest_speed(stroke))
