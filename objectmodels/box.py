"""A cuboid, which may stand on any of its faces."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from objectmodels.base import Polygon
from objectmodels.faces import Face, sides
from objectmodels.model import ObjectModel
from objectmodels.parameters import Array, Size

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

    @property
    def resting_faces(self) -> tuple[str, ...]:
        """All six, named as if B's axes were the robot's."""
        return tuple(_TURNED)

    def standing(self, face: str) -> BoxModel:
        """The box lying on another face; see `ObjectModel.standing`.

        What was fitted for the base (points to stand on, friction radius) does not go along; its
        centre of mass and all coefficients do.
        """
        turn = _TURNED.get(face)
        if turn is None:
            super().standing(face)
        assert turn is not None
        size = np.abs(turn @ np.array(self.size))
        middle = np.array([0.0, 0.0, self.size[2] / 2.0])
        com = turn @ (np.array(self.com) - middle) + [0.0, 0.0, size[2] / 2.0]
        changes: dict[str, Any] = {
            "size": tuple(size.tolist()),
            "com": tuple(com.tolist()),
            "com_sd": tuple(np.abs(turn @ np.array(self.com_sd)).tolist()),
        }
        if face != "bottom":
            kept = {name: getattr(self, name) for name in type(self).model_fields}
            for name in ("support", "friction_radius", "friction_radius_sd", "correlations"):
                if name != "support" or not isinstance(self.support, str):
                    del kept[name]
            return type(self)(**(kept | changes))
        return self
