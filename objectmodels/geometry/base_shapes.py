"""The base that an object stands on: a convex polygon, or a disc.

Model: the table presses anywhere on the base, so the object stays on it while the centre of
pressure does. A push moves that along a straight line: its moment, load times place, is m + s·e for
a force of size s, and it leaves the base where m + s·e leaves (G − s·w) times the base. That is
when the object topples, exactly, for any rigid flat base (friction acts in its plane and does not
enter).

Frame: everything in the x, y of B, whose origin is the centre of the base.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import asinh, hypot, inf, sqrt
from typing import Annotated, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator

from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import Coordinate, Weight, length_of
from objectmodels.geometry.rotations import as_tuples, cross, dot, left_of, unique_rows

Array = NDArray[np.float64]

# Corners nearer to the line through their neighbours than this share of the base count as on it.
_FLAT = 1e-9

# Sides of the polygon that stands for a round base where points are needed.
ROUND_CORNERS = 24

_CORNERS = "for example [[-0.03, -0.02], [0.03, -0.02], [0.03, 0.02], [-0.03, 0.02]] in metres"


class Base(Protocol):
    """Base of an object, as the mechanics needs it."""

    @property
    def corners(self) -> Array:
        """Its corners, or evenly spread points of its rim, counter-clockwise, shape (k, 2) [m]."""

    @property
    def uniform_radius(self) -> float:
        """Mean distance of its points from its centre: c̄ of uniform pressure [m]."""

    @property
    def size(self) -> float:
        """Largest distance of its points from the origin [m]."""

    @property
    def area(self) -> float:
        """Its area [m²]."""

    @property
    def is_round(self) -> bool:
        """Whether it is a disc around the origin, which has no edges."""

    @property
    def enclosing_corners(self) -> Array:
        """Corners of a convex polygon that encloses it, counter-clockwise, shape (k, 2) [m]."""

    def extent(self, normals: Array) -> Array:
        """Reach along unit vectors (..., 2), shape (...) [m]."""

    def contains(self, points: Array, tolerance: float = 0.0) -> bool:
        """Return True if all points (n, 2) lie in it, or beyond it by at most a tolerance [m]."""

    def chords(self, along: Array, u: Array) -> tuple[Array, Array]:
        """Widths across unit directions u (..., 2) and their middles, shape (..., k) [m].

        Args:
            along: distances from the origin along u at which it is cut, shape (..., k) [m].
            u: unit directions, shape (..., 2).
        """

    def inset(self, wall: float) -> Base | None:
        """What is left of it within walls so thick [m]; None if nothing is."""

    def topple_force(
        self, m: Array, e: Array, w: Array, weight: float, shift: ArrayLike = 0.0
    ) -> Array:
        """Smallest force s ≥ 0 at which m + s·e leaves (G − s·w) times the base; inf if never.

        Args:
            m: moment of the weight, G c_xy, shape (..., 2) [N·m].
            e: moment of a unit push, p_z u_xy − u_z p_xy, shape (..., 2) [m].
            w: upward part of a unit push, u_z, shape (...).
            weight: G [N].
            shift: the centre of mass may be nearer to every edge by this, along x and y [m].
        """

    def single_topple_force(
        self, m: tuple[float, float], e: tuple[float, float], w: float, weight: float
    ) -> float:
        """The force of `topple_force` for one push, in plain numbers [N]."""

    def nearest_edge(self, q: Array) -> tuple[Array, NDArray[np.int64]]:
        """Outward normals (n, 2) of the edges nearest to points (n, 2), and their indices.

        The index is −1 on a round base.
        """

    def facing_normal(self, direction: Array) -> Array:
        """Outward normal of the edge that looks most along a unit direction, shape (2,)."""

    def topple_height(
        self, m: Array, e: Array, rise: Array, load: Array, shift: ArrayLike = 0.0
    ) -> Array:
        """Smallest z from which on m + e + z·rise lies outside of load times the base, (...) [m].

        Infinite where a higher contact does not help to tip.

        Args:
            m: moment of the weight, shape (..., 2) [N·m].
            e: moment of the push with its contact at z = 0, shape (..., 2) [N·m].
            rise: what that gains with z: F_xy, shape (..., 2) [N].
            load: G − F_z, shape (...) [N].
            shift: as in `topple`, times the weight [N·m].
        """

    def quadrature_nodes(self) -> tuple[Array, Array]:
        """Points (k, 2) and weights (k,) of a quadrature over its area; the weights sum to one."""


@dataclass(frozen=True, eq=False)
class Polygon(Base):
    """A convex polygon.

    Attributes:
        vertices: counter-clockwise, shape (k, 2) [m].
    """

    vertices: Array

    @classmethod
    def rectangle(cls, x: float, y: float) -> Polygon:
        """A rectangle of sides x and y around the origin."""
        return cls(0.5 * np.array([[x, -y], [x, y], [-x, y], [-x, -y]]))

    @classmethod
    def convex(cls, points: ArrayLike) -> Polygon:
        """The polygon of corners that were given in order, either way round.

        Raises:
            ModelError: `bad_value` if they are not the corners of a convex polygon.
        """
        v = np.asarray(points, dtype=np.float64)
        if v.ndim != 2 or v.shape[1] != 2 or len(v) < 3 or not np.isfinite(v).all():
            raise ModelError(
                "bad_value", "a base needs three or more corners [x, y]", suggestions=(_CORNERS,)
            )
        v = without_collinear(v)
        ahead = np.roll(v, -1, axis=0) - v
        if len(v) >= 3 and cross(ahead, np.roll(ahead, -1, axis=0)).sum() < 0.0:
            v = v[::-1]
            ahead = np.roll(v, -1, axis=0) - v
        turns = cross(ahead, np.roll(ahead, -1, axis=0))
        angle = np.arctan2(turns, np.sum(ahead * np.roll(ahead, -1, axis=0), axis=1)).sum()
        if len(v) < 3 or not (turns > 0.0).all() or abs(angle - 2.0 * np.pi) > 1e-6:
            raise ModelError(
                "bad_value",
                "the base is not a convex polygon, its corners in order",
                suggestions=("give the corners counter-clockwise as seen from above", _CORNERS),
            )
        return cls(v)

    @cached_property
    def normals(self) -> Array:
        """Outward unit normals n_k of the edges, edge k from vertex k to the next, (k, 2)."""
        along = np.roll(self.vertices, -1, axis=0) - self.vertices
        normals = np.column_stack((along[:, 1], -along[:, 0]))
        return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))

    @cached_property
    def offsets(self) -> Array:
        """Offsets d_k of the edges, {q : n_k·q ≤ d_k for all k}, shape (k,) [m]."""
        return np.asarray(np.sum(self.normals * self.vertices, axis=1))

    @property
    def corners(self) -> Array:
        """Its vertices."""
        return self.vertices

    @property
    def is_round(self) -> bool:
        """No."""
        return False

    @property
    def enclosing_corners(self) -> Array:
        """Its vertices."""
        return self.vertices

    @cached_property
    def centroid(self) -> Array:
        """Centre of its area, shape (2,) [m]."""
        v, ahead = self.vertices, np.roll(self.vertices, -1, axis=0)
        area = cross(v, ahead)
        return np.asarray(((v + ahead) * area[:, None]).sum(axis=0) / (3.0 * area.sum()))

    @cached_property
    def area(self) -> float:
        """Its area [m²]."""
        return float(0.5 * cross(self.vertices, np.roll(self.vertices, -1, axis=0)).sum())

    @cached_property
    def uniform_radius(self) -> float:
        """Mean distance from the centroid, by triangles between it and the edges."""
        v = self.vertices - self.centroid
        total = 0.0
        for a, b in zip(v, np.roll(v, -1, axis=0), strict=True):
            along = (b - a) / hypot(*(b - a))
            d = abs(a[0] * along[1] - a[1] * along[0])
            t = [float(x @ along) for x in (a, b)]
            # ∫ r² dr dφ over the triangle = d³/3 ∫ sec³φ dφ
            part = [x / d * hypot(1.0, x / d) + asinh(x / d) for x in t]
            total += d**3 / 6.0 * (part[1] - part[0])
        return float(total / self.area)

    @cached_property
    def size(self) -> float:
        """Distance of the farthest vertex from the origin."""
        return float(np.hypot(*self.vertices.T).max())

    def extent(self, normals: Array) -> Array:
        """See `Base`."""
        return np.asarray((np.asarray(normals) @ self.vertices.T).max(axis=-1))

    def contains(self, points: Array, tolerance: float = 0.0) -> bool:
        """See `Base`."""
        return bool((points @ self.normals.T <= self.offsets + tolerance).all())

    def chords(self, along: Array, u: Array) -> tuple[Array, Array]:
        """See `Base`: each edge n·q ≤ d bounds the chord s·u + t·left(u) on one side."""
        ahead, aside = (w @ self.normals.T for w in (u, left_of(u)))
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            bound = (self.offsets - along[..., None] * ahead[..., None, :]) / aside[..., None, :]
        left = np.where(aside[..., None, :] > 1e-12, bound, np.inf).min(axis=-1)
        right = np.where(aside[..., None, :] < -1e-12, bound, -np.inf).max(axis=-1)
        return np.maximum(left - right, 0.0), 0.5 * (left + right)

    def inset(self, wall: float) -> Polygon | None:
        """See `Base`: what the edges leave, each moved inwards."""
        corners = self.vertices
        for normal, offset in zip(self.normals, self.offsets - wall, strict=True):
            corners = _cut_polygon(corners, corners @ normal - offset)
            if len(corners) < 3:
                return None
        return Polygon(corners)

    def topple_force(
        self, m: Array, e: Array, w: Array, weight: float, shift: ArrayLike = 0.0
    ) -> Array:
        """Least of s_k = (G d_k − n_k·m) / (n_k·e + w d_k) over its edges; see `Base`."""
        if m.ndim == 1:
            return self._topple_force_from(m, e, w, weight, shift)
        least: Array | None = None
        (m_x, m_y), (e_x, e_y) = (m[..., 0], m[..., 1]), (e[..., 0], e[..., 1])
        for n_x, n_y, d, nearer in self._edges(shift):
            holding = weight * (d - nearer) - (n_x * m_x + n_y * m_y)
            growing = n_x * e_x + n_y * e_y + w * d
            force = _first_crossing(np.maximum(holding, 0.0), growing)
            least = force if least is None else np.minimum(least, force, out=least)
        assert least is not None
        return least

    def _topple_force_from(
        self, m: Array, e: Array, w: Array, weight: float, shift: ArrayLike
    ) -> Array:
        """`topple_force` for one m of all, shape (2,): the largest 1/s_k is a matrix product."""
        room = self.offsets - np.abs(self.normals) @ np.broadcast_to(shift, 2)
        # So little holds nothing: the centre of mass is over an edge.
        holding = np.maximum(weight * room - self.normals @ m, 1e-100 * weight * self.size)
        rates = np.column_stack((self.normals, self.offsets)) / holding[:, None]
        push = np.stack((e[..., 0], e[..., 1], np.broadcast_to(w, e.shape[:-1])))
        growth = (rates @ push.reshape(3, -1)).max(axis=0, initial=0.0)
        with np.errstate(divide="ignore"):
            return np.asarray(1.0 / growth.reshape(e.shape[:-1]))

    def single_topple_force(
        self, m: tuple[float, float], e: tuple[float, float], w: float, weight: float
    ) -> float:
        """See `Base`."""
        least = inf
        (m_x, m_y), (e_x, e_y) = m, e
        for n_x, n_y, d in self._plain_edges:
            growing = n_x * e_x + n_y * e_y + w * d
            if growing > 0.0:
                holding = weight * d - (n_x * m_x + n_y * m_y)
                least = min(least, max(holding, 0.0) / growing)
        return least

    @cached_property
    def _plain_edges(self) -> list[tuple[float, float, float]]:
        """Normal and offset of each edge."""
        normals = self.normals.tolist()
        return [(x, y, d) for (x, y), d in zip(normals, self.offsets.tolist(), strict=True)]

    def _edges(self, shift: ArrayLike) -> Iterator[tuple[float, float, float, float]]:
        """Normal and offset of each edge, and by how much a shift brings it nearer [m]."""
        x, y = np.broadcast_to(shift, 2).tolist()
        for n_x, n_y, d in self._plain_edges:
            yield n_x, n_y, d, abs(n_x) * x + abs(n_y) * y

    def nearest_edge(self, q: Array) -> tuple[Array, NDArray[np.int64]]:
        """See `Base`."""
        k = np.argmax(q @ self.normals.T - self.offsets, axis=-1)
        return self.normals[k], k

    def facing_normal(self, direction: Array) -> Array:
        """See `Base`."""
        return np.asarray(self.normals[np.argmax(self.normals @ direction)])

    def topple_height(
        self, m: Array, e: Array, rise: Array, load: Array, shift: ArrayLike = 0.0
    ) -> Array:
        """See `Base`."""
        (x, y), (rise_x, rise_y) = np.moveaxis(m + e, -1, 0), np.moveaxis(rise, -1, 0)
        heights = [
            _first_crossing(d * load - nearer - (n_x * x + n_y * y), n_x * rise_x + n_y * rise_y)
            for n_x, n_y, d, nearer in self._edges(shift)
        ]
        return np.asarray(np.min(heights, axis=0))

    def quadrature_nodes(self) -> tuple[Array, Array]:
        """Corners of small triangles, each with a third of the area of those that it belongs to."""
        v = self.vertices
        centre = np.broadcast_to(self.centroid, v.shape)
        triangles = np.stack((centre, v, np.roll(v, -1, axis=0)), axis=1)
        for _ in range(3 if len(v) <= 4 else 2):
            # Each triangle (n, 3, 2) cut into four at the middles of its sides.
            a, b, c = triangles.transpose(1, 0, 2)
            ab, bc, ca = (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0
            parts = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
            triangles = np.concatenate([np.stack(part, axis=1) for part in parts])
        area = np.repeat(cross(*(triangles[:, 1:] - triangles[:, :1]).transpose(1, 0, 2)), 3)
        points = triangles.reshape(-1, 2)
        cell = 1e-9 * self.size  # corners that triangles share differ by rounding
        first, which = unique_rows(np.round(points / cell))
        weights = np.bincount(which, weights=area)
        return points[first], weights / weights.sum()


@dataclass(frozen=True)
class Disc(Base):
    """A round base around the origin.

    Attributes:
        radius: R [m].
    """

    radius: float

    @cached_property
    def corners(self) -> Array:
        """Points of the rim."""
        phi = 2.0 * np.pi * np.arange(ROUND_CORNERS) / ROUND_CORNERS
        return self.radius * np.column_stack((np.cos(phi), np.sin(phi)))

    @property
    def uniform_radius(self) -> float:
        """2R/3."""
        return 2.0 * self.radius / 3.0

    @property
    def size(self) -> float:
        """Its radius."""
        return self.radius

    @property
    def area(self) -> float:
        """π R²."""
        return float(np.pi * self.radius**2)

    @property
    def is_round(self) -> bool:
        """Yes."""
        return True

    @property
    def enclosing_corners(self) -> Array:
        """Corners of a polygon whose edges touch the rim."""
        return np.asarray(self.corners / np.cos(np.pi / len(self.corners)))

    def extent(self, normals: Array) -> Array:
        """See `Base`."""
        return np.full(np.shape(normals)[:-1], self.radius)

    def contains(self, points: Array, tolerance: float = 0.0) -> bool:
        """See `Base`."""
        return bool((np.hypot(*points.T) <= self.radius + tolerance).all())

    def chords(self, along: Array, u: Array) -> tuple[Array, Array]:
        """See `Base`."""
        half = np.sqrt(np.maximum(self.radius**2 - along * along, 0.0))
        return 2.0 * half, np.zeros_like(half)

    def inset(self, wall: float) -> Disc | None:
        """See `Base`."""
        return Disc(self.radius - wall) if self.radius > wall else None

    def topple_force(
        self, m: Array, e: Array, w: Array, weight: float, shift: ArrayLike = 0.0
    ) -> Array:
        """The first positive root of |m + s·e| = R (G − s·w); see `Base`."""
        drawn = weight * float(np.hypot(*np.broadcast_to(shift, 2)))
        return _leaves_circle(m, e, self.radius * weight - drawn, self.radius * w)

    def single_topple_force(
        self, m: tuple[float, float], e: tuple[float, float], w: float, weight: float
    ) -> float:
        """See `Base`, and `_leaves_circle`."""
        room, shrink = self.radius * weight, self.radius * w
        a = e[0] * e[0] + e[1] * e[1] - shrink * shrink
        b = m[0] * e[0] + m[1] * e[1] + room * shrink
        c = min(m[0] * m[0] + m[1] * m[1] - room * room, 0.0)
        under = b * b - a * c
        if under < 0.0 or (a <= 0.0 and b <= 0.0):
            return inf
        return -c / (b + sqrt(under)) if b > 0.0 else (sqrt(under) - b) / a

    def nearest_edge(self, q: Array) -> tuple[Array, NDArray[np.int64]]:
        """See `Base`."""
        length = np.hypot(q[..., 0], q[..., 1])[..., None]
        with np.errstate(invalid="ignore", divide="ignore"):
            return q / length, np.full(q.shape[:-1], -1)

    def facing_normal(self, direction: Array) -> Array:
        """The direction itself."""
        return direction

    def topple_height(
        self, m: Array, e: Array, rise: Array, load: Array, shift: ArrayLike = 0.0
    ) -> Array:
        """See `Base`."""
        room = self.radius * load - np.hypot(*np.broadcast_to(shift, 2))
        height = _leaves_circle(m + e, rise, room, np.zeros(()))
        # Where it tips already with the contact on the table, at any height.
        start = np.hypot(m[..., 0] + e[..., 0], m[..., 1] + e[..., 1])
        return np.where(start >= room, 0.0, height)

    def quadrature_nodes(self) -> tuple[Array, Array]:
        """The centre and rings of 24 points, the outermost on the rim; a trapezoidal rule."""
        rings = 6
        k = np.arange(1, rings + 1)
        inner = (k - 0.5) / rings
        outer = np.append(inner[1:], 1.0)
        ring = np.repeat((outer**2 - inner**2) / ROUND_CORNERS, ROUND_CORNERS)
        points = (k / rings)[:, None, None] * self.corners
        weights = np.append(inner[0] ** 2, ring)
        return np.vstack(([[0.0, 0.0]], points.reshape(-1, 2))), weights


def without_collinear(vertices: Array) -> Array:
    """The polygon's true corners: vertices on the line through their neighbours are dropped."""
    before = vertices - np.roll(vertices, 1, axis=0)
    after = np.roll(vertices, -1, axis=0) - vertices
    lengths = np.hypot(*before.T) * np.hypot(*after.T)
    return np.asarray(vertices[np.abs(cross(before, after)) > _FLAT * lengths])


def _cut_polygon(corners: Array, outside: Array) -> Array:
    """The part of a convex polygon at whose points `outside` is not positive."""
    kept = []
    for a, b, p, q in zip(
        corners, np.roll(corners, -1, axis=0), outside, np.roll(outside, -1), strict=True
    ):
        if p <= 0.0:
            kept.append(a)
        if p * q < 0.0:
            kept.append(a + p / (p - q) * (b - a))
    return np.array(kept).reshape(-1, 2)


def _first_crossing(holding: Array, growing: Array) -> Array:
    """Holding / growing where that is positive, else never."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return np.where(growing > 0.0, holding / growing, np.inf)


def _leaves_circle(m: Array, e: Array, room: Array | float, shrink: Array) -> Array:
    """Smallest s ≥ 0 at which |m + s·e| reaches room − s·shrink, a quadratic equation."""
    a = dot(e, e) - shrink * shrink
    b = dot(m, e) + room * shrink
    c = np.minimum(dot(m, m) - np.square(np.maximum(room, 0.0)), 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        # c ≤ 0 at s = 0. With a > 0 one root is positive; else the first, if both are.
        root = np.sqrt(b * b - a * c)
        s = np.where(b > 0.0, -c / (b + root), (root - b) / a)
        s = np.where((a <= 0.0) & (b <= 0.0), np.inf, s)
    return np.where(np.isnan(s), np.inf, s)


# Support of an object: the points on which it stands, and its friction radius.
#
# Model: the points are springs of given weights (`objectmodels.exact.support_springs`),
# so their loads follow from the centre of pressure. The ellipsoidal limit surface needs to know
# one number of them only, the friction radius c̄ = m_max / f_max [m]: the largest friction moment
# about the vertical over the largest friction force, with the centre of pressure in the middle
# (Howe and Cutkosky 1996).

SupportPoint = tuple[Coordinate, Coordinate] | tuple[Coordinate, Coordinate, Weight]
Points = Annotated[tuple[SupportPoint, ...], BeforeValidator(as_tuples), length_of("support")]
Support = Literal["corners", "uniform"] | Points
"""`corners` (of a round base: its rim), `uniform` pressure, or points [x, y] or [x, y, weight] in B
[m], whose weights are their stiffnesses relative to each other, 1 if not given."""


def carrying_base(support: Support, base: Base) -> Base:
    """The base that the object would topple over: the hull of the points if it stands on points.

    Raises:
        ModelError: `bad_value` if the points lie on a line, or outside of the base.
    """
    if isinstance(support, str):
        return base
    points, _ = support_points(support, base)
    if not base.contains(points, 1e-6 * base.size):
        raise ModelError(
            "bad_value",
            "a support point lies outside of the base",
            suggestions=("give points [x, y] in metres, from the middle of the base",),
        )
    return hull_polygon(points)


def support_points(support: Support, base: Base) -> tuple[Array, Array]:
    """Points (k, 2) [m] and weights (k,) of the springs on which the object stands."""
    if support == "uniform":
        return base.quadrature_nodes()
    if support == "corners":
        corners = base.corners
        return corners, np.full(len(corners), 1.0 / len(corners))
    points = np.array([point[:2] for point in support])
    weights = np.array([point[2] if len(point) == 3 else 1.0 for point in support])
    return points, weights / weights.sum()


def friction_radius(support: Support, base: Base) -> float:
    """Friction radius c̄ [m]: the mean distance of what carries from its middle."""
    if support == "uniform":
        return base.uniform_radius
    return mean_distance(*support_points(support, base))


def mean_distance(points: Array, weights: Array) -> float:
    """Friction radius of points (k, 2) with weights (k,): mean distance from their middle [m]."""
    return float(weights @ np.hypot(*(points - weights @ points).T))


def hull_polygon(points: Array) -> Polygon:
    """Convex hull of points (n, 2) [m].

    Raises:
        ModelError: `bad_value` if they lie on a line.
    """
    from scipy.spatial import ConvexHull, QhullError  # takes a while to import

    try:
        return Polygon.convex(points[ConvexHull(points).vertices])
    except QhullError as error:
        raise ModelError(
            "bad_value",
            "the support points lie on a line",
            suggestions=("give three or more points that span an area",),
        ) from error
