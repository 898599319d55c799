"""Probability that an uncertain box slides first, or topples first.

The parameters are taken as independent and normal, cut off where they would make no sense. For one
force direction the box slides first iff its friction is below μ* (`critical_friction`), so the
friction integrates in closed form: P = Φ((μ* − μ)/σ_μ). The other four that matter (the centre of
mass along x and y, the friction radius, the finger's friction) are averaged over the points of a
Halton sequence: no randomness, the same answer every time, within 0.04 of what many samples give.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from statistics import NormalDist
from typing import TYPE_CHECKING, Literal

import numpy as np

from objectmodels.extremes import contact_forces, directions
from objectmodels.thresholds import (
    Array,
    critical_friction,
    edge_offsets,
    topple_thresholds,
    yaw_arm,
)

if TYPE_CHECKING:
    from objectmodels.box import BoxModel

NODES = 128
"""Points of the Halton sequence that a probability is averaged over."""

SEARCH_NODES, SEARCH_RING = 8, 16
"""The same, and the directions on the outer ring, for finding the worst direction."""

BLOCK = 64
"""Contacts that are treated at once, so that the arrays stay in the processor's cache."""

SMALLEST_SHARE = 0.05
"""Drawn radii and offsets from an edge are cut off at this share of their nominal value."""


@dataclass(frozen=True)
class Draws:
    """Values of the uncertain parameters, arrays over k draws.

    Attributes:
        com: centre of mass in B, shape (k, 3) [m].
        friction_radius: shape (k,) [m].
        finger_friction: shape (k,).
    """

    com: Array
    friction_radius: Array
    finger_friction: Array


def draws(model: BoxModel, z: Array, *, yaw: bool = True) -> Draws:
    """Parameters at standard normal deviates z, shape (k, 4): com x, com y, radius, finger.

    Without yaw the friction radius is infinite.
    """
    c, reach = np.array(model.com), (1.0 - SMALLEST_SHARE) * edge_offsets(model.size)[:2]
    com = np.tile(c, (len(z), 1))
    com[:, :2] = np.clip(c[:2] + z[:, :2] * np.array(model.com_sd[:2]), -reach, reach)
    radius = model.friction_radius + z[:, 2] * model.friction_radius_sd
    finger = model.finger_friction + z[:, 3] * model.finger_friction_sd
    return Draws(
        com=com,
        friction_radius=np.maximum(
            radius, SMALLEST_SHARE * model.friction_radius if yaw else np.inf
        ),
        finger_friction=np.maximum(finger, 0.0),
    )


def worst_probability(
    model: BoxModel, p: Array, normals: Array, yaw: bool, outcome: Literal["slide", "topple"]
) -> Array:
    """Probability of an outcome at onset for the worst direction in the finger's cone, (n,).

    Args:
        model: the uncertain box.
        p: contact points in B on side faces, shape (n, 3) [m].
        normals: outward unit normals of the faces, shape (n, 3).
        yaw: whether the box may turn as it slides.
        outcome: what is asked for.
    """
    shares = directions(p, normals, np.array(model.com), model.finger_friction, SEARCH_RING)
    few, many = (draws(model, _nodes(k), yaw=yaw) for k in (SEARCH_NODES, NODES))
    worst = np.empty(len(p))
    for i in range(0, len(p), BLOCK):
        block = slice(i, i + BLOCK)
        q, n, tried = p[block], normals[block], shares[block]
        rough = _probability(model, q, n, tried, outcome, few)
        chosen = tried[np.arange(len(q)), rough.argmin(axis=1)]
        worst[block] = _probability(model, q, n, chosen[:, None, :], outcome, many)[:, 0]
    return worst


def _probability(
    model: BoxModel, p: Array, normals: Array, shares: Array, outcome: str, draw: Draws
) -> Array:
    """Probability of an outcome for the directions of given shares (n, j, 2), shape (n, j)."""
    tangential = shares[:, :, None, :] * draw.finger_friction[:, None]
    f = contact_forces(normals[:, None, None, :], tangential)  # (n, j, k, 3)
    p = p[:, None, None, :]
    offsets = edge_offsets(model.size)
    topple = topple_thresholds(p, f, draw.com, offsets, model.weight).min(axis=-1)
    arm = yaw_arm(p, f, draw.com)
    limit = critical_friction(f, arm, topple, draw.friction_radius, model.weight)
    spread = max(model.friction_sd, 1e-12 * model.friction)  # a step function if μ is certain
    below = normal_cdf((limit - model.friction) / spread)
    if outcome == "topple":
        below = np.where(np.isinf(topple), 0.0, 1.0 - below)
    return np.asarray(below.mean(axis=-1))


def normal_cdf(x: Array) -> Array:
    """Φ(x) to 1.5e-7 (Abramowitz and Stegun 1964, 7.1.26); spares importing scipy for it."""
    a = np.abs(x) / np.sqrt(2.0)
    t = 1.0 / (1.0 + 0.3275911 * a)
    poly = t * (
        0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))
    )
    with np.errstate(over="ignore", under="ignore"):
        tail = 0.5 * poly * np.exp(-a * a)
    tail = np.where(np.isinf(a), 0.0, tail)
    return np.where(x < 0.0, tail, 1.0 - tail)


@cache
def _nodes(k: int) -> Array:
    """Standard normal deviates at the first k points of the Halton sequence, shape (k, 4)."""
    inverse = NormalDist().inv_cdf
    return np.array(
        [[inverse(_radical_inverse(i, b)) for b in (2, 3, 5, 7)] for i in range(1, k + 1)]
    )


def _radical_inverse(i: int, base: int) -> float:
    """The digits of i > 0 mirrored at the point, in (0, 1)."""
    x, unit = 0.0, 1.0 / base
    while i:
        i, digit = divmod(i, base)
        x, unit = x + digit * unit, unit / base
    return x
