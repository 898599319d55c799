"""Places on another object, and off it.

Frames: W is the world, B an object.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from objectmodels.geometry.base_shapes import Array, Polygon
from objectmodels.models.shapes import top_face
from planner.geometry.footprints import footprint, gap
from planner.geometry.stacks import face_in_world
from planner.problem.place_measures import Measure, Region
from planner.types.world_state import SeenObject

_SHARES = np.linspace(-0.8, 0.8, 9)  # of half the extent of a top, at which places are looked at


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
        top = top_face(self.lower.model)
        if top is None:
            return []
        face = face_in_world(top, self.lower)
        com = own.pose.R_WB[:2, :2] @ np.array(own.model.com[:2])
        half = 0.5 * np.ptp(top.vertices, axis=0)
        steps = np.stack(np.meshgrid(_SHARES, _SHARES), axis=-1).reshape(-1, 2)
        steps = steps[np.argsort(np.hypot(*steps.T), kind="stable")]
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
