"""What came to lie where the hand does not get to it, told before anybody asks for it.

Where something is brought to, its place is chosen so that the hand gets to it again. Where it falls
to is chosen by nobody: it is looked whether it can be pushed on or lifted from there. Frames: W.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, get_args

from grammar.frames import command as g
from nlcontrol.errors import ControlError
from nlcontrol.session.foresight.kept_denials import RecallingRobot
from nlcontrol.text_format import place_text
from objectmodels.geometry.rotations import from_quaternion
from planner import planning
from planner.problem.planning_problem import SearchBudget
from planner.types.refusal import Refusal
from sim.supervision import Stopped, StopToken

if TYPE_CHECKING:
    from collections.abc import Callable

    from nlcontrol.session.foresight.foreseen_steps import StepPlanner
    from planner.types.world_state import WorldState
    from sim.traces.trace import Trace

_LEANING = 0.7  # least cosine between what was up in an object, and what is, unless it fell [1]
_WAY = 0.05  # of a push, and up in a lift, that is a hold on an object [m]
_MOST = 0.1  # work of each plan, in what a plan may take


def stranded_things(
    controller: StepPlanner, trace: Trace, look: Callable[[], WorldState], stop: StopToken
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
                yield from _stranded(controller, name, state, stop)
    except (Stopped, ControlError):
        return  # what was done is told all the same


def fallen_things(trace: Trace) -> list[str]:
    """Names of what lies or stands on another face than at the beginning, as it was seen."""
    ups = {name: from_quaternion(seen[[0, -1], :4])[:, 2] for name, seen in trace.seen.items()}
    return [name for name, (first, last) in ups.items() if first @ last < _LEANING]


def _stranded(
    controller: StepPlanner, name: str, state: WorldState, stop: StopToken
) -> Iterator[str]:
    robot = RecallingRobot(controller.robot, stop, controller.time_limit)
    most = int(_MOST * controller.defaults.most_work)
    for frame in _frames_of(name):
        plan = controller.planner or partial(planning.plan, budget=SearchBudget(most))
        made = plan(frame, state, robot, defaults=controller.defaults)
        if not isinstance(made, Refusal):
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
