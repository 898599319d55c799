"""Probability that an uncertain object slides first, topples first, or stays.

The parameters are normal, correlated if the model says so, cut off where they would make no
sense. The class at the onset does not depend on the mass, and for one force direction the
object slides first iff its friction is below μ* (`critical_friction`), so the friction
integrates in closed form, given the others: P = Φ((μ* − μ)/σ_μ). The other four that matter
(the centre of mass along x and y, the friction radius, the finger's friction) are averaged over
the points of a Halton sequence: no randomness, the same answer every time, within 0.04 of what
many samples give. What becomes of a push with a given force depends on the mass too and is
sampled, with a seed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.geometry.rotations import require_amount
from objectmodels.mechanics.push_thresholds import (
    critical_friction,
    slide_threshold,
    topple_threshold,
    yaw_arm,
)

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody

NODES = 128
"""Points of the Halton sequence that a probability is averaged over."""

SAMPLES = 4000
"""Samples for a given force: a probability of one half is met to 0.008 (a standard deviation)."""

BLOCK = 64
"""Contacts that are treated at once, so that the arrays stay in the processor's cache."""

SMALLEST_SHARE = 0.05
"""Drawn masses, coefficients, radii and offsets from an edge are cut off at this share of their
nominal value."""


@dataclass(frozen=True)
class Likelihood:
    """Probabilities of the outcomes of pushes; arrays over n pushes.

    Attributes:
        none: that it stays where it is, shape (n,); at the onset, that nothing ever moves it.
        slide: that it slides.
        topple: that it topples.
        method: `closed form` or `exact tier` (over the friction; the rest by a fixed sequence), or
            `sampled`.
        samples: number of draws behind it.
        seed: of the draws, None for the fixed sequence.
    """

    none: Array
    slide: Array
    topple: Array
    method: str
    samples: int
    seed: int | None


@dataclass(frozen=True)
class Draws:
    """Values of the uncertain parameters, arrays over k draws.

    Attributes:
        com: centre of mass in B, shape (k, 3) [m].
        friction_radius: shape (k,) [m].
        finger_friction: shape (k,).
        weight: G, shape (k,) [N]; that of the belief if the mass is not drawn.
        friction: mean at the table given the others, shape (k,).
        friction_sd: its standard deviation given the others.
    """

    com: Array
    friction_radius: Array
    finger_friction: Array
    weight: Array
    friction: Array
    friction_sd: float


_CONDITIONS = ("com_x", "com_y", "friction_radius", "finger_friction", "mass")


def draw_parameters(model: PushedBody, z: Array, *, yaw: bool = True) -> Draws:
    """Parameters at standard normal deviates z: com x, com y, radius, finger, and mass if asked.

    The deviates are (k, 4), or (k, 5) with the mass. Without yaw the friction radius is infinite.
    """
    n = z.shape[1]
    order = [UNCERTAIN.index(name) for name in (*_CONDITIONS[:n], "friction")]
    root = _triangular_root(model.correlation[np.ix_(order, order)])
    sd, mean = model.deviations[order], model.means[order]
    values = mean[:n] + sd[:n] * (z @ root[:n, :n].T)
    com = np.tile(np.array(model.com), (len(z), 1))
    com[:, :2] = _drawn_inside(model, values[:, :2])
    smallest = SMALLEST_SHARE * model.friction_radius
    mass = values[:, 4] / model.mass if n == len(_CONDITIONS) else np.ones(len(z))
    return Draws(
        com=com,
        friction_radius=np.maximum(values[:, 2], smallest if yaw else np.inf),
        finger_friction=np.maximum(values[:, 3], 0.0),
        weight=model.weight * np.maximum(mass, SMALLEST_SHARE),
        friction=mean[n] + sd[n] * (z @ root[n, :n]),
        friction_sd=float(sd[n] * root[n, n]),
    )


def _triangular_root(correlation: Array) -> Array:
    """Lower triangular root of a correlation matrix that may be singular."""
    shifted = correlation + 1e-12 * np.eye(len(correlation))
    return np.asarray(np.linalg.cholesky(shifted), dtype=np.float64)


def _drawn_inside(model: PushedBody, com: Array) -> Array:
    """Centres of mass (k, 2) drawn back along rays from the origin until they are on the base."""
    length = np.hypot(*com.T)
    rays = com / np.maximum(length, 1e-300)[:, None]
    # Along a ray the base ends where the moment of a unit push along it would leave it.
    none = np.zeros_like(com)
    room = (1.0 - SMALLEST_SHARE) * model.base.topple_force(none, rays, np.zeros(len(com)), 1.0)
    return np.asarray(rays * np.minimum(length, room)[:, None])


def outcome_likelihood(
    model: PushedBody, p: Array, u: Array, force: float | None = None
) -> Likelihood:
    """See `ObjectModel.likelihood`, which checks its arrays."""
    if force is None:
        draw = draw_parameters(model, normal_nodes(NODES))
        slide, topple = (
            np.concatenate(parts)
            for parts in zip(
                *(_at_onset(model, *b, draw) for b in _contact_blocks(p, u)), strict=True
            )
        )
        none = np.clip(1.0 - slide - topple, 0.0, 1.0)
        return Likelihood(none, slide, topple, "closed form", NODES, None)
    require_amount(force, "a force of", "give it in newtons; without one, any force is meant")
    counts = np.vstack([_sample_outcomes(model, *b, force, 0) for b in _contact_blocks(p, u)])
    none, slide, topple = counts.T
    return Likelihood(none, slide, topple, "sampled", SAMPLES, 0)


def _contact_blocks(p: Array, u: Array) -> list[tuple[Array, Array]]:
    starts = range(0, max(len(p), 1), BLOCK)
    return [(p[i : i + BLOCK], u[i : i + BLOCK]) for i in starts]


def _at_onset(model: PushedBody, p: Array, u: Array, draw: Draws) -> tuple[Array, Array]:
    """Probabilities of sliding and of toppling first, shape (n,) each."""
    slide, topple = class_probabilities(model, p[:, None, :], u[:, None, :], draw)
    return slide.mean(axis=-1), topple.mean(axis=-1)


def class_probabilities(model: PushedBody, p: Array, f: Array, draw: Draws) -> tuple[Array, Array]:
    """Probabilities over the friction alone, for each draw in the last axis."""
    topple = topple_threshold(model.base, p, f, draw.com, model.weight)
    arm = yaw_arm(p, f, draw.com)
    limit = critical_friction(f, arm, topple, draw.friction_radius, model.weight)
    below = friction_below(model, limit, draw.friction, draw.friction_sd)
    return below, np.where(np.isinf(topple), 0.0, 1.0 - below)


def friction_below(model: PushedBody, limit: Array, mean: Array, sd: float) -> Array:
    """Probability that the friction at the table, normal with a mean, is below a limit, (...)."""
    spread = max(sd, 1e-12 * model.friction)  # a step function if μ is certain
    return normal_cdf((limit - mean) / spread)


@dataclass(frozen=True)
class Sample:
    """Objects drawn from what is believed of one; arrays over k of them.

    Attributes:
        weight: G, shape (k,) [N].
        friction: at the table, shape (k,).
        finger_friction: shape (k,).
        friction_radius: shape (k,) [m].
        com: centre of mass in B, over the base, shape (k, 3) [m].
    """

    weight: Array
    friction: Array
    finger_friction: Array
    friction_radius: Array
    com: Array


def sample_parameters(model: PushedBody, samples: int, seed: int) -> Sample:
    """Draws all uncertain parameters of an object."""
    z = np.random.default_rng(seed).standard_normal((samples, len(UNCERTAIN)))
    z = z @ _triangular_root(model.correlation).T
    return sample_at(model, model.means + model.deviations * z)


def sample_at(model: PushedBody, x: Array) -> Sample:
    """Objects of parameters in the order of `UNCERTAIN`, shape (k, 7), cut off as those drawn."""
    x = np.column_stack((np.maximum(x[:, :4], SMALLEST_SHARE * model.means[:4]), x[:, 4:]))
    return Sample(
        weight=model.weight / model.mass * x[:, UNCERTAIN.index("mass")],
        friction=x[:, UNCERTAIN.index("friction")],
        finger_friction=x[:, UNCERTAIN.index("finger_friction")],
        friction_radius=x[:, UNCERTAIN.index("friction_radius")],
        com=np.column_stack((_drawn_inside(model, x[:, 4:6]), x[:, 6])),
    )


def _sample_outcomes(model: PushedBody, p: Array, u: Array, force: float, seed: int) -> Array:
    """Shares of none, slide, topple among samples of all parameters, shape (n, 3)."""
    drawn = sample_parameters(model, SAMPLES, seed)
    weight, com = drawn.weight, drawn.com
    p, u = p[:, None, :], u[:, None, :]
    arm = yaw_arm(p, u, com)
    slide = weight * slide_threshold(u, arm, drawn.friction, drawn.friction_radius, 1.0)
    topple = weight * topple_threshold(model.base, p, u, com, 1.0)
    moves = np.minimum(slide, topple) <= force
    slides = moves & (slide < topple)
    shares = ~moves, slides, moves & ~slides
    return np.stack([share.mean(axis=1) for share in shares], axis=1)


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
def normal_nodes(k: int, *, mass: bool = False) -> Array:
    """Standard normal deviates at the first k points of the Halton sequence, (k, 4) or (k, 5)."""
    inverse, bases = NormalDist().inv_cdf, (2, 3, 5, 7, 11)[: 4 + mass]
    return np.array([[inverse(_radical_inverse(i, b)) for b in bases] for i in range(1, k + 1)])


def _radical_inverse(i: int, base: int) -> float:
    """The digits of i > 0 mirrored at the point, in (0, 1)."""
    x, unit = 0.0, 1.0 / base
    while i:
        i, digit = divmod(i, base)
        x, unit = x + digit * unit, unit / base
    return x
