"""Opening and closing lids: which steps a lid takes, and whether the standing object bears them.

Model: a flip lid is moved over its arc by a fingertip on its tab; a lid that lifts off and a cap
are held from above, pulled or turned, and put aside on the table. The object itself is not held:
it must resist what moves its lid by a reserve (`objectmodels.containers.lid_forces`), or stand in a
holder.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.containers.lid_forces import FlipArc, Loosening, flip, lift_off, unscrew
from objectmodels.containers.lid_geometry import is_off
from objectmodels.geometry.base_shapes import Array, Disc
from objectmodels.geometry.support_points import hull_polygon
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_parts import FlipLid, LiftOffLid, ScrewCap
from planner.geometry.footprints import footprint, gap, travel_to_edge
from planner.grasping.grasp_sampling import held_part, lid_middle, of_lid
from planner.grasping.grasp_selection import (
    Bearing,
    Draft,
    Load,
    each_with_each,
    first_way,
    holds,
)
from planner.refusals import lid_refusals as lidrefusals
from planner.types.actions import (
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
)
from planner.types.plan import DefaultUsed, Plan, Reached

if TYPE_CHECKING:
    from collections.abc import Iterator

    from planner.grasping.grasp_selection import Hold
    from planner.problem.planning_problem import Task
    from planner.types.actions import Action
    from planner.types.defaults import Defaults
    from planner.types.plan import PlanTask
    from planner.types.world_state import SeenObject

_ASIDE = 6  # places beside it that are looked at for its lid
_RINGS = np.arange(0.0, 0.25, 0.04)  # beyond the nearest place [m]
_AROUND = np.arange(12) * math.tau / 12.0
_ROOM = 0.05  # between a lid and what stands near it, for the fingers that let go of it [m]
_AXES = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])


def open_lid(task: Task) -> Plan | Reached:
    """Flips, lifts or screws the lid open.

    Raises:
        NoPlanError: it has none, or would come along with it.
    """
    lid, seen = task.target.model.lid, task.target.lid or 0.0
    match lid:
        case FlipLid():
            if seen >= task.defaults.lid_opened:
                return Reached(lid=seen)
            return _flipped(task, lid, "open", min(task.defaults.lid_open, lid.opens_to))
        case LiftOffLid():
            return Reached(lid=seen) if is_off(lid, seen) else _pulled_off(task, lid)
        case ScrewCap():
            return Reached(lid=seen) if is_off(lid, seen) else _screwed_off(task, lid)
    raise lidrefusals.no_lid(task)


def close_lid(task: Task) -> Plan | Reached:
    """Flips the lid back, or puts it on.

    Raises:
        NoPlanError: it has none, or nobody knows where it lies.
    """
    lid, seen = task.target.model.lid, task.target.lid or 0.0
    match lid:
        case FlipLid():
            if seen <= task.defaults.lid_closed:
                return Reached(lid=seen)
            return _flipped(task, lid, "close", 0.0)
        case LiftOffLid():
            return _put_on(task, lid) if is_off(lid, seen) else Reached(lid=seen)
        case ScrewCap():
            if seen <= task.defaults.lid_closed:
                return Reached(lid=seen)
            return _screwed_on(task, lid, seen)
    raise lidrefusals.no_lid(task)


def is_open(seen: SeenObject, defaults: Defaults) -> bool:
    """Whether something could run out: its lid is open, or it has none."""
    lid, angle = seen.model.lid, seen.lid or 0.0
    match lid:
        case None:
            return True
        case FlipLid():
            return angle >= defaults.lid_opened
    return is_off(lid, angle)


# -- flip lids ----------------------------------------------------------------------------------


def _flipped(task: Task, lid: FlipLid, action: PlanTask, end: float) -> Plan:
    target, d = task.target, task.defaults
    start = target.lid or 0.0
    arc = flip(target.model, lid, start=start, end=end, fixed=target.fixed)
    if arc.largest_force > task.how.most_force:
        raise lidrefusals.too_weak(task, arc.largest_force)
    if arc.least_margin < d.lid_reserve:
        raise lidrefusals.gives_way(task, arc)
    if arc.probability < d.probability:
        raise lidrefusals.may_give_way(task, arc)
    step = FlipOver(
        start=start,
        end=end,
        speed=task.how.lid_speed,
        force_limit=_force_limit(task, arc),
        heading=math.remainder(target.pose.yaw + lid.tab_heading, math.tau),
        prediction=_arc_prediction(arc, end),
    )
    used = DefaultUsed(name="lid_open", value=end, unit="rad", reason="no angle said")
    draft = Draft(
        (step,),
        arc.probability,
        defaults=(used,) if action == "open" else (),
    )
    return first_way(task, action, [(None, draft)], 1)


def _force_limit(task: Task, arc: FlipArc) -> float:
    """Force at which a finger stops: more than the lid takes, less than moves the object [N]."""
    needed = arc.largest_force
    given_way = float(min(arc.slide.min(), arc.topple.min()))
    most = max(given_way, task.defaults.lid_reserve * needed)
    return min((1.0 + task.defaults.force_reserve) * needed, most, task.how.most_force)


def _arc_prediction(arc: FlipArc, end: float) -> FlipPrediction:
    near = arc.weakest_index
    slide, topple = (float(force[near]) for force in (arc.slide, arc.topple))
    return FlipPrediction(
        lid_force=arc.largest_force,
        nearest_angle=float(arc.angles[near]),
        nearest_force=float(arc.force[near]),
        slide_force=slide if math.isfinite(slide) else None,
        topple_force=topple if math.isfinite(topple) else None,
        lid_angle=end,
    )


# -- lids that come off -------------------------------------------------------------------------


def _pulled_off(task: Task, lid: LiftOffLid) -> Plan:
    found = lift_off(task.target.model, lid, fixed=task.target.fixed)
    _require_still(task, found)
    load = Load(found.needed, lid.retention_sd)
    pull = PullPrediction(lid_force=found.needed, lifting_force=_finite(found.held))
    return _taken_off(task, lid, _lid_holds(task, lid, load), found.probability, pull=pull)


def _screwed_off(task: Task, cap: ScrewCap) -> Plan:
    found = unscrew(task.target.model, cap, fixed=task.target.fixed)
    _require_still(task, found)
    rest = math.tau * cap.turns - (task.target.lid or 0.0)
    turn = _turn(task, cap, rest, found)
    return _taken_off(task, cap, _cap_holds(task, cap), found.probability, turn)


def _taken_off(
    task: Task,
    lid: LiftOffLid | ScrewCap,
    ways: list[Hold],
    probability: float,
    *before: Action,
    pull: PullPrediction | None = None,
) -> Plan:
    """A lid that is loose, lifted off and put aside."""
    drafts = []
    for spot, tallest in free_lid_places(task, lid.radius, _ASIDE):
        # Its lower side is as high as the object, and passes over what stands on the way.
        up = max(tallest - task.target.model.top, 0.0) + task.defaults.carry_clearance
        steps = (*before, LiftUp(height=up, hold=0.0, prediction=pull), Carry(to=spot), SetDown())
        drafts.append(Draft(steps, probability))
    if not drafts:
        raise lidrefusals.no_room_aside(task, lid.radius)
    return first_way(task, "open", each_with_each(ways, drafts), len(ways) * len(drafts))


def _put_on(task: Task, lid: LiftOffLid) -> Plan:
    """A lid that lies aside put on its rim."""
    target, d = task.target, task.defaults
    x, y, _ = (target.pose.R_WB @ [*lid_middle(target), 0.0] + target.pose.p_WB).tolist()
    if target.lid_at is None:
        raise lidrefusals.lid_not_seen(task)
    press = max(lid.retention, d.lid_press)
    # Pressed on, it must not slide through the fingers.
    ways = _lid_holds(task, lid, Load(max(press, lid.mass * GRAVITY)))
    up = max(target.model.top - target.lid_at[2], 0.0) + d.carry_clearance
    down = PutOn(onto=target.name, press=press)
    draft = Draft((LiftUp(height=up, hold=0.0), Carry(to=Aim(x=x, y=y)), down))
    return first_way(task, "close", [(way, draft) for way in ways], len(ways))


def _screwed_on(task: Task, cap: ScrewCap, seen: float) -> Plan:
    """A cap that is turned back.

    Raises:
        NoPlanError: it is off, and no hand gets a thread to catch.
    """
    if is_off(cap, seen):
        raise lidrefusals.thread(task)
    found = unscrew(task.target.model, cap, fixed=task.target.fixed)
    _require_still(task, found)
    turn = _turn(task, cap, -seen, found)
    ways = _cap_holds(task, cap)
    draft = Draft((turn,), found.probability)
    return first_way(task, "close", [(way, draft) for way in ways], len(ways))


def _require_still(task: Task, found: Loosening) -> None:
    """The object stays where it is while its lid comes off."""
    if found.margin < task.defaults.lid_reserve:
        raise lidrefusals.comes_along(task, found)
    if found.probability < task.defaults.probability:
        raise lidrefusals.may_come_along(task, found)


def _cap_holds(task: Task, cap: ScrewCap) -> list[Hold]:
    """How a cap is held for turning: friction at its rim bears the torque."""
    radius, *_ = held_part(task.target, cap)
    torque = cap.friction_torque / radius
    return _lid_holds(task, cap, Load(torque, cap.friction_torque_sd / radius))


def _lid_holds(task: Task, lid: LiftOffLid | ScrewCap, load: Load) -> list[Hold]:
    """How a lid is held while something pulls at it."""
    return holds(task, [Bearing(each, load) for each in of_lid(task.target, lid, task.hand)])


def _turn(task: Task, cap: ScrewCap, angle: float, found: Loosening) -> TurnCap:
    limit = (1.0 + task.defaults.force_reserve) * cap.friction_torque
    prediction = TurnPrediction(lid_torque=found.needed, turning_torque=_finite(found.held))
    return TurnCap(angle=angle, torque_limit=limit, prediction=prediction)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


# -- where a lid is put aside -------------------------------------------------------------------


def free_lid_places(task: Task, radius: float, most: int) -> list[tuple[Aim, float]]:
    """Free places for a disc, the nearest first, and what is tallest on the way to each [m].

    Args:
        task: about the object whose lid it is.
        radius: of the lid [m].
        most: how many places.
    """
    free = (found for found in _places_around(task, radius) if _is_free(task, found, radius))
    return [
        (Aim(x=float(at[0]), y=float(at[1])), _tallest_on_way(task, at, radius))
        for _, at in zip(range(most), free, strict=False)
    ]


def _places_around(task: Task, radius: float) -> Iterator[Array]:
    """Places around the object, ring after ring, shape (2,) [m]."""
    own = footprint(task.target)
    middle = task.target.pose.p_WB[:2]
    nearest = float(np.linalg.norm(own - middle, axis=1).max()) + radius + _ROOM
    for ring in _RINGS:
        for angle in _AROUND:
            yield middle + (nearest + ring) * np.array([math.cos(angle), math.sin(angle)])


def _disc(at: Array, radius: float) -> Array:
    return np.asarray(at + Disc(radius).corners)


def _is_free(task: Task, at: Array, radius: float) -> bool:
    lid, d = _disc(at, radius), task.defaults
    if min(travel_to_edge(lid, task.state.table, u, d.clearance) for u in _AXES) < 0.0:
        return False
    return all(gap(lid, footprint(seen)) >= _ROOM for seen in task.state.objects.values())


def _tallest_on_way(task: Task, at: Array, radius: float) -> float:
    start = _disc(task.target.pose.p_WB[:2], radius)
    way = hull_polygon(np.vstack([start, _disc(at, radius)])).vertices
    return max(
        seen.bulk()[1]
        for seen in task.state.objects.values()
        if seen is task.target or gap(way, footprint(seen)) < task.defaults.clearance
    )
