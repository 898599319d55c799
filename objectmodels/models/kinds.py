"""Kinds of object model: a shape, with what is believed of an object that has it.

A kind takes its geometry from a class of `objectmodels.models.shapes`, and says besides on which
faces an object of it may lie. A new one is a class here, and a row in `KINDS`.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array, hull_polygon
from objectmodels.geometry.solids import FLAT, lowest_places, turning_down, vertices_error
from objectmodels.lazy import cached_property
from objectmodels.models.object_model import ObjectModel, Resting
from objectmodels.models.shapes import Box, Cylinder, Hull, Prism

# Rows are the new axes in the old frame: the named face comes to lie below.
_TURNED: dict[str, Array] = {
    "bottom": np.eye(3),
    "top": np.diag([1.0, -1.0, -1.0]),
    "front": np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
    "back": np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]),
    "left": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "right": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
}


class BoxModel(Box, ObjectModel):
    """A box, its sides along the axes of B.

    Attributes:
        size: extents along x, y, z of B [m].
    """

    kind: Literal["box"] = "box"

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


class CylinderModel(Cylinder, ObjectModel):
    """An upright cylinder on a round base.

    Attributes:
        radius: of its side [m].
        height: of the cylinder [m].
        base_radius: of the circle it stands on, if that is smaller [m].
    """

    kind: Literal["cylinder"] = "cylinder"


class PrismModel(Prism, ObjectModel):
    """A prism over a convex polygon.

    Attributes:
        corners: of the polygon in B, in order, either way round [m]; the origin lies inside.
        height: of the prism [m].
    """

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
    def rests(self) -> tuple[Resting, ...]:
        """On `bottom`, and as a hull on its other faces: `face 1`, `face 2`, … by size."""
        ends = [(x, y, z) for z in (0.0, self.height) for x, y in self.corners]
        kept = self._fields_on_face(self.height, vertices=tuple(ends))
        solid = HullModel(**{k: v for k, v in kept.items() if k not in ("corners", "height")})
        upright = Resting("bottom", self, np.eye(3), np.zeros(3), self)
        return (upright, *(replace(rest, standing=self) for rest in solid.rests[1:]))


class HullModel(Hull, ObjectModel):
    """The convex hull of points, standing on the face at z = 0.

    Attributes:
        vertices: in B, shape (k, 3) [m]; none below the table, three or more on it.
    """

    kind: Literal["hull"] = "hull"

    @model_validator(mode="after")
    def _check_standing(self) -> Self:
        if not (self.footprint.offsets > 0.0).all():
            raise vertices_error(
                "the base does not enclose B's origin",
                "move the vertices: [0, 0, 0] is in the base",
            )
        return self

    @cached_property
    def rests(self) -> tuple[Resting, ...]:
        """On `bottom` and `face 1`, `face 2`, … by size, those off which it does not topple."""
        found = [Resting("bottom", self, np.eye(3), np.zeros(3), self)]
        others = [plane for plane in self._side_planes if plane[0][2] > -1.0 + FLAT]
        for k, (normal, _) in enumerate(others, start=1):
            try:
                found.append(self._resting_on(f"face {k}", normal))
            except ValueError:  # its centre of mass is not above that face
                continue
        return tuple(found)

    def _resting_on(self, face: str, normal: Array) -> Resting:
        """The hull with the face of that outward normal on the table."""
        R_NB = turning_down(normal)
        turned = self._vertex_array @ R_NB.T
        low, on_table = lowest_places(turned)
        origin = np.append(hull_polygon(on_table).centroid, low)
        turned = turned - origin
        turned[np.abs(turned[:, 2]) < FLAT * self.top, 2] = 0.0
        sd = np.sqrt((R_NB**2) @ np.array(self.com_sd) ** 2)
        model = HullModel(
            **self._fields_on_face(
                float(turned[:, 2].max()),
                vertices=turned.tolist(),
                com=(R_NB @ np.array(self.com) - origin).tolist(),
                com_sd=sd.tolist(),
            )
        )
        return Resting(face, model, R_NB.T, R_NB.T @ origin, self)


KINDS: Mapping[str, type[ObjectModel]] = {
    "box": BoxModel,
    "prism": PrismModel,
    "cylinder": CylinderModel,
    "hull": HullModel,
}
"""Kinds of model that a file may name without any plug-in."""
