"""Free way on the table: footprints that move, land and must not meet.

Model: an upright object covers a convex polygon of the table plane. One that is pushed straight
keeps its heading, so its polygon is translated; one that topples lands on the strip in front of
the edge it turns about. Two convex polygons are apart if and only if their projections on the
normal of one of their edges are (separating axes); a translation moves every projection linearly,
which gives the free distance exactly.

Frames: everything in W's table plane [m].
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.base_shapes import Array, hull_polygon
from planner.problem.directions import heading_of, unit
from planner.types.world_state import SeenObject, TableState, WorldState

CLOSER = 0.7
"""Share of a gap that is asked for, or that there is, that is kept on a way."""

ROLLED_ASKEW, ROLLED_ASIDE = math.radians(20.0), 0.05
"""How far what is round turns out of the way in which it is toppled, and rolls aside [rad], [m].

Of sixteen simulated falls of the water bottle, frictions and mass within 30 %, two were more askew
(22° at most, under one fingertip) and one went farther aside (59 mm, under two).
"""

_SEEN = 0.0005  # things are seen so much nearer than they stand, and may even seem to overlap [m]
_TOUCHING = 1e-9  # that much nearer than a clearance still counts as apart [m]
_NONE = np.empty(0)


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


def landing_area(seen: SeenObject, direction_W: Array) -> Array:
    """Corners of all that it may cover then, shape (k, 2) [m].

    What is round rolls on its rim as it topples, so that it may fall askew or roll aside.
    """
    strip = landing_strip(seen, direction_W)
    if not seen.model.footprint.is_round:
        return strip
    heading = heading_of(direction_W)
    aside = ROLLED_ASIDE * unit(heading + math.pi / 2.0)[:2]
    askew = [landing_strip(seen, unit(heading + turn)) for turn in (ROLLED_ASKEW, -ROLLED_ASKEW)]
    return hull_polygon(np.vstack([strip + aside, strip - aside, *askew])).vertices


def _normals(polygon: Array) -> Array:
    edges = _edges(polygon)
    return np.asarray((edges / np.hypot(*edges.T)[:, None])[:, ::-1] * (1.0, -1.0))


def _edges(polygon: Array) -> Array:
    return np.concatenate((polygon[1:], polygon[:1])) - polygon


class Separations:
    """Translations at which a convex polygon is closer to others than clearances.

    Args:
        moving: its corners in W, shape (n, 2) [m].
        standing: corners of the m others, shape (k, 2) each [m].
        clearances: distance to be kept from each, along the edges' normals [m].
    """

    def __init__(
        self, moving: Array, standing: Sequence[Array], clearances: Sequence[float]
    ) -> None:
        own, axes, low, high = _normals(moving), [np.empty((0, 2))], [], []
        for other, clearance in zip(standing, clearances, strict=True):
            axes.append(np.concatenate((own, _normals(other))))
            a, b = moving @ axes[-1].T, other @ axes[-1].T
            low.append(b.min(axis=0) - clearance - a.max(axis=0))
            high.append(b.max(axis=0) + clearance - a.min(axis=0))
        self._axes = np.concatenate(axes)
        self._low, self._high = np.concatenate([_NONE, *low]), np.concatenate([_NONE, *high])
        self._first = np.cumsum([len(each) for each in axes[:-1]], dtype=np.intp)

    def free_travels(self, moved: Array, direction: Array) -> Array:
        """Way before it is too close to each of the others, shape (m,) [m].

        It starts translated by `moved` and goes along a unit direction, shape (2,) each. The way is
        0 where it is too close already, inf where they never meet.
        """
        at, speed = self._axes @ moved, self._axes @ direction
        low, high = self._low - at, self._high - at
        still = np.abs(speed) < 1e-12
        # Along an axis on which it does not move it is too close all the way or never.
        never = still & ((low >= 0.0) | (high <= 0.0))
        speed = np.where(still, 1.0, speed)
        low, high = low / speed, high / speed
        enter = np.where(never, np.inf, np.where(still, -np.inf, np.minimum(low, high)))
        leave = np.where(still, np.inf, np.maximum(low, high))
        enter = np.maximum.reduceat(enter, self._first)
        leave = np.minimum.reduceat(leave, self._first)
        return np.where((enter >= leave) | (leave <= 0.0), np.inf, np.maximum(enter, 0.0))

    def are_free(self, translations: Array) -> NDArray[np.bool_]:
        """Which translations, shape (..., 2) [m], bring it too close to none, shape (...)."""
        along = translations @ self._axes.T
        apart = (along <= self._low + _TOUCHING) | (along >= self._high - _TOUCHING)
        return np.asarray(np.logical_or.reduceat(apart, self._first, axis=-1).all(axis=-1))


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
    separation = Separations(moving, [standing], [clearance])
    return float(separation.free_travels(np.zeros(2), direction)[0])


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
    low, high = table.corners_within(margin)
    room = np.where(direction > 0.0, high - corners, corners - low)
    going = np.abs(direction) > 1e-12
    return float((room[:, going] / np.abs(direction[going])).min())


def room_to_edge(corners: Array, table: TableState, margin: float = 0.0) -> float:
    """Least distance of a polygon's corners, shape (n, 2), from a margin of the table's edge [m].

    Less than 0 if a corner is beyond it.
    """
    low, high = table.corners_within(margin)
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


def kept_gap(moving: Array, standing: Array, usual: float) -> float:
    """Clearance that one polygon can keep from another on its way [m].

    Args:
        moving: corners of a convex polygon, shape (n, 2) [m].
        standing: those of another, shape (k, 2) [m].
        usual: the clearance that is to be kept [m].

    Returns:
        Less than the usual one where they are closer already, and less than 0 where they seem to
        overlap: what touches another thing must still get away from it, and along it.
    """
    here = gap(moving, standing)
    return usual if here >= usual else min(CLOSER * here, here - _SEEN)


def _apart(a: Array, b: Array) -> float:
    """The widest gap along the normal of an edge; between two corners it is wider still."""
    axes = np.vstack([_normals(a), _normals(b)])
    pa, pb = a @ axes.T, b @ axes.T
    return float(np.maximum(pa.min(axis=0) - pb.max(axis=0), pb.min(axis=0) - pa.max(axis=0)).max())


def _to_edges(points: Array, polygon: Array) -> float:
    """Least distance of points from the edges of a polygon [m]."""
    edges = _edges(polygon)
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


# Ways around what stands on the table, along the faces of an object.
#
# Model: the object keeps its heading and moves along the normals of two of its faces, so its
# origin goes along the lines of a grid in these two directions. A place is free if the footprint
# keeps the clearance there, along the edges' normals. The shortest way is searched with A* (Hart,
# Nilsson and Raphael 1968); a turn costs as much as a piece of way, since it takes another push.

STEP = 0.02
"""Distance of the grid's lines [m]."""

_AROUND = 0.30  # how far beyond start and end the grid reaches [m]


def shortest_detour(
    target: SeenObject,
    aim: tuple[float, float],
    headings: tuple[float, ...],
    state: WorldState,
    clearances: Mapping[str, float],
    margin: float,
    turn_cost: float,
) -> list[tuple[float, float]] | None:
    """The cheapest way of straight legs, (heading in W [rad], length [m]) each.

    Args:
        target: the object, where the way begins.
        aim: where its origin should be [m].
        headings: in which it can be pushed, in W [rad]; two across each other and their opposites.
        state: what is believed.
        clearances: distance kept from each other object [m].
        margin: distance kept from the table's edge [m].
        turn_cost: way that costs as much as one more leg [m].

    Returns:
        None if there is no way.
    """
    # Two headings that are as square to each other as any.
    pairs = [(a, b) for i, a in enumerate(headings) for b in headings[i + 1 :]]
    first, second = max(pairs, key=lambda pair: abs(math.sin(pair[1] - pair[0])))
    axes = np.column_stack((unit(first)[:2], unit(second)[:2]))
    start, end = (np.linalg.solve(axes, p) for p in (target.pose.p_WB[:2], np.array(aim)))
    lines = [_grid_lines(a, b) for a, b in zip(start, end, strict=True)]
    grid = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1) @ axes.T
    free = _free_places(grid, target, state, clearances, margin)
    here, there = (
        (int(np.argmin(np.abs(lines[0] - x))), int(np.argmin(np.abs(lines[1] - y))))
        for x, y in (start, end)
    )
    steps = {
        heading: move
        for heading, move in (
            (first, (1, 0)),
            (first + math.pi, (-1, 0)),
            (second, (0, 1)),
            (second + math.pi, (0, -1)),
        )
        if any(abs(math.remainder(heading - h, math.tau)) < 1e-6 for h in headings)
    }
    plain = [line.tolist() for line in lines]
    return _cheapest_path(plain, free.tolist(), here, there, steps, turn_cost)


def _grid_lines(a: float, b: float) -> Array:
    """Coordinates of the grid's lines along one axis: through the end, and through the start."""
    low, high = min(a, b) - _AROUND, max(a, b) + _AROUND
    count = np.arange(math.ceil((low - b) / STEP), math.floor((high - b) / STEP) + 1)
    lines = b + STEP * count
    apart = np.abs(lines - a).min()
    return np.asarray(np.sort(np.append(lines, a)) if apart > 1e-9 else lines)


def _free_places(
    grid: Array,
    target: SeenObject,
    state: WorldState,
    clearances: Mapping[str, float],
    margin: float,
) -> NDArray[np.bool_]:
    """Which places of the origin, shape (n, m, 2) [m], are free, shape (n, m)."""
    own = footprint(target) - target.pose.p_WB[:2]
    low, high = state.table.corners_within(margin)
    within = (grid >= low - own.min(axis=0)) & (grid <= high - own.max(axis=0))
    others = [footprint(state.objects[name]) for name in clearances]
    apart = Separations(own, others, [*clearances.values()])
    return np.asarray(within.all(axis=-1)) & apart.are_free(grid)


def _cheapest_path(
    lines: list[list[float]],
    free: list[list[bool]],
    here: tuple[int, int],
    there: tuple[int, int],
    steps: Mapping[float, tuple[int, int]],
    turn_cost: float,
) -> list[tuple[float, float]] | None:
    """The cheapest way over the grid; the start itself need not be free."""
    to_go = [[abs(x - line[k]) for x in line] for line, k in zip(lines, there, strict=True)]
    best: dict[tuple[int, int, float], float] = {}
    # Estimate, cost, number of legs, place, heading of the last leg, legs as a linked list.
    queue: list[tuple[float, float, int, tuple[int, int], float, object]] = [
        (to_go[0][here[0]] + to_go[1][here[1]], 0.0, 0, here, math.inf, None)
    ]
    while queue:
        _, cost, legs, at, heading, way = heapq.heappop(queue)
        if at == there:
            return _joined_legs(way)
        for next_heading, (di, dj) in steps.items():
            i, j = at[0] + di, at[1] + dj
            if not (0 <= i < len(free) and 0 <= j < len(free[i]) and free[i][j]):
                continue
            length = abs(lines[0][i] - lines[0][at[0]] + lines[1][j] - lines[1][at[1]])
            turns = next_heading != heading
            if legs + turns > 4:  # Legs of a way; more pushes than that are not worth it
                continue
            total = cost + length + turn_cost * turns
            if total < best.get((i, j, next_heading), math.inf) - 1e-9:
                best[i, j, next_heading] = total
                estimate = total + (to_go[0][i] + to_go[1][j])
                linked = (way, next_heading, length)
                heapq.heappush(queue, (estimate, total, legs + turns, (i, j), next_heading, linked))
    return None


def _joined_legs(way: object) -> list[tuple[float, float]]:
    """Steps joined to legs, in order."""
    legs: list[tuple[float, float]] = []
    while way is not None:
        assert isinstance(way, tuple)
        way, heading, length = way
        if legs and legs[-1][0] == heading:
            legs[-1] = (heading, legs[-1][1] + length)
        else:
            legs.append((heading, length))
    return legs[::-1]
