"""Upright solids in the hull of a mesh: a box, a cylinder or a prism, where it is nearly one.

Model: the hull lies inside the upright solid over its outline as seen from above. How far a rim of
that solid stands out over the hull's faces is what the simpler shape gets wrong.

Frame: B, at the centre of the base, z up.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from objectmodels.geometry.base_shapes import Array, Disc, Polygon
from objectmodels.geometry.support_points import hull_polygon
from objectmodels.models.convex_hull import WIDE, hull_facets, lowest_places
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.upright_solids import BoxModel, CylinderModel, PrismModel

TOLERANCE = 0.03
"""Largest residual of a simpler shape, as a share of the least extent."""

_SAME = 0.0005  # a foot ring that is smaller by less is none [m]


@dataclass(frozen=True)
class UprightShape:
    """A shape that a hull nearly has.

    Attributes:
        kind: class of models of that shape.
        fields: its own fields [m].
        residual: how far the shape stands out over the hull [m].
    """

    kind: type[ObjectModel]
    fields: Mapping[str, object]
    residual: float

    def text(self) -> str:
        """The shape and its residual in words."""
        name = self.kind.model_fields["kind"].default
        return f"taken for a {name}, which it is within {1e3 * self.residual:.1f} mm"


def upright_shape(vertices: Array) -> UprightShape | None:
    """The upright solid that a hull of vertices (k, 3) in B nearly is; None if it is none.

    A cylinder may stand on a smaller foot; the base of a box or a prism is its outline.
    """
    height = float(vertices[:, 2].max())
    outline = hull_polygon(vertices[:, :2])
    base = hull_polygon(lowest_places(vertices)[1])
    tolerance = TOLERANCE * float(np.ptp(vertices, axis=0).min())
    radius, foot = (float(np.linalg.norm(each.vertices, axis=1).max()) for each in (outline, base))
    kind: type[ObjectModel]
    fields: dict[str, object] = {"height": round(height, 6)}
    if radius - outline.offsets.min() <= tolerance and foot - base.offsets.min() <= tolerance:
        kind, rim = CylinderModel, Disc(radius).corners
        fields["radius"] = round(radius, 6)
        if foot < radius - _SAME:
            fields["base_radius"] = round(foot, 6)
    elif _reaches(base, outline) and _has_wide_sides(outline):
        kind, rim = PrismModel, outline.vertices
        fields["corners"] = tuple(map(tuple, np.round(outline.vertices, 6).tolist()))
    else:
        return None
    # A foot ring is as high as it is smaller, or flatter.
    low = radius - foot if kind is CylinderModel else 0.0
    residual = max(_residual(vertices, rim, z) for z in (low, height))
    if residual > tolerance:
        return None
    if kind is PrismModel and (size := _rectangle(outline)) is not None:
        kind, fields = BoxModel, {"size": tuple(np.round([*size, height], 6).tolist())}
    return UprightShape(kind, fields, residual)


def _reaches(base: Polygon, outline: Polygon) -> bool:
    """Check that a base reaches to all corners of an outline."""
    beyond = outline.vertices @ base.normals.T - base.offsets
    return bool(beyond.max() <= _SAME)


def _has_wide_sides(outline: Polygon) -> bool:
    """Check that edges as wide as a fingertip make up half of an outline or more."""
    lengths = np.linalg.norm(np.roll(outline.vertices, -1, axis=0) - outline.vertices, axis=1)
    return bool(lengths[lengths >= WIDE].sum() >= 0.5 * lengths.sum())


def _rectangle(outline: Polygon) -> tuple[float, float] | None:
    """Sides of an outline along x and y [m]; None if it is no rectangle around the origin."""
    x, y = np.abs(outline.vertices).max(axis=0).tolist()
    off = np.abs(np.abs(outline.vertices) - [x, y]).max()
    return (2.0 * x, 2.0 * y) if len(outline.vertices) == 4 and off <= _SAME else None


def _residual(vertices: Array, corners: Array, height: float) -> float:
    """Largest distance of corners (k, 2) at a height beyond the faces of a hull [m]."""
    points = np.column_stack((corners, np.full(len(corners), height)))
    beyond = [(points @ normal - face[0] @ normal) for normal, face in hull_facets(vertices)]
    return max(0.0, float(np.max(beyond)))
