"""The planning problem of a frame whose object is pushed.

Names of directions, faces, regions and degrees become headings, heights, newtons and metres per
second. What this version has no controller for is refused here, by the name of the capability.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from grammar.frames import command as g
from planner.geometry.directions import HEADINGS
from planner.problem.constraint_limits import apply_constraint
from planner.problem.goal_poses import find_goal_poses
from planner.problem.planning_problem import (
    ContactLimits,
    Effort,
    ForceLimits,
    MotionLimits,
    PlanningProblem,
    PushGoal,
    PushProblem,
)
from planner.problem.tilt_goals import tilt_goal
from planner.refusals.push_refusals import not_capable
from planner.types.plan import DefaultUsed
from planner.types.robot import NoRobot

if TYPE_CHECKING:
    from collections.abc import Sequence

    from planner.types.defaults import Defaults
    from planner.types.plan import Plan
    from planner.types.robot import FailedPush, Robot
    from planner.types.world_state import WorldState

_NO_CONTROLLER = {
    "upright": "standing objects up",
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
    failed: Sequence[FailedPush] = (),
) -> PushProblem:
    """The planning problem of a frame.

    Args:
        frame: what is asked, its objects resolved to names in `state`.
        state: what is believed.
        defaults: what a clause means when the sentence does not say more.
        robot: that is to do it; None if only the meaning of the frame is wanted.
        previous: the plan whose first push was made last.
        failed: pushes of this frame that went wrong.

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
        PlanningProblem(
            frame,
            target,
            state,
            robot or NoRobot(),
            defaults,
            PushGoal(),
            ContactLimits(high=target.model.top),
            ForceLimits(defaults.force_reserve),
            MotionLimits(defaults.speed),
            Effort.from_defaults(defaults),
            (speed,),
            previous,
            tuple(failed),
        )
    )
    # How far it will tilt is known when all others are read.
    for clause in sorted(frame.constraints, key=lambda c: c.kind == "no_spill"):
        problem = apply_constraint(problem, clause)
    return problem


def _with_goal(problem: PushProblem) -> PushProblem:
    """The problem with the goal of its frame."""
    goal, used = problem.frame.goal, problem.defaults_used
    if isinstance(goal, g.Topple):
        heading = HEADINGS[goal.direction] if goal.direction else None
        return replace(problem, goal=PushGoal("topple", heading))
    if isinstance(goal, g.Tilt):
        angle, reason = tilt_goal(goal, problem.target.model, problem.defaults)
        if reason:
            used = (DefaultUsed(name="tilt", value=angle, unit="rad", reason=reason), *used)
        heading = HEADINGS[goal.direction] if goal.direction else None
        return replace(problem, goal=PushGoal("topple", heading, tilt=angle), defaults_used=used)
    if not isinstance(goal, g.Displace | g.Place | g.Rotate | g.NoGoal):
        what = _NO_CONTROLLER.get(goal.kind, goal.kind)
        message = f"this version of the robot has no controller for {what}"
        spans = goal.spans or problem.frame.spans
        raise not_capable(what, message, spans, "push, turn, tilt or topple it")
    found = find_goal_poses(problem)
    return replace(problem, goal=found.goal, defaults_used=found.defaults_used + used)
