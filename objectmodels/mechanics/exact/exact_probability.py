"""Probability that an uncertain object slides or topples first, by the exact tier.

Model: as `objectmodels.mechanics.outcome_probability`, with the critical friction μ* of the exact
tier: given the centre of mass and the friction radius the loads do not depend on the friction, so
that this integrates in closed form again. The others are averaged over a fixed sequence.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.exact.exact_thresholds import springs_of
from objectmodels.mechanics.exact.slide_search import SlideSearch, Standing, push_blocks
from objectmodels.mechanics.outcome_probability import (
    Likelihood,
    draw_parameters,
    friction_below,
    normal_nodes,
)
from objectmodels.mechanics.push_thresholds import ratio_at, topple_threshold

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody

DRAWS = 64
"""Points of the sequence that a probability is averaged over."""

_NO_END = np.array([np.inf])


def exact_likelihood(
    model: PushedBody, p: Array, u: Array, force: float | None = None
) -> Likelihood:
    """See `ObjectModel.likelihood`, which checks its arrays."""
    if force is not None:
        raise ModelError(
            "bad_value",
            "the exact tier tells probabilities at the onset, not with a force",
            suggestions=("leave out the force", "leave out `exact`"),
        )
    draw, n = draw_parameters(model, normal_nodes(DRAWS)), len(p)
    p, u = np.repeat(p, DRAWS, axis=0), np.repeat(u, DRAWS, axis=0)
    com, radius, friction = (
        np.tile(each, (n, *(1,) * (each.ndim - 1)))
        for each in (draw.com, draw.friction_radius, draw.friction)
    )
    springs, topples = springs_of(model), topple_threshold(model.base, p, u, com, 1.0)
    tips, critical = ratio_at(topples, u[:, 2], 1.0), np.empty(len(p))
    for b in push_blocks(len(p), springs):
        scale = radius[b] / springs.radius
        body = Standing(model.base, springs, scale, _NO_END, com[b, :2])
        critical[b] = SlideSearch(body, p[b], u[b], tips[b]).critical_friction()
    below = friction_below(model, critical, friction, draw.friction_sd)
    above = np.where(np.isinf(topples), 0.0, 1.0 - below)
    slide, topple = (each.reshape(n, DRAWS).mean(axis=1) for each in (below, above))
    none = np.clip(1.0 - slide - topple, 0.0, 1.0)
    return Likelihood(none, slide, topple, "exact tier", DRAWS, None)
