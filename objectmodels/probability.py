"""Probability that an uncertain box slides first, or topples first.

The parameters are taken as independent and normal, cut off where they would make no sense. For one
force direction the box slides first iff its friction is below μ* (`critical_friction`), so the
friction integrates in closed form: P = Φ((μ* − μ)/σ_μ). The other four that matter (the centre of
mass along x and y, the friction radius, the finger's friction) are averaged over the points of a
fixed lattice rule: no randomness, the same answer every time.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.thresholds import (
    Array,
    critical_friction,
    edge_offsets,
    topple_thresholds,
    yaw_arm,
)

if TYPE_CHECKING:
    from objectmodels.box import BoxModel

NODES = 32
"""Points of the lattice rule."""

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


def draws(model: BoxModel, z: Array) -> Draws:
    """Parameters at standard normal deviates z, shape (k, 4): com x, com y, radius, finger."""
    c, reach = np.array(model.com), (1.0 - SMALLEST_SHARE) * edge_offsets(model.size)[:2]
    com = np.tile(c, (len(z), 1))
    com[:, :2] = np.clip(c[:2] + z[:, :2] * np.array(model.com_sd[:2]), -reach, reach)
    radius = model.friction_radius + z[:, 2] * model.friction_radius_sd
    finger = model.finger_friction + z[:, 3] * model.finger_friction_sd
    return Draws(
        com=com,
        friction_radius=np.maximum(radius, SMALLEST_SHARE * model.friction_radius),
        finger_friction=np.maximum(finger, 0.0),
    )


def probabilities(model: BoxModel, p: Array, normals: Array, shares: Array) -> tuple[Array, Array]:
    """Probabilities of sliding first and of toppling first, each of shape (n,).

    Args:
        model: the uncertain box.
        p: contact points in B, shape (n, 3) [m].
        normals: outward unit normals, shape (n, 3).
        shares: sideways and upward force as shares of what the finger's friction allows,
            shape (n, 2), in the unit disc.
    """
    draw = draws(model, _NORMAL_NODES)
    c, d = draw.com, edge_offsets(model.size)
    f = contact_forces(normals[:, None, :], shares[:, None, :] * draw.finger_friction[:, None])
    foot = p[:, None, :]
    topple = topple_thresholds(foot, f, c, d, model.weight).min(axis=-1)
    arm = yaw_arm(foot, f, c)
    limit = critical_friction(f, arm, topple, draw.friction_radius, model.weight)
    below = normal_cdf((limit - model.friction) / max(model.friction_sd, 1e-12 * model.friction))
    return below.mean(axis=1), np.where(np.isinf(topple), 0.0, 1.0 - below).mean(axis=1)


def contact_forces(normals: Array, tangential: Array) -> Array:
    """Forces f = −n + η t + κ ẑ of unit normal component, with t = ẑ × n; shape (..., 3).

    Args:
        normals: outward horizontal unit normals, shape (..., 3).
        tangential: η and κ, shape (..., 2).
    """
    n_x, n_y, eta = normals[..., 0], normals[..., 1], tangential[..., 0]
    x, y, z = np.broadcast_arrays(-n_x - eta * n_y, -n_y + eta * n_x, tangential[..., 1])
    return np.stack((x, y, z), axis=-1)


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


def _lattice(k: int, dimensions: int) -> Array:
    """Standard normal deviates from Roberts' additive recurrence, shape (k, dimensions)."""
    root = 2.0
    for _ in range(60):  # the positive root of x^(d+1) = x + 1
        root = (1.0 + root) ** (1.0 / (dimensions + 1))
    steps = root ** -np.arange(1.0, dimensions + 1)
    uniform = (0.5 + np.arange(k)[:, None] * steps) % 1.0
    inverse = NormalDist().inv_cdf
    return np.array([[inverse(x) for x in row] for row in uniform])


_NORMAL_NODES = _lattice(NODES, 4)
