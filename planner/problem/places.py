"""Places as regions of poses: next to, left of, between, touching, at the edge.

Model: objects cover convex polygons of the table plane, and a place is a region of poses. The same
region tells where an object has to go and, afterwards, whether it is there; so planner and checker
cannot differ about a word. Left, right, in front and behind are those of the robot. Gaps are exact
distances between surfaces; the middle of an object is its origin.

Frames: everything in W's table plane [m].
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from grammar.frames import command as g
from objectmodels.geometry.base_shapes import Array, Polygon
from objectmodels.geometry.rotations import left_of
from objectmodels.models.object_parts import Cavity, inner_floor
from objectmodels.safety_figure import SafetyFigure
from planner.problem.directions import HEADINGS, heading_of, unit
from planner.problem.footprints import footprint, gap
from planner.problem.overhangs import edge_name
from planner.problem.stacks import face_in_world
from planner.types.defaults import Defaults
from planner.types.world_state import SeenObject, TableState, WorldState


@dataclass(frozen=True)
class Measure:
    """One quantity of a place, as it should be and as it is.

    Attributes:
        quantity: what is measured, in words.
        relation: how `measured` must stand to `expected`.
        expected: what it should be [m].
        measured: what it is [m].
        tolerance: by how much it may miss [m].
    """

    quantity: str
    relation: Literal["about", "at_most", "at_least"]
    expected: float
    measured: float
    tolerance: float

    @property
    def miss(self) -> float:
        """Distance from what it should be [m]; never negative."""
        excess = self.measured - self.expected
        return {"about": abs(excess), "at_most": max(excess, 0.0), "at_least": max(-excess, 0.0)}[
            self.relation
        ]

    @property
    def ok(self) -> bool:
        """Return True if it is within its tolerance."""
        return self.miss <= self.tolerance


class Region(ABC):
    """A place: the poses in which an object is where a word says."""

    @abstractmethod
    def spots(self, own: SeenObject) -> list[Array]:
        """Positions of an object's origin in W at which it is in the middle of the place.

        Args:
            own: the object, with the heading that it will have there.

        Returns:
            Positions, shape (2,) each [m], the nearest to where it is first; none if there is no
            room for it.
        """

    @abstractmethod
    def measures(self, own: SeenObject) -> tuple[Measure, ...]:
        """Quantities of how well an object is there."""

    def holds(self, own: SeenObject) -> bool:
        """Return True if an object is there, within the tolerances."""
        return all(measure.ok for measure in self.measures(own))


_SIDES = {
    "left_half": "left",
    "right_half": "right",
    "front_half": "toward",
    "back_half": "away",
}
_WAYS = np.arange(8) * np.pi / 4.0  # headings in which something is moved away [rad]
_ASIDE = (0.0, 0.06, -0.06, 0.12, -0.12, 0.18, -0.18, 0.24, -0.24)  # along the middle [m]
_STEP, _FARTHEST = 0.005, 0.6  # of places along them [m]


@dataclass(frozen=True)
class InHalf(Region):
    """A place in one half of the table.

    Attributes:
        table: that has it.
        half: its name.
        tolerance: by which the object may reach over the middle [m].
    """

    table: TableState
    half: str
    tolerance: float

    def spots(self, own: SeenObject) -> list[Array]:
        """So far that none of it is in the other half, straight first, or where it is."""
        here, across = own.pose.p_WB[:2], self._reach_over(own) + self.tolerance
        if across <= 0.0:
            return [here]
        along = left_of(self._way)
        return [here + across * self._way + aside * along for aside in _ASIDE]

    def measures(self, own: SeenObject) -> tuple[Measure, ...]:
        """How far it reaches into the other half."""
        over = self._reach_over(own)
        return (Measure("beyond the middle of the table", "at_most", 0.0, over, self.tolerance),)

    @property
    def _way(self) -> Array:
        """Unit direction from the middle into the half, shape (2,)."""
        return np.asarray(unit(HEADINGS[_SIDES[self.half]])[:2])

    def _reach_over(self, own: SeenObject) -> float:
        """Way from the middle to the farthest corner in the other half; negative if none is [m]."""
        return float(((self.table.middle - footprint(own)) @ self._way).max())


@dataclass(frozen=True)
class Beyond(Region):
    """A place at least a distance away from what covers some parts of the table.

    Attributes:
        shapes: names, and corners of convex polygons in W, (k, 2) each [m].
        distance: to be kept from each [m].
        tolerance: of the distance [m].
    """

    shapes: tuple[tuple[str, Array], ...]
    distance: float
    tolerance: float

    def spots(self, own: SeenObject) -> list[Array]:
        """Straight away in eight directions, the nearest first; or where it is."""
        here, shape = own.pose.p_WB[:2], footprint(own)
        found = []
        for u in (unit(float(way))[:2] for way in _WAYS):
            for length in np.arange(0.0, _FARTHEST, _STEP):
                if self._room(shape + length * u) >= self.distance:
                    found.append((float(length), here + length * u))
                    break
        return [spot for _, spot in sorted(found, key=lambda each: each[0])]

    def measures(self, own: SeenObject) -> tuple[Measure, ...]:
        """The gap to each."""
        here = footprint(own)
        return tuple(
            Measure(
                f"gap to the {name}", "at_least", self.distance, gap(here, shape), self.tolerance
            )
            for name, shape in self.shapes
        )

    def _room(self, corners: Array) -> float:
        return min(gap(corners, shape) for _, shape in self.shapes)


@dataclass(frozen=True)
class Aside(Region):
    """A place some way from where an object stood, to a side if there is room.

    Attributes:
        start: the object, where it stood.
        distance: at least so far from there [m].
        tolerance: of the distance [m].
    """

    start: SeenObject
    distance: float
    tolerance: float

    def spots(self, own: SeenObject) -> list[Array]:
        """To the left, to the right, then in the other directions of eight."""
        there = self.start.pose.p_WB[:2]
        ways = sorted(_WAYS, key=lambda way: -abs(round(math.sin(way), 3)))
        return [there + self.distance * unit(float(way))[:2] for way in ways]

    def measures(self, own: SeenObject) -> tuple[Measure, ...]:
        """The way aside."""
        aside = math.dist((own.pose.x, own.pose.y), (self.start.pose.x, self.start.pose.y))
        return (Measure("moved aside", "at_least", self.distance, aside, self.tolerance),)


# Places in an open box, on its floor.
#
# Model: what stands there keeps its heading; it and its neighbours cover convex polygons. Frames:
# W is the world, B the box.

WALL_ROOM: SafetyFigure = 0.008
"""Room between the walls of a box and what is put into it [m]."""


@dataclass(frozen=True)
class InBox(Region):
    """A place on the floor of an open box.

    Attributes:
        box: what it is in.
        contents: what stands in it.
        apart: distance that is kept from that [m].
        tolerance: of the height [m].
    """

    box: SeenObject
    contents: tuple[SeenObject, ...]
    apart: float
    tolerance: float

    def spots(self, own: SeenObject) -> list[Array]:
        """With room on all sides: far from what is in it, else in the middle first."""
        low, high = self._free_range(own)
        if (low > high).any():
            return []
        R_WB = self.box.pose.R_WB[:2, :2]
        steps = _pairs_outwards(np.linspace(-1.0, 1.0, 5))
        inside = 0.5 * (low + high) + 0.5 * steps * (high - low)
        places = inside @ R_WB.T + self.box.pose.p_WB[:2]
        rooms = [self._room(own, at) for at in places]
        order = np.argsort(-np.minimum(rooms, 2.0 * self.apart).round(3), kind="stable")
        return [places[k] for k in order if rooms[k] >= self.apart]

    def excess(self, own: SeenObject) -> float:
        """Length by which an object is too long for the box, with room on all sides [m]."""
        low, high = self._free_range(own)
        return float((low - high).max())

    def measures(self, own: SeenObject) -> tuple[Measure, ...]:
        """How far it is beyond the inner walls, and its height over the floor."""
        name = self.box.name
        floor = face_in_world(inner_floor(self._cavity), self.box)
        beyond = max(float((footprint(own) @ floor.normals.T - floor.offsets).max()), 0.0)
        height = own.pose.z - self.box.pose.z - self.box.model.standing_height
        return (
            Measure(f"beyond the walls of the {name}", "at_most", 0.0, beyond, 0.0),
            Measure(f"height over the floor of the {name}", "about", 0.0, height, self.tolerance),
        )

    @property
    def _cavity(self) -> Cavity:
        inside = self.box.model.inside
        assert inside is not None, "it is in an open box"
        return inside

    def _free_range(self, own: SeenObject) -> tuple[Array, Array]:
        """Between which the origin of an object may be in B, each (2,) [m]; none if crossed."""
        shape = (footprint(own) - own.pose.p_WB[:2]) @ self.box.pose.R_WB[:2, :2]
        half = 0.5 * np.array(self._cavity.size) - WALL_ROOM
        return -half - shape.min(axis=0), half - shape.max(axis=0)

    def _room(self, own: SeenObject, at: Array) -> float:
        """Distance of an object at a place from all that stands in the box [m]."""
        there = footprint(own) - own.pose.p_WB[:2] + at
        others = (seen for seen in self.contents if seen.name != own.name)
        return min((gap(there, footprint(seen)) for seen in others), default=np.inf)


@dataclass(frozen=True)
class OnTop(Region):
    """A place on top of an object.

    Attributes:
        lower: the object.
        tolerance: of the height [m].
    """

    lower: SeenObject
    tolerance: float

    def spots(self, own: SeenObject) -> list[Array]:
        """With its centre of mass over the top, the middle first; none if the top is not flat."""
        top = self.lower.model.top_face
        if top is None:
            return []
        face = face_in_world(top, self.lower)
        com = own.pose.R_WB[:2, :2] @ np.array(own.model.com[:2])
        half = 0.5 * np.ptp(top.vertices, axis=0)
        steps = _pairs_outwards(np.linspace(-0.8, 0.8, 9))
        over = face.centroid + (steps * half) @ self.lower.pose.R_WB[:2, :2].T
        inside = (over @ face.normals.T < face.offsets).all(axis=1)
        return list(over[inside] - com)

    def measures(self, own: SeenObject) -> tuple[Measure, ...]:
        """Height over the top, and how far its middle is beyond the top's edge."""
        name, lower = self.lower.name, self.lower
        height = own.pose.z - lower.pose.z - lower.model.top
        outline = Polygon.convex(lower.bulk()[0])
        beyond = max(float((outline.normals @ own.pose.p_WB[:2] - outline.offsets).max()), 0.0)
        return (
            Measure(f"height over the top of the {name}", "about", 0.0, height, self.tolerance),
            Measure(f"beyond the edge of the {name}'s top", "at_most", 0.0, beyond, 0.0),
        )


@dataclass(frozen=True)
class OffObject(Region):
    """A place on the table, taken off an object or out of it.

    Attributes:
        lower: that object.
        beside: places next to it.
    """

    lower: SeenObject
    beside: Region

    def spots(self, own: SeenObject) -> list[Array]:
        """Beside it, the nearest first."""
        return self.beside.spots(own)

    def measures(self, own: SeenObject) -> tuple[Measure, ...]:
        """The gap to what it stood on; what is on it or in it has none."""
        apart = gap(footprint(own), footprint(self.lower))
        return (Measure(f"gap to the {self.lower.name}", "at_least", 0.0, apart, 0.0),)


SIDES: dict[str, tuple[str, ...]] = {
    "left_of": ("left",),
    "right_of": ("right",),
    "in_front_of": ("toward",),
    "behind": ("away",),
    "front_left_of": ("toward", "left"),
    "front_right_of": ("toward", "right"),
    "behind_left_of": ("away", "left"),
    "behind_right_of": ("away", "right"),
}
"""Relations to one side or corner of an object, and the directions between which that lies."""

_EDGES: dict[str, tuple[tuple[str, ...], ...]] = {
    "left_edge": (("left",),),
    "right_edge": (("right",),),
    "front_edge": (("toward",),),
    "back_edge": (("away",),),
    "edge": (("left",), ("right",), ("toward",), ("away",)),
    "front_left_corner": (("toward", "left"),),
    "front_right_corner": (("toward", "right"),),
    "back_left_corner": (("away", "left"),),
    "back_right_corner": (("away", "right"),),
    "corner": (("toward", "left"), ("toward", "right"), ("away", "left"), ("away", "right")),
}
"""Edges at which an object must stand to be in a region of the table; any of the choices will do.
"""

OTHER_HALF = {
    "left_half": "right_half",
    "right_half": "left_half",
    "front_half": "back_half",
    "back_half": "front_half",
}
"""Halves of the table, and where what is cleared from them goes."""

_DOT = 1e-3 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])  # a point, nearly [m]
_CLOSE = 1e-5  # accuracy of a gap [m]
_STEPS = 60  # advances until a gap is that accurate


def region(
    goal: g.Place, state: WorldState, d: Defaults, start: SeenObject | None = None
) -> Region | None:
    """The place that a goal asks for, without its share of the way; None for one in no open box.

    The objects of the goal are resolved, its length is in metres. What is moved aside stood at the
    start where `start` says.
    """
    reference = goal.reference
    if goal.relation == "clear_of":
        return _place_clear_of(goal, state, d, start)
    if isinstance(reference, g.Point):
        return Spot(reference.x, reference.y, d.place_tolerance)
    if isinstance(reference, str):
        if goal.distance is not None:
            assert isinstance(goal.distance, float), "lengths measured in objects are resolved"
            d = replace(d, edge_gap=goal.distance, overhang=goal.distance)
        if goal.relation == "over":
            choices = _EDGES[reference]
            return AtEdge(state.table, choices, -d.overhang, d.overhang_tolerance)
        return table_region(reference, state.table, d)
    objects = tuple(state.objects[ref.id or ""] for ref in reference)
    match goal.relation, objects:
        case "between", (one, other):
            return Between(one, other, d.between_tolerance)
        case "on", (other,):
            return OnTop(other, d.no_lift)
        case "in", (other,) if other.model.inside is not None:
            return InBox(other, state.carried_by(other.name), d.clearance, d.no_lift)
        case (("off" | "out_of"), (other,)):
            return OffObject(other, Beside(other, (), d.place_gap, d.place_gap_tolerance, 0.0))
        case "touching", (other,):
            return Beside(other, (), 0.0, d.touching_gap, d.place_aside)
        case relation, (other,) if relation in SIDES or relation in ("next_to", "at"):
            side = SIDES.get(relation, ())
            if goal.distance is None:
                return Beside(other, side, d.place_gap, d.place_gap_tolerance, d.place_aside)
            assert isinstance(goal.distance, float), "lengths measured in objects are resolved"
            return Beside(other, side, goal.distance, d.place_tolerance, d.place_aside)
    return None


def _place_clear_of(
    goal: g.Place, state: WorldState, d: Defaults, start: SeenObject | None
) -> Region | None:
    """The place away from objects, from a part of the table, or aside."""
    reference, distance = goal.reference, goal.distance
    assert not isinstance(distance, g.RelativeLength), "lengths measured in objects are resolved"
    if isinstance(reference, tuple) and not reference:
        way = d.aside if distance is None else distance
        return (
            None if start is None else Aside(start, way, d.tolerance_of(way, d.distance_tolerance))
        )
    if isinstance(reference, str) and reference in OTHER_HALF:
        return InHalf(state.table, OTHER_HALF[reference], d.edge_tolerance)
    room = d.room if distance is None else distance
    if isinstance(reference, tuple):
        objects = [state.objects[ref.id or ""] for ref in reference]
        return Beyond(tuple((o.name, footprint(o)) for o in objects), room, d.place_tolerance)
    if reference != "center":
        return None
    return Beyond((("middle of the table", _DOT + state.table.middle),), room, d.place_tolerance)


def table_region(name: str, table: TableState, d: Defaults) -> Region:
    """A region of the table by its name in the frame contract."""
    if name in OTHER_HALF:
        return InHalf(table, name, d.edge_tolerance)
    if name == "center":
        x, y = table.middle.tolist()
        return Spot(x, y, d.centre_tolerance)
    return AtEdge(table, _EDGES[name], d.edge_gap, d.edge_tolerance)


@dataclass(frozen=True)
class Spot(Region):
    """A point of the table.

    Attributes:
        x, y: the point in W [m].
        tolerance: distance from it within which an object is there [m].
    """

    x: float
    y: float
    tolerance: float

    def spots(self, own: SeenObject) -> list[Array]:
        """The point."""
        return [np.array([self.x, self.y])]

    def measures(self, own: SeenObject) -> tuple[Measure, ...]:
        """Distance of the object from it."""
        off = math.hypot(own.pose.x - self.x, own.pose.y - self.y)
        where = f"x {self.x:.3g} m, y {self.y:.3g} m"
        return (Measure(f"distance from {where}", "at_most", 0.0, off, self.tolerance),)


@dataclass(frozen=True)
class Beside(Region):
    """A place next to an object, on one side of it, at one corner or anywhere.

    Attributes:
        other: the object.
        side: direction in which the place lies, seen from `other`; two for a corner, none for any.
        gap: between the surfaces [m].
        tolerance: of the gap [m].
        aside: share of the offset at which the two would no longer face each other.
    """

    other: SeenObject
    side: tuple[str, ...]
    gap: float
    tolerance: float
    aside: float

    def spots(self, own: SeenObject) -> list[Array]:
        """On its side: straight across from where the object is, and in the middle of the side."""
        here, there = own.pose.p_WB[:2], self.other.pose.p_WB[:2]
        if not self.side:
            straight = [self._position_against(own, unit(heading_of(here - there))[:2], 0.0)]
            sides = [
                self._position_against(own, unit(heading)[:2], 0.0) for heading in HEADINGS.values()
            ]
            return _nearest_first(here, straight + sides)
        u = self._way()
        room = max(self._room(own, u) - self.tolerance, 0.0) if len(self.side) == 1 else 0.0
        offset = float(np.clip((here - there) @ left_of(u), -room, room))
        return _nearest_first(
            here, [self._position_against(own, u, offset), self._position_against(own, u, 0.0)]
        )

    def measures(self, own: SeenObject) -> tuple[Measure, ...]:
        """The gap, less than nothing on the wrong side; and how far it is from facing the other."""
        name = self.other.name
        apart = gap(footprint(own), footprint(self.other))
        if not self.side:
            return (Measure(f"gap to the {name}", "about", self.gap, apart, self.tolerance),)
        u = self._way()
        way = own.pose.p_WB[:2] - self.other.pose.p_WB[:2]
        apart = apart if way @ u > 0.0 else -abs(apart)
        names = {"toward": "in front", "away": "behind"}
        where = " and ".join(names.get(side, f"to the {side}") for side in self.side)
        offset, room = abs(float(way @ left_of(u))), self._room(own, u)
        part = "side" if len(self.side) == 1 else "corner"
        if part == "corner":
            # Nearer to the diagonal than to either side.
            room = min(room, math.tan(math.pi / 8.0) * max(float(way @ u), 0.0))
        return (
            Measure(f"gap to the {name}, {where}", "about", self.gap, apart, self.tolerance),
            Measure(f"off the middle of the {name}'s {part}", "at_most", 0.0, offset, room),
        )

    def _way(self) -> Array:
        """Unit vector from the other object to the place, shape (2,)."""
        way = sum((unit(HEADINGS[side])[:2] for side in self.side), start=np.zeros(2))
        return np.asarray(way / np.linalg.norm(way))

    def _room(self, own: SeenObject, u: Array) -> float:
        """Offset across a direction that is allowed [m]."""
        widths = [np.ptp(footprint(seen) @ left_of(u)) for seen in (own, self.other)]
        return float(self.aside * sum(widths) / 2.0)

    def _position_against(self, own: SeenObject, u: Array, offset: float) -> Array:
        """Position of an object that came straight against `u` until the gap was left, (2,) [m]."""
        standing, shape = footprint(self.other), footprint(own) - own.pose.p_WB[:2]
        far = np.linalg.norm(shape, axis=1).max() + self.gap
        far += np.linalg.norm(standing - self.other.pose.p_WB[:2], axis=1).max()
        at = self.other.pose.p_WB[:2] + offset * left_of(u) + far * u
        for _ in range(_STEPS):
            # A step as long as what is left of the gap never takes it too close.
            left = gap(shape + at, standing) - self.gap
            if left < _CLOSE:
                break
            at = at - left * u
        return np.asarray(at)


@dataclass(frozen=True)
class Between(Region):
    """The place between two objects, with the same gap to both.

    Attributes:
        one, other: the two.
        tolerance: distance from the middle within which an object is there [m].
    """

    one: SeenObject
    other: SeenObject
    tolerance: float

    def spots(self, own: SeenObject) -> list[Array]:
        """The middle; none if the object does not fit in between."""
        at = self._position_halfway(own)
        shape = footprint(own) - own.pose.p_WB[:2] + at
        fits = all(gap(shape, footprint(seen)) > 0.0 for seen in (self.one, self.other))
        return [at] if fits else []

    def measures(self, own: SeenObject) -> tuple[Measure, ...]:
        """Distance of the object from the middle."""
        off = float(np.linalg.norm(own.pose.p_WB[:2] - self._position_halfway(own)))
        quantity = f"off the middle between the {self.one.name} and the {self.other.name}"
        return (Measure(quantity, "at_most", 0.0, off, self.tolerance),)

    def apart(self, own: SeenObject) -> float:
        """The gap to each of the two, with the object in the middle [m]."""
        at = object_at(own, self._position_halfway(own))
        return gap(footprint(at), footprint(self.one))

    def _position_halfway(self, own: SeenObject) -> Array:
        """Position between the two at which an object is as far from one as from the other."""
        a, b = self.one.pose.p_WB[:2], self.other.pose.p_WB[:2]
        first, second = footprint(self.one), footprint(self.other)
        shape = footprint(own) - own.pose.p_WB[:2]
        u = (b - a) / np.linalg.norm(b - a)
        at = (a + b) / 2.0
        for _ in range(_STEPS):
            # Each gap changes by no more than the step, so half of the difference is never too far.
            more = gap(shape + at, first) - gap(shape + at, second)
            if abs(more) < _CLOSE:
                break
            at = at - 0.5 * more * u
        return np.asarray(at)


@dataclass(frozen=True)
class AtEdge(Region):
    """A place at an edge of the table, or at two of them.

    Attributes:
        table: whose edges they are.
        choices: directions in which the edges lie; any of the choices will do.
        gap: between the object and each edge [m]; less than 0 of what hangs over it.
        tolerance: of the gap [m].
    """

    table: TableState
    choices: tuple[tuple[str, ...], ...]
    gap: float
    tolerance: float

    def spots(self, own: SeenObject) -> list[Array]:
        """Straight across to the edge, for each choice."""
        here = own.pose.p_WB[:2]
        ways = [
            sum(
                ((self._room(own, side) - self.gap) * unit(HEADINGS[side])[:2] for side in sides),
                start=np.zeros(2),
            )
            for sides in self.choices
        ]
        return _nearest_first(here, [here + way for way in ways])

    def measures(self, own: SeenObject) -> tuple[Measure, ...]:
        """The gap to each edge of the choice that it is nearest to."""
        what, sign = ("overhang at", -1.0) if self.gap < 0.0 else ("gap to", 1.0)
        found = [
            tuple(
                Measure(
                    f"{what} the table's {edge_name(side)} edge",
                    "about",
                    sign * self.gap,
                    sign * self._room(own, side),
                    self.tolerance,
                )
                for side in sides
            )
            for sides in self.choices
        ]
        return min(found, key=lambda gaps: sum(one.miss for one in gaps))

    def _room(self, own: SeenObject, side: str) -> float:
        """Distance from an object to an edge, negative beyond it [m]."""
        t, u = self.table, unit(HEADINGS[side])[:2]
        corner = np.array([t.x_max if u[0] > 0 else t.x_min, t.y_max if u[1] > 0 else t.y_min])
        return float((corner - footprint(own)).dot(u).min())


def share_of_way(place: Region, share: float, start: SeenObject, d: Defaults) -> Region:
    """The place at a share of the straight way to another one ("halfway to the left edge").

    The object `start` is where the way begins.
    """
    spots = place.spots(start)
    if not spots:
        return place
    here = start.pose.p_WB[:2]
    way = share * (spots[0] - here)
    x, y = (here + way).tolist()
    return Spot(x, y, d.tolerance_of(float(np.linalg.norm(way)), d.place_tolerance))


def object_at(seen: SeenObject, at: Array) -> SeenObject:
    """An object at another position, with the heading that it has."""
    return replace(seen, pose=replace(seen.pose, x=float(at[0]), y=float(at[1])))


def _pairs_outwards(shares: Array) -> Array:
    """Pairs of shares of a range, those nearest to its middle first, shape (n, 2)."""
    pairs = np.stack(np.meshgrid(shares, shares), axis=-1).reshape(-1, 2)
    return pairs[np.argsort(np.hypot(*pairs.T), kind="stable")]


def _nearest_first(here: Array, spots: Iterable[Array]) -> list[Array]:
    """Spots by their distance, none of them twice."""
    found: list[Array] = []
    for spot in sorted(spots, key=lambda at: float(np.linalg.norm(at - here))):
        if not any(np.allclose(spot, other, atol=_CLOSE) for other in found):
            found.append(spot)
    return found
