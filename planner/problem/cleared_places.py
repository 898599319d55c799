"""Places out of the way: in a half of the table, some way from objects, and aside.

Frames: everything in W's table plane [m].
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from objectmodels.geometry.base_shapes import Array
from planner.geometry.directions import HEADINGS, unit
from planner.geometry.footprints import footprint, gap
from planner.problem.place_measures import Measure, Region
from planner.types.world_state import SeenObject, TableState

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
        here, across = np.array([own.pose.x, own.pose.y]), self._reach_over(own) + self.tolerance
        if across <= 0.0:
            return [here]
        along = np.array([-self._way[1], self._way[0]])
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
        t = self.table
        middle = np.array([t.x_min + t.x_max, t.y_min + t.y_max]) / 2.0
        return float(((middle - footprint(own)) @ self._way).max())


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
        here, shape = np.array([own.pose.x, own.pose.y]), footprint(own)
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
            Measure(f"gap to the {name}", "at_least", self.distance, gap(here, shape),
                    self.tolerance)
            for name, shape in self.shapes
        )  # fmt: skip

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
        there = np.array([self.start.pose.x, self.start.pose.y])
        ways = sorted(_WAYS, key=lambda way: -abs(round(math.sin(way), 3)))
        return [there + self.distance * unit(float(way))[:2] for way in ways]

    def measures(self, own: SeenObject) -> tuple[Measure, ...]:
        """The way aside."""
        aside = math.dist((own.pose.x, own.pose.y), (self.start.pose.x, self.start.pose.y))
        return (Measure("moved aside", "at_least", self.distance, aside, self.tolerance),)
