"""Upright solids: a cuboid, which may stand on any of its faces, a cylinder and a prism."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, model_validator

from objectmodels.cached_values import cached_property
from objectmodels.errors import ModelError
from objectmodels.files.value_types import Length
from objectmodels.geometry.base_shapes import Array, Disc, Polygon
from objectmodels.geometry.side_faces import AXES, Face, sides
from objectmodels.geometry.vector_arrays import cross
from objectmodels.models.convex_hull import HullModel
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.object_parts import Cavity
from objectmodels.models.open_box import require_open_box
from objectmodels.models.parameters import Corners, Size
from objectmodels.models.resting_face import Resting

# Rows are the new axes in the old frame: the named face comes to lie below.
_TURNED: dict[str, Array] = {
    "bottom": np.eye(3),
    "top": np.diag([1.0, -1.0, -1.0]),
    "front": np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
    "back": np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]),
    "left": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "right": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
}

FACE_SHARE = 1.0
"""Width of a face on the round side, as a share of the radius: its ends lie 12 % of that back."""


class BoxModel(ObjectModel):
    """A box, its sides along the axes of B.

    Attributes:
        size: extents along x, y, z of B [m].
    """

    size: Annotated[Size, Field(alias="size_m")]
    kind: Literal["box"] = "box"

    @cached_property
    def footprint(self) -> Polygon:
        """A rectangle."""
        return Polygon.rectangle(*self.size[:2])

    @property
    def top(self) -> float:
        """Its height."""
        return self.size[2]

    def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
        """The four side faces: +x, +y, −x, −y."""
        return sides(self.footprint, self.size[2])

    def _require_walls(self, inside: Cavity) -> None:
        require_open_box(self.size, inside)

    @cached_property
    def rests(self) -> tuple[Resting, ...]:
        """On those faces off which it does not topple, named as if B's axes were the robot's."""
        found = []
        for face, turn in _TURNED.items():
            with suppress(ValueError):  # its centre of mass is not above that face
                found.append(self._resting_on(face, turn))
        return tuple(found)

    def _resting_on(self, face: str, turn: Array) -> Resting:
        if face == "bottom":
            return Resting(face, self, np.eye(3), np.zeros(3), self)
        middle = np.array([0.0, 0.0, self.size[2] / 2.0])
        size = np.abs(turn @ np.array(self.size))
        up = np.array([0.0, 0.0, size[2] / 2.0])
        model = type(self)(
            **self._fields_on_face(
                float(size[2]),
                size=tuple(size.tolist()),
                com=tuple((turn @ (np.array(self.com) - middle) + up).tolist()),
                com_sd=tuple(np.abs(turn @ np.array(self.com_sd)).tolist()),
            )
        )
        return Resting(face, model, turn.T, middle - turn.T @ up, self)


class CylinderModel(ObjectModel):
    """An upright cylinder on a round base.

    Attributes:
        radius: of its side [m].
        height: of the cylinder [m].
        base_radius: of the circle it stands on, if that is smaller [m].
    """

    radius: Annotated[Length, Field(alias="radius_m")]
    height: Annotated[Length, Field(alias="height_m")]
    base_radius: Annotated[Length | None, Field(alias="base_radius_m")] = None
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

    @cached_property
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


class PrismModel(ObjectModel):
    """A prism over a convex polygon.

    Attributes:
        corners: of the polygon in B, in order, either way round [m]; the origin lies inside.
        height: of the prism [m].
    """

    corners: Annotated[Corners, Field(alias="corners_m")]
    height: Annotated[Length, Field(alias="height_m")]
    kind: Literal["prism"] = "prism"

    @model_validator(mode="after")
    def _around_the_origin(self) -> Self:
        if not (self.footprint.offsets > 0.0).all():
            x, y = self.footprint.centroid.tolist()
            raise ModelError(
                "bad_value",
                f"found a base around [{x:.4f}, {y:.4f}], expected one that encloses [0, 0]",
                path="corners",
                suggestions=(f"take {x:.4f} from each x and {y:.4f} from each y",),
            )
        return self

    @cached_property
    def footprint(self) -> Polygon:
        """The polygon."""
        try:
            return Polygon.convex(self.corners)
        except ModelError as error:
            raise ModelError(
                "bad_value", error.message, path="corners", suggestions=error.suggestions
            ) from error

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
        kept = self._fields_on_face(self.height, vertices=tuple(ends))
        solid = HullModel(**{k: v for k, v in kept.items() if k not in ("corners", "height")})
        upright = Resting("bottom", self, np.eye(3), np.zeros(3), self)
        return (upright, *(replace(rest, standing=self) for rest in solid.rests[1:]))

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
