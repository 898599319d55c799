"""Loads of the support points, as the centre of pressure moves.

Model: the points are unilateral springs of given weights under a rigid base, so their pressure is
linear over the base and never negative: N_i = w_i max(0, a + b·r_i). The loads follow uniquely from
the centre of pressure q inside the points' hull: Σ N_i = 1, Σ N_i r_i = q (loads in shares of N).
They are the least of the energy ½ Σ w_i max(0, a + b·r_i)² − a − b·q, convex and quadratic as long
as the same points are loaded; Newton's method with a line search finds it in finitely many steps.

Arrays are laid out with the k points first and the n pushes last.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.base_shapes import Array, mean_distance
from objectmodels.geometry.rotations import total

_QUICK = 15  # guesses of the loaded points before they are searched
_STEPS = 80  # of the search for the loaded points; a handful suffices
_HALVINGS = 60
_TOUCHING = 1e-10  # share of the most pressed point's depth that counts as none
_AFTER = 1e-7  # step beyond a change, as a share of the way, to learn which points are loaded then
_BALANCED = 1e-9  # imbalance up to which a set of loaded points counts as the right one
_SETTLED = 1e-13  # imbalance at which loads are found

# Sets of points that carry nothing have no plane.
_SINGULAR = np.errstate(divide="ignore", invalid="ignore", over="ignore")

# Cofactors of a symmetric matrix as products of its upper triangle, and where that stands in it.
_FIRST, _OTHER = np.array([[3, 4, 1, 0, 1, 0], [5, 2, 4, 5, 2, 3]])
_LESS, _TIMES = np.array([[4, 1, 3, 2, 0, 1], [4, 5, 2, 2, 4, 1]])
_SYMMETRIC = np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])


@dataclass(frozen=True)
class Springs:
    """Springs under a base.

    Attributes:
        points: in B, shape (k, 2) [m].
        weights: relative stiffnesses, shape (k,).
    """

    points: Array
    weights: Array

    @cached_property
    def radius(self) -> float:
        """Their friction radius: mean distance from their middle [m]."""
        return mean_distance(self.points, self.weights)

    @cached_property
    def distances(self) -> Array:
        """Distances between them, shape (k, k) [m]."""
        off = self.points[:, None] - self.points
        return np.hypot(off[..., 0], off[..., 1])

    @cached_property
    def spread(self) -> float:
        """Root of their mean squared distance from their middle [m]."""
        return float(np.sqrt(np.var(self.points, axis=0).sum()))

    @_SINGULAR
    def loads(self, q: Array, dq: Array, loaded: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Loads for centres of pressure, and how they change as those move.

        Args:
            q: centres of pressure, shape (2, n) [m], inside the hull of the points.
            dq: their velocities, shape (2, n).
            loaded: which points were loaded at a nearby q, shape (k, n); updated in place.

        Returns:
            Loads N_i and their derivatives along dq, each of shape (k, n).
        """
        _, middle, to_units = self._scaled_points
        return self._scaled_loads(to_units.T @ (q - middle[:, None]), to_units.T @ dq, loaded)

    def _scaled_loads(self, q: Array, dq: Array, loaded: NDArray[np.bool_]) -> tuple[Array, Array]:
        """`loads` in the units of `_scaled_points`."""
        target = _with_row(1.0, q)
        inverse = self._inverse_stiffness(loaded)
        depth = self._plane_depth(_times(inverse, target))
        pressing = _is_pressing(depth)
        (wrong,) = np.nonzero((pressing != loaded).any(axis=0))
        # Mostly the points that a set of points presses are the next better set.
        for _ in range(_QUICK):
            if not wrong.size:
                break
            loaded[:, wrong] = pressing[:, wrong]
            inverse[:, wrong] = self._inverse_stiffness(loaded[:, wrong])
            depth[:, wrong] = self._plane_depth(_times(inverse[:, wrong], target[:, wrong]))
            pressing[:, wrong] = _is_pressing(depth[:, wrong])
            wrong = wrong[(pressing[:, wrong] != loaded[:, wrong]).any(axis=0)]
        # Two points, or some on a line, make equations that only rounding seems to solve.
        off = np.abs(self._imbalance(depth, target)).max(axis=0)
        off[wrong] = np.inf
        (wrong,) = np.nonzero(~(off <= _BALANCED))
        if wrong.size:
            depth[:, wrong] = self._searched_depth(target[:, wrong])
            loaded[:, wrong] = _is_pressing(depth[:, wrong])
            inverse[:, wrong] = self._inverse_stiffness(loaded[:, wrong])
        change = self._plane_depth(_times(inverse, _with_row(0.0, dq)))
        stiffness = self.weights[:, None]
        loads = np.where(loaded, stiffness * np.maximum(depth, 0.0), 0.0)
        return loads, np.where(loaded, stiffness * change, 0.0)

    @_SINGULAR
    def load_changes(
        self, start: Array, moves: Array, last: Array, loaded: NDArray[np.bool_]
    ) -> list[Array]:
        """Ratios r up to last (n,) at which the set of loaded points changes, q = start + r·moves.

        Centres of pressure at r = 0 [m] and their velocities are (2, n), the points that are loaded
        then are (k, n). Each change has its r, shape (n,), in rising order; inf for pushes that
        have no more.
        """
        _, middle, to_units = self._scaled_points
        start, moves = to_units.T @ (start - middle[:, None]), to_units.T @ moves
        n, loaded = last.size, loaded.copy()
        r, found = np.zeros(n), []
        open_ = np.arange(n)
        # For each point; loads come and go at most once or twice.
        for _ in range(3 * len(self.points)):
            here, on = r[open_], loaded[:, open_]
            inverse = self._inverse_stiffness(on)
            depth = self._plane_depth(_times(inverse, _with_row(1.0, start[:, open_])))
            rate = self._plane_depth(_times(inverse, _with_row(0.0, moves[:, open_])))
            change = -depth / rate
            step = _AFTER * last[open_]
            # Loaded points let go as their depth falls to zero, others touch as it rises to it.
            ahead = (change > here + 0.5 * step) & (np.where(on, -rate, rate) > 0.0)
            change = np.where(ahead, change, np.inf).min(axis=0)
            go = change < last[open_] - step
            end = np.full(n, np.inf)
            open_ = open_[go]
            end[open_], r[open_] = change[go], change[go] + step[go]
            if not open_.size:
                break
            found.append(end)
            guess = loaded[:, open_]
            self._scaled_loads(start[:, open_] + r[open_] * moves[:, open_], moves[:, open_], guess)
            loaded[:, open_] = guess
        return found

    @cached_property
    def _scaled_points(self) -> tuple[Array, Array, Array]:
        """Points about their middle with equal spread along all axes, middle, and the map to that.

        Planes stay planes under it, and the equations keep their digits even for points that are
        nearly on a line.
        """
        middle = self.points.mean(axis=0)
        off = self.points - middle
        _, spread, axes = np.linalg.svd(off, full_matrices=False)
        to_units = axes.T / spread * np.sqrt(len(off))
        return off @ to_units, middle, to_units

    @cached_property
    def _moments(self) -> Array:
        """Zeroth, first and second moments of each spring, shape (6, k)."""
        (x, y), w = self._scaled_points[0].T, self.weights
        return np.stack((w, w * x, w * y, w * x * x, w * x * y, w * y * y))

    @cached_property
    def _rows(self) -> Array:
        """The points as rows (1, r_i) of the equations, shape (k, 3)."""
        return np.column_stack((np.ones(len(self.points)), self._scaled_points[0]))

    def _plane_depth(self, plane: Array) -> Array:
        """Depth of each point, a + b·r_i, shape (k, n)."""
        return np.asarray(self._rows @ plane)

    def _searched_depth(self, target: Array) -> Array:
        """Depth of each point under the plane of least energy, shape (k, n)."""
        plane = np.zeros_like(target)
        plane[0] = 1.0 / self.weights.sum()
        open_ = np.arange(target.shape[1])
        for _ in range(_STEPS):
            here, aim = plane[:, open_], target[:, open_]
            depth = self._plane_depth(here)
            down = -self._imbalance(depth, aim)
            settled = np.abs(down).max(axis=0) <= _SETTLED
            # Stiffness added, for where too few points are loaded to fix the base.
            step = _times(self._inverse_stiffness(depth > 0.0, soft=1e-9), down)
            plane[:, open_] = here + np.where(
                settled, 0.0, self._step_share(here, step, aim) * step
            )
            open_ = open_[~settled]
            if not open_.size:
                break
        return self._plane_depth(plane)

    def _imbalance(self, depth: Array, target: Array) -> Array:
        """Slope of the energy: Σ N_i (1, r_i) − (1, q), shape (3, n)."""
        return np.asarray(self._moments[:3] @ np.maximum(depth, 0.0) - target)

    def _plane_energy(self, plane: Array, target: Array) -> Array:
        depth = np.maximum(self._plane_depth(plane), 0.0)
        return np.asarray(0.5 * self.weights @ depth**2 - (plane * target).sum(axis=0))

    def _step_share(self, plane: Array, step: Array, target: Array) -> Array:
        """Share of each step that lowers the energy, shape (n,)."""
        share, before = np.ones(plane.shape[1]), self._plane_energy(plane, target)
        # Rounding of the energy must not stop a step that is as good as at its end.
        allowed = before + 1e-15 * np.abs(before)
        for _ in range(_HALVINGS):
            worse = self._plane_energy(plane + share * step, target) > allowed
            if not worse.any():
                break
            share[worse] *= 0.5
        return share

    def _inverse_stiffness(self, loaded: NDArray[np.bool_], soft: float = 0.0) -> Array:
        """Inverse of Σ w_i (1, r_i)(1, r_i)ᵀ over the loaded points: its upper triangle, (6, n)."""
        s = self._moments @ loaded
        if soft:
            s[[0, 3, 5]] += soft
        cofactors = s[_FIRST] * s[_OTHER] - s[_LESS] * s[_TIMES]
        return np.asarray(cofactors / total(s[:3] * cofactors[:3]))


def _with_row(value: float, q: Array) -> Array:
    """Vectors (value, q), shape (3, n)."""
    row = np.empty((3, q.shape[1]))
    row[0], row[1:] = value, q
    return row


def _times(inverse: Array, v: Array) -> Array:
    """Products of symmetric matrices, given as upper triangles, with vectors, shape (3, n)."""
    return np.asarray((inverse[_SYMMETRIC] * v).sum(axis=1))


def _is_pressing(depth: Array) -> NDArray[np.bool_]:
    """Return True for loaded points; those that just touch count, so that there are three."""
    # No base presses a point in so far, in units of a mean load.
    return np.asarray(depth > -_TOUCHING * np.minimum(np.abs(depth).max(axis=0), 1e3))
