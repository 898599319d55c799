"""Loads of the support points, as the centre of pressure moves.

Model: the points are unilateral springs of given weights under a rigid base, so their pressure is
linear over the base and never negative: N_i = w_i max(0, a + b·r_i). The loads follow uniquely from
the centre of pressure q inside the points' hull: Σ N_i = 1, Σ N_i r_i = q (loads in shares of N).

Arrays are laid out with the k points first and the n pushes last.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from objectmodels.base import Array

# Changes of the set of loaded points until the loads fit; a few suffice, a cycle is cut by halves.
_MAX_CHANGES = 60


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
        x, y = self.points.T[:, :, None]
        gap, solve = self._pressed(q, loaded)
        # Where the guess was wrong the set of loaded points is searched, one push after another.
        wrong = np.flatnonzero(((gap > 0.0) != loaded).any(axis=0))
        if wrong.size:
            found = loaded[:, wrong]
            for _ in range(_MAX_CHANGES):
                new = self._pressed(q[:, wrong], found)[0] > 0.0
                if np.array_equal(new, found):
                    break
                found = new
            loaded[:, wrong] = found
            gap, solve = self._pressed(q, loaded)
        a, b, c = solve(np.zeros(q.shape[1]), dq[0], dq[1])
        stiffness = self.weights[:, None] * loaded
        return stiffness * np.maximum(gap, 0.0), stiffness * (a + x * b + y * c)

    def _pressed(self, q: Array, loaded: NDArray[np.bool_]):  # type: ignore[no-untyped-def]
        """How far each point is pressed in if the given ones are loaded, and the solver for it."""
        solve = self._solver(loaded)
        a, b, c = solve(np.ones(q.shape[1]), q[0], q[1])
        x, y = self.points.T[:, :, None]
        return a + x * b + y * c, solve

    def _solver(self, loaded: NDArray[np.bool_]):  # type: ignore[no-untyped-def]
        """Solves Σ w_i (1, x, y)(1, x, y)ᵀ (a, b, c) = rhs over the loaded points, by cofactors."""
        (x, y), w = self.points.T, self.weights
        moments = np.stack((w, w * x, w * y, w * x * x, w * x * y, w * y * y)) @ loaded
        m, mx, my, xx, xy, yy = moments
        c00, c01, c02 = xx * yy - xy * xy, xy * my - mx * yy, mx * xy - xx * my
        c11, c12, c22 = m * yy - my * my, mx * my - m * xy, m * xx - mx * mx
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = 1.0 / (m * c00 + mx * c01 + my * c02)

        def solve(r0: Array, r1: Array, r2: Array) -> tuple[Array, Array, Array]:
            return (
                (c00 * r0 + c01 * r1 + c02 * r2) * scale,
                (c01 * r0 + c11 * r1 + c12 * r2) * scale,
                (c02 * r0 + c12 * r1 + c22 * r2) * scale,
            )

        return solve
