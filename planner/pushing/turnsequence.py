"""Turning an object where it stands: pushes on two opposite faces by turns.

Model: a push turns the object about a pivot p of B (see `objectmodels.mechanics.turning_push`), the
same push on the opposite face about −p. Turning by a, b and c on one face, the other, and the first
again moves B's origin, with R the turn in the plane, by

    (1 − 2 R(a) + 2 R(a + b) − R(a + b + c)) p

which vanishes for a = c and sin(b / 2) = sin((a + b + c) / 2) / 2, wherever the pivot is. So what
is least known, the friction radius, does not matter. Two such threes after each other share a push.
"""

from __future__ import annotations

import numpy as np

LARGEST_TURN = float(np.radians(90.0))
"""Turn that three pushes make at most [rad]; the largest of them then turns by 49°."""

PAIRED_TURN = float(np.radians(15.0))
"""Turn that two pushes make at most [rad]: they leave the object p · (turn / 2)² off, 2 mm."""

PUSH_HEIGHT = 0.03
"""Contact height that suits all pushes that turn [m]: a hand gets there from all sides, and nothing
tilts."""


def turn_parts(angle: float, largest: float = LARGEST_TURN) -> tuple[float, ...]:
    """Turns of pushes on two opposite faces by turns, which leave the object where it was [rad].

    Args:
        angle: of the whole turn, counter-clockwise [rad].
        largest: turn that three pushes make at most, no more than π [rad].
    """
    if abs(angle) <= PAIRED_TURN:
        return (0.5 * angle, 0.5 * angle)
    threes = int(np.ceil(abs(angle) / largest - 1e-9))
    whole = angle / threes
    middle = 2.0 * float(np.arcsin(0.5 * np.sin(0.5 * whole)))
    outer = 0.5 * (whole - middle)
    return (outer, *(middle, 2.0 * outer) * (threes - 1), middle, outer)
