"""Ways of an object over the table: straight segments along its faces from where it is to its aim.

Model: a straight push moves an object along the inward normal of a face, or a little oblique to it
as long as the fingertips stick; its heading stays. So the path to a place is one segment, or two
along the normals of two faces, or more around what stands in the way. A round object has a face
everywhere. Segments must be free for the moving footprint; shorter ways come first.

Frames: W, its table plane.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.problem.directions import angle_between, heading_of, unit
from planner.problem.footprints import (
    Separations,
    footprint,
    free_travel,
    leading_point,
    travel_to_edge,
)
from planner.problem.places import object_at
from planner.pushing.turn_planner import TurnStroke
from planner.refusals.blocked import Blocked, length_mark
from planner.types.actions import Aim
from planner.types.world_state import LengthMark, SeenObject, WorldState

ANOTHER_PUSH = 0.15
"""Way that costs as much as another push [m]."""

_DETOURS = np.arange(0.04, 0.33, 0.04)
"""Lengths of a first segment around what stands in the way [m]."""


@dataclass(frozen=True)
class PathSegment:
    """A straight piece of a way: heading in W [rad] and length [m]."""

    heading: float
    distance: float

    @property
    def displacement(self) -> NDArray[np.float64]:
        """Of the object in W, shape (3,) [m]."""
        return self.distance * unit(self.heading)


@dataclass(frozen=True)
class SegmentEnd:
    """End of a path before its goal.

    Attributes:
        free: length that is free [m].
        segment: on which it is met.
        other: name of the object in the way; None if it is the table's edge.
    """

    free: float
    segment: PathSegment
    other: str | None


def moved_along(target: SeenObject, segment: PathSegment) -> SeenObject:
    """The object after a segment."""
    return object_at(target, (target.pose.p_WB + segment.displacement)[:2])


def heading_at_contact(
    target: SeenObject, path: tuple[PathSegment, ...], other: NDArray[np.float64]
) -> float:
    """Heading in which an object has come where the last push ends as it meets another [rad].

    Args:
        target: the object, before the first segment.
        path: its way; the last segment may go on to beyond where they touch.
        other: corners of what is met in W, shape (k, 2) [m].
    """
    *before, last = path
    there = target
    for segment in before:
        there = moved_along(there, segment)
    way = free_travel(footprint(there), other, unit(last.heading)[:2], 0.0)
    met = moved_along(there, replace(last, distance=min(way, last.distance)))
    return heading_of(met.pose.p_WB - target.pose.p_WB)


def largest_obliqueness(target: SeenObject, sigmas: float, *, steep: bool = False) -> float:
    """Largest angle between a push and the normal of a face at which fingertips stick [rad].

    Args:
        target: the object.
        sigmas: by which friction may be less than believed.
        steep: whether two fingertips may go nearly to where they would slip.
    """
    model = target.model
    least = model.finger_friction - sigmas * model.finger_friction_sd
    slips = math.atan(max(least, 0.0))
    # Beyond 85 % of the angle at which two fingertips slip they creep along the face.
    return 0.85 * slips if steep else min(math.radians(17.5), slips)


def obliqueness(target: SeenObject, heading: float) -> float:
    """Angle by which an object would have to turn for a face to be square to a push [rad]."""
    inward = _inward_headings(target)
    if target.model.base.is_round or not inward:
        return 0.0
    return min((angle_between(heading, h) for h in inward), key=abs)


def direct_paths(
    target: SeenObject, aim: Aim, within: float, largest: float
) -> Iterator[tuple[PathSegment, ...]]:
    """Ways of one or two segments from where an object is to an aim, the shortest first.

    Args:
        target: the object.
        aim: where it should be; its heading is not looked at.
        within: distance that need not be travelled [m]; segments shorter than half of it are left
            out.
        largest: angle between a segment and the normal of its face, if it is the only one [rad].
    """
    rest = np.array([aim.x, aim.y, 0.0]) - target.pose.p_WB
    length, heading = float(np.linalg.norm(rest)), heading_of(rest)
    if target.model.base.is_round:
        yield (PathSegment(heading, length),)
        return
    inward = _inward_headings(target)
    if not inward:
        return
    off = min(abs(angle_between(heading, h)) for h in inward)
    if off <= largest:
        yield (PathSegment(heading, length),)
    pairs = []
    for a, b in itertools.combinations(inward, 2):
        along = np.column_stack((unit(a)[:2], unit(b)[:2]))
        if abs(np.linalg.det(along)) < 0.1:
            continue
        lengths = np.linalg.solve(along, rest[:2])
        if (lengths < -0.5 * within).any():
            continue
        segments = [
            PathSegment(h, float(s))
            for h, s in zip((a, b), lengths, strict=True)
            if s > 0.5 * within
        ]
        pairs.append(sorted(segments, key=lambda segment: -segment.distance))
    for segments in sorted(pairs, key=lambda each: sum(segment.distance for segment in each)):
        for order in itertools.permutations(segments):
            if order:
                yield order


def push_headings(target: SeenObject, aim: Aim) -> tuple[float, ...]:
    """Headings in which an object is pushed square to a face [rad].

    A round object is pushed straight to the aim, and across.
    """
    if not target.model.base.is_round:
        return tuple(_inward_headings(target))
    ahead = heading_of(np.array([aim.x, aim.y, 0.0]) - target.pose.p_WB)
    return tuple(ahead + quarter * math.pi / 2.0 for quarter in range(4))


def sidestep_paths(
    target: SeenObject, aim: Aim, within: float, largest: float
) -> list[tuple[PathSegment, ...]]:
    """Ways that begin with a segment to the side, the shortest first."""
    found = []
    for heading, length in itertools.product(push_headings(target, aim), _DETOURS):
        first = PathSegment(heading, float(length))
        found += [
            (first, *then)
            for then in direct_paths(moved_along(target, first), aim, within, largest)
        ]
    return sorted(found, key=lambda way: sum(segment.distance for segment in way))


class Obstructions:
    """Everything that may stand in the ways of an object.

    Args:
        target: the object, where the ways begin.
        state: what is believed.
        clearances: distance kept from each other object [m].
        margin: distance kept from the table's edge [m].
    """

    def __init__(
        self, target: SeenObject, state: WorldState, clearances: dict[str, float], margin: float
    ) -> None:
        self._own, self._table, self._margin = footprint(target), state.table, margin
        self._names = [*clearances]
        others = [footprint(state.objects[name]) for name in clearances]
        self._others = Separations(self._own, others, [*clearances.values()])

    def first_stop(self, way: tuple[PathSegment, ...]) -> SegmentEnd | None:
        """The first thing that stands in a path of segments; None if the path is free."""
        moved, free = np.zeros(2), 0.0
        for segment in way:
            u = unit(segment.heading)[:2]
            least = travel_to_edge(self._own + moved, self._table, u, self._margin)
            other = None
            rooms = self._others.free_travels(moved, u).tolist()
            for name, room in zip(self._names, rooms, strict=True):
                if room < least:
                    least, other = room, name
            if least < segment.distance:
                return SegmentEnd(free + max(least, 0.0), segment, other)
            moved, free = moved + segment.distance * u, free + segment.distance
        return None


def free_length_mark(
    target: SeenObject, way: tuple[PathSegment, ...], met: SegmentEnd
) -> LengthMark:
    """The mark of what is free before the end of a way, on the segment on which it ends."""
    gone = 0.0
    for segment in itertools.takewhile(lambda each: each is not met.segment, way):
        target, gone = moved_along(target, segment), gone + segment.distance
    u, asked, free = unit(met.segment.heading), met.segment.distance, max(met.free - gone, 0.0)
    what = "to the table's edge" if met.other is None else f"to the {met.other}"
    text = f"{1e3 * free:.0f} mm {what}; {1e3 * asked:.0f} mm asked"
    return length_mark(leading_point(target, u), u, free, text, asked)


def _inward_headings(target: SeenObject) -> list[float]:
    """Headings in W of the inward normals of the side faces [rad]."""
    R_WB = target.pose.R_WB
    return [heading_of(-R_WB @ np.array(face.normal)) for face in target.model.faces()]


_ALIKE = 0.05  # half the depth of a hand: pushes that begin nearer to each other meet the same [m]
_SAME_WAY = math.radians(6.0)  # pushes whose headings differ by less go alike
_SAME_SPOT, _SAME_HEADING = 1e-4, 1e-3  # objects that stand so near stand alike [m], [rad]


def is_denied(why: Blocked) -> bool:
    """Return True if a push is not made since the hand does not get there."""
    return why.reason in ("out_of_reach", "blocked")


class DeniedPushes:
    """The segments of paths and the parts of turns to which the hand does not get."""

    def __init__(self) -> None:
        self._segments: list[tuple[SeenObject, PathSegment]] = []
        self._strokes: list[tuple[SeenObject, TurnStroke]] = []

    def forget_segments(self) -> None:
        """Lets all segments be asked for again."""
        self._segments.clear()

    def note_segment(self, target: SeenObject, segment: PathSegment) -> None:
        """Takes note of a segment that begins where an object stands."""
        self._segments.append((target, segment))

    def note_stroke(self, target: SeenObject, stroke: TurnStroke) -> None:
        """Takes note of a part of a turn."""
        self._strokes.append((target, stroke))

    def cover_path(self, target: SeenObject, path: tuple[PathSegment, ...]) -> bool:
        """Return True if a push of a path is much like one of them."""
        for segment in path:
            for there, denied in self._segments:
                # A push may be made if it is shorter than this share of one like it that is not.
                if (
                    _apart(target, there) < _ALIKE
                    and abs(angle_between(segment.heading, denied.heading)) <= _SAME_WAY
                    and segment.distance >= 0.5 * denied.distance
                ):
                    return True
            target = moved_along(target, segment)
        return False

    def cover_turn(self, target: SeenObject, steps: tuple[TurnStroke, ...]) -> bool:
        """Return True if a part of a turn is one of them, or more of one."""
        for stroke in steps:
            for there, denied in self._strokes:
                if (
                    stroke.side.face == denied.side.face
                    and stroke.angle / denied.angle >= 1.0
                    and _apart(target, there) < _SAME_SPOT
                    and abs(angle_between(target.pose.yaw, there.pose.yaw)) < _SAME_HEADING
                ):
                    return True
            target = stroke.target_after(target)
        return False


def _apart(target: SeenObject, there: SeenObject) -> float:
    """Distance between two places of an object [m]."""
    return math.dist(target.pose.p_WB, there.pose.p_WB)
