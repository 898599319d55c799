"""What a hand is planned for: an object, what is believed, and what the sentence says of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from planner.problem.grasp_limits import Manner
    from planner.types.defaults import Defaults
    from planner.types.robot import HandReach
    from planner.types.world_state import SeenObject, WorldState


@dataclass(frozen=True)
class Task:
    """What is planned for.

    Attributes:
        target: what is handled.
        state: what is believed.
        hand: what the hand can hold.
        how: what the sentence says of it.
        defaults: what a clause means when it does not say more.
        doing: what is done, such as `lifting`.
    """

    target: SeenObject
    state: WorldState
    hand: HandReach
    how: Manner
    defaults: Defaults
    doing: str
