"""Ways around what stands on the table, along the faces of an object.

Model: the object keeps its heading and moves along the normals of two of its faces, so its origin
goes along the lines of a grid in these two directions. A place is free if the footprint keeps the
clearance there, along the edges' normals. The shortest way is searched with A* (Hart, Nilsson and
Raphael 1968); a turn costs as much as a piece of way, since it takes another push.

Frames: W, its table plane.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.base_shapes import Array
from planner.geometry.directions import unit
from planner.geometry.footprints import Separations, footprint
from planner.types.world_state import SeenObject, WorldState

STEP = 0.02
"""Distance of the grid's lines [m]."""

MOST_LEGS = 4
"""Legs of a way; more pushes than that are not worth it."""

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
    first, second = _square_headings(headings)
    axes = np.column_stack((unit(first)[:2], unit(second)[:2]))
    start, end = (np.linalg.solve(axes, p) for p in (target.pose.p_WB[:2], np.array(aim)))
    lines = [_grid_lines(a, b) for a, b in zip(start, end, strict=True)]
    grid = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1) @ axes.T
    free = _free_places(grid, target, state, clearances, margin)
    here, there = (_nearest_lines(lines, p) for p in (start, end))
    steps = {
        heading: move
        for heading, move in (
            (first, (1, 0)), (first + math.pi, (-1, 0)),
            (second, (0, 1)), (second + math.pi, (0, -1)),
        )
        if any(abs(math.remainder(heading - h, math.tau)) < 1e-6 for h in headings)
    }  # fmt: skip
    plain = [line.tolist() for line in lines]
    return _cheapest_path(plain, free.tolist(), here, there, steps, turn_cost)


def _square_headings(headings: tuple[float, ...]) -> tuple[float, float]:
    """Two headings that are as square to each other as any."""
    pairs = [(a, b) for i, a in enumerate(headings) for b in headings[i + 1 :]]
    return max(pairs, key=lambda pair: abs(math.sin(pair[1] - pair[0])))


def _grid_lines(a: float, b: float) -> Array:
    """Coordinates of the grid's lines along one axis: through the end, and through the start."""
    low, high = min(a, b) - _AROUND, max(a, b) + _AROUND
    count = np.arange(math.ceil((low - b) / STEP), math.floor((high - b) / STEP) + 1)
    lines = b + STEP * count
    apart = np.abs(lines - a).min()
    return np.asarray(np.sort(np.append(lines, a)) if apart > 1e-9 else lines)


def _nearest_lines(lines: list[Array], p: Array) -> tuple[int, int]:
    """The lines through a point."""
    i, j = (int(np.argmin(np.abs(line - x))) for line, x in zip(lines, p, strict=True))
    return i, j


def _free_places(
    grid: Array,
    target: SeenObject,
    state: WorldState,
    clearances: Mapping[str, float],
    margin: float,
) -> NDArray[np.bool_]:
    """Which places of the origin, shape (n, m, 2) [m], are free, shape (n, m)."""
    own = footprint(target) - target.pose.p_WB[:2]
    table = state.table
    low = np.array([table.x_min, table.y_min]) + margin - own.min(axis=0)
    high = np.array([table.x_max, table.y_max]) - margin - own.max(axis=0)
    free = np.asarray(((grid >= low) & (grid <= high)).all(axis=-1))
    others = [footprint(state.objects[name]) for name in clearances]
    return free & Separations(own, others, [*clearances.values()]).are_free(grid)


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
            if legs + turns > MOST_LEGS:
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
