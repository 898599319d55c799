"""Plans midway: to the aim of the plan before, or to another one that the sentence allows.

A push that ends elsewhere than foreseen may leave an object where the hand does not get to it for
the aim that was chosen. From there another aim is looked for, if the sentence does not measure it
from where the object stood.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from planner.clearing import is_beyond_hand, may_be_brought
from planner.types.plan import Plan
from planner.types.refusal import Refusal

if TYPE_CHECKING:
    from grammar.frames import command as g
    from planner.types.plan import PlanningResult
    from planner.types.world_state import WorldState


class Planning(Protocol):
    """Planning of one frame from one state."""

    def __call__(self, *, previous: Plan | None = None) -> PlanningResult:
        """The answer; the aim of a previous plan is kept."""
        ...


def onward_plan(
    planning: Planning, frame: g.Frame, state: WorldState, previous: Plan | None
) -> PlanningResult:
    """The plan of what is left of a frame, or why there is none to the aim that was chosen.

    Args:
        planning: of the frame from where everything is.
        frame: that was begun.
        state: what is believed now.
        previous: the plan whose first push was made last; None if its aim is not kept.
    """
    made = planning(previous=previous)
    if previous is None or not isinstance(made, Refusal):
        return made
    if not (is_beyond_hand(made) and may_be_brought(frame, state)):
        return made
    anew = planning()
    if isinstance(anew, Plan):
        notes = (f"another aim, since {made.message}", *anew.notes)
        return anew.model_copy(update={"notes": notes})
    return made if isinstance(anew, Refusal) else anew
