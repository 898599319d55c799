"""Where an object should be at the end: goals as aims on the table.

A goal of moving, placing or turning is an aim, a pose of the object in W, or several of which one
will do, the nearest first. Aims are fixed once, from where everything stands at first: later
pushes correct what earlier ones missed, they do not shift the aim.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from grammar.frames import command as g
from objectmodels.geometry.base_shapes import Disc
from planner.geometry.directions import FACE_OF_PUSH, HEADINGS, unit
from planner.geometry.footprints import footprint, free_travel, travel_to_edge
from planner.problem.displacement_goals import asked_distance, asked_heading
from planner.problem.place_regions import Beside, Between, region, share_of_way
from planner.refusals.push_refusals import NoPlanError, unsupported
from planner.types.actions import Aim, StopEvent
from planner.types.plan import DefaultUsed
from planner.types.refusal import Refusal

if TYPE_CHECKING:
    from planner.types.defaults import Defaults
    from planner.types.world_state import SeenObject, WorldState

_BEYOND = 0.008  # travel beyond the place where something should be met [m]


_TIPPING = ("tips", "about_to_tip")  # events that end no way over the table


@dataclass(frozen=True)
class Aimed:
    """What a goal aims at.

    Attributes:
        aims: poses of which one should be reached, the nearest first.
        heading: direction in W in which the object is to move [rad]; None if it follows from the
            aim.
        distance: to be moved [m]; None if it follows from the aim.
        until: event that ends the way earlier.
        meets: name of the object that is to be touched then.
        near: objects that it is to stand close to, and how close [m].
        defaults: what the sentence left open.
    """

    aims: tuple[Aim, ...]
    heading: float | None = None
    distance: float | None = None
    until: StopEvent | None = None
    meets: str | None = None
    near: tuple[tuple[str, float], ...] = ()
    defaults: tuple[DefaultUsed, ...] = ()


def aimed(frame: g.Frame, target: SeenObject, state: WorldState, defaults: Defaults) -> Aimed:
    """What a frame that moves, turns or taps its object aims at.

    Raises:
        NoPlanError: there is no such place, or it cannot be moved to.
    """
    goal = frame.goal
    until = next((c for c in frame.constraints if isinstance(c, g.Until)), None)
    match goal:
        case g.Rotate():
            return _rotated(goal, target, defaults)
        case g.Place():
            return _placed(goal, target, state, defaults)
        case g.Displace() if until is not None and until.event not in _TIPPING:
            return _until(frame, goal, until, target, state, defaults)
        case g.NoGoal():
            return _tapped(frame, target, defaults)
        case g.Displace():
            return _displaced(frame, goal, target, state, defaults)
    raise AssertionError(f"{goal.kind} moves nothing")


def here(target: SeenObject, x: float | None = None, y: float | None = None) -> Aim:
    """The pose that an object has, or one moved elsewhere that looks the same way.

    The heading of what is round does not matter unless it is to be turned.
    """
    pose = target.pose
    yaw = None if isinstance(target.model.base, Disc) else pose.yaw
    return Aim(x=pose.x if x is None else x, y=pose.y if y is None else y, yaw=yaw)


# -- moving -----------------------------------------------------------------------------------


def _displaced(
    frame: g.Frame, goal: g.Displace, target: SeenObject, state: WorldState, defaults: Defaults
) -> Aimed:
    heading, used = _heading(frame, goal, target, state, defaults)
    distance, reason = asked_distance(goal, target, state, defaults, frame.constraints)
    if reason:
        used += (DefaultUsed(name="distance", value=distance, unit="m", reason=reason),)
    elif goal.distance is not None:
        # A bound is kept with the tolerance to spare.
        spare = {"exact": 0.0, "at_least": 1.0, "at_most": -1.0}[goal.bound]
        distance += spare * min(defaults.distance_tolerance, 0.5 * distance)
    return _along(target, heading, distance, used)


def _along(
    target: SeenObject, heading: float, distance: float, used: tuple[DefaultUsed, ...] = ()
) -> Aimed:
    x, y, _ = (target.pose.p_WB + distance * unit(heading)).tolist()
    return Aimed((here(target, x, y),), heading, distance, defaults=used)


def _heading(
    frame: g.Frame, goal: g.Displace, target: SeenObject, state: WorldState, defaults: Defaults
) -> tuple[float, tuple[DefaultUsed, ...]]:
    """Direction of a displacement in W [rad], and that it was not said."""
    for other, way in ((goal.toward, "towards"), (goal.away_from, "away from")):
        if isinstance(other, g.ObjectRef) and other.id == target.name:
            message = f"the {target.name} cannot move {way} itself"
            raise NoPlanError(Refusal(reason="impossible", message=message, spans=other.spans))
    heading = asked_heading(goal, target, state, defaults)
    if heading is not None:
        return heading, ()
    way = "toward" if frame.action == "pull" else "away"
    used = DefaultUsed(
        name="direction", value=HEADINGS[way], unit="rad", reason=f"no direction said: {way}"
    )
    return used.value, (used,)


def _tapped(frame: g.Frame, target: SeenObject, defaults: Defaults) -> Aimed:
    """A touch that ends as soon as the object gives way; on the side that is said, or the front."""
    faces = [c.face for c in frame.constraints if isinstance(c, g.ContactRegion)]
    push = next((way for way, face in FACE_OF_PUSH.items() if face in faces), "away")
    return replace(_along(target, HEADINGS[push], defaults.tap), until="moves")


# -- until something happens ------------------------------------------------------------------


def _until(
    frame: g.Frame,
    goal: g.Displace,
    until: g.Until,
    target: SeenObject,
    state: WorldState,
    defaults: Defaults,
) -> Aimed:
    """As far as it takes until an event."""
    if until.event == "moves":
        moved = _displaced(frame, goal, target, state, defaults)
        return replace(moved, until="moves")
    other = None if until.object is None else state.objects.get(until.object.id or "")
    if goal.direction is None and goal.heading is None and other is not None:
        goal = goal.model_copy(update={"toward": until.object})
    heading, used = _heading(frame, goal, target, state, defaults)
    u, own = unit(heading), footprint(target)
    if until.event == "edge":
        room = travel_to_edge(own, state.table, u[:2], defaults.edge_gap)
        return _along(target, heading, max(room, 0.0), used)
    if other is None:
        raise unsupported(
            f"stopping at the event '{until.event}'",
            "the event needs an object that the way leads to",
            until.spans,
        )
    way = free_travel(own, footprint(other), u[:2], 0.0)
    if until.event == "touching":
        if math.isinf(way):
            raise NoPlanError(_never_met(target, other, until.spans))
        met = _along(target, heading, way + _BEYOND, used)
        return replace(met, until="touching", meets=other.name)
    # In line with it, or beside it: as far along the way as the other one stands.
    along = float((other.pose.p_WB - target.pose.p_WB) @ u)
    if until.event == "next_to" and math.isfinite(way):
        along = min(along, way - defaults.place_gap)
    if along <= 0.0:
        raise NoPlanError(_never_met(target, other, until.spans))
    return _along(target, heading, along, used)


def _never_met(target: SeenObject, other: SeenObject, spans: g.Spans) -> Refusal:
    return Refusal(
        reason="impossible",
        message=f"the {target.name} does not come to the {other.name} in that direction",
        spans=spans,
        suggestions=(f"push it towards the {other.name}",),
    )


# -- placing and turning ----------------------------------------------------------------------


def _placed(goal: g.Place, target: SeenObject, state: WorldState, defaults: Defaults) -> Aimed:
    place = region(goal, state, defaults)
    if place is None or (isinstance(goal.reference, tuple) and goal.relation == "on"):
        raise unsupported(
            "putting objects on others",
            "this version of the robot moves objects over the table only",
            goal.spans,
        )
    if goal.fraction is not None:
        place = share_of_way(place, goal.fraction, target, defaults.place_tolerance)
    spots = place.spots(target)
    if not spots:
        message = f"there is no room for the {target.name} there"
        raise NoPlanError(Refusal(reason="impossible", message=message, spans=goal.spans))
    used: tuple[DefaultUsed, ...] = ()
    if isinstance(place, Beside) and goal.distance is None and place.gap > 0.0:
        reason = "no distance said"
        used = (DefaultUsed(name="place_gap", value=place.gap, unit="m", reason=reason),)
    aims = tuple(here(target, float(x), float(y)) for x, y in spots)
    if isinstance(place, Between):
        both = tuple((seen.name, place.apart(target)) for seen in (place.one, place.other))
        return Aimed(aims, near=both, defaults=used)
    if not isinstance(place, Beside):
        return Aimed(aims, defaults=used)
    if goal.relation != "touching":
        return Aimed(aims, near=((place.other.name, place.gap),), defaults=used)
    beyond = tuple(_farther(aim, target, _BEYOND) for aim in aims)
    return Aimed(beyond, until="touching", meets=place.other.name, defaults=used)


def _farther(aim: Aim, target: SeenObject, by: float) -> Aim:
    """An aim so much farther on the way to it [m]."""
    x, y = target.pose.x, target.pose.y
    length = math.dist((aim.x, aim.y), (x, y))
    share = 1.0 + by / max(length, by)
    return aim.model_copy(update={"x": x + share * (aim.x - x), "y": y + share * (aim.y - y)})


def _rotated(goal: g.Rotate, target: SeenObject, defaults: Defaults) -> Aimed:
    angle, used = goal.angle, []
    if angle is None:
        angle, reason = {
            "little": (defaults.turn_little, "“a little”"),
            "lot": (defaults.turn_lot, "“a lot”"),
            None: (defaults.turn, "no angle said"),
        }[goal.amount]
        used.append(DefaultUsed(name="turn", value=angle, unit="rad", reason=reason))
    spare = {"exact": 0.0, "at_least": 1.0, "at_most": -1.0}[goal.bound]
    angle += spare * min(defaults.turn_tolerance, 0.5 * angle)
    signs = {"ccw": (1.0,), "cw": (-1.0,), None: (1.0, -1.0)}[goal.sense]
    pose = target.pose
    aims = tuple(Aim(x=pose.x, y=pose.y, yaw=pose.yaw + sign * angle) for sign in signs)
    return Aimed(aims, defaults=tuple(used))
