"""Whether what is toppled could be stood up again where it will lie, which is told beforehand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from grammar.frames import command as g
from planner import plan
from planner.problem.planning_problem import SearchBudget
from planner.problem.predicted_states import state_after
from planner.true_reasons import REASON_WORK
from planner.types.plan import Plan
from planner.types.refusal import Refusal

if TYPE_CHECKING:
    from nlcontrol.session.foresight.foreseen_steps import StepPlanner
    from planner.types.plan import PlanningResult
    from planner.types.world_state import WorldState


def with_way_back(
    controller: StepPlanner, made: PlanningResult, state: WorldState
) -> PlanningResult:
    """The plan, with a note if there is no way back from the fall in which it ends.

    Args:
        controller: that plans.
        made: from a state.
        state: what is believed.
    """
    if not isinstance(made, Plan) or not made.pushes or made.pushes[-1].ends_on != "toppled":
        return made
    then = state_after(made, state)
    if then is None:
        return made
    budget = SearchBudget(int(REASON_WORK * controller.defaults.most_work))
    own = g.ObjectRef(text=made.object, id=made.object)
    upright = g.Frame(action="place", object=own, goal=g.Upright())
    back = plan(upright, then, controller.robot, defaults=controller.defaults, budget=budget)
    if not isinstance(back, Refusal) or back.code == "work_used_up":
        return made
    note = f"where it will lie I could not stand it up again: {back.message}"
    return made.model_copy(update={"notes": (*made.notes, note)})
