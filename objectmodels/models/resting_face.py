"""Face on which an object lies, and what is believed of it as it lies there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from objectmodels.geometry.base_shapes import Array

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel


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
