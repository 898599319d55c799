"""Shapes of object models: boxes and cylinders that stand upright, and convex hulls.

A convex hull: any solid with flat faces, which may stand on any of them.

Model: the solid is the convex hull of its vertices. The face on the table (vertices at z = 0) is
the base; faces that look sideways are where a finger may push, slanted ones too.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator, Field, model_validator

from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import Coordinate, Length, length_of
from objectmodels.geometry.base_shapes import Array, Disc, Polygon, hull_polygon
from objectmodels.geometry.rotations import as_tuples, cross
from objectmodels.geometry.side_faces import AXES, Face, sides
from objectmodels.lazy import cached_property
from objectmodels.models.object_model import ObjectModel, Resting
from objectmodels.models.object_parts import Cavity, inner_floor, require_open_box
from objectmodels.models.parameters import Corners, Size

SIDEWAYS = 0.5
"""Faces whose normal is at most 30° above or below the horizontal are sides."""

WIDE = 0.02
"""Faces narrower than this have no room for a fingertip [m]."""

_STRAIGHT = np.radians(10.0)  # a face that looks so nearly against a heading is pushed along it
_BESIDE = 0.7  # a facet that looks less against a heading says nothing of the side there

# Vertices within this share of the size of a plane lie on it; normals closer than it are equal.
_FLAT = 1e-6

Vertices = Annotated[
    tuple[tuple[Coordinate, Coordinate, Coordinate], ...],
    BeforeValidator(as_tuples),
    length_of("vertices"),
]


class HullModel(ObjectModel):
    """The convex hull of points, standing on the face at z = 0.

    Attributes:
        vertices: in B, shape (k, 3) [m]; none below the table, three or more on it.
    """

    vertices: Annotated[Vertices, Field(alias="vertices_m")]
    kind: Literal["hull"] = "hull"

    @model_validator(mode="after")
    def _check_standing(self) -> Self:
        if not (self.footprint.offsets > 0.0).all():
            raise _vertices_error(
                "the base does not enclose B's origin",
                "move the vertices: [0, 0, 0] is in the base",
            )
        return self

    @cached_property
    def _vertex_array(self) -> Array:
        return np.array(self.vertices)

    @cached_property
    def footprint(self) -> Polygon:
        """The face at z = 0."""
        low, on_table = lowest_places(self._vertex_array)
        if abs(low) > _FLAT * np.ptp(self._vertex_array, axis=0).max():
            raise _vertices_error(
                f"the lowest vertex is at z = {low} m, not 0", f"add {-low} to each z"
            )
        if len(on_table) < 3:
            raise _vertices_error(
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
        triangles = _scipy_hull(self._vertex_array).simplices
        return np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)), axis=0)

    @cached_property
    def rests(self) -> tuple[Resting, ...]:
        """On `bottom` and `face 1`, `face 2`, … by size, those off which it does not topple."""
        found = [Resting("bottom", self, np.eye(3), np.zeros(3), self)]
        others = [plane for plane in self._side_planes if plane[0][2] > -1.0 + _FLAT]
        for k, (normal, _) in enumerate(others, start=1):
            try:
                found.append(self._resting_on(f"face {k}", normal))
            except ValueError:  # its centre of mass is not above that face
                continue
        return tuple(found)

    def _resting_on(self, face: str, normal: Array) -> Resting:
        """The hull with the face of that outward normal on the table."""
        R_NB = turning_down(normal)
        turned = self._vertex_array @ R_NB.T
        low, on_table = lowest_places(turned)
        origin = np.append(hull_polygon(on_table).centroid, low)
        turned = turned - origin
        turned[np.abs(turned[:, 2]) < _FLAT * self.top, 2] = 0.0
        sd = np.sqrt((R_NB**2) @ np.array(self.com_sd) ** 2)
        model = HullModel(
            **self._fields_on_face(
                float(turned[:, 2].max()),
                vertices=turned.tolist(),
                com=(R_NB @ np.array(self.com) - origin).tolist(),
                com_sd=sd.tolist(),
            )
        )
        return Resting(face, model, R_NB.T, R_NB.T @ origin, self)


def lowest_places(points: Array) -> tuple[float, Array]:
    """Height of the lowest of points (k, 3) [m], and the x, y of those at it, shape (j, 2) [m]."""
    low = float(points[:, 2].min())
    return low, points[points[:, 2] <= low + _FLAT * np.ptp(points[:, 2]), :2]


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
    solid = _scipy_hull(points)
    size = np.ptp(points, axis=0).max()
    planes: list[tuple[Array, Array, float]] = []
    left = np.arange(len(solid.simplices))
    while left.size:
        equation = solid.equations[left[0]]
        same = np.abs(solid.equations[left, :3] @ equation[:3] - 1.0) < _FLAT
        same &= np.abs(solid.equations[left, 3] - equation[3]) < _FLAT * size
        triangles = points[solid.simplices[left[same]]]
        spans = triangles[:, 1:] - triangles[:, :1]
        area = 0.5 * float(np.linalg.norm(np.cross(spans[:, 0], spans[:, 1]), axis=1).sum())
        planes.append((equation[:3], points[np.unique(solid.simplices[left[same]])], area))
        left = left[~same]
    planes.sort(key=lambda plane: -plane[2])
    return tuple((normal, corners) for normal, corners, _ in planes)


def volume_and_centre(points: Array) -> tuple[float, Array]:
    """Volume [m³] and its centre, shape (3,) [m], of the convex hull of points (k, 3)."""
    solid = _scipy_hull(points)
    middle = points.mean(axis=0)
    corners = points[solid.simplices] - middle
    volumes = np.abs(np.linalg.det(corners)) / 6.0
    centre = (volumes[:, None] * corners.sum(axis=1) / 4.0).sum(axis=0) / volumes.sum()
    return float(volumes.sum()), middle + centre


def _scipy_hull(points: Array):  # type: ignore[no-untyped-def]  # scipy's class, imported late
    from scipy.spatial import ConvexHull, QhullError

    try:
        return ConvexHull(points)
    except QhullError as error:
        raise _vertices_error(
            "the vertices lie in a plane: they enclose nothing", "add vertices above the base"
        ) from error


def _vertices_error(message: str, hint: str) -> ModelError:
    return ModelError("bad_value", message, path="vertices", suggestions=(hint,))


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


_LEVEL = 1e-4  # heights of a hull's corners that differ by less are one [m]


def top_face(model: ObjectModel) -> Polygon | None:
    """The level face on top of an object in its frame; None if its top is round or an edge.

    That of a container of liquids is the face within its rim, as if it were closed.
    """
    if not isinstance(model, HullModel):
        return Polygon.convex(model.section.corners)
    vertices = np.array(model.vertices)
    highest = vertices[vertices[:, 2] > model.top - _LEVEL, :2]
    return hull_polygon(highest) if len(highest) > 2 else None


def standing_face(model: ObjectModel) -> Polygon | None:
    """The face on which others stand in its frame: the inner floor of an open box, or its top."""
    return top_face(model) if model.inside is None else inner_floor(model.inside)


def standing_height(model: ObjectModel) -> float:
    """Height of that face over its base [m]."""
    return model.top if model.inside is None else model.inside.floor


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

    size: Annotated[Size, Field(alias="size_m")]
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

    def _require_walls(self, inside: Cavity) -> None:
        require_open_box(self.size, inside)

    @cached_property
    def rests(self) -> tuple[Resting, ...]:
        """On those faces off which it does not topple, named as if B's axes were the robot's."""
        found = []
        for face, turn in _TURNED.items():
            with suppress(ValueError):  # its centre of mass is not above that face
                found.append(self._resting_on(face, turn))
        return tuple(found)

    def _resting_on(self, face: str, turn: Array) -> Resting:
        if face == "bottom":
            return Resting(face, self, np.eye(3), np.zeros(3), self)
        middle = np.array([0.0, 0.0, self.size[2] / 2.0])
        size = np.abs(turn @ np.array(self.size))
        up = np.array([0.0, 0.0, size[2] / 2.0])
        model = type(self)(
            **self._fields_on_face(
                float(size[2]),
                size=tuple(size.tolist()),
                com=tuple((turn @ (np.array(self.com) - middle) + up).tolist()),
                com_sd=tuple(np.abs(turn @ np.array(self.com_sd)).tolist()),
            )
        )
        return Resting(face, model, turn.T, middle - turn.T @ up, self)


class CylinderModel(ObjectModel):
    """An upright cylinder on a round base.

    Attributes:
        radius: of its side [m].
        height: of the cylinder [m].
        base_radius: of the circle it stands on, if that is smaller [m].
    """

    radius: Annotated[Length, Field(alias="radius_m")]
    height: Annotated[Length, Field(alias="height_m")]
    base_radius: Annotated[Length | None, Field(alias="base_radius_m")] = None
    kind: Literal["cylinder"] = "cylinder"

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


class PrismModel(ObjectModel):
    """A prism over a convex polygon.

    Attributes:
        corners: of the polygon in B, in order, either way round [m]; the origin lies inside.
        height: of the prism [m].
    """

    corners: Annotated[Corners, Field(alias="corners_m")]
    height: Annotated[Length, Field(alias="height_m")]
    kind: Literal["prism"] = "prism"

    @model_validator(mode="after")
    def _around_the_origin(self) -> Self:
        if not (self.footprint.offsets > 0.0).all():
            x, y = self.footprint.centroid.tolist()
            raise ModelError(
                "bad_value",
                f"found a base around [{x:.4f}, {y:.4f}], expected one that encloses [0, 0]",
                path="corners",
                suggestions=(f"take {x:.4f} from each x and {y:.4f} from each y",),
            )
        return self

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

    @cached_property
    def rests(self) -> tuple[Resting, ...]:
        """On `bottom`, and as a hull on its other faces: `face 1`, `face 2`, … by size."""
        ends = [(x, y, z) for z in (0.0, self.height) for x, y in self.corners]
        kept = self._fields_on_face(self.height, vertices=tuple(ends))
        solid = HullModel(**{k: v for k, v in kept.items() if k not in ("corners", "height")})
        upright = Resting("bottom", self, np.eye(3), np.zeros(3), self)
        return (upright, *(replace(rest, standing=self) for rest in solid.rests[1:]))

    def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
        """One for each edge of the polygon, in its order."""
        return sides(self.footprint, self.height)


def _second_moments(polygon: Polygon) -> tuple[float, float]:
    """Mean squares of x and y over the area, about its centroid [m²]."""
    v = polygon.vertices - polygon.centroid
    w = np.roll(v, -1, axis=0)
    area = cross(v, w)
    second = (area[:, None] * (v * v + v * w + w * w)).sum(axis=0) / (6.0 * area.sum())
    x2, y2 = second.tolist()
    return x2, y2
