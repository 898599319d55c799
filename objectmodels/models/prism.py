"""A prism: upright sides over a convex polygon."""

from __future__ import annotations

from functools import cached_property
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, PositiveFloat, model_validator

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Polygon
from objectmodels.geometry.planar_vectors import cross
from objectmodels.geometry.side_faces import Face, sides
from objectmodels.models.convex_hull import HullModel
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.parameters import Corners
from objectmodels.models.resting_faces import Resting


class PrismModel(ObjectModel):
    """A prism over a convex polygon.

    Attributes:
        corners: of the polygon in B, in order, either way round [m]; the origin lies inside.
        height: of the prism [m].
    """

    corners: Corners = Field(alias="corners_m")
    height: PositiveFloat = Field(alias="height_m")
    kind: Literal["prism"] = "prism"

    @model_validator(mode="after")
    def _around_the_origin(self) -> Self:
        if not (self.footprint.offsets > 0.0).all():
            x, y = self.footprint.centroid.tolist()
            raise ModelError(
                "bad_value",
                f"found a base around [{x:.4f}, {y:.4f}], expected one that encloses [0, 0]",
                path="corners",
            )
        return self

    @cached_property
    def footprint(self) -> Polygon:
        """The polygon."""
        try:
            return Polygon.convex(self.corners)
        except ModelError as error:
            raise ModelError("bad_value", error.message, path="corners") from error

    @property
    def top(self) -> float:
        """Its height."""
        return self.height

    @property
    def centre(self) -> tuple[float, float, float]:
        """Centre of its volume."""
        x, y = self.footprint.centroid.tolist()
        return (x, y, self.height / 2.0)

    @property
    def gyration(self) -> tuple[float, float, float]:
        """Of the solid prism."""
        x2, y2 = _second_moments(self.footprint)
        z2 = self.height**2 / 12.0
        return (y2 + z2, x2 + z2, x2 + y2)

    @cached_property
    def rests(self) -> tuple[Resting, ...]:
        """On `bottom`, and as a hull on its other faces: `face 1`, `face 2`, … by size."""
        ends = [(x, y, z) for z in (0.0, self.height) for x, y in self.corners]
        kept = self._fields_on_face(vertices=tuple(ends))
        solid = HullModel(**{k: v for k, v in kept.items() if k not in ("corners", "height")})
        upright = Resting("bottom", self, np.eye(3), np.zeros(3))
        return (upright, *solid.rests[1:])

    def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
        """One for each edge of the polygon, in its order."""
        return sides(self.footprint, self.height)


def _second_moments(polygon: Polygon) -> tuple[float, float]:
    """Mean squares of x and y over the area, about its centroid [m²]."""
    v = polygon.vertices - polygon.centroid
    w = np.roll(v, -1, axis=0)
    area = cross(v, w)
    second = (area[:, None] * (v * v + v * w + w * w)).sum(axis=0) / (6.0 * area.sum())
    x2, y2 = second.tolist()
    return x2, y2
