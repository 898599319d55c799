"""Thresholds of the exact tier: for springs, and for every way to share the load.

Bounds of the exact tier over every way in which the support points may share the load.

*Optimistic*: the largest push that some loads and friction forces at the points balance, all of
them pressing and inside their friction cones: a second-order cone programme, solved for all pushes
at once by a barrier method on its dual. That dual is a motion in space, whose least dissipation it
is; by it the points slip at (v_x, v_y) and are lifted by a + b·r ≥ |v|. (It says how far the push
can be held, not how the object moves: Coulomb friction is not associated.)

*Pessimistic*: the smallest push that some admissible loads cannot hold. The friction limit is
concave in the loads, so the worst ones are at a corner of those that are admissible: they rest on
three points around the centre of pressure. Many points are taken as an area, of which a single spot
may bear all the load: then any push turns the object whose line passes that spot by.

Pushes are measured by the load ratio r = s/N, as in
`objectmodels.exact.exact_thresholds`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations
from math import isclose
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from objectmodels.errors import ModelError
from objectmodels.exact.slide_search import CERTAIN, SlideSearch, Standing, push_blocks
from objectmodels.exact.support_springs import Springs
from objectmodels.geometry.base_shapes import Array, Polygon, friction_radius, support_points
from objectmodels.geometry.rotations import cross
from objectmodels.lazy import remember_answers
from objectmodels.mechanics.friction_limit import friction_limit
from objectmodels.mechanics.push_outcomes import Thresholds, closed_form_thresholds
from objectmodels.mechanics.push_thresholds import (
    force_at,
    push_axes,
    push_moment,
    ratio_at,
    topple_threshold,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from objectmodels.geometry.pushed_body import Friction, PushedBody
    from objectmodels.mechanics.outcome_probability import Sample


# Thresholds of the exact tier, for an object that stands on springs.
#
# Model: toppling is the closed form's, exact for a rigid base. For sliding, the support points
# carry what springs carry (`objectmodels.exact.support_springs`), and resist what
# Coulomb friction resists under those loads (`objectmodels.mechanics.friction_limit`); the loads
# follow the push as it grows. In the load ratio r = s/N the centre of pressure moves evenly, q =
# (1 + r u_z) c_xy + r (p_z u_xy − u_z p_xy), and the object slides at the first r with r |u_xy| =
# μ S(q), S the friction limit. A friction radius other than the support's own scales the points'
# distances from the centre of pressure.
#
# Every answer is certified: `residual` says how far loads and friction forces are from balancing
# the push, and from Coulomb's law.

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
        bound = best_case_onset(self)
        _require_order(self.onset, bound)
        return np.maximum(bound, self.onset)

    @cached_property
    def pessimistic(self) -> Array:
        """Onset if they shared it as badly as balance allows, shape (n,) [N].

        Raises:
            ModelError: `no_bounds` and `not_solved`, as for `optimistic`.
        """
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
    if model.base.is_round:
        close |= t.topple < t.slide
    (i,) = np.nonzero(close)
    slide = t.slide.copy()
    if i.size:
        slide[i] = exact_thresholds(model, p[i], u[i], friction).slide
    return replace(t, slide=slide)


BLOCK, TRIANGLES = 512, 20_000
"""Pushes, and triples of points times pushes, that are treated at once."""

_PRECISE = 1e-9  # relative gap at which the barrier method stops
_THIN = 1e-9  # area of triples that count as on a line, of the support's size squared
_STEPS, _ROOT = 60, 1e-11


def best_case_onset(t: ExactThresholds) -> Array:
    """Onset under the best sharing of the load, shape (n,) [N]."""
    _require_known(t)
    (p, u), (base, c, _, weight) = t.push, t.body
    # Loads anywhere on the base hold no more than loads at its corners do.
    # Of a round base those around the rim, so that no push that the rim holds is left out.
    points = base.enclosing_corners
    found: Array = np.full(len(p), np.inf)
    h = np.hypot(u[:, 0], u[:, 1])
    (level,) = np.nonzero(h > 0.0)
    for start in range(0, len(level), BLOCK):
        i = level[start : start + BLOCK]
        r = _largest_ratio(points, c[:2], p[i], u[i], t.coefficient)
        w = u[i, 2]
        never = (w < 0.0) & (r * -w >= 1.0 - 1e-9)
        found[i] = force_at(np.where(never, np.inf, r), w, weight)
    np.minimum(found, t.topple, out=found)
    return found


def _require_known(t: ExactThresholds) -> None:
    """Makes sure that the points are known that may carry the load."""
    if t.fitted:
        raise ModelError(
            "no_bounds",
            "the friction radius was fitted, so where the object stands is not known",
            suggestions=("bounds belong to a support of corners or of given points",),
        )


def _largest_ratio(points: Array, com: Array, p: Array, u: Array, mu: float) -> Array:
    """Largest load ratio at which the points can hold a push, shape (n,).

    In units of μ/|u_xy|: least a + b·c over (β, ω, a, b) with a + b·r_i ≥ |v_i| for all points,
    v_i = (1 + κ b·g − ω η_i, β + ω ξ_i), κ = μ/|u_xy| and g = u_z c + p_z u_xy − u_z p_xy.
    """
    size = float(np.hypot(*np.ptp(points, axis=0)))
    h, along, across = push_axes(u)
    kappa = mu / h
    g = (u[:, 2:] * com + push_moment(p, u)) / size
    place, c = points / size, com / size
    xi = points @ along.T / size
    eta = (points @ across.T - np.sum(p[:, :2] * across, axis=1)) / size
    k, n = xi.shape
    # Rows of the linear maps from (β, ω, a, b_x, b_y) to (lift, v_x, v_y), each (k, n, 5).
    lift, v_x, v_y = (np.zeros((k, n, 5)) for _ in range(3))
    lift[..., 2] = 1.0
    lift[..., 3:] = place[:, None, :]
    v_x[..., 1] = -eta
    v_x[..., 3:] = kappa[:, None] * g
    v_y[..., 0], v_y[..., 1] = 1.0, xi
    cost = np.zeros((n, 5))
    cost[:, 2], cost[:, 3:] = 1.0, c
    x = np.zeros((n, 5))
    x[:, 2] = 2.0  # sliding along the push, lifted more than it slips
    weight = 1.0
    while 2.0 * k / weight > _PRECISE:
        weight *= 8.0  # by which the barrier's weight grows
        for _ in range(4):  # Newton steps for each weight, at most
            step, decrement = _newton_step(x, weight, cost, lift, v_x, v_y)
            x = x + _interior_shares(x, step, lift, v_x, v_y) * step
            if decrement.max() < 1e-3:
                break
    return np.asarray(kappa * (x * cost).sum(axis=1))


def _cone_slack(x: Array, lift: Array, v_x: Array, v_y: Array) -> tuple[Array, Array, Array, Array]:
    """Lift and slip of the points, and lift² − slip², each (k, n)."""
    z, a, b = (lift * x).sum(-1), 1.0 + (v_x * x).sum(-1), (v_y * x).sum(-1)
    return z, a, b, z * z - a * a - b * b


def _newton_step(
    x: Array, weight: float, cost: Array, lift: Array, v_x: Array, v_y: Array
) -> tuple[Array, Array]:
    """Newton step of weight · cost − Σ log(lift² − slip²), and its decrement."""
    z, a, b, d = _cone_slack(x, lift, v_x, v_y)
    grown = (z[..., None] * lift - a[..., None] * v_x - b[..., None] * v_y) * (2.0 / d)[..., None]
    gradient = weight * cost - grown.sum(axis=0)
    root = np.sqrt(2.0 / d)[..., None]
    rows = np.stack((lift * root, v_x * root, v_y * root))
    signs = np.array([-1.0, 1.0, 1.0])
    hessian = np.einsum("skni,sknj->nij", rows * signs[:, None, None, None], rows)
    hessian += np.einsum("kni,knj->nij", grown, grown)
    # Near an optimum that is an edge the equations lose rank but for rounding.
    scale = 1.0 / np.sqrt(np.einsum("nii->ni", hessian))
    scaled = hessian * scale[:, :, None] * scale[:, None, :] + 1e-14 * np.eye(5)
    step = -scale * np.linalg.solve(scaled, (scale * gradient)[..., None])[..., 0]
    return step, -(gradient * step).sum(axis=1)


def _interior_shares(x: Array, step: Array, lift: Array, v_x: Array, v_y: Array) -> Array:
    """Shares of steps that stay well inside all cones, shape (n, 1)."""
    share = np.ones(len(x))
    for _ in range(40):
        z, _, _, d = _cone_slack(x + share[:, None] * step, lift, v_x, v_y)
        out = ((d <= 0.0) | (z <= 0.0)).any(axis=0)
        if not out.any():
            break
        share[out] *= 0.6
    return np.where(share < 1.0, 0.9 * share, share)[:, None]


def worst_case_onset(t: ExactThresholds) -> Array:
    """Onset under the worst sharing of the load, shape (n,) [N]."""
    _require_known(t)
    (p, u), (base, c, _, weight) = t.push, t.body
    points = t.support[0]
    if len(points) > 24:  # More points than these are an area, for the pessimistic bound
        return np.minimum(_onset_on_a_spot(t), t.topple)
    threes = _support_triangles(points)
    worst = np.full(len(p), np.inf)
    block = max(TRIANGLES // len(threes), 1)
    for start in range(0, len(p), block):
        b = slice(start, start + block)
        tips = ratio_at(t.topple[b], u[b, 2], weight)
        worst[b] = _smallest_ratio(points, threes, c[:2], p[b], u[b], t.coefficient, tips)
    found = force_at(worst, u[:, 2], weight)
    if base.is_round:
        # Between the points and the rim the load rests on an edge of theirs, or on none.
        leaves = Polygon(points).topple_force(weight * c[:2], push_moment(p, u), u[:, 2], weight)
        found = np.minimum(found, leaves)
    return np.asarray(np.minimum(np.where(found > 0.0, found, np.inf), t.topple))


def _onset_on_a_spot(t: ExactThresholds) -> Array:
    """Onset of sliding or turning if the load rests on its centre alone, shape (n,) [N]."""
    (p, u), (base, c, _, weight) = t.push, t.body
    h, _, across = push_axes(u)
    passes_by = np.abs(np.sum((p - c)[:, :2] * across, axis=1)) > _THIN * base.size
    with np.errstate(divide="ignore"):
        ratio = np.where(passes_by & (h > 0.0), 0.0, t.coefficient / h)
    never = 1.0 + ratio * u[:, 2] <= 0.0
    return force_at(np.where(never, np.inf, ratio), u[:, 2], weight)


def _support_triangles(points: Array) -> NDArray[np.intp]:
    """Indices of all triples of points that are not on a line, shape (m, 3)."""
    threes = np.array(list(combinations(range(len(points)), 3)))
    a, b, c = (points[threes[:, k]] for k in range(3))
    area = cross(b - a, c - a)
    return np.asarray(threes[np.abs(area) > _THIN * np.ptp(points, axis=0).max() ** 2])


def _smallest_ratio(
    points: Array, threes: NDArray[np.intp], com: Array, p: Array, u: Array, mu: float, tips: Array
) -> Array:
    """Smallest load ratio that some three points cannot hold, shape (n,); inf if there is none.

    The loads of three points grow evenly with the load ratio, N = n0 + r n1, and the friction limit
    is concave in them. So on the stretch where all three press a push first slides at its start, or
    at the one root on it, or nowhere.
    """
    h, along, across = push_axes(u)
    e = u[:, 2:] * com + push_moment(p, u)
    corners = points[threes]  # (m, 3, 2)
    share = np.linalg.inv(
        np.concatenate((np.ones((len(threes), 1, 3)), corners.swapaxes(1, 2)), axis=1)
    )
    n0 = share @ np.append(1.0, com)  # (m, 3)
    n1 = np.einsum("mij,nj->imn", share[:, :, 1:], e)  # (3, m, n)
    with np.errstate(divide="ignore"):
        kappa = mu / h
    first, end = _pressing_ratios(n0.T[:, :, None], n1, np.minimum(tips, kappa))
    triangle, push = np.nonzero((first < end) & (h > 0.0))
    n0, n1 = n0.T[:, triangle], n1[:, triangle, push]
    first, end, kappa = first[triangle, push], end[triangle, push], kappa[push]
    place = corners[triangle]
    xi = np.einsum("sij,sj->is", place, along[push])
    eta = np.einsum("sij,sj->is", place, across[push]) - np.sum(p[push, :2] * across[push], axis=1)
    ratio = _first_root(n0, n1, xi, eta, kappa, first, end)
    worst = np.full(len(p), np.inf)
    np.minimum.at(worst, push, ratio)
    return worst


def _pressing_ratios(n0: Array, n1: Array, last: Array) -> tuple[Array, Array]:
    """Between which load ratios three loads n0 + r n1 all press, shape (m, n) each."""
    with np.errstate(divide="ignore", invalid="ignore"):
        zero = -n0 / n1
    never = np.where((n1 == 0.0) & (n0 < 0.0), np.inf, 0.0)
    first = np.where(n1 > 0.0, zero, never).max(axis=0)
    end = np.where(n1 < 0.0, zero, np.inf).min(axis=0)
    return np.maximum(first, 0.0), np.minimum(end, last)


def _first_root(
    n0: Array, n1: Array, xi: Array, eta: Array, kappa: Array, first: Array, end: Array
) -> Array:
    """First r of a stretch at which r ≥ κ S, inf if there is none, shape (s,)."""

    def excess(r: Array, i: NDArray[np.intp]) -> tuple[Array, Array]:
        # A point without load has no friction, yet the equations need all three.
        loads = np.maximum(n0[:, i] + r * n1[:, i], 1e-12)
        limit = friction_limit(loads, xi[:, i], eta[:, i])
        slope = (n1[:, i] * np.hypot(*limit.slip_velocities(xi[:, i], eta[:, i]))).sum(axis=0)
        return kappa[i] * limit.ratio - r, kappa[i] * slope - 1.0

    everywhere = np.arange(len(first))
    found = np.where(excess(first, everywhere)[0] <= 0.0, first, np.inf)
    (i,) = np.nonzero(np.isinf(found) & (excess(end, everywhere)[0] <= 0.0))
    lo, hi = first.copy(), end.copy()
    r = 0.5 * (lo + hi)
    for _ in range(_STEPS):
        if not i.size:
            break
        value, slope = excess(r[i], i)
        lo[i], hi[i] = np.where(value > 0.0, r[i], lo[i]), np.where(value > 0.0, hi[i], r[i])
        with np.errstate(divide="ignore", invalid="ignore"):
            step = r[i] - value / slope
        step = np.where((step > lo[i]) & (step < hi[i]), step, 0.5 * (lo[i] + hi[i]))
        done = (np.abs(value) <= _ROOT * r[i]) | (hi[i] - lo[i] <= _ROOT * hi[i])
        found[i[done]] = r[i[done]]
        r[i] = step
        i = i[~done]
    found[i] = r[i]
    return found
