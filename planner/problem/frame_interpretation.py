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
from planner.refusals.blocked import Blocked, dead_end
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
) -> planning_problem.PushProblem | Blocked:
    """The planning problem of a frame, or why this version cannot do what it asks for.

    Args:
        frame: what is asked, its objects resolved to names in `state`.
        state: what is believed.
        defaults: what a clause means when the sentence does not say more.
        robot: that is to do it; None if only the meaning of the frame is wanted.
        previous: the plan whose first push was made last.
        failed: pushes and holds of this frame that went wrong.
    """
    if frame.query or frame.dialogue or frame.object is None or frame.object.id is None:
        return dead_end("not_capable.command", spans=frame.spans)
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
        if isinstance(problem, Blocked):
            return problem
        problem = apply_constraint(problem, clause)
    return problem


def _with_goal(
    problem: planning_problem.PushProblem,
) -> planning_problem.PushProblem | Blocked:
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
            return dead_end("no_edge", object=problem.target.name, side=problem.target.side_below)
        return replace(problem, goal=planning_problem.PushGoal("topple", heading_of(foot)))
    if not isinstance(goal, g.Displace | g.Place | g.Rotate | g.NoGoal):
        what, spans = _NO_CONTROLLER.get(goal.kind, goal.kind), goal.spans or problem.frame.spans
        return dead_end("not_capable.controller", spans=spans, what=what)
    found = find_goal_poses(problem)
    if isinstance(found, Blocked):
        return found
    return replace(problem, goal=found.goal, defaults_used=found.defaults_used + used)


def grasp_problem(
    frame: g.Frame,
    state: WorldState,
    robot: Robot,
    defaults: Defaults,
    failed: Sequence[Failed] = (),
) -> planning_problem.GraspProblem | Blocked:
    """The planning problem of a frame that takes a whole hand; see `interpret_frame`."""
    d = defaults
    used = DefaultUsed(name="carry_speed", value=d.carry_speed, unit="m/s", reason="no speed said")
    held = state.held
    name = frame.object.id if frame.object is not None else None
    if name is None and isinstance(frame.goal, g.SetDown):
        if held is None:
            return dead_end("holds_nothing")
        name = held.name
    assert name is not None, "objects are resolved by now"
    # A hand that holds an object has none left for its lid.
    by_lid = isinstance(frame.goal, g.Open | g.Close)
    if held is not None and (held.name != name or by_lid):
        return dead_end("hand_not_free", object=held.name)
    target = state.objects[name]
    if why := why_not_resting(target) or why_not_bare(target, state):
        return why
    if frame.goal.kind in ("open", "close", "pour") and target.rest is not None:
        doing = planning_problem.HAND_GOALS[frame.goal.kind]
        return dead_end("lies", object=name, side=target.side_below, doing=doing)
    by_itself = isinstance(frame.goal, g.Lift | g.Place | g.SetDown)
    if not by_itself and (why := why_not_on_table(target, state)):
        return why
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


def why_not_resting(target: SeenObject) -> Blocked | None:
    """It lies on its round side, or leans on something."""
    if target.attitude is None:
        return None
    level = abs(target.attitude[-1]) < math.sin(LEVEL)
    rolls = level and target.model.footprint.is_round
    return dead_end("rolls" if rolls else "leans", object=target.name)


def why_not_loose(frame: g.Frame, target: SeenObject) -> Blocked | None:
    """A holder keeps an object where it stands, if a push is to move it."""
    if target.fixed and frame.goal.kind != "none":
        return dead_end("is_fixed", doing=_DOING.get(frame.goal.kind, "moving"), object=target.name)
    return None


def why_not_bare(target: SeenObject, state: WorldState) -> Blocked | None:
    """Something stands on an object, or in it."""
    for seen in state.carried_by(target.name):
        code = "contains" if state.stands_inside(seen) else "carries"
        return dead_end(code, object=target.name, other=seen.name)
    return None


def why_not_on_table(target: SeenObject, state: WorldState) -> Blocked | None:
    """Something stands on an object, or it stands on something."""
    if why := why_not_bare(target, state):
        return why
    if target.on is not None:
        code = "stands_in" if state.stands_inside(target) else "stands_on"
        return dead_end(code, object=target.name, other=target.on)
    return None


def why_no_place(frame: g.Frame) -> Blocked | None:
    """A place is told by the object that goes there, or as between one object."""
    goal, own = frame.goal, frame.object
    if not isinstance(goal, g.Place) or isinstance(goal.reference, str | g.Point) or own is None:
        return None
    names = [other.id for other in goal.reference]
    if own.id in names:
        return dead_end("place_at_itself", spans=goal.spans, object=own.id)
    if len(names) > len(set(names)):
        return dead_end("between_one", spans=goal.spans, object=own.id, other=names[0])
    return None
