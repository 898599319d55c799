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

from objectmodels.geometry.base_shapes import Array

_QUICK = 6  # guesses of the loaded points before they are searched
_STEPS = 80  # of the search for the loaded points; a handful suffices
_HALVINGS = 60
_SOFT = 1e-9  # stiffness added, for where too few points are loaded to fix the base
_TOUCHING = 1e-10  # share of the most pressed point's depth that counts as none
_AFTER = 1e-7  # step beyond a change, as a share of the way, to learn which points are loaded then
_MOST_CHANGES = 3  # for each point; loads come and go at most once or twice
_DEEP = 1e3  # no base presses a point in so far, in units of a mean load
_BALANCED = 1e-9  # imbalance up to which a set of loaded points counts as the right one
_SETTLED = 1e-13  # imbalance at which loads are found


@dataclass(frozen=True)
class Springs:
    """Springs under a base.

    Attributes:
        points: in B, shape (k, 2) [m].
        weights: relative stiffnesses, shape (k,).
    """

    points: Array
    weights: Array

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
        """`loads` in the units of `_units`."""
        gap = self._carried_depth(q, loaded)
        wrong = np.flatnonzero(self._are_wrong(gap, q, loaded))
        # Mostly the points that a set of points presses are the next better set.
        for _ in range(_QUICK):
            if not wrong.size:
                break
            new = _is_pressing(gap[:, wrong])
            loaded[:, wrong] = new
            gap[:, wrong] = self._carried_depth(q[:, wrong], new)
            wrong = wrong[self._are_wrong(gap[:, wrong], q[:, wrong], new)]
        if wrong.size:
            loaded[:, wrong] = self._search_loaded(q[:, wrong])
            gap[:, wrong] = self._carried_depth(q[:, wrong], loaded[:, wrong])
        change = self._plane_depth(self._solve_plane(loaded, np.zeros(q.shape[1]), dq[0], dq[1]))
        stiffness = np.broadcast_to(self.weights[:, None], loaded.shape)
        loads = np.where(loaded, stiffness * np.maximum(gap, 0.0), 0.0)
        return loads, np.where(loaded, stiffness * change, 0.0)

    def load_changes(self, start: Array, moves: Array, last: Array) -> list[Array]:
        """Ratios r up to last (n,) at which the set of loaded points changes, q = start + r·moves.

        Centres of pressure at r = 0 [m] and their velocities are (2, n). Each change has its r,
        shape (n,), in rising order; inf for pushes that have no more.
        """
        _, middle, to_units = self._scaled_points
        start, moves = to_units.T @ (start - middle[:, None]), to_units.T @ moves
        n = last.size
        loaded = np.ones((len(self.points), n), dtype=bool)
        self._scaled_loads(start, moves, loaded)
        r, found = np.zeros(n), []
        open_ = np.arange(n)
        for _ in range(_MOST_CHANGES * len(self.points)):
            here, on = r[open_], loaded[:, open_]
            depth = self._carried_depth(start[:, open_], on)
            zero = np.zeros(open_.size)
            rate = self._plane_depth(self._solve_plane(on, zero, *moves[:, open_]))
            with np.errstate(divide="ignore", invalid="ignore"):
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

    def _carried_depth(self, q: Array, loaded: NDArray[np.bool_]) -> Array:
        """Depth of each point if the given ones carry the load, shape (k, n)."""
        return self._plane_depth(self._solve_plane(loaded, np.ones(q.shape[1]), q[0], q[1]))

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

    def _are_wrong(self, depth: Array, q: Array, loaded: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return True for sets of points that do not carry the loads, or press others, (n,)."""
        others = (_is_pressing(depth) != loaded).any(axis=0)
        # Two points, or some on a line, make equations that only rounding seems to solve.
        with np.errstate(invalid="ignore"):
            off = np.abs(self._depth_imbalance(depth, np.vstack((np.ones(q.shape[1]), q)))).max(
                axis=0
            )
        return np.asarray(others | ~(off <= _BALANCED))

    def _plane_depth(self, plane: Array) -> Array:
        """Depth of each point, a + b·r_i, shape (k, n)."""
        x, y = self._scaled_points[0].T[:, :, None]
        with np.errstate(invalid="ignore", over="ignore"):  # of sets that carry nothing
            return np.asarray(plane[0] + x * plane[1] + y * plane[2])

    def _search_loaded(self, q: Array) -> NDArray[np.bool_]:
        """The points that are loaded, shape (k, n)."""
        target = np.vstack((np.ones(q.shape[1]), q))
        plane = np.zeros_like(target)
        plane[0] = 1.0 / self.weights.sum()
        open_ = np.arange(q.shape[1])
        for _ in range(_STEPS):
            here, aim = plane[:, open_], target[:, open_]
            down = -self._plane_imbalance(here, aim)
            settled = np.abs(down).max(axis=0) <= _SETTLED
            step = self._solve_plane(
                self._plane_depth(here) > 0.0, down[0], down[1], down[2], soft=_SOFT
            )
            plane[:, open_] = here + np.where(
                settled, 0.0, self._step_share(here, step, aim) * step
            )
            open_ = open_[~settled]
            if not open_.size:
                break
        return _is_pressing(self._plane_depth(plane))

    def _plane_imbalance(self, plane: Array, target: Array) -> Array:
        """Slope of the energy: Σ N_i (1, r_i) − (1, q), shape (3, n)."""
        return self._depth_imbalance(self._plane_depth(plane), target)

    def _depth_imbalance(self, depth: Array, target: Array) -> Array:
        loads = self.weights[:, None] * np.maximum(depth, 0.0)
        return np.vstack((loads.sum(axis=0), self._scaled_points[0].T @ loads)) - target

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

    def _solve_plane(
        self, loaded: NDArray[np.bool_], r0: Array, r1: Array, r2: Array, soft: float = 0.0
    ) -> Array:
        """(a, b) with Σ w_i (1, r_i)(1, r_i)ᵀ (a, b) = rhs over the loaded points, (3, n)."""
        m, mx, my, xx, xy, yy = self._moments @ loaded
        m, xx, yy = m + soft, xx + soft, yy + soft
        c00, c01, c02 = xx * yy - xy * xy, xy * my - mx * yy, mx * xy - xx * my
        c11, c12, c22 = m * yy - my * my, mx * my - m * xy, m * xx - mx * mx
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            scale = 1.0 / (m * c00 + mx * c01 + my * c02)
            return np.stack(
                (
                    (c00 * r0 + c01 * r1 + c02 * r2) * scale,
                    (c01 * r0 + c11 * r1 + c12 * r2) * scale,
                    (c02 * r0 + c12 * r1 + c22 * r2) * scale,
                )
            )


def _is_pressing(depth: Array) -> NDArray[np.bool_]:
    """Return True for loaded points; those that just touch count, so that there are three."""
    return np.asarray(depth > -_TOUCHING * np.minimum(np.abs(depth).max(axis=0), _DEEP))
