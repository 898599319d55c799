"""Places in an open box, on its floor.

Model: what stands there keeps its heading; it and its neighbours cover convex polygons.
Frames: W is the world, B the box.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.models.object_parts import Cavity, inner_floor
from objectmodels.models.shapes import standing_height
from planner.geometry.footprints import footprint, gap
from planner.geometry.stacks import face_in_world
from planner.problem.place_measures import Measure, Region
from planner.types.world_state import SeenObject

WALL_ROOM = 0.008
"""Room between the walls of a box and what is put into it [m]."""

_SHARES = np.linspace(-1.0, 1.0, 5)  # of the way that is free, at which places are looked at


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
        steps = np.stack(np.meshgrid(_SHARES, _SHARES), axis=-1).reshape(-1, 2)
        steps = steps[np.argsort(np.hypot(*steps.T), kind="stable")]
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
        height = own.pose.z - self.box.pose.z - standing_height(self.box.model)
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
