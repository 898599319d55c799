"""Steps that make room before a frame, as frames like those of a sentence.

Model: what is in the way goes straight along one of eight directions to a place that leaves the
object its way and the hand some room, the nearest first. The object itself goes to where there is
room around it, if only the hand does not get to it where it stands. Whether something can be pushed
there, and whether the object then gets where it should, is planned as for any other frame.

Frames: W, its table plane.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from grammar.frames import command as g
from objectmodels.geometry.base_shapes import Array, hull_polygon
from planner.problem.directions import bisector, unit
from planner.problem.footprints import footprint, gap, kept_gap, room_to_edge
from planner.problem.frame_interpretation import interpret_frame
from planner.problem.places import object_at
from planner.problem.planning_problem import places_told_by
from planner.pushing.push_paths import Obstructions, PathSegment
from planner.refusals.blocked import Blocked
from planner.types.defaults import Defaults
from planner.types.refusal import Refusal
from planner.types.world_state import ObstacleMark, SeenObject, WorldState

_WAYS: tuple[tuple[g.Direction, ...], ...] = (
    ("left",),
    ("right",),
    ("away",),
    ("toward",),
    ("away", "left"),
    ("away", "right"),
    ("toward", "left"),
    ("toward", "right"),
)
_STEPS = (0.04, 0.06, 0.08, 0.10, 0.12, 0.15, 0.20, 0.25, 0.30, 0.40)  # ways that are tried [m]
_HAND = 0.05  # room that a hand has beside what was cleared [m]
_BESIDE = 0.02  # a clearance, and what pushes miss by [m]
_KEPT = frozenset({"no_touch", "gentle", "slow", "max_force", "max_speed", "no_lift"})
"""Constraints of a frame that a step before it keeps, too."""
_KEPT_BY_ITSELF = _KEPT | {"no_topple", "no_tilt", "max_tilt", "no_turn", "max_turn", "no_spill"}
"""The same of a step of the frame's own object; any other says where or when it is moved."""
_FAR = (0.10, 0.20, 0.30)  # ways on which the hand gets to an object otherwise [m]
_ROOMY = 0.10  # more room around it is no better [m]
_ANYWHERE = (g.Open, g.Close, g.Lift, g.Pour)
"""Goals that an object may reach wherever it stands, and that the hand may reach elsewhere.

What is not stood up where it lies is hardly stood up elsewhere, and finding that out takes long.
"""
_FROM_HERE = frozenset({"back", "clear_of", "out_of", "off", "over", "in_row", "together"})
"""Relations that tell a place by where the object stands, or by what it stands on."""
_IN_HAND = (g.Place, g.Pour)
"""Goals that an object may reach in another grasp."""
_BEYOND_HAND = frozenset(
    {"grasps_blocked", "no_grasp_reached", "pushes_blocked", "no_push_reached"}
    | {"blocked_in_hand", "no_reach_in_hand"}
)
"""Codes of refusals that name nothing but the hand's reach."""


def obstacles(refusal: Refusal) -> tuple[str, ...]:
    """Names of what stands in the way, by a refusal."""
    marks = (mark.object for mark in refusal.marks if isinstance(mark, ObstacleMark))
    return tuple(dict.fromkeys(marks))


def may_be_cleared(name: str, frames: Sequence[g.Frame], state: WorldState) -> bool:
    """Return True if an object may be moved out of the way of frames.

    It may not if it is fixed, fragile or held, if a frame says that it is not touched, or if a
    frame tells by it where to go. What a frame is about may be moved anyhow.
    """
    seen, held = state.objects[name], state.held
    about = {frame.object.id for frame in frames if frame.object is not None}
    if seen.fixed or (held is not None and held.name == name):
        return False
    if seen.fragile and name not in about:
        return False
    for frame in frames:
        own = frame.object is not None and frame.object.id == name
        spared = [c.object for c in frame.constraints if isinstance(c, g.NoTouch) and not own]
        if any(other is None or other.id == name for other in spared):
            return False
        if name in places_told_by(frame.goal):
            return False
    return True


def clearing_frames(
    name: str, frame: g.Frame, state: WorldState, defaults: Defaults
) -> Iterator[g.Frame]:
    """Frames that move an object out of the way of another frame, the shortest way first.

    Args:
        name: of what is in the way.
        frame: that cannot be carried out before.
        state: what is believed.
        defaults: margins.
    """
    constraints = tuple(c for c in frame.constraints if c.kind in _KEPT)
    for way, distance in _ways_out(state.objects[name], frame, state, defaults):
        yield _step_of(name, way, distance, constraints)


def is_beyond_hand(refusal: Refusal) -> bool:
    """Return True if something is refused since the hand does not get there."""
    return refusal.code in _BEYOND_HAND


def may_be_brought(frame: g.Frame, state: WorldState) -> bool:
    """Return True if the object of a frame may be moved first, so that the hand gets to it.

    The frame must not say by where the object stands what becomes of it, nor how or when it moves.
    """
    own = frame.object
    if own is None or own.id is None or not _begins_anywhere(frame):
        return False
    return may_be_cleared(own.id, (frame,), state)


def may_be_grasped_anew(frame: g.Frame, state: WorldState) -> bool:
    """Return True if the object of a frame is held, and may be put down first.

    In another grasp the hand may get it to where it should.
    """
    held, own = state.held, frame.object
    if held is None or own is None or own.id != held.name:
        return False
    return isinstance(frame.goal, _IN_HAND) and _begins_anywhere(frame)


def setting_down_frame(frame: g.Frame) -> g.Frame:
    """The frame that puts down what another one is about, as gently as that asks."""
    assert frame.object is not None, "what is put down is held"
    name, kept = frame.object.id or "", frame.constraints
    own = g.ObjectRef(text=name, noun=name, id=name)
    return g.Frame(action="place", object=own, goal=g.SetDown(), constraints=kept)


def _begins_anywhere(frame: g.Frame) -> bool:
    """Return True if what a frame asks for does not depend on where its object is at first."""
    goal = frame.goal
    anywhere = isinstance(goal, _ANYWHERE) or (
        isinstance(goal, g.Place) and goal.fraction is None and goal.relation not in _FROM_HERE
    )
    return anywhere and all(each.kind in _KEPT_BY_ITSELF for each in frame.constraints)


def bringing_frames(frame: g.Frame, state: WorldState, defaults: Defaults) -> Iterator[g.Frame]:
    """Frames that bring the object of a frame to other places, those with most room first.

    Args:
        frame: that cannot be carried out before, since the hand does not get to its object.
        state: what is believed.
        defaults: margins.
    """
    assert frame.object is not None, "what is about no object needs no hand"
    seen = state.objects[frame.object.id or ""]
    free = _free_ways(seen, state, defaults)
    found = []
    for number, way in enumerate(_WAYS):
        for distance in _FAR:
            room = _room_around(_place_along(seen, way, distance), seen, state)
            if room >= _HAND and free.first_stop((_segment(way, distance),)) is None:
                found.append((-round(min(room, _ROOMY), 2), distance, number, way))
    for _, distance, _, way in sorted(found):
        yield _step_of(seen.name, way, distance, frame.constraints)


def _step_of(
    name: str,
    way: tuple[g.Direction, ...],
    distance: float,
    constraints: tuple[g.Constraint, ...],
) -> g.Frame:
    """The frame that moves an object along a way."""
    return g.Frame(
        action="move",
        object=g.ObjectRef(text=name, noun=name, id=name),
        goal=g.Displace(direction=way if len(way) == 2 else way[0], distance=distance),
        constraints=constraints,
    )


def _ways_out(
    seen: SeenObject, frame: g.Frame, state: WorldState, defaults: Defaults
) -> list[tuple[tuple[g.Direction, ...], float]]:
    """Directions, and how far along each [m], the shortest way first."""
    free = _free_ways(seen, state, defaults)
    lanes = _lanes(frame, state, defaults)
    here = [gap(footprint(seen), lane) for lane in lanes]
    found = []
    for way in _WAYS:
        for distance in _STEPS:
            there = _place_along(seen, way, distance)
            if _room_around(there, seen, state) < _HAND:
                continue
            rooms = [gap(there, lane) for lane in lanes]
            if not any(map(_leaves_way, here, rooms)):
                continue
            if free.first_stop((_segment(way, distance),)) is None:
                found.append((way, distance))
            break
    return sorted(found, key=lambda each: each[1])


def _free_ways(seen: SeenObject, state: WorldState, defaults: Defaults) -> Obstructions:
    """What stands in the ways of an object."""
    others = (other for name, other in state.objects.items() if name != seen.name)
    usual = {True: defaults.clearance_fragile, False: defaults.clearance}
    # What stands closer keeps less.
    kept = {
        other.name: kept_gap(footprint(seen), footprint(other), usual[other.fragile])
        for other in others
    }
    return Obstructions(seen, state, kept, defaults.clearance)


def _segment(way: tuple[g.Direction, ...], distance: float) -> PathSegment:
    """So much of a way [m]."""
    heading = bisector(way)
    assert heading is not None, "neighbouring directions have a middle"
    return PathSegment(heading, distance)


def _place_along(seen: SeenObject, way: tuple[g.Direction, ...], distance: float) -> Array:
    """Outline of an object that went along a way, shape (k, 2) [m]."""
    along = unit(_segment(way, distance).heading)
    return footprint(object_at(seen, (seen.pose.p_WB + distance * along)[:2]))


def _room_around(outline: Array, seen: SeenObject, state: WorldState) -> float:
    """Least distance of an outline of an object from all others and from the table's edge [m].

    More than `_ROOMY` is not told exactly.
    """
    low, high = outline.min(axis=0) - _ROOMY, outline.max(axis=0) + _ROOMY
    others = (footprint(other) for name, other in state.objects.items() if name != seen.name)
    near = (o for o in others if (o.min(axis=0) < high).all() and (o.max(axis=0) > low).all())
    return min([room_to_edge(outline, state.table), *(gap(outline, other) for other in near)])


def _leaves_way(before: float, after: float) -> bool:
    """Return True if what stood in a way leaves it; what stood beside it is in the hand's way."""
    return after >= _BESIDE and (before < _BESIDE or after >= before + _HAND)


def _lanes(frame: g.Frame, state: WorldState, defaults: Defaults) -> list[Array]:
    """Polygons that an object covers on the straight way to each of its aims, (k, 2) each [m]."""
    assert frame.object is not None, "what is in the way of nothing is not cleared"
    target = state.objects[frame.object.id or ""]
    here = footprint(target)
    problem = interpret_frame(frame, state, defaults)
    aims = () if isinstance(problem, Blocked) else problem.goal.aims
    ends = [here + (np.array([aim.x, aim.y]) - target.pose.p_WB[:2]) for aim in aims]
    return [hull_polygon(np.vstack([here, end])).vertices for end in ends or [here]]
