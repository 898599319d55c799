"""Solids of which shapes consist: cuboids and cylinders that stand upright, convex hulls.

A shape says of what solids it consists; an engine, a picture or a file of another tool says what
becomes of each kind of solid, as a `SolidVisitor`. So a new shape needs no word in any of them.

Frame: B, z up.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Protocol, TypeVar

import numpy as np

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array

FLAT = 1e-6
"""Vertices within this share of the size of a plane lie on it; normals closer are equal."""

T_co = TypeVar("T_co", covariant=True)


class SolidVisitor(Protocol[T_co]):
    """What becomes of solids, one method for each kind."""

    def cuboid(self, solid: Cuboid) -> T_co:
        """Of a cuboid."""

    def cylinder(self, solid: UprightCylinder) -> T_co:
        """Of a cylinder."""

    def hull(self, solid: ConvexHull) -> T_co:
        """Of a convex hull."""


class Solid(ABC):
    """A convex piece of an object in B."""

    @abstractmethod
    def accept(self, visitor: SolidVisitor[T_co]) -> T_co:
        """What a visitor makes of this kind of solid."""

    @abstractmethod
    def raised_to(self, z: float) -> Solid:
        """The solid without what is lower than a height [m]."""


@dataclass(frozen=True, eq=False)
class Cuboid(Solid):
    """A cuboid along the axes of B.

    Attributes:
        low, high: opposite corners, those of least and largest coordinates, shape (3,) [m].
    """

    low: Array
    high: Array

    @property
    def size(self) -> Array:
        """Extents, shape (3,) [m]."""
        return np.asarray(self.high - self.low)

    @property
    def middle(self) -> Array:
        """Its middle, shape (3,) [m]."""
        return np.asarray((self.low + self.high) / 2.0)

    def accept(self, visitor: SolidVisitor[T_co]) -> T_co:
        """See `Solid`."""
        return visitor.cuboid(self)

    def raised_to(self, z: float) -> Cuboid:
        """See `Solid`."""
        return replace(self, low=np.array([*self.low[:2], max(self.low[2], z)]))


@dataclass(frozen=True)
class UprightCylinder(Solid):
    """A cylinder around B's z axis.

    Attributes:
        radius: [m].
        low, high: heights of its ends [m].
    """

    radius: float
    low: float
    high: float

    @property
    def length(self) -> float:
        """From end to end [m]."""
        return self.high - self.low

    @property
    def middle(self) -> Array:
        """Its middle, shape (3,) [m]."""
        return np.array([0.0, 0.0, (self.low + self.high) / 2.0])

    def accept(self, visitor: SolidVisitor[T_co]) -> T_co:
        """See `Solid`."""
        return visitor.cylinder(self)

    def raised_to(self, z: float) -> UprightCylinder:
        """See `Solid`."""
        return replace(self, low=max(self.low, z))


@dataclass(frozen=True, eq=False)
class ConvexHull(Solid):
    """The convex hull of points.

    Attributes:
        vertices: the points, shape (k, 3) [m].
    """

    vertices: Array

    def accept(self, visitor: SolidVisitor[T_co]) -> T_co:
        """See `Solid`."""
        return visitor.hull(self)

    def raised_to(self, z: float) -> ConvexHull:
        """See `Solid`: lower vertices are moved up, which is the same for upright sides."""
        x_y, heights = self.vertices[:, :2], self.vertices[:, 2]
        return ConvexHull(np.column_stack((x_y, np.maximum(heights, z))))


@dataclass(frozen=True, eq=False)
class Column:
    """An upright prism or cylinder that encloses a piece of an object, in B.

    Attributes:
        outline: its convex corners, counter-clockwise, shape (k, 2) [m].
        height: of its top; it stands on the table [m].
        radius: if it is round about B's origin, else 0 [m].
    """

    outline: Array
    height: float
    radius: float = 0.0


def between(lower: Array, upper: Array, height: float) -> Array:
    """Corners of the ends of a solid, shape (k + m, 3) [m].

    Args:
        lower: outline of its lower end, shape (k, 2) [m].
        upper: outline of its upper end, shape (m, 2) [m].
        height: of the upper end, the lower one being at z = 0 [m].
    """
    ends = ((lower, 0.0), (upper, height))
    return np.vstack([np.column_stack((xy, np.full(len(xy), z))) for xy, z in ends])


def lowest_places(points: Array) -> tuple[float, Array]:
    """Height of the lowest of points (k, 3) [m], and the x, y of those at it, shape (j, 2) [m]."""
    low = float(points[:, 2].min())
    return low, points[points[:, 2] <= low + FLAT * np.ptp(points[:, 2]), :2]


def turning_down(normal: Array) -> Array:
    """The smallest rotation that makes a unit vector look down, shape (3, 3)."""
    down = np.array([0.0, 0.0, -1.0])
    axis, c = np.cross(normal, down), float(normal @ down)
    if np.linalg.norm(axis) < 1e-12:
        return np.eye(3) if c > 0.0 else np.diag([1.0, -1.0, -1.0])
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.asarray(np.eye(3) + K + K @ K / (1.0 + c))


def hull_facets(points: Array) -> tuple[tuple[Array, Array], ...]:
    """Faces of the convex hull of points (k, 3): outward normals and their vertices.

    Triangles in one plane are one face. The largest comes first.

    Raises:
        ModelError: `bad_value` if the points lie in a plane.
    """
    solid = scipy_hull(points)
    size = np.ptp(points, axis=0).max()
    planes: list[tuple[Array, Array, float]] = []
    left = np.arange(len(solid.simplices))
    while left.size:
        equation = solid.equations[left[0]]
        same = np.abs(solid.equations[left, :3] @ equation[:3] - 1.0) < FLAT
        same &= np.abs(solid.equations[left, 3] - equation[3]) < FLAT * size
        triangles = points[solid.simplices[left[same]]]
        spans = triangles[:, 1:] - triangles[:, :1]
        area = 0.5 * float(np.linalg.norm(np.cross(spans[:, 0], spans[:, 1]), axis=1).sum())
        planes.append((equation[:3], points[np.unique(solid.simplices[left[same]])], area))
        left = left[~same]
    planes.sort(key=lambda plane: -plane[2])
    return tuple((normal, corners) for normal, corners, _ in planes)


def volume_and_centre(points: Array) -> tuple[float, Array]:
    """Volume [m³] and its centre, shape (3,) [m], of the convex hull of points (k, 3)."""
    solid = scipy_hull(points)
    middle = points.mean(axis=0)
    corners = points[solid.simplices] - middle
    volumes = np.abs(np.linalg.det(corners)) / 6.0
    centre = (volumes[:, None] * corners.sum(axis=1) / 4.0).sum(axis=0) / volumes.sum()
    return float(volumes.sum()), middle + centre


def scipy_hull(points: Array):  # type: ignore[no-untyped-def]  # scipy's class, imported late
    """The convex hull of points (k, 3), as scipy has it.

    Raises:
        ModelError: `bad_value` if they lie in a plane.
    """
    from scipy.spatial import ConvexHull, QhullError

    try:
        return ConvexHull(points)
    except QhullError as error:
        raise vertices_error(
            "the vertices lie in a plane: they enclose nothing", "add vertices above the base"
        ) from error


def vertices_error(message: str, hint: str) -> ModelError:
    """The error of a hull's vertices."""
    return ModelError("bad_value", message, path="vertices", suggestions=(hint,))
