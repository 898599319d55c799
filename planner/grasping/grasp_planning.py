"""From a frame to what a whole hand does, or to a refusal with numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from grammar.frames import command as g
from planner.grasping.lid_planner import close_lid, open_lid
from planner.grasping.lift_planner import lift, place, set_down
from planner.grasping.pour_planner import pour_out
from planner.problem.grasp_limits import Setting, manner
from planner.problem.hand_goals import HAND_GOALS
from planner.problem.planning_problem import Task
from planner.refusals import grasp_refusals as refusals
from planner.refusals import push_refusals as pushing
from planner.refusals.push_refusals import NoPlanError

if TYPE_CHECKING:
    from planner.types.defaults import Defaults
    from planner.types.plan import Plan, Reached
    from planner.types.refusal import Refusal
    from planner.types.robot import HandReach
    from planner.types.world_state import SeenObject, WorldState


def handle(
    frame: g.Frame, state: WorldState, hand: HandReach, defaults: Defaults
) -> Plan | Reached | Refusal:
    """Finds a grasp and steps that satisfy a frame.

    Args:
        frame: what is asked, its objects resolved to names in `state`.
        state: what the robot believes.
        hand: what the hand can hold, and whether the arm gets there.
        defaults: what a clause means when the sentence does not say more.
    """
    try:
        target = _target(frame, state)
        doing = HAND_GOALS[frame.goal.kind]
        how = manner(frame, Setting(target, state, defaults, doing))
        task = Task(target, state, hand, how, defaults, doing)
        return _done(frame, task)
    except NoPlanError as refused:
        return refused.refusal


def _target(frame: g.Frame, state: WorldState) -> SeenObject:
    held = state.held
    name = frame.object.id if frame.object is not None else None
    if name is None and isinstance(frame.goal, g.SetDown):
        if held is None:
            raise refusals.holds_nothing()
        name = held.name
    assert name is not None, "objects are resolved by now"
    # A hand that holds an object has none left for its lid.
    by_lid = isinstance(frame.goal, g.Open | g.Close)
    if held is not None and (held.name != name or by_lid):
        raise NoPlanError(pushing.holds(held.name))
    target = state.objects[name]
    if target.lies_on != "bottom":
        raise NoPlanError(pushing.lies(target))
    return target


def _done(frame: g.Frame, task: Task) -> Plan | Reached:
    match frame.goal:
        case g.Lift() as goal:
            return lift(task, goal)
        case g.SetDown():
            return set_down(task)
        case g.Place():
            return place(task, frame)
        case g.Pour() as goal:
            return pour_out(task, goal)
        case g.Open():
            return open_lid(task)
        case g.Close():
            return close_lid(task)
    raise AssertionError(f"{frame.goal.kind} takes no hand")
