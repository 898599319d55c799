"""The plain solid that a convex hull nearly is: a box, a cylinder or a prism.

A hull counts as one if nowhere the one sticks out of the other by more than `LARGEST_RESIDUAL`,
measured along the normals of the faces that it sticks out of.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.support_points import hull_polygon
from objectmodels.models.convex_hull import WIDE, HullModel, lowest_places
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.upright_solids import BoxModel, CylinderModel, PrismModel

LARGEST_RESIDUAL = 0.02
"""Share of the smallest extent: edges of usual roundness stay below it."""

_MOST_CORNERS = 12  # of a prism; what has more is better told by its hull
_FOOT = 0.15  # share of the height below which a cylinder may be narrower
_ROUND = 48  # corners of the polygon that stands for a circle


@dataclass(frozen=True)
class PlainSolid:
    """A solid in place of a hull.

    Attributes:
        kind: the model that has this shape.
        shape: fields of that model.
        vertices: of it, in the hull's frame, shape (k, 3) [m].
        origin: middle of its base in the hull's frame, shape (2,) [m].
        yaw: turn of its axes against those of the hull's frame [rad].
        residual: by how much hull and solid stick out of each other at most [m].
    """

    kind: type[ObjectModel]
    shape: dict[str, Any]
    vertices: Array
    origin: Array = field(default_factory=lambda: np.zeros(2))
    yaw: float = 0.0
    residual: float = 0.0

    @property
    def extents(self) -> Array:
        """Its size along its own axes, shape (3,) [m]."""
        turned = self.vertices[:, :2] @ _turn(self.yaw)
        return np.append(np.ptp(turned, axis=0), np.ptp(self.vertices[:, 2]))

    def method_texts(self) -> tuple[str, ...]:
        """The finding in words, for a provenance; nothing of a hull."""
        if self.kind is HullModel:
            return ()
        kind = self.kind.model_fields["kind"].default
        apart = max(round(1e3 * self.residual, 2), 0.01)
        return (f"a {kind}, from which the hull of the mesh differs by {apart:g} mm at most",)

    def in_own_frame(self, point: Array) -> Array:
        """A point of the hull's frame in that of the solid, shape (3,) [m]."""
        return np.append((point[:2] - self.origin) @ _turn(self.yaw), point[2])


def plain_solid(vertices: Array) -> PlainSolid:
    """The plain solid that a hull is, or the hull itself.

    Args:
        vertices: of the hull, standing on z = 0, shape (k, 3) [m].
    """
    most = LARGEST_RESIDUAL * float(np.ptp(vertices, axis=0).min())
    for solid in _candidates(vertices, most):
        residual = max(_outside(vertices, solid.vertices), _outside(solid.vertices, vertices))
        if residual <= most:
            return replace(solid, residual=residual)
    return the_hull(vertices)


def the_hull(vertices: Array) -> PlainSolid:
    """The hull itself, of vertices, shape (k, 3) [m]."""
    return PlainSolid(HullModel, {"vertices": tuple(map(tuple, vertices.tolist()))}, vertices)


def _candidates(vertices: Array, most: float) -> Iterator[PlainSolid]:
    outline = hull_polygon(vertices[:, :2]).vertices
    height = float(vertices[:, 2].max())
    box = _box(outline, height)
    if round(min(box.shape["size"][:2]), 6) >= WIDE:
        yield box
    yield _cylinder(vertices, outline, height, most)
    if len(outline) <= _MOST_CORNERS and _has_wide_sides(outline):
        outer = hull_polygon(outline)
        origin = outer.centroid if (outer.offsets <= 0.0).any() else np.zeros(2)
        shape = {"corners": (outline - origin).tolist(), "height": height}
        yield PlainSolid(PrismModel, shape, _ends(outline, 0.0, height), origin)


def _has_wide_sides(outline: Array) -> bool:
    """Check that edges as wide as a fingertip make up half of an outline or more."""
    lengths = np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1)
    return bool(lengths[lengths >= WIDE].sum() >= 0.5 * lengths.sum())


def _box(outline: Array, height: float) -> PlainSolid:
    """The smallest upright box around an outline; one of its sides lies along one of that."""
    edges = np.roll(outline, -1, axis=0) - outline
    quarter = np.pi / 2.0
    yaws = (np.arctan2(edges[:, 1], edges[:, 0]) + quarter / 2.0) % quarter - quarter / 2.0
    boxes = []
    for yaw in yaws.tolist():
        turned = outline @ _turn(yaw)
        low, high = turned.min(axis=0), turned.max(axis=0)
        boxes.append((float(np.prod(high - low)), yaw, low, high))
    _, yaw, low, high = min(boxes, key=lambda box: box[0])
    corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]]]) @ _turn(yaw).T
    size = (*(high - low).tolist(), height)
    origin = (low + high) / 2.0 @ _turn(yaw).T
    return PlainSolid(BoxModel, {"size": size}, _ends(corners, 0.0, height), origin, yaw)


def _cylinder(vertices: Array, outline: Array, height: float, most: float) -> PlainSolid:
    """The upright cylinder through an outline; on a narrower foot if it stands on one."""
    # x² + y² = 2 x₀ x + 2 y₀ y + (r² − x₀² − y₀²), linear in what is looked for.
    design = np.column_stack((2.0 * outline, np.ones(len(outline))))
    (x, y, rest), *_ = np.linalg.lstsq(design, np.sum(outline**2, axis=1), rcond=None)
    radius = float(np.sqrt(rest + x * x + y * y))
    origin = np.array([x, y])
    phi = 2.0 * np.pi * np.arange(_ROUND) / _ROUND
    rim = origin + radius * np.column_stack((np.cos(phi), np.sin(phi)))
    shape: dict[str, Any] = {"radius": radius, "height": height}
    foot = np.hypot(*(hull_polygon(lowest_places(vertices)[1]).vertices - origin).T)
    begins = vertices[np.hypot(*(vertices[:, :2] - origin).T) >= radius - most, 2].min()
    if np.ptp(foot) > most or foot.max() > radius - most or begins > _FOOT * height:
        return PlainSolid(CylinderModel, shape, _ends(rim, 0.0, height), origin)
    shape["base_radius"] = float(foot.max())
    base = origin + foot.max() / radius * (rim - origin)
    solid = np.concatenate((_ends(base, 0.0), _ends(rim, begins, height)))
    return PlainSolid(CylinderModel, shape, solid, origin)


def _ends(corners: Array, *heights: float) -> Array:
    """Vertices above corners (k, 2) at n heights, shape (n k, 3) [m]."""
    ends = [np.column_stack((corners, np.full(len(corners), z))) for z in heights]
    return np.concatenate(ends)


def _outside(solid: Array, points: Array) -> float:
    """Distance by which the furthest of points sticks out of a face of the hull of others [m]."""
    from scipy.spatial import ConvexHull  # takes a while to import

    planes = ConvexHull(solid).equations
    return float((points @ planes[:, :3].T + planes[:, 3]).max())


def _turn(yaw: float) -> Array:
    """Rotation by an angle: rows times it are in axes that are turned so, shape (2, 2)."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s], [s, c]])
