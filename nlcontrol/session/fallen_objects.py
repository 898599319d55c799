"""Objects that fell where the hand does not get to them, told before anybody asks for them.

Where something is brought to, its place is chosen so that the hand gets to it again. Where it falls
to is chosen by nobody: it is looked whether it can be pushed on or lifted from there, and before a
topple whether it could be stood up again. Frames: W.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, get_args

from grammar.frames import command as g
from nlcontrol.errors import ControlError
from nlcontrol.session.foresight import BudgetedPlanner
from nlcontrol.session.step_search import ReachCache
from nlcontrol.text_format import place_text
from objectmodels.geometry.rotations import from_quaternion
from planner import plan
from planner.problem.planning_problem import SearchBudget
from planner.problem.predicted_states import state_after
from planner.true_reasons import REASON_WORK
from planner.types.plan import Plan, PlanningResult
from planner.types.refusal import Refusal
from sim.supervision import Stopped, StopToken

if TYPE_CHECKING:
    from nlcontrol.session.controller import Controller
    from planner.types.world_state import WorldState
    from sim.traces.trace import Trace

_WAY = 0.05  # of a push, and up in a lift, that is a hold on an object [m]


def unreachable_after_fall(
    controller: Controller, trace: Trace, look: Callable[[], WorldState], stop: StopToken
) -> Iterator[str]:
    """Sentences on what fell, and is neither pushed nor lifted from where it lies."""
    names = fallen_things(trace)
    if not names:
        return
    try:
        state = look()
        held = state.held.name if state.held is not None else None
        for name in names:
            if name != held and name in state.objects:
                yield from _unreachable(controller, name, state, stop)
    except (Stopped, ControlError):
        return  # what was done is told all the same


def fallen_things(trace: Trace) -> list[str]:
    """Names of what lies or stands on another face than at the beginning, as it was seen."""
    ups = {name: from_quaternion(seen[[0, -1], :4])[:, 2] for name, seen in trace.seen.items()}
    # 0.7: the cosine between what was up in an object and what is now, unless it fell.
    return [name for name, (first, last) in ups.items() if first @ last < 0.7]


def _unreachable(
    controller: Controller, name: str, state: WorldState, stop: StopToken
) -> Iterator[str]:
    robot = ReachCache(controller.robot, stop, controller.time_limit)
    # Each plan may take a tenth of the usual work.
    most = int(0.1 * controller.defaults.most_work)
    for frame in _frames_of(name):
        if not isinstance(BudgetedPlanner(controller, robot, most, most)(frame, state), Refusal):
            return
    place = place_text(*state.objects[name].pose.p_WB[:2])
    yield (
        f"the {name} lies at {place} now, where the robot finds no way to push it or to lift it "
        "as things are"
    )


def _frames_of(name: str) -> Iterator[g.Frame]:
    """Small motions; what allows none of them is out of the hand's reach."""
    own = g.ObjectRef(text=name, noun=name, id=name)
    for way in get_args(g.Direction):
        yield g.Frame(action="push", object=own, goal=g.Displace(direction=way, distance=_WAY))
    yield g.Frame(action="lift", object=own, goal=g.Lift(height=_WAY))


def with_way_back(
    controller: Controller, made: PlanningResult, state: WorldState
) -> PlanningResult:
    """The plan, with a note if there is no way back from the fall in which it ends.

    Args:
        controller: the controller that plans.
        made: a plan.
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
