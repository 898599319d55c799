"""Probability that an uncertain object slides first, topples first, or stays, by the exact tier.

Model: as `objectmodels.mechanics.outcome_probability`, with the critical friction μ* of the exact
tier: given the centre of mass and the friction radius the loads do not depend on the friction, so
that this integrates in closed form again. The others are averaged over a fixed sequence. A given
force ends the push before it topples: then μ* is the friction that is used up to there, and the
mass, which says how much of the weight that force is, is averaged over too.
"""

from __future__ import annotations

from statistics import NormalDist
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from objectmodels.exact.exact_thresholds import springs_of
from objectmodels.exact.slide_search import SlideSearch, Standing, push_blocks
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.rotations import require_amount
from objectmodels.mechanics.friction_cone import cone_directions, contact_forces
from objectmodels.mechanics.outcome_probability import (
    Draws,
    Likelihood,
    draw_parameters,
    friction_below,
    normal_cdf,
    normal_nodes,
)
from objectmodels.mechanics.push_thresholds import ratio_at, topple_threshold

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody


DRAWS = 64
"""Points of the sequence that a probability is averaged over."""

RING = 8
"""Directions around a finger's cone of which the least probable one is found."""

_RAREST = 1e-9  # rank of the least mass
_UPRIGHT = 1e-9  # share of the friction sideways that counts as none
_NO_END = np.array([np.inf])


def exact_likelihood(
    model: PushedBody, p: Array, u: Array, force: float | None = None
) -> Likelihood:
    """See `ObjectModel.likelihood`, which checks its arrays."""
    if force is None:
        draw = draw_parameters(model, normal_nodes(DRAWS))
        slide, topple = _probabilities(model, p[:, None, :], u[:, None, :], draw)
    else:
        require_amount(force, "a force of", "give it in newtons; without one, any force is meant")
        each = [_with_force(model, *push, force) for push in zip(p, u, strict=True)]
        slide, topple = np.reshape(each, (-1, 2)).T
    none = np.clip(1.0 - slide - topple, 0.0, 1.0)
    return Likelihood(none, slide, topple, "exact tier", DRAWS, None)


def _with_force(model: PushedBody, p: Array, u: Array, force: float) -> tuple[float, float]:
    """Probabilities that a force slides it first, and that it topples it first.

    Each draw is split at the mass from which on the force does not topple it: there the outcome
    jumps.
    """
    z = normal_nodes(DRAWS, mass=True)
    others, mass = z[:, :4], z[:, 4]
    light, heavy = (
        draw_parameters(model, np.column_stack((others, np.full(DRAWS, at)))) for at in (0.0, 1.0)
    )
    topples = topple_threshold(model.base, p, u, light.com, 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        split = normal_cdf((force / topples - light.weight) / (heavy.weight - light.weight))
    share = np.nan_to_num(split)
    rank = normal_cdf(mass)
    parts = [(share, share * rank), (1.0 - share, share + (1.0 - share) * rank)]
    found = np.zeros(2)
    for weights, ranks in parts:
        drawn = np.column_stack((others, _normal_deviates(ranks)))
        args = p[None, None], u[None, None], draw_parameters(model, drawn)
        found += np.ravel(_probabilities(model, *args, force=force, weights=weights))
    return float(found[0]), float(found[1])


def _normal_deviates(ranks: Array) -> Array:
    """Standard normal deviates of ranks in [0, 1], shape (k,)."""
    inverse = NormalDist().inv_cdf
    return np.array([inverse(rank) for rank in np.clip(ranks, _RAREST, 1.0 - _RAREST).tolist()])


def least_probability(
    model: PushedBody,
    p: Array,
    normal: Array,
    outcome: Literal["slide", "topple"],
    *,
    aside: bool = True,
    topples_at: float = 1.0,
) -> float:
    """Probability of an outcome at onset, whatever the finger transmits at a contact.

    The direction of a ring around the friction cone counts that is the worst one for the nominal
    parameters.

    Args:
        model: what is believed.
        p: contact point p_BC, shape (3,) [m].
        normal: outward unit normal of the face there in B, not vertical, shape (3,).
        outcome: that is wanted.
        aside: whether the finger may press sideways too, or up and down only.
        topples_at: share of the force to topple it from which on a slide is none any more.
    """
    com, reach, at = np.array(model.com), model.finger_friction, np.array(p)[None]
    shares = cone_directions(at, normal[None], com, reach, RING)[0]
    if not aside:
        shares = shares[np.abs(shares[:, 0]) < _UPRIGHT]
    u = contact_forces(normal, reach * shares)
    nominal = draw_parameters(model, np.zeros((1, 4)))
    tips, critical = _critical_frictions(model, at[:, None], u[:, None], nominal, topples_at)
    worst = np.argmin(critical if outcome == "slide" else np.where(tips, -critical, -np.inf))
    draw = draw_parameters(model, normal_nodes(DRAWS))
    u = contact_forces(normal, draw.finger_friction[:, None] * shares[worst])
    slide, topple = _probabilities(model, at[None], u[None], draw, topples_at=topples_at)
    return (slide if outcome == "slide" else topple).item()


def _probabilities(
    model: PushedBody,
    p: Array,
    u: Array,
    draw: Draws,
    *,
    topples_at: float = 1.0,
    force: float | None = None,
    weights: Array | float = 1.0,
) -> tuple[Array, Array]:
    """Probabilities of sliding and of toppling first for n pushes, averaged over k draws, (n,).

    Contacts and directions are (n, 1, 3), or (n, k, 3) if they differ from draw to draw; draws
    count by their weights, shape (k,).
    """
    tips, critical = _critical_frictions(model, p, u, draw, topples_at, force)
    below = friction_below(model, critical, draw.friction, draw.friction_sd)
    above = np.where(tips, 1.0 - below, 0.0)
    return (weights * below).mean(axis=1), (weights * above).mean(axis=1)


def _critical_frictions(
    model: PushedBody,
    p: Array,
    u: Array,
    draw: Draws,
    topples_at: float,
    force: float | None = None,
) -> tuple[NDArray[np.bool_], Array]:
    """Pushes that topple what does not slide before, and frictions below which that slides, (n, k).

    The arguments are those of `_probabilities`.
    """
    shape, springs = (max(len(p), len(u)), len(draw.com)), springs_of(model)
    p, u, com = (np.broadcast_to(each, (*shape, 3)).reshape(-1, 3) for each in (p, u, draw.com))
    scale, weight = (
        np.broadcast_to(each, shape).ravel()
        for each in (draw.friction_radius / springs.radius, draw.weight)
    )
    topples = topples_at * topple_threshold(model.base, p, u, com, 1.0)
    ends = topples if force is None else np.minimum(topples, force / weight)
    ratio, critical = ratio_at(ends, u[:, 2], 1.0), np.empty(len(p))
    for b in push_blocks(len(p), springs):
        body = Standing(model.base, springs, scale[b], _NO_END, com[b, :2])
        critical[b] = SlideSearch(body, p[b], u[b], ratio[b]).critical_friction()
    tips = np.isfinite(topples) & (topples <= ends)
    return tips.reshape(shape), critical.reshape(shape)
