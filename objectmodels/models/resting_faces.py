"""Objects that lie on another face than the one their model stands on.

Frame N belongs to the face that is below, as B does to the base: origin at its centre on the table,
z up. A pose of B picks the face.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array

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
    """

    face: str
    model: ObjectModel
    R_BN: Array
    p_BN: Array

    @property
    def down(self) -> Array:
        """Outward normal of the face below in B, shape (3,)."""
        return -self.R_BN[:, 2]


def rest_on_face(model: ObjectModel, R_WB: ArrayLike) -> Resting:
    """Face on which an object rests in an orientation; see `ObjectModel.resting_face`."""
    R = np.asarray(R_WB, dtype=np.float64)
    if R.shape != (3, 3) or not np.allclose(R @ R.T, np.eye(3), atol=1e-6) or np.linalg.det(R) < 0:
        raise ModelError("bad_array", "R_WB must be a rotation matrix, shape (3, 3)")
    down = -R[2]  # W's downward direction in B
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
