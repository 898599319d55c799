"""Opening and closing lids: which steps a lid takes, and whether the standing object bears them.

Model: a flip lid is moved over its arc by a fingertip on its tab; a lid that lifts off and a cap
are held from above, pulled or turned, and put aside on the table. The object itself is not held:
it must resist what moves its lid by a reserve (`objectmodels.containers.lids`), or stand in a
holder.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np

from objectmodels.containers.lids import FlipArc, Loosening, flip, is_off, lift_off, unscrew
from objectmodels.geometry.base_shapes import Disc, hull_polygon
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_parts import FlipLid, LiftOffLid, ScrewCap
from planner.grasping.grasp_candidates import held_part, lid_candidates, lid_middle
from planner.grasping.grasp_plans import MotionDraft, each_with_each, first_reachable_plan
from planner.grasping.grasp_selection import GraspLoad, Load, StableGrasp, stable_grasps
from planner.problem.footprints import footprint, gap, room_to_edge
from planner.problem.planning_problem import GraspProblem
from planner.refusals.blocked import Blocked, dead_end
from planner.types.actions import (
    Action,
    Aim,
    Carry,
    FlipOver,
    FlipPrediction,
    LiftUp,
    PullPrediction,
    PutOn,
    SetDown,
    TurnCap,
    TurnPrediction,
    finite_or_none,
)
from planner.types.defaults import Defaults
from planner.types.plan import DefaultUsed, Plan, PlanTask, Reached
from planner.types.world_state import SeenObject

_RINGS = np.arange(0.0, 0.25, 0.04)  # beyond the nearest place [m]
_AROUND = np.arange(12) * math.tau / 12.0
_ROOM = 0.05  # between a lid and what stands near it, for the fingers that let go of it [m]


def open_lid(problem: GraspProblem) -> Plan | Reached | Blocked:
    """Flips, lifts or screws the lid open."""
    lid, seen = problem.target.model.lid, problem.target.lid or 0.0
    match lid:
        case FlipLid():
            if seen >= problem.defaults.lid_opened:
                return Reached(lid=seen)
            return _plan_flip(problem, lid, "open", min(problem.defaults.lid_open, lid.opens_to))
        case LiftOffLid():
            if is_off(lid, seen):
                return Reached(lid=seen)
            found = lift_off(problem.target.model, lid, fixed=problem.target.fixed)
            pull = PullPrediction(lid_force=found.needed, lifting_force=finite_or_none(found.held))
            ways = _lid_holds(problem, lid, Load(found.needed, lid.retention_sd))
            return _plan_take_off(problem, lid, ways, found, pull=pull)
        case ScrewCap():
            if is_off(lid, seen):
                return Reached(lid=seen)
            found = unscrew(problem.target.model, lid, fixed=problem.target.fixed)
            turn = _turn_step(problem, lid, math.tau * lid.turns - seen, found)
            return _plan_take_off(problem, lid, _cap_holds(problem, lid), found, turn)
    return dead_end("no_lid", object=problem.target.name)


def close_lid(problem: GraspProblem) -> Plan | Reached | Blocked:
    """Flips the lid back, or puts it on."""
    lid, seen = problem.target.model.lid, problem.target.lid or 0.0
    match lid:
        case FlipLid():
            if seen <= problem.defaults.lid_closed:
                return Reached(lid=seen)
            return _plan_flip(problem, lid, "close", 0.0)
        case LiftOffLid():
            return _plan_put_on(problem, lid) if is_off(lid, seen) else Reached(lid=seen)
        case ScrewCap():
            if seen <= problem.defaults.lid_closed:
                return Reached(lid=seen)
            if is_off(lid, seen):
                return dead_end("cap_off", object=problem.target.name)
            found = unscrew(problem.target.model, lid, fixed=problem.target.fixed)
            if why := _why_not_still(problem, found):
                return why
            turn = _turn_step(problem, lid, -seen, found)
            ways = _cap_holds(problem, lid)
            draft = MotionDraft((turn,), found.probability)
            return first_reachable_plan(problem, "close", each_with_each(ways, [draft]))
    return dead_end("no_lid", object=problem.target.name)


def is_open(seen: SeenObject, defaults: Defaults) -> bool:
    """Return True if something could run out: its lid is open, or it has none."""
    lid, angle = seen.model.lid, seen.lid or 0.0
    match lid:
        case None:
            return True
        case FlipLid():
            return angle >= defaults.lid_opened
    return is_off(lid, angle)


def _plan_flip(problem: GraspProblem, lid: FlipLid, action: PlanTask, end: float) -> Plan | Blocked:
    target = problem.target
    start = target.lid or 0.0
    arc = flip(target.model, lid, start=start, end=end, fixed=target.fixed)
    if arc.largest_force > problem.force.max:
        numbers = {"needed_force": arc.largest_force, "allowed_force": problem.force.max}
        doing, spans = problem.goal.doing, problem.force.spans
        return dead_end("flip_not_allowed", numbers, spans=spans, doing=doing, object=target.name)
    if why := _why_not_standing(problem, arc):
        return why
    most = (1.0 + problem.defaults.force_reserve) * arc.largest_force
    bears = np.minimum(arc.slide, arc.topple)
    # A plan states the limit at every fourth angle of the arc.
    limits = tuple(np.minimum(bears, min(most, problem.force.max))[::4].tolist())
    near = arc.weakest_index
    slide, topple = (float(force[near]) for force in (arc.slide, arc.topple))
    step = FlipOver(
        start=start,
        end=end,
        speed=problem.motion.lid_speed,
        force_limit=max(limits),
        force_limits=limits,
        heading=math.remainder(target.pose.yaw + lid.tab_heading, math.tau),
        prediction=FlipPrediction(
            lid_force=arc.largest_force,
            nearest_angle=float(arc.angles[near]),
            nearest_force=float(arc.force[near]),
            slide_force=finite_or_none(slide),
            topple_force=finite_or_none(topple),
            lid_angle=end,
        ),
    )
    used = DefaultUsed(name="lid_open", value=end, unit="rad", reason="no angle said")
    defaults = (used,) if action == "open" else ()
    draft = MotionDraft((step,), arc.probability, defaults=defaults)
    return first_reachable_plan(problem, action, [(None, draft)])


def _why_not_standing(problem: GraspProblem, arc: FlipArc) -> Blocked | None:
    """The object would slide or topple before its lid has moved all the way, or may."""
    near, target, d = arc.weakest_index, problem.target, problem.defaults
    forces = {
        "lid_force": float(arc.force[near]),
        "largest_lid_force": arc.largest_force,
        "slide_force": float(arc.slide[near]),
        "topple_force": float(arc.topple[near]),
        "angle": float(arc.angles[near]),
    }
    numbers = {name: value for name, value in forces.items() if math.isfinite(value)}
    slides = forces["slide_force"] < forces["topple_force"]
    words: dict[str, Any] = {
        "doing": problem.goal.doing,
        "object": target.name,
        "mass": target.model.mass,
        "verb": "slides" if slides else "tips",
        "limit": forces["slide_force" if slides else "topple_force"],
    }
    if arc.least_margin < d.lid_reserve:
        numbers["margin"] = arc.least_margin
        return dead_end("gives_way", numbers, reserve=d.lid_reserve, **words)
    if arc.probability < d.probability:
        asked = problem.effort.probability
        sure = {"probability": arc.probability, "asked_probability": asked}
        return dead_end("may_give_way", {**numbers, **sure}, **words)
    return None


def _plan_take_off(
    problem: GraspProblem,
    lid: LiftOffLid | ScrewCap,
    ways: list[StableGrasp] | Blocked,
    found: Loosening,
    *before: Action,
    pull: PullPrediction | None = None,
) -> Plan | Blocked:
    """A lid that is loose, lifted off and put aside."""
    if why := _why_not_still(problem, found):
        return why
    drafts = []
    for spot, tallest in _free_lid_places(problem, lid.radius):
        # Its lower side is as high as the object, and passes over what stands on the way.
        up = max(tallest - problem.target.model.top, 0.0) + problem.defaults.carry_clearance
        steps = (*before, LiftUp(height=up, hold=0.0, prediction=pull), Carry(to=spot), SetDown())
        drafts.append(MotionDraft(steps, found.probability))
    if not drafts:
        return dead_end("no_room_aside", {"width": 2.0 * lid.radius}, object=problem.target.name)
    return first_reachable_plan(problem, "open", each_with_each(ways, drafts))


def _plan_put_on(problem: GraspProblem, lid: LiftOffLid) -> Plan | Blocked:
    """A lid that lies aside put on its rim."""
    target, d = problem.target, problem.defaults
    x, y, _ = (target.pose.R_WB @ [*lid_middle(target), 0.0] + target.pose.p_WB).tolist()
    if target.lid_at is None:
        return dead_end("lid_not_seen", object=problem.target.name)
    press = max(lid.retention, d.lid_press)
    # Pressed on, it must not slide through the fingers.
    ways = _lid_holds(problem, lid, Load(max(press, lid.mass * GRAVITY)))
    up = max(target.model.top - target.lid_at[2], 0.0) + d.carry_clearance
    down = PutOn(onto=target.name, press=press)
    draft = MotionDraft((LiftUp(height=up, hold=0.0), Carry(to=Aim(x=x, y=y)), down))
    return first_reachable_plan(problem, "close", each_with_each(ways, [draft]))


def _why_not_still(problem: GraspProblem, found: Loosening) -> Blocked | None:
    """The object would be lifted or turned as its lid comes off, or may."""
    name, asked = problem.target.name, problem.effort.probability
    screwed = isinstance(problem.target.model.lid, ScrewCap)
    numbers = {"needed": found.needed, "held": found.held, "margin": found.margin}
    if found.margin < problem.defaults.lid_reserve:
        return dead_end("turned_along" if screwed else "pulled_along", numbers, object=name)
    if found.probability < asked:
        numbers |= {"probability": found.probability, "asked_probability": asked}
        code = "may_be_turned_along" if screwed else "may_be_pulled_along"
        return dead_end(code, numbers, object=name)
    return None


def _cap_holds(problem: GraspProblem, cap: ScrewCap) -> list[StableGrasp] | Blocked:
    """Grasps of a cap that is turned: friction at its rim bears the torque."""
    radius, *_ = held_part(problem.target, cap)
    torque = cap.friction_torque / radius
    return _lid_holds(problem, cap, Load(torque, cap.friction_torque_sd / radius))


def _lid_holds(
    problem: GraspProblem, lid: LiftOffLid | ScrewCap, load: Load
) -> list[StableGrasp] | Blocked:
    """Grasps of a lid at which something pulls."""
    found = lid_candidates(problem, lid)
    if isinstance(found, Blocked):
        return found
    return stable_grasps(problem, [GraspLoad(each, load) for each in found])


def _turn_step(problem: GraspProblem, cap: ScrewCap, angle: float, found: Loosening) -> TurnCap:
    limit = (1.0 + problem.defaults.force_reserve) * cap.friction_torque
    prediction = TurnPrediction(lid_torque=found.needed, turning_torque=finite_or_none(found.held))
    return TurnCap(angle=angle, torque_limit=limit, prediction=prediction)


def _free_lid_places(problem: GraspProblem, radius: float) -> list[tuple[Aim, float]]:
    """Free places for a disc [m], the nearest first, and what is tallest on the way to each [m]."""
    target, d, disc = problem.target, problem.defaults, Disc(radius).corners
    middle, others = target.pose.p_WB[:2], problem.state.objects.values()
    nearest = float(np.linalg.norm(footprint(target) - middle, axis=1).max()) + radius + _ROOM
    found: list[tuple[Aim, float]] = []
    for ring, angle in itertools.product(_RINGS, _AROUND):
        at = middle + (nearest + ring) * np.array([math.cos(angle), math.sin(angle)])
        if room_to_edge(at + disc, problem.state.table, d.clearance) < 0.0:
            continue
        if any(gap(at + disc, footprint(seen)) < _ROOM for seen in others):
            continue
        way = hull_polygon(np.vstack([middle + disc, at + disc])).vertices
        tallest = max(
            seen.top_height
            for seen in others
            if seen is target or gap(way, footprint(seen)) < d.clearance
        )
        found.append((Aim(x=float(at[0]), y=float(at[1])), tallest))
        if len(found) == 6:  # places are enough to look at
            break
    return found
