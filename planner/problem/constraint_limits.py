"""Constraints of a sentence as limits on contact, force and motion: one table for all kinds.

Each kind has a row in `LIMITS`: how it limits pushes, how it limits what a whole hand does, and
words for what a hand lacks that cannot keep it. What is held is held upright and keeps its heading,
so most of what a sentence forbids a hand holds anyhow.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from grammar.frames import command as g
from planner.problem.contact_heights import (
    limit_fingertips,
    limit_grasp_contact,
    limit_push_contact,
    require_whole_hand,
)
from planner.problem.planning_problem import GoalT, GraspProblem, PlanningProblem, PushProblem
from planner.problem.tilt_goals import almost_tips, most_tilt, spill_tilt
from planner.refusals.refusal_builder import no_plan, not_capable, unsupported_while
from planner.types.actions import Aim
from planner.types.refusal import NoPlanError
from planner.types.speed_profile import LIFT_SPEED, reached_speed


@dataclass(frozen=True)
class ConstraintRule:
    """Rule by which one kind of constraint limits a problem.

    Attributes:
        push: makes the problem of pushes that keep it; None if no push does.
        grasp: makes the problem of a hand that keeps it; None if no hand does.
        unsupported: words for what no hand does, such as `moving fast`.
    """

    push: Callable[[PushProblem, Any], PushProblem] | None = None
    grasp: Callable[[GraspProblem, Any], GraspProblem] | None = None
    unsupported: str = ""


def apply_constraint(problem: PushProblem, clause: g.Constraint) -> PushProblem:
    """The problem of pushes with one more constraint.

    Raises:
        NoPlanError: the constraint contradicts the goal, or this version cannot keep it.
    """
    rule = LIMITS[clause.kind]
    if rule.push is None:
        what = clause.kind.replace("_", " ")
        raise not_capable(what, f"this version of the robot is not capable of {what}", clause.spans)
    return rule.push(problem, clause)


def grasp_limits(problem: GraspProblem) -> GraspProblem:
    """The problem of a hand with the constraints of its frame.

    Raises:
        NoPlanError: this version cannot keep one of them.
    """
    for clause in problem.frame.constraints:
        rule = LIMITS[clause.kind]
        if rule.grasp is None:
            raise unsupported_while(rule.unsupported, problem.goal.doing, clause.spans)
        problem = rule.grasp(problem, clause)
    return problem


def _keep_anyhow(problem: PlanningProblem[GoalT], clause: g.Constraint) -> PlanningProblem[GoalT]:
    """The same problem: pushes on the table, or what is held, keep it anyhow."""
    return problem


def _contradiction(message: str, spans: g.Spans, **numbers: float) -> NoPlanError:
    return no_plan("contradiction", numbers, spans=spans, message=message)


def _with_tilt(problem: PushProblem, tilt: float) -> PushProblem:
    """The problem with a narrower limit of the tilt [rad]."""
    narrowest = min(tilt, problem.motion.tilt or math.inf)
    return replace(problem, motion=replace(problem.motion, tilt=narrowest))


# -- tilting, turning, sliding ----------------------------------------------------------------


def _stay_on_base(problem: PushProblem, clause: g.NoTopple | g.NoTilt | g.MaxTilt) -> PushProblem:
    """An object that slides stays on its base, one that is tilted comes back."""
    defaults, goal = problem.defaults, problem.goal
    most = {"no_topple": None, "no_tilt": defaults.no_tilt}.get(clause.kind)
    if isinstance(clause, g.MaxTilt):
        most = clause.value
    if goal.outcome == "slide":
        return problem if most is None else _with_tilt(problem, most)
    if goal.tilt is None or clause.kind == "no_tilt":
        raise _contradiction("it cannot topple and stay on its base", clause.spans)
    if most is None:
        return problem
    if most < goal.tilt - defaults.tolerance_of(goal.tilt, defaults.tilt_tolerance):
        asks = f"{math.degrees(goal.tilt):.0f}° are asked"
        message = f"{asks}, but {math.degrees(most):.0f}° are the most that is allowed"
        raise _contradiction(message, clause.spans)
    return _with_tilt(problem, most)


def _keep_upright(problem: GraspProblem, clause: g.NoTilt | g.MaxTilt) -> GraspProblem:
    if isinstance(clause, g.MaxTilt) and clause.value < problem.defaults.upright:
        least = math.degrees(problem.defaults.upright)
        what = f"keeping it within less than {least:.0f}° of upright"
        raise unsupported_while(what, problem.goal.doing, clause.spans)
    motion = replace(problem.motion, upright=problem.motion.upright + clause.spans)
    return replace(problem, motion=motion)


def _stay_on_table(problem: GraspProblem, clause: g.NoLift) -> GraspProblem:
    motion = replace(problem.motion, on_the_table=problem.motion.on_the_table + clause.spans)
    return replace(problem, motion=motion)


def _stay_in_place(problem: PushProblem, clause: g.NoSlide) -> PushProblem:
    if problem.goal.aims:
        raise _contradiction("it cannot move over the table and not slide", clause.spans)
    return problem


def _keep_heading(problem: PushProblem, clause: g.NoTurn | g.MaxTurn) -> PushProblem:
    most = problem.defaults.no_turn if isinstance(clause, g.NoTurn) else clause.value
    goal, yaw = problem.goal, problem.target.pose.yaw
    turned = [abs(yaw if aim.yaw is None else aim.yaw - yaw) for aim in goal.aims]
    if goal.rotates and min(turned) > most:
        raise _contradiction("it cannot turn and keep its heading", clause.spans)
    narrowest = min(most, problem.motion.turn or math.inf)
    return replace(problem, motion=replace(problem.motion, turn=narrowest))


def _push_until(problem: PushProblem, clause: g.Until) -> PushProblem:
    """A push that ends with the object's fall, or with a tilt well before it."""
    if clause.event not in ("tips", "about_to_tip"):
        if not problem.goal.aims:
            what = f"toppling until '{clause.event}'"
            raise not_capable(what, f"this version is not capable of {what}", clause.spans)
        return problem  # the aim is where it happens
    tilt = problem.goal.tilt
    if clause.event == "about_to_tip":
        tilt = almost_tips(problem.target.model, problem.defaults)
    goal = replace(problem.goal, outcome="topple", aims=(), distance=math.inf, tilt=tilt)
    return replace(problem.without_default("distance"), goal=goal)


def _keep_contents(problem: PushProblem, clause: g.NoSpill) -> PushProblem:
    """It leans less than what makes its contents run out; what slides upright keeps them."""
    defaults, goal = problem.defaults, problem.goal
    spills = spill_tilt(problem.target, defaults.sigmas)
    if spills is None:
        return problem
    most = max(spills, defaults.rest_tilt)
    if goal.outcome == "slide":
        return _with_tilt(problem, most)
    if goal.tilt is not None and most_tilt(goal.tilt, defaults) <= spills:
        return _with_tilt(problem, most)
    does, numbers = "toppling tilts it further", {"spill_angle": spills}
    if goal.tilt is not None:
        does = f"{math.degrees(goal.tilt):.0f}° are asked"
        numbers["tilt"] = goal.tilt
    begins = f"the {problem.target.name} begins to spill at {math.degrees(spills):.0f}°"
    raise _contradiction(f"{begins}; {does}", clause.spans, **numbers)


# -- others -----------------------------------------------------------------------------------


def _keep_clear(problem: PlanningProblem[GoalT], clause: g.NoTouch) -> PlanningProblem[GoalT]:
    """The problem with objects from which a distance is kept, on the way and by a guard."""
    others = list(problem.others)
    if clause.object is not None:
        assert clause.object.id is not None, "objects are resolved by now"
        others = [clause.object.id]
    apart = problem.defaults.clearance if clause.clearance is None else clause.clearance
    before = dict(problem.motion.clear_of)
    both = {name: max(apart, before.get(name, 0.0)) for name in others}
    kept = tuple(sorted({**before, **both}.items()))
    return replace(problem, motion=replace(problem.motion, clear_of=kept))


def _push_clear(problem: PushProblem, clause: g.NoTouch) -> PushProblem:
    limited, meets = _keep_clear(problem, clause), problem.goal.meets
    others = problem.others if clause.object is None else (clause.object.id,)
    if meets in others:
        raise _contradiction(f"it cannot touch the {meets} and not touch it", clause.spans)
    return limited


# -- force ------------------------------------------------------------------------------------


def _push_at_most(problem: PushProblem, clause: g.MaxForce | g.Force) -> PushProblem:
    largest = min(problem.force.max, clause.value)
    return replace(problem, force=replace(problem.force, max=largest, spans=clause.spans))


def _squeeze_at_most(problem: GraspProblem, clause: g.MaxForce | g.Force) -> GraspProblem:
    largest, spans = min(problem.force.max, clause.value), problem.force.spans + clause.spans
    return replace(problem, force=replace(problem.force, max=largest, spans=spans))


def _push_at_least(problem: PushProblem, clause: g.MinForce) -> PushProblem:
    return replace(problem, force=replace(problem.force, min=clause.value, spans=clause.spans))


def _push_hard(problem: PushProblem, clause: g.Hard) -> PushProblem:
    return replace(problem, force=replace(problem.force, least_limit=problem.defaults.force_hard))


def _push_gently(problem: PushProblem, clause: g.Gentle) -> PushProblem:
    force = replace(problem.force, reserve=problem.defaults.force_reserve_gentle)
    return _limit_speed(replace(problem, force=force), problem.defaults.speed_gentle)


def _grasp_gently(problem: GraspProblem, clause: g.Gentle) -> GraspProblem:
    reserve = min(problem.force.reserve, problem.defaults.grasp_reserve_gentle)
    force = replace(problem.force, reserve=reserve)
    return _limit_speed(replace(problem, force=force), problem.defaults.carry_speed_gentle)


# -- speed and time ---------------------------------------------------------------------------


def _limit_speed(problem: PlanningProblem[GoalT], speed: float) -> PlanningProblem[GoalT]:
    """The problem with a lower speed [m/s]; one that the sentence gave is no default any more."""
    motion = problem.motion
    motion = replace(motion, speed=min(motion.speed, speed), lid_speed=min(motion.lid_speed, speed))
    return replace(problem.without_default("speed").without_default("carry_speed"), motion=motion)


def _at_speed(problem: PushProblem, speed: float, spans: g.Spans) -> PushProblem:
    most = problem.defaults.speed_most
    if speed > most:
        what, goal = "objects keep to the fingertips up to", problem.goal
        if goal.aims and not goal.rotates and reached_speed(most, goal.distance) < most:
            what = f"over {1e3 * goal.distance:.0f} mm the fingertips come to"
            most = reached_speed(most, goal.distance)
        raise _too_fast(speed, most, what, spans)
    motion = replace(problem.motion, speed=speed)
    return replace(problem.without_default("speed"), motion=motion)


def _too_fast(speed: float, most: float, what: str, spans: g.Spans) -> NoPlanError:
    return no_plan("too_fast", {"speed": speed, "most": most}, spans=spans, what=what)


def _push_slowly(problem: PushProblem, clause: g.Slow) -> PushProblem:
    return _limit_speed(problem, problem.defaults.speed_gentle)


def _push_fast(problem: PushProblem, clause: g.Fast) -> PushProblem:
    return _at_speed(problem, problem.defaults.speed_fast, clause.spans)


def _push_at_speed(problem: PushProblem, clause: g.Speed | g.MinSpeed) -> PushProblem:
    return _at_speed(problem, clause.value, clause.spans)


def _move_at_most(problem: PlanningProblem[GoalT], clause: g.MaxSpeed) -> PlanningProblem[GoalT]:
    return _limit_speed(problem, clause.value)


def _carry_slowly(problem: GraspProblem, clause: g.Slow) -> GraspProblem:
    return _limit_speed(problem, problem.defaults.carry_speed_gentle)


def _carry_at_speed(problem: GraspProblem, clause: g.Speed | g.MinSpeed) -> GraspProblem:
    most, doing = problem.defaults.carry_speed, "moved"
    if problem.frame.goal.kind not in ("place", "pour"):
        most, doing = min(most, LIFT_SPEED), "lifted"
    if clause.value > most:
        raise _too_fast(clause.value, most, f"what is held is {doing} at up to", clause.spans)
    return problem if isinstance(clause, g.MinSpeed) else _limit_speed(problem, clause.value)


def _push_within(problem: PushProblem, clause: g.MaxDuration) -> PushProblem:
    shortest = min(clause.value, problem.motion.duration or math.inf)
    motion = replace(problem.motion, duration=shortest, spans=clause.spans)
    return replace(problem, motion=motion)


def _push_exactly(problem: PushProblem, clause: g.Duration) -> PushProblem:
    what = "pushing for an exact time"
    raise not_capable(what, f"this version of the robot is not capable of {what}", clause.spans)


# -- how far ----------------------------------------------------------------------------------


def _push_near(problem: PushProblem, clause: g.MaxDistance) -> PushProblem:
    """The limit is kept with the tolerance to spare, if that is still far enough."""
    goal, tolerance = problem.goal, problem.defaults.distance_tolerance
    if not goal.aims:
        raise not_capable(
            "limiting how far a toppling object moves",
            "this version does not limit how far an object moves while it topples",
            clause.spans,
        )
    most = clause.value - min(tolerance, 0.5 * clause.value)
    start = problem.target.pose.x, problem.target.pose.y
    lengths = {aim: math.dist((aim.x, aim.y), start) for aim in goal.aims}
    aims = tuple(
        _shorten_aim(aim, start, min(1.0, most / max(lengths[aim], 1e-9)))
        for aim in goal.aims
        if lengths[aim] - tolerance <= most
    )
    if not aims:
        nearest = min(lengths.values())
        message = (
            f"{1e3 * nearest:.0f} mm are to be moved, but {1e3 * clause.value:.0f} mm "
            "are the most that is allowed"
        )
        numbers = {"distance": nearest, "max_distance": clause.value}
        raise _contradiction(message, clause.spans, **numbers)
    return replace(problem, goal=replace(goal, aims=aims, distance=min(goal.distance, most)))


def _shorten_aim(aim: Aim, start: tuple[float, float], share: float) -> Aim:
    """An aim that lies only a share of the way from a start."""
    x, y = (a + share * (b - a) for a, b in zip(start, (aim.x, aim.y), strict=True))
    return Aim(x=x, y=y, yaw=aim.yaw)


LIMITS: dict[str, ConstraintRule] = {
    "no_topple": ConstraintRule(_stay_on_base, _keep_anyhow),
    "no_tilt": ConstraintRule(_stay_on_base, _keep_upright),
    "max_tilt": ConstraintRule(_stay_on_base, _keep_upright),
    "no_slide": ConstraintRule(_stay_in_place, _keep_anyhow),
    "no_turn": ConstraintRule(_keep_heading, _keep_anyhow),
    "max_turn": ConstraintRule(_keep_heading, _keep_anyhow),
    "no_spill": ConstraintRule(_keep_contents, _keep_anyhow),
    "no_lift": ConstraintRule(_keep_anyhow, _stay_on_table),
    "no_touch": ConstraintRule(_push_clear, _keep_clear),
    "max_force": ConstraintRule(_push_at_most, _squeeze_at_most),
    "force": ConstraintRule(_push_at_most, _squeeze_at_most),
    "min_force": ConstraintRule(_push_at_least, unsupported="pressing with a least force"),
    "hard": ConstraintRule(_push_hard, unsupported="using much force"),
    "gentle": ConstraintRule(_push_gently, _grasp_gently),
    "slow": ConstraintRule(_push_slowly, _carry_slowly),
    "fast": ConstraintRule(_push_fast, unsupported="moving fast"),
    "speed": ConstraintRule(_push_at_speed, _carry_at_speed),
    "min_speed": ConstraintRule(_push_at_speed, _carry_at_speed),
    "max_speed": ConstraintRule(_move_at_most, _move_at_most),
    "max_duration": ConstraintRule(_push_within, unsupported="keeping to a time"),
    "duration": ConstraintRule(_push_exactly, unsupported="keeping to a time"),
    "max_distance": ConstraintRule(_push_near, unsupported="limiting a distance"),
    "contact": ConstraintRule(limit_push_contact, limit_grasp_contact),
    "effector": ConstraintRule(limit_fingertips, require_whole_hand),
    "until": ConstraintRule(_push_until, unsupported="stopping at an event"),
}
"""The rule for every kind of constraint."""
