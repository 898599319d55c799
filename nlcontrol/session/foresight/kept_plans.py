"""Plans of the steps of a command from predicted states, each of which is made once."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grammar.frames import command as g
    from planner.types.plan import PlanningResult
    from planner.types.world_state import WorldState


class KeptPlans:
    """What planning answered so far; beliefs other than poses and the hand stay what they are."""

    def __init__(self) -> None:
        self._made: dict[tuple[object, ...], PlanningResult] = {}

    def plan(
        self,
        frame: g.Frame | tuple[g.Frame, ...],
        state: WorldState,
        make: Callable[[], PlanningResult],
    ) -> PlanningResult:
        """The answer for a frame from a state; made if it is not known.

        Of several frames it is the one for the first after which the others can be done.
        """
        poses = ((name, seen.pose, seen.lies_on) for name, seen in state.objects.items())
        key = (frame, state.held, *poses)
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]
