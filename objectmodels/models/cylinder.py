"""An upright cylinder: a can, a mug, a bottle."""

from __future__ import annotations

from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, PositiveFloat

from objectmodels.geometry.base_shapes import Array, Disc
from objectmodels.geometry.side_faces import AXES, Face
from objectmodels.models.object_model import ObjectModel

FACE_SHARE = 1.0
"""Width of a face on the round side, as a share of the radius: its ends lie 12 % of that back."""


class CylinderModel(ObjectModel):
    """An upright cylinder on a round base.

    Attributes:
        radius: of its side [m].
        height: of the cylinder [m].
        base_radius: of the circle it stands on, if that is smaller [m].
    """

    radius: PositiveFloat = Field(alias="radius_m")
    height: PositiveFloat = Field(alias="height_m")
    base_radius: PositiveFloat | None = Field(None, alias="base_radius_m")
    kind: Literal["cylinder"] = "cylinder"

    @cached_property
    def footprint(self) -> Disc:
        """A disc."""
        return Disc(self.radius if self.base_radius is None else self.base_radius)

    @property
    def top(self) -> float:
        """Its height."""
        return self.height

    @property
    def section(self) -> Disc:
        """A disc, that of its side."""
        return Disc(self.radius)

    @property
    def outline(self) -> Array:
        """A polygon around the side."""
        around = Disc(self.radius)
        return np.asarray(around.corners / np.cos(np.pi / len(around.corners)))

    @property
    def extents(self) -> tuple[float, float, float]:
        """Its diameter twice, and its height."""
        return (2.0 * self.radius, 2.0 * self.radius, self.height)

    @property
    def gyration(self) -> tuple[float, float, float]:
        """Of the solid cylinder."""
        across = self.radius**2 / 4.0 + self.height**2 / 12.0
        return (across, across, self.radius**2 / 2.0)

    def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
        """Strips of the round side that look against each heading."""
        pushed = np.atleast_1d(AXES if headings is None else np.asarray(headings, float))
        normals = -np.column_stack((np.cos(pushed), np.sin(pushed)))
        width = FACE_SHARE * self.radius
        return tuple(
            Face.upright(n, self.radius * n, width, self.height, 1.0 / self.radius) for n in normals
        )
