"""Where a lid may be put aside: free places of the table, near the object that it belongs to."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.base_shapes import Array, Disc
from objectmodels.geometry.support_points import hull
from planner.geometry.footprints import footprint, gap, travel_to_edge
from planner.types.plan import Aim

if TYPE_CHECKING:
    from collections.abc import Iterator

    from planner.problem.planning_problem import Task

_RINGS = np.arange(0.0, 0.25, 0.04)  # beyond the nearest place [m]
_AROUND = np.arange(12) * math.tau / 12.0
_ROOM = 0.05  # between a lid and what stands near it, for the fingers that let go of it [m]
_AXES = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])


def spots(task: Task, radius: float, most: int) -> list[tuple[Aim, float]]:
    """Free places for a disc, the nearest first, and what is tallest on the way to each [m].

    Args:
        task: about the object whose lid it is.
        radius: of the lid [m].
        most: how many places.
    """
    free = (found for found in _near(task, radius) if _is_free(task, found, radius))
    return [
        (Aim(x=float(at[0]), y=float(at[1])), _tallest(task, at, radius))
        for _, at in zip(range(most), free, strict=False)
    ]


def _near(task: Task, radius: float) -> Iterator[Array]:
    """Places around the object, ring after ring, shape (2,) [m]."""
    own = footprint(task.target)
    middle = task.target.pose.p_WB[:2]
    nearest = float(np.linalg.norm(own - middle, axis=1).max()) + radius + _ROOM
    for ring in _RINGS:
        for angle in _AROUND:
            yield middle + (nearest + ring) * np.array([math.cos(angle), math.sin(angle)])


def _disc(at: Array, radius: float) -> Array:
    return np.asarray(at + Disc(radius).corners)


def _is_free(task: Task, at: Array, radius: float) -> bool:
    lid, d = _disc(at, radius), task.defaults
    if min(travel_to_edge(lid, task.state.table, u, d.clearance) for u in _AXES) < 0.0:
        return False
    return all(gap(lid, footprint(seen)) >= _ROOM for seen in task.state.objects.values())


def _tallest(task: Task, at: Array, radius: float) -> float:
    start = _disc(task.target.pose.p_WB[:2], radius)
    way = hull(np.vstack([start, _disc(at, radius)])).vertices
    return max(
        seen.bulk()[1]
        for seen in task.state.objects.values()
        if seen is task.target or gap(way, footprint(seen)) < task.defaults.clearance
    )
