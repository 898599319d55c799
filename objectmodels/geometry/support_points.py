"""Support of an object: the points on which it stands, and its friction radius.

Model: the points are springs of given weights (`objectmodels.mechanics.exact.support_springs`), so
their loads follow from the centre of pressure. The ellipsoidal limit surface needs to know one
number of them only, the friction radius c̄ = m_max / f_max [m]: the largest friction moment about
the vertical over the largest friction force, with the centre of pressure in the middle (Howe and
Cutkosky 1996).
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import BeforeValidator

from objectmodels.errors import ModelError
from objectmodels.files.value_types import Coordinate, Weight, length_of
from objectmodels.geometry.base_shapes import Array, Base, Polygon
from objectmodels.geometry.vector_arrays import as_tuples

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
    if not is_within(base, points, 1e-6 * base.size):
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


def is_within(base: Base, points: Array, tolerance: float = 0.0) -> bool:
    """Return True if all points (n, 2) lie in a base, or beyond it by at most a tolerance [m]."""
    if isinstance(base, Polygon):
        return bool((points @ base.normals.T <= base.offsets + tolerance).all())
    return bool((np.hypot(*points.T) <= base.size + tolerance).all())


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
