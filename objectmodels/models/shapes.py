"""Shapes of objects: boxes and cylinders that stand upright, prisms, and convex hulls.

What is believed of an object has a shape (`objectmodels.models.kinds`), and so has what is true of
it in a simulated world; shapes tell neither mass nor friction. A new one is a class here, with its
keys in files as fields, and a row in `SHAPES`.

Model: a shape stands on its flat convex base. A hull is the convex hull of its vertices, any solid
with flat faces, which may stand on any of them: the face on the table (vertices at z = 0) is its
base; faces that look sideways are where a finger may push, slanted ones too.

Frame: B, origin at the centre of the base on the table, z up.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator
from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator, Field, model_validator

from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import Coordinate, Length, length_of
from objectmodels.geometry.base_shapes import Array, Base, Disc, Polygon, hull_polygon
from objectmodels.geometry.rotations import as_tuples, cross
from objectmodels.geometry.side_faces import AXES, Face, sides
from objectmodels.geometry.solids import (
    FLAT,
    Column,
    ConvexHull,
    Cuboid,
    Solid,
    UprightCylinder,
    between,
    hull_facets,
    lowest_places,
    scipy_hull,
    vertices_error,
    volume_and_centre,
)
from objectmodels.lazy import cached_property
from objectmodels.models.object_parts import (
    Cavity,
    Part,
    inner_floor,
    open_box_parts,
    require_open_box,
)
from objectmodels.models.parameters import Corners, Size

SIDEWAYS = 0.5
"""Faces whose normal is at most 30° above or below the horizontal are sides."""

WIDE = 0.02
"""Faces narrower than this have no room for a fingertip [m]."""

_STRAIGHT = np.radians(10.0)  # a face that looks so nearly against a heading is pushed along it
_BESIDE = 0.7  # a facet that looks less against a heading says nothing of the side there

_LEVEL = 1e-4  # heights of a hull's corners that differ by less are one [m]

_RIM_POINTS = 16  # of a round or many-cornered end where an engine needs points

Vertices = Annotated[
    tuple[tuple[Coordinate, Coordinate, Coordinate], ...],
    BeforeValidator(as_tuples),
    length_of("vertices"),
]

Places = tuple[tuple[float, float], ...]
"""Points in B's x, y [m]."""


class Shape(ABC):
    """The shape of an object that stands on a table.

    A shape says its `footprint`, `top` and `faces`; the rest has defaults, those of an upright
    solid over its base.
    """

    @property
    @abstractmethod
    def footprint(self) -> Base:
        """The flat base on which the shape stands, in B."""

    @property
    @abstractmethod
    def top(self) -> float:
        """Height of its highest point [m]."""

    @abstractmethod
    def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
        """Places on its sides where a finger may push, in B.

        Args:
            headings: directions in which a round side is to be pushed, as angles from B's x axis,
                shape (k,) [rad]; along the axes of B if not given. Flat faces do not depend on it.
        """

    @property
    def outline(self) -> Array:
        """Convex polygon that it covers of the table seen from above, shape (k, 2) [m]."""
        return self.footprint.corners

    @property
    def section(self) -> Base:
        """Its horizontal section, the same at all heights, which a cavity inside it follows.

        Raises:
            ModelError: `bad_value` if it differs from height to height.
        """
        return self.footprint

    @cached_property
    def rim(self) -> Base:
        """Outline of its top."""
        return Polygon.convex(self.outline)

    @property
    def centre(self) -> tuple[float, float, float]:
        """Centre of mass if it is not stated: the middle [m]."""
        return (0.0, 0.0, self.top / 2.0)

    @property
    def gyration(self) -> tuple[float, float, float]:
        """Squared radii of gyration about axes x, y, z through the centre of mass [m²].

        Those of a solid box around it, unless a shape knows better.
        """
        x2, y2, z2 = (side * side / 12.0 for side in self.extents)
        return (y2 + z2, x2 + z2, x2 + y2)

    @property
    def extents(self) -> tuple[float, float, float]:
        """Size along x, y, z of B [m]."""
        x, y = np.ptp(self.outline, axis=0).tolist()
        return (x, y, self.top)

    @property
    def cavity(self) -> Cavity | None:
        """The room between its walls, if it is a box that is open above."""
        return None

    @property
    def has_upright_walls(self) -> bool:
        """Whether it may be hollow and have a lid: its section is the same at all heights."""
        return True

    @property
    def is_labelled(self) -> bool:
        """Whether pictures have a name on its four sides."""
        return False

    @property
    def top_face(self) -> Polygon | None:
        """The level face on top in B; None if its top is round or an edge.

        That of a container of liquids is the face within its rim, as if it were closed.
        """
        return Polygon.convex(self.section.corners)

    @property
    def standing_face(self) -> Polygon | None:
        """The face on which others stand in B: the inner floor of an open box, or its top."""
        return self.top_face if self.cavity is None else inner_floor(self.cavity)

    @property
    def standing_height(self) -> float:
        """Height of that face over its base [m]."""
        return self.top if self.cavity is None else self.cavity.floor

    @property
    def solids(self) -> tuple[Solid, ...]:
        """Solids of which it consists, for engines, pictures and files of other tools."""
        return (ConvexHull(between(self.outline, self.outline, self.top)),)

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """Upright prisms and cylinders that enclose it, for what must not touch it."""
        return (self.column,)

    @cached_property
    def column(self) -> Column:
        """The upright prism or cylinder that encloses all of it."""
        return Column(self.outline, self.top)

    @property
    def silhouette(self) -> Places:
        """Its corners seen from above, or points of a round side; none lies outside of it."""
        return _thinned(_places(self.outline))

    @property
    def feet(self) -> Places:
        """Points of its base on which an engine has it stand."""
        return self.silhouette

    @property
    def crown(self) -> Places:
        """Points of its top, on which an engine has it lie once it has fallen over."""
        return self.silhouette

    @property
    def bearing_points(self) -> Iterator[tuple[float, float, float]]:
        """Corners of what others stand on: of its top, or of the floor between its walls [m]."""
        if self.cavity is None:
            return ((x, y, self.top) for x, y in self.crown)
        floor = inner_floor(self.cavity).vertices.tolist()
        return ((x, y, self.cavity.floor) for x, y in floor)

    @property
    def hull_corners(self) -> Array:
        """Corners of its convex hull, points around those of round ends, shape (k, 3) [m]."""
        return np.array([(x, y, z) for z in (0.0, self.top) for x, y in self.silhouette])

    def bare_shape(self) -> ShapeKeys:
        """The shape without what else is known of the object: of its base and its outline."""
        ends = between(self.footprint.corners, self.outline, self.top)
        return Hull(vertices=tuple(map(tuple, ends.tolist())))


class ShapeKeys(Part, Shape):
    """A shape whose fields are its keys in files; the first of them tells which shape it is."""

    @classmethod
    def file_keys(cls) -> dict[str, bool]:
        """Its keys in files, in order, and whether each of them must be given."""
        return {f.alias or name: f.is_required() for name, f in cls.model_fields.items()}

    def bare_shape(self) -> ShapeKeys:
        """The shape without what else is known of the object."""
        own = next((shape for shape in SHAPES if isinstance(self, shape)), None)
        if own is None:
            return super().bare_shape()
        return own(**{name: getattr(self, name) for name in own.model_fields})


class Box(ShapeKeys):
    """A box, its sides along the axes of B.

    Attributes:
        size: extents along x, y, z of B [m].
        inside: its cavity, if it is open above.
    """

    size: Annotated[Size, Field(alias="size_m")]
    inside: Cavity | None = None

    @model_validator(mode="after")
    def _check_walls(self) -> Self:
        if self.inside is not None:
            require_open_box(self.size, self.inside)
        return self

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
    def cavity(self) -> Cavity | None:
        """Its cavity, if it is open above."""
        return self.inside

    @property
    def is_labelled(self) -> bool:
        """Yes."""
        return True

    @property
    def solids(self) -> tuple[Cuboid, ...]:
        """The box; of an open one its floor, then its walls."""
        if self.inside is not None:
            return tuple(Cuboid(*ends) for ends in open_box_parts(self.size, self.inside))
        x, y, z = self.size
        return (Cuboid(np.array([-x / 2, -y / 2, 0.0]), np.array([x / 2, y / 2, z])),)

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """One; of an open box one for its floor, and one for each wall."""
        if self.inside is None:
            return (self.column,)
        return tuple(
            Column(np.array([[x, y], [u, y], [u, v], [x, v]]), float(top))
            for (x, y, _), (u, v, top) in open_box_parts(self.size, self.inside)
        )

    @property
    def silhouette(self) -> Places:
        """Its four corners."""
        a, b = self.size[0] / 2, self.size[1] / 2
        return ((a, b), (-a, b), (-a, -b), (a, -b))


class Cylinder(ShapeKeys):
    """An upright cylinder on a round base.

    Attributes:
        radius: of its side [m].
        height: of the cylinder [m].
        base_radius: of the circle it stands on, if that is smaller [m].
    """

    radius: Annotated[Length, Field(alias="radius_m")]
    height: Annotated[Length, Field(alias="height_m")]
    base_radius: Annotated[Length | None, Field(alias="base_radius_m")] = None

    @cached_property
    def footprint(self) -> Disc:
        """A disc."""
        return Disc(self.radius if self.base_radius is None else self.base_radius)

    @property
    def top(self) -> float:
        """Its height."""
        return self.height

    @property
    def section(self) -> Disc:
        """A disc, that of its side."""
        return Disc(self.radius)

    @property
    def rim(self) -> Disc:
        """A disc, that of its side."""
        return Disc(self.radius)

    @cached_property
    def outline(self) -> Array:
        """A polygon around the side."""
        return Disc(self.radius).enclosing_corners

    @property
    def extents(self) -> tuple[float, float, float]:
        """Its diameter twice, and its height."""
        return (2.0 * self.radius, 2.0 * self.radius, self.height)

    @property
    def gyration(self) -> tuple[float, float, float]:
        """Of the solid cylinder."""
        across = self.radius**2 / 4.0 + self.height**2 / 12.0
        return (across, across, self.radius**2 / 2.0)

    def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
        """Strips of the round side that look against each heading."""
        pushed = np.atleast_1d(AXES if headings is None else np.asarray(headings, float))
        normals = -np.column_stack((np.cos(pushed), np.sin(pushed)))
        width = self.radius  # of a face on the round side, whose ends lie 12 % of that back
        return tuple(
            Face.upright(n, self.radius * n, width, self.height, 1.0 / self.radius) for n in normals
        )

    @property
    def solids(self) -> tuple[UprightCylinder, ...]:
        """The cylinder; a smaller base is told by its feet alone."""
        return (UprightCylinder(self.radius, 0.0, self.height),)

    @cached_property
    def column(self) -> Column:
        """The cylinder."""
        return Column(self.outline, self.height, self.radius)

    @property
    def silhouette(self) -> Places:
        """Points around it."""
        return _circle(self.radius)

    @property
    def feet(self) -> Places:
        """Points around its base."""
        return self.silhouette if self.base_radius is None else _circle(self.base_radius)


class Prism(ShapeKeys):
    """A prism over a convex polygon.

    Attributes:
        corners: of the polygon in B, in order, either way round [m].
        height: of the prism [m].
    """

    corners: Annotated[Corners, Field(alias="corners_m")]
    height: Annotated[Length, Field(alias="height_m")]

    @cached_property
    def footprint(self) -> Polygon:
        """The polygon."""
        try:
            return Polygon.convex(self.corners)
        except ModelError as error:
            raise ModelError(
                "bad_value", error.message, path="corners", suggestions=error.suggestions
            ) from error

    @property
    def top(self) -> float:
        """Its height."""
        return self.height

    @property
    def centre(self) -> tuple[float, float, float]:
        """Centre of its volume."""
        x, y = self.footprint.centroid.tolist()
        return (x, y, self.height / 2.0)

    @property
    def gyration(self) -> tuple[float, float, float]:
        """Of the solid prism."""
        x2, y2 = _second_moments(self.footprint)
        z2 = self.height**2 / 12.0
        return (y2 + z2, x2 + z2, x2 + y2)

    def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
        """One for each edge of the polygon, in its order."""
        return sides(self.footprint, self.height)

    @property
    def silhouette(self) -> Places:
        """The corners of the polygon."""
        return self.corners


class Hull(ShapeKeys):
    """The convex hull of points, standing on the face at z = 0.

    Attributes:
        vertices: in B, shape (k, 3) [m]; none below the table, three or more on it.
    """

    vertices: Annotated[Vertices, Field(alias="vertices_m")]

    @cached_property
    def _vertex_array(self) -> Array:
        return np.array(self.vertices)

    @cached_property
    def footprint(self) -> Polygon:
        """The face at z = 0."""
        low, on_table = lowest_places(self._vertex_array)
        if abs(low) > FLAT * np.ptp(self._vertex_array, axis=0).max():
            raise vertices_error(
                f"the lowest vertex is at z = {low} m, not 0", f"add {-low} to each z"
            )
        if len(on_table) < 3:
            raise vertices_error(
                f"only {len(on_table)} vertices at z = 0: it does not stand on a face",
                "turn it so that three or more vertices have z = 0",
            )
        return hull_polygon(on_table)

    @property
    def top(self) -> float:
        """Height of the highest vertex."""
        return float(self._vertex_array[:, 2].max())

    @property
    def section(self) -> Polygon:
        """Refused: it differs from height to height."""
        raise ModelError(
            "bad_value",
            "a container has upright walls",
            path="container",
            suggestions=("model it as a box, a cylinder or a prism",),
        )

    @cached_property
    def outline(self) -> Array:
        """The hull seen from above."""
        return hull_polygon(self._vertex_array[:, :2]).vertices

    @cached_property
    def _volume_and_centre(self) -> tuple[float, Array]:
        return volume_and_centre(self._vertex_array)

    @property
    def centre(self) -> tuple[float, float, float]:
        """Centre of its volume."""
        x, y, z = self._volume_and_centre[1].tolist()
        return (x, y, z)

    @property
    def volume(self) -> float:
        """Its volume [m³]."""
        return self._volume_and_centre[0]

    @cached_property
    def _side_planes(self) -> tuple[tuple[Array, Array], ...]:
        """Outward normal and vertices of each face, the largest first."""
        return hull_facets(self._vertex_array)

    def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
        """Its sides that are wide enough to be pushed, the largest first.

        Where none of them looks against a heading, because the side is curved, what bulges out
        most that way counts as a face.
        """
        flat = [
            _outlined_face(*plane) for plane in self._side_planes if abs(plane[0][2]) <= SIDEWAYS
        ]
        found = [face for face in flat if face.width >= WIDE]
        looks = [np.arctan2(-face.normal[1], -face.normal[0]) for face in found]
        pushed = np.atleast_1d(AXES if headings is None else np.asarray(headings, float))
        for heading in pushed:
            off = [abs(np.angle(np.exp(1j * (heading - other)))) for other in looks]
            if min(off, default=np.pi) > _STRAIGHT:
                found += self._bulging_face(float(heading))
        return tuple(found)

    def _bulging_face(self, heading: float) -> list[Face]:
        """Face of what lies within a small depth of a plane against a heading, if wide enough.

        The plane leans as the side does there.
        """
        level = -np.array([np.cos(heading), np.sin(heading), 0.0])
        sides = [normal for normal, _ in self._side_planes if abs(normal[2]) <= SIDEWAYS]
        nearest = max(sides, key=lambda n: float(n @ level), default=level)
        slope = nearest[2] if nearest @ level > _BESIDE else 0.0
        normal = np.sqrt(1.0 - slope**2) * level + np.array([0.0, 0.0, slope])
        depth = self._vertex_array @ normal
        # Depth within which a curved side counts as flat [m].
        near = self._part_beyond(normal, depth.max() - 0.0025)
        across = near @ np.array([-level[1], level[0], 0.0])
        if np.ptp(across) < WIDE or np.ptp(near[:, 2]) < WIDE:
            return []
        return [_outlined_face(normal, near + (depth.max() - near @ normal)[:, None] * normal)]

    def _part_beyond(self, normal: Array, offset: float) -> Array:
        """Corners of what lies beyond a plane, those where edges cross it too, shape (k, 3)."""
        depth = self._vertex_array @ normal - offset
        ends = self._edges[(depth[self._edges] >= 0.0).sum(axis=1) == 1]
        (a, b), (p, q) = depth[ends].T, np.swapaxes(self._vertex_array[ends], 0, 1)
        crossings = p + (a / (a - b))[:, None] * (q - p)
        return np.vstack((self._vertex_array[depth >= 0.0], crossings))

    @cached_property
    def _edges(self) -> NDArray[np.intp]:
        """Pairs of vertices that an edge of a triangle of its surface ties, shape (k, 2)."""
        triangles = scipy_hull(self._vertex_array).simplices
        return np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)), axis=0)

    @property
    def has_upright_walls(self) -> bool:
        """No."""
        return False

    @property
    def top_face(self) -> Polygon | None:
        """The hull of its highest vertices."""
        highest = self._vertex_array[self._vertex_array[:, 2] > self.top - _LEVEL, :2]
        return hull_polygon(highest) if len(highest) > 2 else None

    @property
    def solids(self) -> tuple[ConvexHull, ...]:
        """The hull."""
        return (ConvexHull(self._vertex_array),)

    @property
    def silhouette(self) -> Places:
        """Its corners seen from above."""
        return _places(self.outline)

    @property
    def feet(self) -> Places:
        """Corners of its base."""
        return self._thinned_end(self._vertex_array[:, 2] <= _LEVEL)

    @property
    def crown(self) -> Places:
        """Corners of its top."""
        return self._thinned_end(self._vertex_array[:, 2] >= self.top - _LEVEL)

    def _thinned_end(self, on_it: NDArray[np.bool_]) -> Places:
        """Corners of some vertices seen from above; one or two are their own."""
        seen = self._vertex_array[on_it, :2]
        return _thinned(_places(hull_polygon(seen).vertices if len(seen) > 2 else seen))

    @property
    def bearing_points(self) -> Iterator[tuple[float, float, float]]:
        """Its vertices."""
        return iter(self.vertices)

    @property
    def hull_corners(self) -> Array:
        """Its vertices."""
        return self._vertex_array


SHAPES: tuple[type[ShapeKeys], ...] = (Box, Cylinder, Prism, Hull)
"""Shapes that files may state, each by its first key."""

if TYPE_CHECKING:
    AnyShape = ShapeKeys
else:  # of what pydantic and the hints of unknown keys see
    AnyShape = reduce(or_, SHAPES)


def _places(points: Array) -> Places:
    """Points (k, 2) as plain numbers."""
    return tuple((x, y) for x, y in points.tolist())


def _thinned(corners: Places) -> Places:
    """Corners of which there are no more than of a rim."""
    return corners[:: math.ceil(len(corners) / _RIM_POINTS)]


def _circle(radius: float) -> Places:
    """Points of a rim on which a round object stands."""
    turns = (2.0 * math.pi * k / _RIM_POINTS for k in range(_RIM_POINTS))
    return tuple((radius * math.cos(phi), radius * math.sin(phi)) for phi in turns)


def _second_moments(polygon: Polygon) -> tuple[float, float]:
    """Mean squares of x and y over the area, about its centroid [m²]."""
    v = polygon.vertices - polygon.centroid
    w = np.roll(v, -1, axis=0)
    area = cross(v, w)
    second = (area[:, None] * (v * v + v * w + w * w)).sum(axis=0) / (6.0 * area.sum())
    x2, y2 = second.tolist()
    return x2, y2


def _outlined_face(normal: Array, corners: Array) -> Face:
    """A face with its outline."""
    level = np.hypot(*normal[:2])
    tangent = np.array([-normal[1], normal[0], 0.0]) / level
    lateral = corners @ tangent
    middle = (lateral.min() + lateral.max()) / 2.0
    low, high = corners[:, 2].min(), corners[:, 2].max()
    z = (low + high) / 2.0
    outward = normal[:2] / level
    out = (corners[0] @ normal - normal[2] * z) / level
    centre = np.append(out * outward + middle * tangent[:2], z)
    outline = hull_polygon(np.column_stack((lateral - middle, corners[:, 2]))).vertices
    return Face(
        normal=tuple(normal.tolist()),
        centre=tuple(centre.tolist()),
        tangent=tuple(tangent.tolist()),
        width=float(np.ptp(lateral)),
        height=float(high - low),
        outline=tuple(map(tuple, outline.tolist())),
    )
