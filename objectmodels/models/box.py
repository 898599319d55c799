"""A cuboid, which may stand on any of its faces."""

from __future__ import annotations

from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from objectmodels.geometry.base_shapes import Array, Polygon
from objectmodels.geometry.side_faces import Face, sides
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.parameters import Size
from objectmodels.models.resting_faces import Resting

# Rows are the new axes in the old frame: the named face comes to lie below.
_TURNED: dict[str, Array] = {
    "bottom": np.eye(3),
    "top": np.diag([1.0, -1.0, -1.0]),
    "front": np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
    "back": np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]),
    "left": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "right": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
}


class BoxModel(ObjectModel):
    """A box, its sides along the axes of B.

    Attributes:
        size: extents along x, y, z of B [m].
    """

    size: Size = Field(alias="size_m")
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

    @cached_property
    def rests(self) -> tuple[Resting, ...]:
        """On all six faces, named as if B's axes were the robot's."""
        return tuple(self._resting_on(face, turn) for face, turn in _TURNED.items())

    def _resting_on(self, face: str, turn: Array) -> Resting:
        if face == "bottom":
            return Resting(face, self, np.eye(3), np.zeros(3))
        middle = np.array([0.0, 0.0, self.size[2] / 2.0])
        size = np.abs(turn @ np.array(self.size))
        up = np.array([0.0, 0.0, size[2] / 2.0])
        model = type(self)(
            **self._fields_on_face(
                size=tuple(size.tolist()),
                com=tuple((turn @ (np.array(self.com) - middle) + up).tolist()),
                com_sd=tuple(np.abs(turn @ np.array(self.com_sd)).tolist()),
            )
        )
        return Resting(face, model, turn.T, middle - turn.T @ up)
