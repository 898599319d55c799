"""The planning problem of a frame: of pushes, or of a whole hand.

Names of directions, faces, regions and degrees become headings, heights, newtons and metres per
second. What this version has no controller for is refused here, by the name of the capability.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from grammar.frames import command as g
from objectmodels.models.object_model import LEVEL
from planner.problem import planning_problem
from planner.problem.constraint_limits import apply_constraint, grasp_limits, tilt_goal
from planner.problem.directions import HEADINGS, heading_of
from planner.problem.goal_poses import find_goal_poses
from planner.refusals.no_plan import no_plan, not_capable
from planner.types.defaults import Defaults
from planner.types.plan import DefaultUsed, Plan
from planner.types.robot import Failed, NoRobot, Robot
from planner.types.world_state import SeenObject, WorldState

_DOING = {"rotate": "turning", "tilt": "tilting", "topple": "toppling"}
_NO_CONTROLLER = {
    "lift": "lifting objects",
    "open": "opening objects",
    "close": "closing objects",
    "pour": "pouring",
    "hand_over": "handing objects over",
    "parameters": "finding out parameters with one push",
}


def interpret_frame(
    frame: g.Frame,
    state: WorldState,
    defaults: Defaults,
    robot: Robot | None = None,
    *,
    previous: Plan | None = None,
    failed: Sequence[Failed] = (),
) -> planning_problem.PushProblem:
    """The planning problem of a frame.

    Args:
        frame: what is asked, its objects resolved to names in `state`.
        state: what is believed.
        defaults: what a clause means when the sentence does not say more.
        robot: that is to do it; None if only the meaning of the frame is wanted.
        previous: the plan whose first push was made last.
        failed: pushes and holds of this frame that went wrong.

    Raises:
        NoPlanError: the frame asks for something that this version cannot do.
    """
    if frame.query or frame.dialogue or frame.object is None or frame.object.id is None:
        raise not_capable(
            "planning what is no command", "only a command about an object is planned", frame.spans
        )
    target = state.objects[frame.object.id]
    speed = DefaultUsed(name="speed", value=defaults.speed, unit="m/s", reason="no speed said")
    problem = _with_goal(
        planning_problem.PlanningProblem(
            frame,
            target,
            state,
            robot or NoRobot(),
            defaults,
            planning_problem.PushGoal(),
            planning_problem.ContactLimits(high=target.model.top),
            planning_problem.ForceLimits(defaults.force_reserve),
            planning_problem.MotionLimits(defaults.speed),
            planning_problem.Effort.from_defaults(defaults),
            (speed,),
            previous,
            tuple(failed),
        )
    )
    # How far it will tilt is known when all others are read.
    for clause in sorted(frame.constraints, key=lambda c: c.kind == "no_spill"):
        problem = apply_constraint(problem, clause)
    return problem


def _with_goal(problem: planning_problem.PushProblem) -> planning_problem.PushProblem:
    """The problem with the goal of its frame."""
    goal, used = problem.frame.goal, problem.defaults_used
    if isinstance(goal, g.Topple):
        heading = HEADINGS[goal.direction] if goal.direction else None
        return replace(problem, goal=planning_problem.PushGoal("topple", heading))
    if isinstance(goal, g.Tilt):
        angle, reason = tilt_goal(goal, problem.target.model, problem.defaults)
        if reason:
            used = (DefaultUsed(name="tilt", value=angle, unit="rad", reason=reason), *used)
        heading = HEADINGS[goal.direction] if goal.direction else None
        return replace(
            problem,
            goal=planning_problem.PushGoal("topple", heading, tilt=angle),
            defaults_used=used,
        )
    if isinstance(goal, g.Upright):
        # The fall over the edge between the face below and the bottom.
        foot = -problem.target.body_pose[0][:, 2]
        if math.hypot(foot[0], foot[1]) < math.cos(LEVEL):
            raise no_plan("no_edge", object=problem.target.name, side=problem.target.side_below)
        return replace(problem, goal=planning_problem.PushGoal("topple", heading_of(foot)))
    if not isinstance(goal, g.Displace | g.Place | g.Rotate | g.NoGoal):
        what = _NO_CONTROLLER.get(goal.kind, goal.kind)
        message = f"this version of the robot has no controller for {what}"
        spans = goal.spans or problem.frame.spans
        raise not_capable(what, message, spans, "push, turn, tilt or topple it")
    found = find_goal_poses(problem)
    return replace(problem, goal=found.goal, defaults_used=found.defaults_used + used)


def grasp_problem(
    frame: g.Frame,
    state: WorldState,
    robot: Robot,
    defaults: Defaults,
    failed: Sequence[Failed] = (),
) -> planning_problem.GraspProblem:
    """The planning problem of a frame that takes a whole hand; see `interpret_frame`.

    Raises:
        NoPlanError: the hand is not free, nothing is held, or the object lies in a way that does
            not do.
    """
    d = defaults
    used = DefaultUsed(name="carry_speed", value=d.carry_speed, unit="m/s", reason="no speed said")
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
        raise no_plan("hand_not_free", object=held.name)
    target = state.objects[name]
    require_resting(target)
    require_no_load(target, state)
    if frame.goal.kind in ("open", "close", "pour") and target.rest is not None:
        doing = planning_problem.HAND_GOALS[frame.goal.kind]
        raise no_plan("lies", object=name, side=target.side_below, doing=doing)
    if not isinstance(frame.goal, g.Lift | g.Place | g.SetDown):
        require_on_table(target, state)
    return grasp_limits(
        planning_problem.PlanningProblem(
            frame,
            target,
            state,
            robot,
            d,
            planning_problem.GraspGoal(planning_problem.HAND_GOALS[frame.goal.kind]),
            planning_problem.ContactLimits(),
            planning_problem.ForceLimits(d.grasp_reserve),
            planning_problem.MotionLimits(d.carry_speed, d.lid_speed),
            planning_problem.Effort.from_defaults(d),
            (used,),
            failed=tuple(failed),
        )
    )


def require_resting(target: SeenObject) -> None:
    """Make sure that an object rests on one of its faces.

    Raises:
        NoPlanError: it lies on its round side, or leans on something.
    """
    if target.attitude is None:
        return
    level = abs(target.attitude[-1]) < math.sin(LEVEL)
    rolls = level and target.model.footprint.is_round
    raise no_plan("rolls" if rolls else "leans", object=target.name)


def require_loose(frame: g.Frame, target: SeenObject) -> None:
    """Make sure that nothing keeps an object where it stands, if a push is to move it.

    Raises:
        NoPlanError: a holder does.
    """
    if target.fixed and frame.goal.kind != "none":
        raise no_plan("is_fixed", doing=_DOING.get(frame.goal.kind, "moving"), object=target.name)


def require_no_load(target: SeenObject, state: WorldState) -> None:
    """Make sure that nothing stands on an object.

    Raises:
        NoPlanError: something does.
    """
    for seen in state.carried_by(target.name):
        code = "contains" if state.stands_inside(seen) else "carries"
        raise no_plan(code, object=target.name, other=seen.name)


def require_on_table(target: SeenObject, state: WorldState) -> None:
    """Make sure that an object stands on the table, with nothing on it.

    Raises:
        NoPlanError: it does not.
    """
    require_no_load(target, state)
    if target.on is not None:
        code = "stands_in" if state.stands_inside(target) else "stands_on"
        raise no_plan(code, object=target.name, other=target.on)


def require_other_objects(frame: g.Frame) -> None:
    """Make sure that a place is told by other objects than the one that goes there.

    Raises:
        NoPlanError: the place is at the object itself, or between one object.
    """
    goal, own = frame.goal, frame.object
    if not isinstance(goal, g.Place) or isinstance(goal.reference, str | g.Point) or own is None:
        return
    names = [other.id for other in goal.reference]
    if own.id in names:
        raise no_plan("place_at_itself", spans=goal.spans, object=own.id)
    if len(names) > len(set(names)):
        raise no_plan("between_one", spans=goal.spans, object=own.id, other=names[0])
