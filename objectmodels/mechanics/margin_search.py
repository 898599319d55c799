"""Search for the direction in a fingertip's friction cone in which a margin is least.

Directions are *shares* of the cone, in the unit disc; see `objectmodels.mechanics.friction_cone`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.base_shapes import Array

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Index = NDArray[np.int64]

STEPS = (0.1, 0.05, 0.025, 0.0125)
"""Steps of the search, in shares."""


def circle_corners(k: int) -> Array:
    """The corners of a regular k-gon in the unit circle, shape (k, 2)."""
    phi = 2.0 * np.pi * np.arange(k) / k
    return np.column_stack((np.cos(phi), np.sin(phi)))


def refine_directions(
    value: Callable[[Array], Array], shares: Array, best: Array, limit: float
) -> Array:
    """Smallest value near given directions, by a compass search with shrinking steps, (n,).

    `value` maps shares (n, j, 2) to what is to be small (n, j); the search begins at shares (n, 2),
    where it is `best`, (n,), and which stay in the disc of radius `limit`.
    """
    compass, rows = circle_corners(8), np.arange(len(shares))
    for step in STEPS:
        tries = shares[:, None, :] + step * compass
        length = np.hypot(tries[..., :1], tries[..., 1:])
        tries = tries * np.minimum(1.0, limit / np.maximum(length, 1e-12))
        values = value(tries)
        j = values.argmin(axis=1)
        better = values[rows, j] < best
        shares = np.where(better[:, None], tries[rows, j], shares)
        best = np.where(better, values[rows, j], best)
    return best


@dataclass(frozen=True)
class MarginSearch:
    """Search for the least margin of each contact over the cone.

    It starts from the worst direction of each quadrant of the cone that comes near the worst of
    all, since there may be several minima.

    Attributes:
        least: over fixed directions, shape (n,) [N].
        starts: shares to search from, a quadrant each, shape (4, n, 2).
        at_starts: margins there, shape (4, n) [N].
        near: which of them come near enough, shape (4, n).
        margin: maps contacts (m,) and shares (m, j, 2) to margins (m, j) [N].
        radius: of the disc that shares must stay in.
    """

    least: Array
    starts: Array
    at_starts: Array
    near: NDArray[np.bool_]
    margin: Callable[[Index, Array], Array]
    radius: float

    @classmethod
    def begin(
        cls,
        margins: Array,
        shares: Array,
        margin: Callable[[Index, Array], Array],
        near: float,
        radius: float,
    ) -> MarginSearch:
        """The search after the margins (n, j) of fixed directions, shares (n, j, 2).

        Args:
            margins: in those directions [N].
            shares: the directions.
            margin: that of any directions, as of the class.
            near: by how much a start may exceed the least margin [N].
            radius: of the disc that shares must stay in.
        """
        least, rows = margins.min(axis=1), np.arange(len(margins))
        quadrant = 2 * (shares[..., 0] > 0.0) + (shares[..., 1] > 0.0)
        inside = np.where(quadrant == np.arange(4)[:, None, None], margins, np.inf)
        j = inside.argmin(axis=2)
        at_starts = inside[np.arange(4)[:, None], rows, j]
        return cls(least, shares[rows, j], at_starts, at_starts <= least + near, margin, radius)

    def least_margin(self) -> Array:
        """Least margin of each contact, refined where it is positive, shape (n,) [N]."""
        least = self.least.copy()
        q, i = np.nonzero(self.near & (least > 0.0))
        found = np.full(self.near.shape, np.inf)
        found[q, i] = refine_directions(
            partial(self.margin, i), self.starts[q, i], self.at_starts[q, i], self.radius
        )
        for each in found:
            least = np.where(least > 0.0, np.minimum(least, each), least)
        return least
