"""A free way for the arm from one pose to another, by way of others where it must.

Model: a road map in joint space whose roads are looked at only when a shortest way takes them (a
lazy probabilistic road map). First the map has a few places that mostly do; if they do not, places
drawn from a fixed seed are added. How much is looked at is bounded, so that a way that does not
exist costs little; where some roads are blocked, all from the start or to the goal are looked at
coarsely together, which takes hardly longer than a few.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.rotations import Array
from objectmodels.safety_figure import SafetyFigure
from sim.robots.arm import ArmKinematics

LIMIT_MARGIN: SafetyFigure = 0.08
"""Least room to the joint limits on any way [rad]."""

_COARSE = 8  # of the poses along a road, the first looked at


def free_path(
    arm: ArmKinematics,
    start: Array,
    goal: Array,
    places: Array,
    is_free: Callable[[Array], NDArray[np.bool_]],
    spend: Callable[[], None] = lambda: None,
) -> tuple[Array, ...] | None:
    """Arm poses between start and goal, joined by straight lines that are free.

    Args:
        arm: that moves.
        start: its angles, shape (joints,) [rad].
        goal: the same at its end.
        places: that the way may take where the joints have room, shape (n, joints) [rad].
        is_free: which arm poses, shape (n, joints), keep clear of everything, shape (n,).
        spend: called for the places, and whenever a road is looked at, coarsely or closely.

    Returns:
        None if no way was found.
    """
    nodes = np.vstack([start, goal, places[arm.joint_room(places) >= LIMIT_MARGIN]])
    spend()
    # The straight road is looked at first, so at once.
    free = is_free(np.vstack([nodes, interpolate_joints(start, goal)[::_COARSE]]))
    free, straight = free[: len(nodes)], bool(free[len(nodes) :].all())
    if not free[:2].all():
        return None
    nodes = nodes[free]
    roads = _Roads(nodes, is_free, spend, straight=straight)
    # Coming to rest at a place costs as much as half a radian to go.
    length = np.linalg.norm(nodes[:, None] - nodes, axis=-1) + 0.5
    for _ in range(60):
        way = _shortest_path(length)
        if way is None:
            return None
        road = roads.first_blocked(way)
        if road is None:
            return tuple(nodes[way[1:-1]])
        length[road] = length[road[::-1]] = np.inf
    return None


def sample_configurations(start: Array, goal: Array) -> Array:
    """Places about start and goal, always the same, shape (n, joints) [rad]."""
    low, high = np.minimum(start, goal) - 1.0, np.maximum(start, goal) + 1.0
    return np.random.default_rng(0).uniform(low, high, (80, len(start)))


def interpolate_joints(start: Array, goal: Array) -> Array:
    """Arm poses on the straight line in joint space, close enough to be looked at one by one."""
    n = int(np.ceil(np.abs(goal - start).max() / 0.05)) + 1
    return np.asarray(start + np.linspace(0.0, 1.0, n)[:, None] * (goal - start))


class _Roads:
    """The straight roads between nodes, node 0 the start and node 1 the goal.

    Whether the `straight` one between these is free, coarsely looked at, is known.
    """

    def __init__(
        self,
        nodes: Array,
        is_free: Callable[[Array], NDArray[np.bool_]],
        spend: Callable[[], None],
        *,
        straight: bool,
    ) -> None:
        self.nodes, self._is_free, self._spend = nodes, is_free, spend
        self._coarsely, self._closely = {(0, 1): straight}, dict[tuple[int, int], bool]()
        # How many roads are looked at one by one.
        self._singly = 4 if len(nodes) > 10 else 1

    def first_blocked(self, way: list[int]) -> tuple[int, int] | None:
        """The first road of a way that is not free; None if all are."""
        roads = [*itertools.pairwise(way)]
        # Most that are not free show it in a few poses.
        for look in (self._is_free_coarsely, self._is_free_closely):
            for road in roads:
                if not look(road):
                    return road
        return None

    def _is_free_coarsely(self, road: tuple[int, int]) -> bool:
        if road not in self._coarsely:
            self._spend()
            roads = {road}
            if len(self._coarsely) >= self._singly:
                roads |= {(0, k) for k in range(1, len(self.nodes))}
                roads |= {(k, 1) for k in range(2, len(self.nodes))}
            new = sorted(roads - self._coarsely.keys())
            poses = [self._poses(each)[::_COARSE] for each in new]
            free = self._is_free(np.concatenate(poses))
            first = np.cumsum([0, *map(len, poses[:-1])])
            self._coarsely |= zip(new, np.logical_and.reduceat(free, first).tolist(), strict=True)
        return self._coarsely[road]

    def _is_free_closely(self, road: tuple[int, int]) -> bool:
        if road not in self._closely:
            self._spend()
            self._closely[road] = bool(self._is_free(self._poses(road)).all())
        return self._closely[road]

    def _poses(self, road: tuple[int, int]) -> Array:
        return interpolate_joints(self.nodes[road[0]], self.nodes[road[1]])


def _shortest_path(length: Array) -> list[int] | None:
    """Nodes of the shortest way from node 0 to node 1 (Dijkstra)."""
    n = len(length)
    far, before, done = np.full(n, np.inf), np.zeros(n, dtype=int), np.zeros(n, dtype=bool)
    far[0] = 0.0
    while not done[1]:
        here = int(np.argmin(np.where(done, np.inf, far)))
        if done[here] or np.isinf(far[here]):
            return None
        done[here] = True
        shorter = far[here] + length[here] < far
        far[shorter], before[shorter] = (far[here] + length[here])[shorter], here
    way = [1]
    while way[-1] != 0:
        way.append(int(before[way[-1]]))
    return way[::-1]
