"""From a frame to what a whole hand does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from grammar.frames import command as g
from planner.grasping.lid_planner import close_lid, open_lid
from planner.grasping.lift_planner import lift, place, set_down
from planner.grasping.pour_planner import pour_out
from planner.problem.constraint_limits import grasp_limits
from planner.problem.hand_goals import HAND_GOALS
from planner.problem.planning_problem import (
    ContactLimits,
    Effort,
    ForceLimits,
    GraspGoal,
    MotionLimits,
    PlanningProblem,
)
from planner.refusals import push_refusals
from planner.refusals.refusal_builder import no_plan
from planner.types.dead_ends import NoPlanError
from planner.types.plan import DefaultUsed

if TYPE_CHECKING:
    from planner.problem.planning_problem import GraspProblem
    from planner.types.defaults import Defaults
    from planner.types.plan import Plan, Reached
    from planner.types.robot import Robot
    from planner.types.world_state import SeenObject, WorldState


def plan_grasp(
    frame: g.Frame, state: WorldState, robot: Robot, defaults: Defaults
) -> Plan | Reached:
    """Plan a grasp and steps that satisfy a frame.

    Args:
        frame: what is asked, its objects resolved to names in `state`.
        state: what the robot believes.
        robot: that is to do it.
        defaults: what a clause means when the sentence does not say more.

    Raises:
        NoPlanError: there is no plan.
    """
    d = defaults
    used = DefaultUsed(name="carry_speed", value=d.carry_speed, unit="m/s", reason="no speed said")
    problem = PlanningProblem(
        frame,
        _target(frame, state),
        state,
        robot,
        d,
        GraspGoal(HAND_GOALS[frame.goal.kind]),
        ContactLimits(),
        ForceLimits(d.grasp_reserve),
        MotionLimits(d.carry_speed, d.lid_speed),
        Effort.from_defaults(d),
        (used,),
    )
    return _plan_goal(grasp_limits(problem))


def _target(frame: g.Frame, state: WorldState) -> SeenObject:
    held = state.held
    name = frame.object.id if frame.object is not None else None
    if name is None and isinstance(frame.goal, g.SetDown):
        if held is None:
            raise no_plan("holds_nothing")
        name = held.name
    assert name is not None, "objects are resolved by now"
    # A hand that holds an object has none left for its lid.
    by_lid = isinstance(frame.goal, g.Open | g.Close)
    if held is not None and (held.name != name or by_lid):
        raise NoPlanError(push_refusals.hand_not_free(held.name))
    target = state.objects[name]
    if target.lies_on != "bottom":
        raise NoPlanError(push_refusals.object_lies(target))
    return target


def _plan_goal(problem: GraspProblem) -> Plan | Reached:
    match problem.frame.goal:
        case g.Lift() as goal:
            return lift(problem, goal)
        case g.SetDown():
            return set_down(problem)
        case g.Place():
            return place(problem)
        case g.Pour() as goal:
            return pour_out(problem, goal)
        case g.Open():
            return open_lid(problem)
        case g.Close():
            return close_lid(problem)
    raise AssertionError(f"{problem.frame.goal.kind} takes no hand")
