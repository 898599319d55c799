"""How fingertips side by side press on a side that may be round.

Model: the middle finger touches the side in its middle, the outer ones as far to its left and right
on a line that may lie askew to the side's axis. A round side lies back there, its normal turned by
α. All press along the closing direction; the outer ones besides by a share k of that towards each
other along their line, which turns nothing. With the sine s of the angle between line and axis,
k = s tan α brings their force nearest to the normal.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.side_faces import Face
from objectmodels.geometry.vector_arrays import spatial_cross


@dataclass(frozen=True)
class SidePress:
    """Press of the outer fingertips, per press along the closing direction.

    Attributes:
        behind: how far behind the middle of the side they touch [m].
        inward: share of the press, towards each other.
        normal, around, axial: their force along the side's normal there, around the side, and along
            its axis.
    """

    behind: float
    inward: float
    normal: float
    around: float
    axial: float

    @classmethod
    def on_face(
        cls, face: Face, closing: Array, approach: Array, contacts: Array, tip_radius: float
    ) -> SidePress:
        """On an upright face.

        Args:
            face: that the fingers touch, or the thumb.
            closing: direction from the fingers to the thumb in B, shape (3,).
            approach: direction of the straight fingers in B, shape (3,).
            contacts: of the fingertips, along the approach and along their line, shape (k, 2) [m].
            tip_radius: of the fingertips [m].
        """
        slope = min(1.0, abs(float(spatial_cross(approach, closing) @ face.tangent)))
        aside = float(np.abs(contacts[:, 1]).max())
        behind, turned = (float(each) for each in face.set_back(aside * slope, tip_radius))
        sine, cosine = math.sin(turned), math.cos(turned)
        inward = slope * math.tan(turned)
        across, along = inward * slope, inward * math.sqrt(1.0 - slope**2)
        return cls(behind, inward, cosine + across * sine, across * cosine - sine, along)


FLAT = SidePress(behind=0.0, inward=0.0, normal=1.0, around=0.0, axial=0.0)
"""On a flat side."""
