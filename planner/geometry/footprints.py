"""Free way on the table: footprints that move, land and must not meet.

Model: an upright object covers a convex polygon of the table plane. One that is pushed straight
keeps its heading, so its polygon is translated; one that topples lands on the strip in front of
the edge it turns about. Two convex polygons are apart if and only if their projections on the
normal of one of their edges are (separating axes); a translation moves every projection linearly,
which gives the free distance exactly.

Frames: everything in W's table plane [m].
"""

from __future__ import annotations

import numpy as np

from objectmodels.geometry.base_shapes import Array
from planner.types.world_state import SeenObject, TableState


def footprint(seen: SeenObject) -> Array:
    """Corners of what an object covers of the table in W, counter-clockwise, shape (k, 2) [m]."""
    return seen.bulk()[0]


def landing_strip(seen: SeenObject, direction_W: Array) -> Array:
    """Corners of the base and of where the object lands if it topples along a direction.

    Args:
        seen: the object, upright.
        direction_W: unit direction of the fall, square to a side face, shape (3,).

    Returns:
        Corners of the rectangle that is swept, shape (4, 2) [m]; the edge does not slide.
    """
    u = direction_W[:2]
    corners = footprint(seen)
    ahead = (corners - corners.mean(axis=0)) @ u > 0.0
    return corners + np.where(ahead[:, None], seen.model.top * u, 0.0)


def _normals(polygon: Array) -> Array:
    edges = np.roll(polygon, -1, axis=0) - polygon
    normals = np.column_stack([edges[:, 1], -edges[:, 0]])
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))


def free_travel(moving: Array, standing: Array, direction: Array, clearance: float) -> float:
    """Way over which a polygon can be moved before it is closer to another than a clearance.

    Args:
        moving: corners of a convex polygon in W, shape (n, 2) [m].
        standing: those of another, shape (k, 2) [m].
        direction: unit direction of the travel, shape (2,).
        clearance: distance to be kept, along the edges' normals [m].

    Returns:
        The distance [m]: 0 if they are too close already, inf if they never meet.
    """
    axes = np.vstack([_normals(moving), _normals(standing)])
    a, b = moving @ axes.T, standing @ axes.T
    low, high = b.min(axis=0) - clearance - a.max(axis=0), b.max(axis=0) + clearance - a.min(axis=0)
    speed = axes @ direction
    still = np.abs(speed) < 1e-12
    if np.any(still & ((low >= 0.0) | (high <= 0.0))):
        return np.inf
    at = np.stack([low[~still], high[~still]]) / speed[~still]
    enter, leave = float(at.min(axis=0).max()), float(at.max(axis=0).min())
    return np.inf if enter >= leave or leave <= 0.0 else max(enter, 0.0)


def travel_to_edge(corners: Array, table: TableState, direction: Array, margin: float) -> float:
    """Way over which a polygon can be moved before a corner is closer to the table's edge.

    Args:
        corners: the polygon in W, shape (n, 2) [m].
        table: extent of the table top.
        direction: unit direction of the travel, shape (2,).
        margin: distance to be kept from the edge [m].

    Returns:
        The distance [m], negative or zero if a corner is too close already.
    """
    low = np.array([table.x_min, table.y_min]) + margin
    high = np.array([table.x_max, table.y_max]) - margin
    room = np.where(direction > 0.0, high - corners, corners - low)
    going = np.abs(direction) > 1e-12
    return float((room[:, going] / np.abs(direction[going])).min())


def room_to_edge(corners: Array, table: TableState, margin: float = 0.0) -> float:
    """Least distance of a polygon's corners, shape (n, 2), from a margin of the table's edge [m].

    Less than 0 if a corner is beyond it.
    """
    low = np.array([table.x_min, table.y_min]) + margin
    high = np.array([table.x_max, table.y_max]) - margin
    return float(np.minimum(corners - low, high - corners).min())


def overlaps(a: Array, b: Array, clearance: float) -> bool:
    """Return True if convex polygons (n, 2), (k, 2) [m] are closer than a clearance."""
    return _apart(a, b) < clearance


def gap(a: Array, b: Array) -> float:
    """Distance between two convex polygons of shapes (n, 2) and (k, 2) [m].

    Returns:
        Where they overlap, less than 0: the least translation that would part them.
    """
    apart = _apart(a, b)
    return apart if apart <= 0.0 else min(_to_edges(a, b), _to_edges(b, a))


def _apart(a: Array, b: Array) -> float:
    """The widest gap along the normal of an edge; between two corners it is wider still."""
    axes = np.vstack([_normals(a), _normals(b)])
    pa, pb = a @ axes.T, b @ axes.T
    return float(np.maximum(pa.min(axis=0) - pb.max(axis=0), pb.min(axis=0) - pa.max(axis=0)).max())


def _to_edges(points: Array, polygon: Array) -> float:
    """Least distance of points from the edges of a polygon [m]."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    from_corner = points[:, None] - polygon
    share = np.clip((from_corner * edges).sum(axis=2) / (edges**2).sum(axis=1), 0.0, 1.0)
    return float(np.linalg.norm(from_corner - share[..., None] * edges, axis=2).min())


def leading_point(seen: SeenObject, direction_W: Array) -> Array:
    """Point on the table as far along a direction from B's origin as the object goes.

    Args:
        seen: the object.
        direction_W: unit direction, horizontal, shape (3,).

    Returns:
        The point in W, shape (3,) [m].
    """
    p_WB = seen.pose.p_WB
    ahead = float(((footprint(seen) - p_WB[:2]) @ direction_W[:2]).max())
    return np.asarray(p_WB + ahead * direction_W)
