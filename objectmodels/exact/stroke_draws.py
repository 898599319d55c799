"""Poses to which a stroke may bring an object of which not all is known.

Model: strokes on the loaded support points, for parameters along a fixed sequence that stands for
what is believed of them: centre of mass, friction radius, friction at the finger. The friction at
the table only counts by how far a high push shifts the load; its mean is taken.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objectmodels.exact.exact_thresholds import springs_of
from objectmodels.exact.top_drag import LoadedPoints
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.outcome_probability import draw_parameters, normal_nodes
from objectmodels.mechanics.push_motion import MODES, integrate_stroke

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody


DRAWS = 64
"""Points of the sequence that a distribution is made of."""


@dataclass(frozen=True)
class StrokeDraws:
    """Ends of n strokes, for each of `DRAWS` objects.

    Attributes:
        pose: x, y [m], θ [rad] of B at the end, in B at the start, shape (DRAWS, n, 3).
        mode: what the fingers do at the end, of `push_motion.MODES`, shape (DRAWS, n).
    """

    pose: Array
    mode: NDArray[np.str_]

    @property
    def mean(self) -> Array:
        """Mean pose, shape (n, 3)."""
        return np.asarray(self.pose.mean(axis=0))

    @property
    def covariance(self) -> Array:
        """Covariance of x, y, θ, shape (n, 3, 3)."""
        off = self.pose - self.mean
        return np.asarray(np.einsum("dni,dnj->nij", off, off) / (len(off) - 1))

    @property
    def lost(self) -> Array:
        """Probability that the finger has left its face, shape (n,)."""
        return np.asarray((self.mode == MODES[-1]).mean(axis=0))


def stroke_draws(
    model: PushedBody,
    points: ArrayLike,
    normals: ArrayLike,
    direction: ArrayLike,
    travel: ArrayLike,
    *,
    tip_radius: float = 0.0,
) -> StrokeDraws:
    """Distribution of the poses after strokes; arguments as of `ObjectModel.stroke`.

    Raises:
        ModelError: `bad_array`, `bad_value`.
    """
    draw, n = draw_parameters(model, normal_nodes(DRAWS)), len(np.asarray(points))
    arguments = ((points, 2), (normals, 2), (direction, 2), (travel, 1))
    p, normal, d, way = (_for_each_draw(value, rank) for value, rank in arguments)

    def law_of(body: PushedBody, heights: Array) -> LoadedPoints:
        return LoadedPoints.of_draws(
            springs_of(body),
            com=np.repeat(draw.com[:, :2], n, axis=0),
            finger_friction=np.repeat(draw.finger_friction, n),
            radius=np.repeat(draw.friction_radius, n),
            lever=body.friction * heights,
        )

    stroke = integrate_stroke(model, p, normal, d, way, tip_radius, law_of)
    return StrokeDraws(stroke.pose.reshape(DRAWS, n, 3), stroke.mode.reshape(DRAWS, n))


def _for_each_draw(values: ArrayLike, rank: int) -> Array:
    """An argument of n strokes, repeated for all draws; of lower rank it is shared by all."""
    found = np.asarray(values, dtype=np.float64)
    return found if found.ndim < rank else np.tile(found, (DRAWS, *(1,) * (found.ndim - 1)))
