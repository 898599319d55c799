"""Side faces, on which a finger may push an object.

Frame: B, origin at the centre of the base, z up. A place on a face is (lateral, height): along its
tangent from the middle, and above the table [m].
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objectmodels.geometry.base_shapes import Array, Polygon
from objectmodels.geometry.rotations import spatial_cross

AXES = np.radians([180.0, -90.0, 0.0, 90.0])
"""Headings along which the faces +x, +y, −x, −y are pushed [rad]."""


@dataclass(frozen=True)
class Face:
    """A side face, flat or round.

    Attributes:
        normal: outward unit normal in the middle.
        centre: its middle [m].
        tangent: horizontal unit vector along the face, ẑ × normal where that is horizontal.
        width: horizontal extent, along the arc of a round face [m].
        height: vertical extent [m].
        curvature: 1/R of a round upright face, 0 of a flat one [1/m].
        outline: convex outline as (lateral, height), counter-clockwise; a rectangle if None.
    """

    normal: tuple[float, float, float]
    centre: tuple[float, float, float]
    tangent: tuple[float, float, float]
    width: float
    height: float
    curvature: float = 0.0
    outline: tuple[tuple[float, float], ...] | None = None

    @classmethod
    def upright(
        cls,
        normal: ArrayLike,
        middle: ArrayLike,
        width: float,
        height: float,
        curvature: float = 0.0,
    ) -> Face:
        """A face that stands on the table.

        Args:
            normal: horizontal outward unit normal, shape (2,).
            middle: middle of its lower edge, shape (2,) [m].
            width: horizontal extent [m].
            height: vertical extent [m].
            curvature: 1/R of a round face [1/m].
        """
        # Adding zero turns −0.0 into 0.0 in what people read.
        (n_x, n_y), (x, y) = ((np.asarray(v) + 0.0).tolist() for v in (normal, middle))
        centre = (x, y, height / 2.0)
        return cls((n_x, n_y, 0.0), centre, (0.0 - n_y, n_x, 0.0), width, height, curvature)

    @property
    def bottom(self) -> float:
        """Height of its lowest point [m]."""
        return self.centre[2] - self.height / 2.0

    @property
    def top(self) -> float:
        """Height of its highest point [m]."""
        return self.centre[2] + self.height / 2.0

    def points_at(self, lateral: ArrayLike, height: ArrayLike) -> tuple[Array, Array]:
        """Points p_BC [m] and outward normals (..., 3) at lateral places and heights (...) [m]."""
        y, z = np.broadcast_arrays(np.asarray(lateral, float), np.asarray(height, float))
        n, c, t = np.array(self.normal), np.array(self.centre), np.array(self.tangent)
        up = np.array([0.0, 0.0, 1.0])
        rise = (z - c[2])[..., None]
        if self.curvature:
            angle, radius = (y * self.curvature)[..., None], 1.0 / self.curvature
            normals = np.cos(angle) * n + np.sin(angle) * t
            return c + radius * (normals - n) + rise * up, normals
        level = np.array([n[0], n[1], 0.0]) / np.hypot(n[0], n[1])
        back = -n[2] / np.hypot(n[0], n[1]) * rise
        points = c + y[..., None] * t + back * level + rise * up
        return points, np.broadcast_to(n, points.shape).copy()

    def set_back(self, lateral: ArrayLike, radius: float = 0.0) -> tuple[Array, Array]:
        """Touch of a ball that comes along the normal at lateral places.

        Args:
            lateral: of its middle, shape (...) [m].
            radius: of the ball [m].

        Returns:
            How far behind its place in the middle of the face it is then [m], and the angle between
            the normals here and there [rad], shape (...) each.
        """
        y = np.asarray(lateral, float)
        if not self.curvature:
            return np.zeros(y.shape), np.zeros(y.shape)
        around = 1.0 / self.curvature + radius
        angle = np.arcsin(np.clip(y / around, -1.0, 1.0))
        return around * (1.0 - np.cos(angle)), angle

    def contains(
        self, lateral: ArrayLike, height: ArrayLike, margin: float = 0.0
    ) -> NDArray[np.bool_]:
        """Return True for places on it, at least a margin from its border [m]."""
        y, z = np.broadcast_arrays(np.asarray(lateral, float), np.asarray(height, float))
        if self.outline is None:
            inside = (np.abs(y) <= self.width / 2.0 - margin + 1e-12) & (z <= self.top - margin)
            return np.asarray(inside & (z >= self.bottom + margin))
        polygon = Polygon.convex(self.outline)
        beyond = np.stack((y, z), axis=-1) @ polygon.normals.T - polygon.offsets
        return np.asarray(beyond.max(axis=-1) <= -margin + 1e-12)

    def grid(self, spacing: float, margin: float = 0.0) -> tuple[Array, Array]:
        """Places in rows and columns around its middle, lateral and height, shape (n,) each [m]."""
        half = self.width / 2.0 - margin
        low, high = self.bottom + margin, self.top - margin
        if half < 0.0 or high < low:
            return np.empty(0), np.empty(0)
        y = _even_steps(-half, half, spacing)
        z = _even_steps(low, high, spacing)
        lateral, height = (a.ravel() for a in np.meshgrid(y, z))
        on = self.contains(lateral, height, margin)
        return lateral[on], height[on]


def sides(base: Polygon, height: float) -> tuple[Face, ...]:
    """The upright faces over the edges of a polygon, in the order of its normals."""
    v = base.vertices
    ahead = np.roll(v, -1, axis=0)
    widths = np.linalg.norm(ahead - v, axis=1).tolist()
    return tuple(
        Face.upright(n, m, w, height)
        for n, m, w in zip(base.normals, (v + ahead) / 2.0, widths, strict=True)
    )


def _even_steps(low: float, high: float, spacing: float) -> Array:
    """Values from low to high, as evenly and about as far apart as asked, the middle among them."""
    n = max(2 * round((high - low) / (2.0 * spacing)), 2 if high > low else 0)
    return np.linspace(low, high, n + 1)


# How fingertips side by side press on a side that may be round.
#
# Model: the middle finger touches the side in its middle, the outer ones as far to its left and
# right on a line that may lie askew to the side's axis. A round side lies back there, its normal
# turned by α. All press along the closing direction; the outer ones besides by a share k of that
# towards each other along their line, which turns nothing. With the sine s of the angle between
# line and axis, k = s tan α brings their force nearest to the normal.


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
