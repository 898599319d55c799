"""Constraints of a sentence as limits on contact, force and motion: one table for all kinds.

Each kind has a row in `LIMITS`: how it limits pushes, how it limits what a whole hand does, and
words for what a hand lacks that cannot keep it. What is held is held upright and keeps its heading,
so most of what a sentence forbids a hand holds anyhow.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from grammar.frames import command as g
from grammar.frames.command import Tilt
from objectmodels import ObjectModel
from objectmodels.mechanics.push_thresholds import largest_return, return_probability
from objectmodels.models.object_parts import FlipLid
from objectmodels.safety_figure import SafetyFigure
from planner.problem.directions import FACE_OF_PUSH, HEADINGS
from planner.problem.footprints import footprint, free_travel, leading_point
from planner.problem.planning_problem import (
    GoalT,
    GraspProblem,
    PlanningProblem,
    PushProblem,
    value_in_bound,
)
from planner.refusals.blocked import QUANTITIES, Blocked, dead_end, length_mark, tilt_mark
from planner.types.actions import Aim, Limits, Prediction, Push
from planner.types.defaults import Defaults
from planner.types.plan import LIFT_SPEED, reached_speed
from planner.types.world_state import SeenObject

Band = tuple[float, float, str]
"""The lowest and the highest of some heights [m], and words for them."""


def height_bands(clause: g.ContactRegion, top: float, defaults: Defaults) -> Iterator[Band]:
    """The heights that a clause allows on an object as high as `top` [m]; all of them hold."""
    if clause.region is not None:
        third = {"bottom": 0, "middle": 1, "top": 2}[clause.region]
        yield third * top / 3.0, (third + 1) * top / 3.0, f"at the {clause.region}"
    if clause.height is not None:
        yield _band_at(clause.height, top, defaults)


def _band_at(height: g.ContactHeight, top: float, defaults: Defaults) -> Band:
    assert isinstance(height.value, float), "lengths measured in objects are resolved by now"
    upwards = height.origin == "table"
    at = height.value if upwards else top - height.value
    where = f"{1e3 * at:.0f} mm above the table"
    if height.bound == "exact":
        near = 0.5 * defaults.height_tolerance
        return at - near, at + near, where
    if (height.bound == "at_least") == upwards:
        return at, top, f"at least {where}"
    return 0.0, at, f"at most {where}"


def _with_heights(
    problem: PlanningProblem[GoalT], clause: g.ContactRegion
) -> PlanningProblem[GoalT]:
    """The problem with one more restriction of the heights; all of them hold."""
    contact = replace(problem.contact, spans=problem.contact.spans + clause.spans)
    for low, high, words in height_bands(clause, problem.target.model.top, problem.defaults):
        region = f"{contact.region} and {words}" if contact.region else words
        contact = replace(
            contact, low=max(contact.low, low), high=min(contact.high, high), region=region
        )
    return replace(problem, contact=contact)


def limit_push_contact(problem: PushProblem, clause: g.ContactRegion) -> PushProblem | Blocked:
    """The problem with a push on one face, or between two heights."""
    goal = problem.goal
    if clause.face == "top" and (not goal.aims or goal.rotates or goal.until is not None):
        return dead_end("not_capable.top_face", spans=clause.spans)
    if clause.face is not None:
        if goal.outcome == "topple" and goal.heading is None:
            push = next(d for d, face in FACE_OF_PUSH.items() if face == clause.face)
            goal = replace(goal, heading=HEADINGS[push])
        contact = replace(problem.contact, face=clause.face)
        problem = replace(problem, goal=goal, contact=contact)
    return _with_heights(problem, clause)


def limit_grasp_contact(problem: GraspProblem, clause: g.ContactRegion) -> GraspProblem | Blocked:
    """The problem with a grasp between two heights."""
    if clause.face is not None:
        return _unsupported_while("touching a named face", problem.goal.doing, clause.spans)
    return _with_heights(problem, clause)


def limit_fingertips(problem: PushProblem, clause: g.Effector) -> PushProblem | Blocked:
    """The problem with the number of fingertips that a sentence asks for."""
    if why := _why_not_right(clause):
        return why
    if clause.tool == "arm" or (clause.tool == "hand" and clause.side is None):
        return dead_end("not_capable.tool", spans=clause.spans, tool=clause.tool)
    if clause.tool != "finger" or clause.count is None:
        return problem
    if clause.count > 2:
        return dead_end("not_capable.fingers", spans=clause.spans, count=clause.count)
    contact = replace(
        problem.contact,
        fingers=(2,) if clause.count == 2 else (1,),
        spans=problem.contact.spans + clause.spans,
    )
    return replace(problem, contact=contact)


def require_whole_hand(problem: GraspProblem, clause: g.Effector) -> GraspProblem | Blocked:
    """The same problem; a whole hand does it, or one fingertip if it flips a lid."""
    if why := _why_not_right(clause):
        return why
    doing = problem.goal.doing
    fingertip = isinstance(problem.target.model.lid, FlipLid) and doing in ("opening", "closing")
    if clause.tool == "arm" or (clause.tool == "finger" and not fingertip):
        which = "fingers" if clause.tool == "finger" else "the arm"
        return _unsupported_while(f"using only {which}", doing, clause.spans)
    if clause.tool == "finger" and (clause.count or 1) > 1:
        return _unsupported_while(f"using {clause.count} fingers", doing, clause.spans)
    return problem


def _why_not_right(clause: g.Effector) -> Blocked | None:
    """The robot has no left hand."""
    return dead_end("not_capable.left", spans=clause.spans) if clause.side == "left" else None


# Tilting an object and letting it back onto its base: how far, and whether it surely comes back.
#
# Model: the object pivots about the far edge of its base; see
# `objectmodels.mechanics.push_thresholds`. It must come back with the probability that plans
# need, from the asked angle and from what the control may miss it by. It leans over by sin θ
# times its height on the way.

CLEARANCE: SafetyFigure = 0.01
"""Distance that a leaning object keeps from others [m]."""

_HEADINGS = 24  # to which what is tilted may lean
_SLACK = 0.015  # travel beyond what the model says, for what it does not know [m]


def tilt_goal(goal: Tilt, model: ObjectModel, defaults: Defaults) -> tuple[float, str | None]:
    """The angle to plan for [rad], and why it is a default, if it is one."""
    if goal.angle is not None:
        return value_in_bound(goal.angle, goal.bound, defaults.tilt_tolerance), None
    most = almost_tips(model, defaults)
    if goal.amount == "lot":
        return most, "“a lot”"
    if goal.amount == "little":
        return min(defaults.tilt_little, most), "“a little”"
    return min(defaults.tilt, most), "no angle said"


def almost_tips(model: ObjectModel, defaults: Defaults) -> float:
    """A tilt well short of the angle of no return, whichever way it is tilted [rad]."""
    least = min(model.angle_of_no_return(face.normal) for face in model.faces())
    return defaults.tilt_lot * least


def most_tilt(angle: float, defaults: Defaults) -> float:
    """The largest tilt that an asked one may become, angles in rad."""
    return angle + defaults.tolerance_of(angle, defaults.tilt_tolerance)


def spill_tilt(target: SeenObject, sigmas: float) -> float | None:
    """Least tilt at which an object may begin to spill [rad]; None if nothing can run out.

    There may be more in it than is believed, by `sigmas` standard deviations.
    """
    container, vessel = target.model.container, target.model.vessel
    if container is None or vessel is None or target.is_covered:
        return None
    volume = container.contents + sigmas * container.contents_sd
    if volume <= 0.0:
        return None
    headings = np.linspace(-np.pi, np.pi, _HEADINGS, endpoint=False)
    return float(vessel.spill_angle(volume, headings).min())


def why_not_tilted(
    problem: PushProblem, normal: ArrayLike, u: NDArray[np.float64], angle: float
) -> Blocked | None:
    """A tilt may end in a fall, or something stands where the object leans to.

    Args:
        problem: about the object.
        normal: outward normal of the face in B, shape (3,).
        u: unit direction of the push in W, shape (3,).
        angle: by which it is to be tilted [rad].
    """
    target = problem.target
    most = most_tilt(angle, problem.defaults)
    inward = -np.asarray(normal)
    if return_probability(target.model, inward, most) < problem.effort.probability:
        return _may_fall(problem, inward, angle)
    leans = target.model.top * math.sin(most)
    here = footprint(target)
    for name, other in problem.others.items():
        free = free_travel(here, footprint(other), u[:2], CLEARANCE)
        if free < leans:
            text = f"{1e3 * free:.0f} mm to the {name}; it leans over by {1e3 * leans:.0f} mm"
            return dead_end(
                "leans_on",
                {"free": free, "leans_over": leans},
                marks=(length_mark(leading_point(target, u), u, free, text, leans),),
                object=target.name,
                other=name,
                tilt=angle,
                room=max(free, 0.0),
            )
    return None


def push_with_tilt(
    push: Push,
    model: ObjectModel,
    inward: NDArray[np.float64],
    angle: float,
    defaults: Defaults,
) -> Push:
    """The push, high on a face with an inward normal in B (3,), that ends on a tilt [rad]."""
    most = most_tilt(angle, defaults)
    stroke = model.topple_stroke(inward, push.p_BC[2], most) + _SLACK
    changes = {
        "ends_on": "tilted",
        "tilt": angle,
        "stroke": stroke,
        "limits": Limits(tilt=most),
    }
    return push.model_copy(update=changes)


def prediction_with_return(
    predicted: Prediction,
    model: ObjectModel,
    inward: NDArray[np.float64],
    angle: float,
    defaults: Defaults,
) -> Prediction:
    """The prediction with the chance that the object also comes back from a tilt."""
    back = return_probability(model, inward, most_tilt(angle, defaults))
    # At least so likely, however the two hang together.
    both = max(predicted.probability + back - 1.0, 0.0)
    return predicted.model_copy(update={"probability": both})


def _may_fall(problem: PushProblem, inward: NDArray[np.float64], angle: float) -> Blocked:
    """It would not surely come back."""
    target, defaults = problem.target, problem.defaults
    no_return = target.model.angle_of_no_return(inward)
    sure = largest_return(target.model, inward, problem.effort.probability)
    possible = max(sure - defaults.tilt_tolerance, 0.0)
    key = "no_return" if angle >= no_return else "may_not_return"
    u = target.pose.R_WB @ inward
    text = f"beyond {QUANTITIES['deg_exact'](no_return)} it falls by itself"
    mark = tilt_mark(target.name, leading_point(target, u), u, no_return, text)
    return dead_end(
        f"{key}.less" if possible > math.radians(1.0) else key,
        {"tilt": angle, "stay_on_base_angle": no_return, "sure_return": sure},
        marks=(mark,),
        object=target.name,
        tolerance=defaults.tilt_tolerance,
        possible=possible,
    )


@dataclass(frozen=True)
class ConstraintRule:
    """Rule by which one kind of constraint limits a problem.

    Attributes:
        push: makes the problem of pushes that keep it; None if no push does.
        grasp: makes the problem of a hand that keeps it; None if no hand does.
        unsupported: words for what no hand does, such as `moving fast`.
    """

    push: Callable[[PushProblem, Any], PushProblem | Blocked] | None = None
    grasp: Callable[[GraspProblem, Any], GraspProblem | Blocked] | None = None
    unsupported: str = ""


def apply_constraint(problem: PushProblem, clause: g.Constraint) -> PushProblem | Blocked:
    """The problem of pushes with one more constraint, or why they cannot keep it."""
    rule = LIMITS[clause.kind]
    if rule.push is None:
        return dead_end("not_capable", spans=clause.spans, what=clause.kind.replace("_", " "))
    return rule.push(problem, clause)


def grasp_limits(problem: GraspProblem) -> GraspProblem | Blocked:
    """The problem of a hand with the constraints of its frame, or why it cannot keep one."""
    for clause in problem.frame.constraints:
        rule = LIMITS[clause.kind]
        if rule.grasp is None:
            return _unsupported_while(rule.unsupported, problem.goal.doing, clause.spans)
        limited = rule.grasp(problem, clause)
        if isinstance(limited, Blocked):
            return limited
        problem = limited
    return problem


def _unsupported_while(what: str, doing: str, spans: g.Spans) -> Blocked:
    """No hand of this version does something meanwhile."""
    return dead_end("not_while", spans=spans, what=what, doing=doing)


def _keep_anyhow(problem: PlanningProblem[GoalT], clause: g.Constraint) -> PlanningProblem[GoalT]:
    """The same problem: pushes on the table, or what is held, keep it anyhow."""
    return problem


def _with_tilt(problem: PushProblem, tilt: float) -> PushProblem:
    """The problem with a narrower limit of the tilt [rad]."""
    narrowest = min(tilt, problem.motion.tilt or math.inf)
    return replace(problem, motion=replace(problem.motion, tilt=narrowest))


def _stay_on_base(
    problem: PushProblem, clause: g.NoTopple | g.NoTilt | g.MaxTilt
) -> PushProblem | Blocked:
    """An object that slides stays on its base, one that is tilted comes back."""
    defaults, goal = problem.defaults, problem.goal
    most = {"no_topple": None, "no_tilt": defaults.no_tilt}.get(clause.kind)
    if isinstance(clause, g.MaxTilt):
        most = clause.value
    if goal.outcome == "slide":
        return problem if most is None else _with_tilt(problem, most)
    if goal.tilt is None or clause.kind == "no_tilt":
        return dead_end("contradiction.base", spans=clause.spans)
    if most is None:
        return problem
    if most < goal.tilt - defaults.tolerance_of(goal.tilt, defaults.tilt_tolerance):
        return dead_end("contradiction.tilt", spans=clause.spans, tilt=goal.tilt, most=most)
    return _with_tilt(problem, most)


def _keep_upright(problem: GraspProblem, clause: g.NoTilt | g.MaxTilt) -> GraspProblem | Blocked:
    if isinstance(clause, g.MaxTilt) and clause.value < problem.defaults.upright:
        least = math.degrees(problem.defaults.upright)
        what = f"keeping it within less than {least:.0f}° of upright"
        return _unsupported_while(what, problem.goal.doing, clause.spans)
    motion = replace(problem.motion, upright=problem.motion.upright + clause.spans)
    return replace(problem, motion=motion)


def _stay_on_table(problem: GraspProblem, clause: g.NoLift) -> GraspProblem:
    motion = replace(problem.motion, on_the_table=problem.motion.on_the_table + clause.spans)
    return replace(problem, motion=motion)


def _keep_heading(problem: PushProblem, clause: g.NoTurn | g.MaxTurn) -> PushProblem | Blocked:
    most = problem.defaults.no_turn if isinstance(clause, g.NoTurn) else clause.value
    goal, yaw = problem.goal, problem.target.pose.yaw
    turned = [abs(yaw if aim.yaw is None else aim.yaw - yaw) for aim in goal.aims]
    if goal.rotates and min(turned) > most:
        return dead_end("contradiction.heading", spans=clause.spans)
    narrowest = min(most, problem.motion.turn or math.inf)
    return replace(problem, motion=replace(problem.motion, turn=narrowest))


def _push_until(problem: PushProblem, clause: g.Until) -> PushProblem | Blocked:
    """A push that ends with the object's fall, or with a tilt well before it."""
    if clause.event not in ("tips", "about_to_tip"):
        if not problem.goal.aims:
            return dead_end("not_capable.fall", spans=clause.spans, event=clause.event)
        return problem  # the aim is where it happens
    tilt = problem.goal.tilt
    if clause.event == "about_to_tip":
        tilt = almost_tips(problem.target.model, problem.defaults)
    goal = replace(problem.goal, outcome="topple", aims=(), distance=math.inf, tilt=tilt)
    return replace(problem.without_default("distance"), goal=goal)


def _keep_contents(problem: PushProblem, clause: g.NoSpill) -> PushProblem | Blocked:
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
    key, numbers = "contradiction.fall_spills", {"spill_angle": spills}
    if goal.tilt is not None:
        key, numbers["tilt"] = "contradiction.tilt_spills", goal.tilt
    return dead_end(key, numbers, spans=clause.spans, object=problem.target.name)


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


def _push_clear(problem: PushProblem, clause: g.NoTouch) -> PushProblem | Blocked:
    limited, meets = _keep_clear(problem, clause), problem.goal.meets
    others = problem.others if clause.object is None else (clause.object.id,)
    if meets in others:
        return dead_end("contradiction.touch", spans=clause.spans, other=meets)
    return limited


def _push_at_most(problem: PushProblem, clause: g.MaxForce | g.Force) -> PushProblem:
    return _with_force(problem, max=min(problem.force.max, clause.value), spans=clause.spans)


def _squeeze_at_most(problem: GraspProblem, clause: g.MaxForce | g.Force) -> GraspProblem:
    spans = problem.force.spans + clause.spans
    return _with_force(problem, max=min(problem.force.max, clause.value), spans=spans)


def _with_force(problem: PlanningProblem[GoalT], **limits: Any) -> PlanningProblem[GoalT]:
    """The problem with other limits of the force."""
    return replace(problem, force=replace(problem.force, **limits))


def _push_gently(problem: PushProblem, clause: g.Gentle) -> PushProblem:
    gentle = _with_force(problem, reserve=problem.defaults.force_reserve_gentle)
    return _limit_speed(gentle, problem.defaults.speed_gentle)


def _grasp_gently(problem: GraspProblem, clause: g.Gentle) -> GraspProblem:
    reserve = min(problem.force.reserve, problem.defaults.grasp_reserve_gentle)
    return _limit_speed(_with_force(problem, reserve=reserve), problem.defaults.carry_speed_gentle)


def _limit_speed(problem: PlanningProblem[GoalT], speed: float) -> PlanningProblem[GoalT]:
    """The problem with a lower speed [m/s]; one that the sentence gave is no default any more."""
    motion = problem.motion
    motion = replace(motion, speed=min(motion.speed, speed), lid_speed=min(motion.lid_speed, speed))
    return replace(problem.without_default("speed").without_default("carry_speed"), motion=motion)


def _push_at_speed(
    problem: PushProblem, clause: g.Fast | g.Speed | g.MinSpeed
) -> PushProblem | Blocked:
    speed = problem.defaults.speed_fast if isinstance(clause, g.Fast) else clause.value
    most = problem.defaults.speed_most
    if speed > most:
        key, goal = "too_fast", problem.goal
        if goal.aims and not goal.rotates and reached_speed(most, goal.distance) < most:
            key, most = "too_fast.short", reached_speed(most, goal.distance)
        numbers = {"speed": speed, "most": most}
        return dead_end(key, numbers, spans=clause.spans, length=goal.distance)
    motion = replace(problem.motion, speed=speed)
    return replace(problem.without_default("speed"), motion=motion)


def _carry_at_speed(problem: GraspProblem, clause: g.Speed | g.MinSpeed) -> GraspProblem | Blocked:
    most, moved = problem.defaults.carry_speed, "moved"
    if problem.frame.goal.kind not in ("place", "pour"):
        most, moved = min(most, LIFT_SPEED), "lifted"
    if clause.value > most:
        numbers = {"speed": clause.value, "most": most}
        return dead_end("too_fast.held", numbers, spans=clause.spans, moved=moved)
    return problem if isinstance(clause, g.MinSpeed) else _limit_speed(problem, clause.value)


def _push_within(problem: PushProblem, clause: g.MaxDuration) -> PushProblem:
    shortest = min(clause.value, problem.motion.duration or math.inf)
    motion = replace(problem.motion, duration=shortest, spans=clause.spans)
    return replace(problem, motion=motion)


def _push_near(problem: PushProblem, clause: g.MaxDistance) -> PushProblem | Blocked:
    """The limit is kept with the tolerance to spare, if that is still far enough."""
    goal, tolerance = problem.goal, problem.defaults.distance_tolerance
    if not goal.aims:
        return dead_end("not_capable.way_of_fall", spans=clause.spans)
    most = clause.value - min(tolerance, 0.5 * clause.value)
    start = problem.target.pose.x, problem.target.pose.y
    lengths = {aim: math.dist((aim.x, aim.y), start) for aim in goal.aims}
    aims = tuple(
        _shorten_aim(aim, start, min(1.0, most / max(lengths[aim], 1e-9)))
        for aim in goal.aims
        if lengths[aim] - tolerance <= most
    )
    if not aims:
        numbers = {"distance": min(lengths.values()), "max_distance": clause.value}
        return dead_end("contradiction.distance", numbers, spans=clause.spans)
    return replace(problem, goal=replace(goal, aims=aims, distance=min(goal.distance, most)))


def _shorten_aim(aim: Aim, start: tuple[float, float], share: float) -> Aim:
    """An aim that lies only a share of the way from a start."""
    x, y = (a + share * (b - a) for a, b in zip(start, (aim.x, aim.y), strict=True))
    return Aim(x=x, y=y, yaw=aim.yaw)


LIMITS: dict[str, ConstraintRule] = {
    "no_topple": ConstraintRule(_stay_on_base, _keep_anyhow),
    "no_tilt": ConstraintRule(_stay_on_base, _keep_upright),
    "max_tilt": ConstraintRule(_stay_on_base, _keep_upright),
    "no_slide": ConstraintRule(
        lambda problem, clause: (
            dead_end("contradiction.slide", spans=clause.spans) if problem.goal.aims else problem
        ),
        _keep_anyhow,
    ),
    "no_turn": ConstraintRule(_keep_heading, _keep_anyhow),
    "max_turn": ConstraintRule(_keep_heading, _keep_anyhow),
    "no_spill": ConstraintRule(_keep_contents, _keep_anyhow),
    "no_lift": ConstraintRule(_keep_anyhow, _stay_on_table),
    "no_touch": ConstraintRule(_push_clear, _keep_clear),
    "max_force": ConstraintRule(_push_at_most, _squeeze_at_most),
    "force": ConstraintRule(_push_at_most, _squeeze_at_most),
    "min_force": ConstraintRule(
        lambda problem, clause: _with_force(problem, min=clause.value, spans=clause.spans),
        unsupported="pressing with a least force",
    ),
    "hard": ConstraintRule(
        lambda problem, _: _with_force(problem, least_limit=problem.defaults.force_hard),
        unsupported="using much force",
    ),
    "gentle": ConstraintRule(_push_gently, _grasp_gently),
    "slow": ConstraintRule(
        lambda problem, _: _limit_speed(problem, problem.defaults.speed_gentle),
        lambda problem, _: _limit_speed(problem, problem.defaults.carry_speed_gentle),
    ),
    "fast": ConstraintRule(_push_at_speed, unsupported="moving fast"),
    "speed": ConstraintRule(_push_at_speed, _carry_at_speed),
    "min_speed": ConstraintRule(_push_at_speed, _carry_at_speed),
    "max_speed": ConstraintRule(
        lambda problem, clause: _limit_speed(problem, clause.value),
        lambda problem, clause: _limit_speed(problem, clause.value),
    ),
    "max_duration": ConstraintRule(_push_within, unsupported="keeping to a time"),
    "duration": ConstraintRule(
        lambda _, clause: dead_end(
            "not_capable", spans=clause.spans, what="pushing for an exact time"
        ),
        unsupported="keeping to a time",
    ),
    "max_distance": ConstraintRule(_push_near, unsupported="limiting a distance"),
    "contact": ConstraintRule(limit_push_contact, limit_grasp_contact),
    "effector": ConstraintRule(limit_fingertips, require_whole_hand),
    "until": ConstraintRule(_push_until, unsupported="stopping at an event"),
}
"""The rule for every kind of constraint."""
