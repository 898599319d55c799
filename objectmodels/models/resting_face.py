"""Face on which an object lies, and what is believed of it as it lies there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.vector_arrays import checked_rotation

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel

LEVEL = np.radians(10.0)
"""An object lies on a face that is tilted by at most so much."""


@dataclass(frozen=True)
class Resting:
    """A way in which an object lies.

    Attributes:
        face: name of the face that is below; `bottom` is the one that its model stands on.
        model: what is believed of it as it lies there, in N.
        R_BN: orientation of N in B, shape (3, 3).
        p_BN: origin of N in B, shape (3,) [m].
        standing: what is believed of it on its bottom, in B.
    """

    face: str
    model: ObjectModel
    R_BN: Array
    p_BN: Array
    standing: ObjectModel

    @property
    def down(self) -> Array:
        """Outward normal of the face below in B, shape (3,)."""
        return -self.R_BN[:, 2]

    @property
    def foot(self) -> Array:
        """Outward normal of the bottom in N, shape (3,)."""
        return np.asarray(-self.R_BN[2])

    def lying_pose(self, R_WB: Array, p_WB: Array) -> tuple[Array, Array]:
        """R_WN, shape (3, 3), and p_WN, shape (3,) [m], of the same object."""
        return R_WB @ self.R_BN, p_WB + R_WB @ self.p_BN

    def body_pose(self, R_WN: Array, p_WN: Array) -> tuple[Array, Array]:
        """R_WB, shape (3, 3), and p_WB, shape (3,) [m], of the same object."""
        R_WB = R_WN @ self.R_BN.T
        return R_WB, p_WN - R_WB @ self.p_BN


def lowest_rest(model: ObjectModel, R_WB: ArrayLike) -> Resting:
    """The way of resting of an object in this orientation of B in W; see `resting_face`."""
    down = -checked_rotation(R_WB)[2]  # W's downward direction in B
    nearest = max(model.rests, key=lambda rest: float(rest.down @ down))
    off = float(np.arccos(np.clip(nearest.down @ down, -1.0, 1.0)))
    if off > LEVEL:
        raise ModelError(
            "not_resting",
            f"the {model.name} does not lie on a face: it leans {np.degrees(off):.0f}° off "
            f"{nearest.face!r}",
            suggestions=(f"it rests on: {', '.join(rest.face for rest in model.rests)}",),
        )
    return nearest
