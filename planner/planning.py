"""From a frame to actions whose predicted outcome satisfies it, or to a refusal with numbers.

What takes a whole hand (lifting, pouring, opening) is planned in `planner.grasping`, if the robot
has one; what is to be placed is lifted where it can be, and pushed where not. All else is pushed.

What is asked (`planner.problem.push_problem`) is a fall or a tilt
(`planner.pushing.topple_planner`), or an aim on the table, to which the object goes by several
pushes (`planner.pushing.push_sequence`). All pushes together must be likely enough; before that is
refused, it is attempted with more effort (`planner.pushing.strategies`).

Frames: W is the world, B the object.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, overload

from grammar.frames import command as g
from planner.problem.hand_goals import is_handled
from planner.problem.place_regions import region
from planner.problem.push_problem import read
from planner.pushing.strategies import Attempt, persistently
from planner.refusals import push_refusals as refusals
from planner.refusals.push_refusals import NoPlanError
from planner.types.defaults import DEFAULTS, Defaults
from planner.types.plan import Plan, Reached
from planner.types.refusal import Refusal
from planner.types.robot import Patient

if TYPE_CHECKING:
    from planner.types.plan import Plan
    from planner.types.robot import HandReach, Reach
    from planner.types.world_state import WorldState


@overload
def plan(
    frame: g.Frame,
    state: WorldState,
    reach: Reach,
    *,
    defaults: Defaults = DEFAULTS,
    before: Plan | None = None,
) -> Plan | Reached | Refusal: ...


@overload
def plan(
    frame: g.Frame,
    state: WorldState,
    reach: Reach,
    *,
    hand: HandReach | None,
    defaults: Defaults = DEFAULTS,
    before: Plan | None = None,
) -> Plan | Reached | Refusal: ...


def plan(
    frame: g.Frame,
    state: WorldState,
    reach: Reach,
    *,
    hand: HandReach | None = None,
    defaults: Defaults = DEFAULTS,
    before: Plan | None = None,
) -> Plan | Reached | Refusal:
    """Finds what satisfies a frame: pushes, or what a whole hand does.

    Args:
        frame: what is asked, its objects resolved to names in `state`.
        state: what the robot believes; the object's heading counts whole turns after a plan before.
        reach: whether the hand gets somewhere with its fingertips.
        hand: what it can hold; None of a robot that only pushes.
        defaults: what a clause means when the sentence does not say more.
        before: the plan whose first push was made last; its aim is kept.

    Returns:
        A plan; that nothing is left to be done; or the reason why there is no plan.
    """
    if hand is None or before is not None or not is_handled(frame):
        return _pushes(frame, state, reach, defaults, before)
    from planner.grasping.grasp_planning import handle  # pushes do without it

    if not isinstance(frame.goal, g.Place):
        return handle(frame, state, hand, defaults)
    # What is nearly there is moved least by a push.
    handled = None if _is_there(frame, state, defaults) else handle(frame, state, hand, defaults)
    if state.held is not None and isinstance(handled, Refusal):
        return handled
    if handled is not None and not isinstance(handled, Refusal):
        return handled
    return _pushes(frame, state, reach, defaults, before)


def _is_there(frame: g.Frame, state: WorldState, defaults: Defaults) -> bool:
    """Whether what is to be placed stands in its place already."""
    assert isinstance(frame.goal, g.Place)
    assert frame.object is not None
    target = state.objects[frame.object.id or ""]
    there = None if frame.goal.fraction is not None else region(frame.goal, state, defaults)
    return state.held is None and there is not None and there.holds(target)


def _pushes(
    frame: g.Frame, state: WorldState, reach: Reach, defaults: Defaults, before: Plan | None
) -> Plan | Reached | Refusal:
    try:
        asked = read(frame, state, defaults)
        assert frame.object is not None
        assert frame.object.id is not None
        target = state.objects[frame.object.id]
        if state.held is not None:
            raise NoPlanError(refusals.holds(state.held.name))
        if target.lies_on != "bottom":
            raise NoPlanError(refusals.lies(target))
    except NoPlanError as refused:
        return refused.refusal
    patient = Patient(reach, defaults.most_looks, state)
    return persistently(Attempt(asked, target, state, patient, defaults, before))
