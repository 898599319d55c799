"""How long the hand's motion is looked for, and how near it may come to things."""

from __future__ import annotations

from dataclasses import dataclass

from sim.collision.collision_scene import LEAST_CLEARANCE, OBJECT_CLEARANCE


@dataclass(frozen=True)
class Effort:
    """Length of a search, and how near the hand may come to things.

    Attributes:
        clearance: of hand and arm from what is neither pushed nor fragile [m].
        fine: whether the palm may lean to its sides by small angles and large ones.
        most_hands: that are clear and for which the arm is asked.
        most_transits: stances of some hands for which a way from home is looked for.
        last_resorts: stances of all hands for which it is looked for among more places.
    """

    clearance: float
    fine: bool
    most_hands: int
    most_transits: int
    last_resorts: int


USUAL = Effort(OBJECT_CLEARANCE, fine=False, most_hands=60, most_transits=2, last_resorts=3)
THOROUGH = Effort(LEAST_CLEARANCE, fine=True, most_hands=600, most_transits=10, last_resorts=10)
