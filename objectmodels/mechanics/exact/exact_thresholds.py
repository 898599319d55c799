"""Thresholds of the exact tier, for an object that stands on springs.

Model: toppling is the closed form's, exact for a rigid base. For sliding, the support points carry
what springs carry (`objectmodels.mechanics.exact.support_springs`), and resist what Coulomb
friction resists under those loads (`objectmodels.mechanics.friction_limit`); the loads follow the
push as it grows. In the load ratio r = s/N the centre of pressure moves evenly, q = (1 + r u_z)
c_xy + r (p_z u_xy − u_z p_xy), and the object slides at the first r with r |u_xy| = μ S(q), S the
friction limit. A friction radius other than the support's own scales the points' distances from the
centre of pressure.

Every answer is certified: `residual` says how far loads and friction forces are from balancing the
push, and from Coulomb's law.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isclose
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from objectmodels.cached_values import remember_answers
from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array, Disc
from objectmodels.geometry.support_points import (
    friction_radius,
    support_points,
)
from objectmodels.mechanics.exact.slide_search import (
    CERTAIN,
    SlideSearch,
    push_blocks,
)
from objectmodels.mechanics.exact.standing import Standing
from objectmodels.mechanics.exact.support_springs import Springs
from objectmodels.mechanics.push_outcomes import Thresholds, closed_form_thresholds
from objectmodels.mechanics.push_thresholds import (
    force_at,
    push_axes,
    ratio_at,
    topple_threshold,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from objectmodels.geometry.pushed_body import Friction, PushedBody
    from objectmodels.mechanics.outcome_probability import Sample

BORDER = 0.4
"""Relative distance of the closed form's thresholds within which its class may be wrong."""


@dataclass(frozen=True, repr=False)
class ExactThresholds(Thresholds):
    """Thresholds of the exact tier; arrays over n pushes.

    Where the object topples first, `slide` is the friction limit for the loads at that moment:
    beyond it there are no loads.

    Attributes:
        residual: largest violation of balance and of Coulomb's law at the onset, relative, (n,).
        support: points, weights and the factor of their distances from the centre of pressure.
        coefficient: μ at the table.
        fitted: whether the friction radius is another one than the support's own.
        motion: β and ω [1/m] of the sliding motion, in axes along and across the push, (2, n).
    """

    residual: Array
    support: Support = field(repr=False)
    coefficient: float
    motion: Array = field(repr=False)
    fitted: bool

    @cached_property
    def optimistic(self) -> Array:
        """Onset if the support points shared the load as well as they can, shape (n,) [N].

        Raises:
            ModelError: `no_bounds` if the friction radius was fitted: its points are not known;
                `not_solved` if it is below the onset.
        """
        from objectmodels.mechanics.exact.load_sharing_bounds import best_case_onset

        bound = best_case_onset(self)
        _require_order(self.onset, bound)
        return np.maximum(bound, self.onset)

    @cached_property
    def pessimistic(self) -> Array:
        """Onset if they shared it as badly as balance allows, shape (n,) [N].

        Raises:
            ModelError: `no_bounds` and `not_solved`, as for `optimistic`.
        """
        from objectmodels.mechanics.exact.load_sharing_bounds import worst_case_onset

        bound = worst_case_onset(self)
        _require_order(bound, self.onset)
        return np.minimum(bound, self.onset)

    def _sliding_twists(self, i: NDArray[np.bool_]) -> Array:
        p, u = (v[i] for v in self.push)
        h, along, across = push_axes(u)
        beta, omega = self.motion[:, i]
        left = np.sum(p[:, :2] * across, axis=1)
        v = (1.0 + omega * left)[:, None] * along + beta[:, None] * across
        zero = np.zeros((len(p), 2))
        return np.asarray(np.column_stack((zero, omega, v, zero[:, 0])) / h[:, None])


def exact_thresholds(model: PushedBody, p: Array, u: Array, friction: Friction) -> ExactThresholds:
    """See `ObjectModel.thresholds`, which checks its arguments."""
    closed, springs = closed_form_thresholds(model, p, u, friction), springs_of(model)
    slide, residual = np.full(len(p), np.inf), np.zeros(len(p))
    motion = np.full((2, len(p)), np.nan)
    body = _standing(model, friction)
    for b, tips, guess in _ratio_blocks(closed, springs):
        answer = SlideSearch(body, p[b], u[b], tips).first_slides(guess)
        r, residual[b], motion[:, b] = answer.ratio, answer.residual, answer.motion
        jams = 1.0 + np.where(np.isfinite(r), r, 0.0) * u[b, 2] <= 0.0
        slide[b] = force_at(np.where(jams, np.inf, r), u[b, 2], model.weight)
    _require_certainty(residual)
    return ExactThresholds(
        slide=slide,
        topple=closed.topple,
        friction=friction,
        push=(p, u),
        body=closed.body,
        residual=residual,
        support=(springs.points, springs.weights, model.friction_radius / springs.radius),
        coefficient=model.friction_coefficient(friction),
        motion=motion,
        fitted=_has_fitted_radius(model),
    )


def thresholds_of_sample(
    model: PushedBody, sample: Sample, p: Array, u: Array
) -> tuple[Array, Array]:
    """Forces at which drawn bodies slide and topple, (k,) each [N], for a push of each, (k, 3).

    Raises:
        ModelError: `not_solved` if one is not certain.
    """
    springs, weight, w = springs_of(model), sample.weight, u[:, 2]
    topples = topple_threshold(model.base, p, u, sample.com, 1.0)
    tips, scale = ratio_at(topples, w, 1.0), sample.friction_radius / springs.radius
    slides, residual = np.empty_like(weight), np.empty_like(weight)
    for b in push_blocks(len(p), springs):
        body = Standing(model.base, springs, scale[b], sample.friction[b], sample.com[b, :2])
        answer = SlideSearch(body, p[b], u[b], tips[b]).first_slides(tips[b])
        slides[b], residual[b] = answer.ratio, answer.residual
    _require_certainty(residual)
    jams = np.isfinite(slides) & (1.0 + slides * w <= 0.0)
    return force_at(np.where(jams, np.inf, slides), w, weight), weight * topples


def _require_certainty(residual: Array) -> None:
    """Refuses answers whose loads and forces do not balance the push."""
    (wrong,) = np.nonzero(~(residual <= CERTAIN))
    if wrong.size:
        raise ModelError(
            "not_solved",
            f"loads and friction of push {wrong[0]} were not found: residual "
            f"{residual[wrong[0]]:.1e}, {CERTAIN:.0e} is certain",
            suggestions=("move its contact by a tenth of a millimetre", "take the closed form"),
        )


def _require_order(low: Array, high: Array) -> None:
    """Refuses answers whose onset and bounds contradict one another."""
    with np.errstate(invalid="ignore"):
        (wrong,) = np.nonzero(low - high > CERTAIN * low)
    if wrong.size:
        i = wrong[0]
        raise ModelError(
            "not_solved",
            f"onset and bounds of push {i} contradict: {low[i]:.9g} N is not below {high[i]:.9g} N",
            suggestions=("move its contact by a tenth of a millimetre", "take the closed form"),
        )


def exact_codes(model: PushedBody, p: Array, u: Array) -> NDArray[np.uint8]:
    """Classes of pushes as indices into `OUTCOMES`, shape (n,), without the forces: much faster.

    Contacts and unit directions are (n, 3), as in `ObjectModel.thresholds`; those that come within
    `UNDECIDED` of both thresholds topple.
    """
    closed = closed_form_thresholds(model, p, u)
    code = np.where(np.isfinite(closed.topple), 2, 0).astype(np.uint8)
    springs = springs_of(model)
    body = _standing(model, "static")
    for b, tips, guess in _ratio_blocks(closed, springs):
        code[b][SlideSearch(body, p[b], u[b], tips).slide_first(guess)] = 1
    return code


Support = tuple[Array, Array, float]


@remember_answers(64)
def springs_of(model: PushedBody) -> Springs:
    """What an object stands on, kept, since models never change."""
    return Springs(*support_points(model.support, model.footprint))


@remember_answers(64)
def _standing(model: PushedBody, friction: Friction) -> Standing:
    springs = springs_of(model)
    scale, mu = model.friction_radius / springs.radius, model.friction_coefficient(friction)
    return Standing(
        model.base, springs, np.array([scale]), np.array([mu]), np.array([model.com[:2]])
    )


@remember_answers(64)
def _has_fitted_radius(model: PushedBody) -> bool:
    return not isclose(model.friction_radius, friction_radius(model.support, model.footprint))


def _ratio_blocks(closed: Thresholds, springs: Springs) -> Iterator[tuple[slice, Array, Array]]:
    """Blocks of pushes, the load ratios at which they topple, and guesses of those at slides."""
    (_, u), weight = closed.push, closed.body[3]
    for b in push_blocks(len(u), springs):
        tips, guess = (ratio_at(s[b], u[b, 2], weight) for s in (closed.topple, closed.slide))
        yield b, tips, guess


def exact_near_the_border(model: PushedBody, p: Array, u: Array, friction: Friction) -> Thresholds:
    """Thresholds of the closed form, exact where its two lie within `BORDER` of each other."""
    t = closed_form_thresholds(model, p, u, friction)
    with np.errstate(invalid="ignore"):
        close = np.abs(t.slide - t.topple) <= BORDER * t.onset
    # Near tipping a round base stands on one point, which does not keep it from turning.
    if isinstance(model.base, Disc):
        close |= t.topple < t.slide
    (i,) = np.nonzero(close)
    slide = t.slide.copy()
    if i.size:
        slide[i] = exact_thresholds(model, p[i], u[i], friction).slide
    return replace(t, slide=slide)
