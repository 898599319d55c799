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
from functools import cached_property, lru_cache
from math import isclose
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.base_shapes import Array, Base, Disc
from objectmodels.geometry.support_points import (
    friction_radius,
    hull_polygon,
    mean_distance,
    support_points,
)
from objectmodels.mechanics.exact.support_springs import Springs
from objectmodels.mechanics.friction_limit import Limit, friction_limit
from objectmodels.mechanics.push_outcomes import Thresholds, closed_form_thresholds
from objectmodels.mechanics.push_thresholds import force_at, push_axes, push_moment, ratio_at

if TYPE_CHECKING:
    from collections.abc import Iterator

    from objectmodels.geometry.pushed_body import Friction, PushedBody

BORDER = 0.4
"""Relative distance of the closed form's thresholds within which its class may be wrong."""

BLOCK = 8192
"""Points of pushes treated at once, so that the arrays stay in the processor's cache."""

# The centre of pressure stays so much of its way short of the edge, where loads are not unique.
_SHORT = 1e-9
_STEPS = 100
_NEWTON = 12  # steps after which every other one halves the bracket
_PRECISE = 1e-12  # of the load ratio
_LOOKS = 16  # even steps in which slides before the one found are looked for
_FEW = 24  # points up to which all changes of the loaded ones are looked at instead

Index = NDArray[np.intp]


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
            ModelError: `no_bounds` if the friction radius was fitted: its points are not known.
        """
        from objectmodels.mechanics.exact.load_sharing_bounds import best_case_onset

        return best_case_onset(self)

    @cached_property
    def pessimistic(self) -> Array:
        """Onset if they shared it as badly as balance allows, shape (n,) [N].

        Raises:
            ModelError: `no_bounds`, as for `optimistic`.
        """
        from objectmodels.mechanics.exact.load_sharing_bounds import worst_case_onset

        return worst_case_onset(self)

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
    closed, springs = closed_form_thresholds(model, p, u, friction), _springs(model)
    slide, residual = np.full(len(p), np.inf), np.zeros(len(p))
    motion = np.full((2, len(p)), np.nan)
    for b, search, guess in _searches(model, closed, springs):
        answer = search.first_slides(guess)
        r, residual[b], motion[:, b] = answer.ratio, answer.residual, answer.motion
        jams = 1.0 + np.where(np.isfinite(r), r, 0.0) * u[b, 2] <= 0.0
        slide[b] = force_at(np.where(jams, np.inf, r), u[b, 2], model.weight)
    return ExactThresholds(
        slide=slide,
        topple=closed.topple,
        friction=friction,
        push=(p, u),
        body=closed.body,
        residual=residual,
        support=(springs.points, springs.weights, _distance_factor(model, springs)),
        coefficient=model.friction_coefficient(friction),
        motion=motion,
        fitted=not isclose(model.friction_radius, friction_radius(model.support, model.footprint)),
    )


def exact_codes(model: PushedBody, p: Array, u: Array) -> NDArray[np.uint8]:
    """Classes of pushes as indices into `OUTCOMES`, shape (n,), without the forces: much faster.

    Contacts and unit directions are (n, 3), as in `ObjectModel.thresholds`; those that come within
    `UNDECIDED` of both thresholds topple.
    """
    closed = closed_form_thresholds(model, p, u)
    code = np.where(np.isfinite(closed.topple), 2, 0).astype(np.uint8)
    for b, search, guess in _searches(model, closed, _springs(model)):
        code[b][search.slide_first(guess)] = 1
    return code


Support = tuple[Array, Array, float]


@lru_cache(maxsize=64)
def _springs(model: PushedBody) -> Springs:
    """What an object stands on, kept, since models never change."""
    return Springs(*support_points(model.support, model.footprint))


def _distance_factor(model: PushedBody, springs: Springs) -> float:
    """Factor of the points' distances that makes the friction radius that of the model."""
    return model.friction_radius / mean_distance(springs.points, springs.weights)


def _searches(
    model: PushedBody, closed: Thresholds, springs: Springs
) -> Iterator[tuple[slice, _Search, Array]]:
    """Blocks of pushes, the searches for them, and guesses of the load ratios."""
    (p, u), points, scale = closed.push, springs.points, _distance_factor(model, springs)
    mu, c, weight = model.friction_coefficient(closed.friction), np.array(model.com), model.weight
    block = max(BLOCK // len(points), 1)
    for start in range(0, len(p), block):
        b = slice(start, start + block)
        tips, guess = (ratio_at(s[b], u[b, 2], weight) for s in (closed.topple, closed.slide))
        yield b, _Search(model.base, springs, scale, mu, c[:2], p[b], u[b], tips), guess


@dataclass(frozen=True)
class Answer:
    """Result of a search for n pushes.

    Attributes:
        ratio: load ratios at which they slide, shape (n,); inf where they never do. Where they
            topple first, the one that the loads at tipping would hold.
        residual: see `ExactThresholds`, shape (n,).
        motion: see `ExactThresholds`, shape (2, n); nan where they do not slide first.
    """

    ratio: Array
    residual: Array
    motion: Array


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


class _Look(NamedTuple):
    """What friction holds at load ratios of n pushes, of k points.

    Attributes:
        excess: μ S − r |u_xy|, shape (n,).
        slope: its derivative by r, shape (n,).
        limit: the friction limit.
        q: centres of pressure, shape (2, n) [m].
        loads: of the points, shape (k, n).
        along, left: the points, see `friction_points`, shape (k, n) [m].
    """

    excess: Array
    slope: Array
    limit: Limit
    q: Array
    loads: Array
    along: Array
    left: Array


class _Search:
    """The first load ratio at which each of n pushes slides."""

    def __init__(
        self, base: Base, springs: Springs, scale: float, mu: float, com: Array,
        p: Array, u: Array, tips: Array,
    ) -> None:  # fmt: skip
        self.springs, self.scale, self.mu = springs, scale, mu
        # On a round base the points are a polygon; the centre of pressure is kept on that.
        self.inside = hull_polygon(springs.points) if isinstance(base, Disc) else None
        self.h, self.along, across = push_axes(u)
        self.line = np.sum(p[:, :2] * across, axis=1)
        self.across = across
        self.start = np.tile(com[:, None], (1, len(p)))
        self.moves = (u[:, 2:] * com + push_moment(p, u)).T
        with np.errstate(divide="ignore"):
            straight = mu / self.h  # more than that no support resists
        self.tips = tips
        self.leaves = np.full(len(p), np.inf)
        if self.inside is not None:
            level = np.zeros(len(p))
            leaves = self.inside.topple_force(self.start.T, self.moves.T, level, 1.0)
            self.leaves = leaves * (1.0 - _SHORT)
        self.last = np.minimum(tips * (1.0 - _SHORT), straight * (1.0 + _SHORT))
        self.loaded = np.ones((len(springs.points), len(p)), dtype=bool)

    def first_slides(self, guess: Array) -> Answer:
        """The first ratios at which the pushes slide, from guesses, shape (n,)."""
        n = len(guess)
        answer = Answer(np.full(n, np.inf), np.zeros(n), np.full((2, n), np.nan))
        i = self._movable()
        zero, last = np.zeros(i.size), self.last[i]
        self._solve_brackets(i, zero, last, np.minimum(guess[i], last), answer)
        i, lo, hi = self._earlier_brackets(i, np.minimum(answer.ratio[i], last))
        self._solve_brackets(i, lo, hi, 0.5 * (lo + hi), answer)
        return answer

    def slide_first(self, guess: Array) -> NDArray[np.bool_]:
        """Return True for pushes that slide before they topple, from guesses, shape (n,)."""
        slides = np.zeros(len(guess), dtype=bool)
        i = self._movable()
        for at in (np.minimum(guess, self.last), self.last):
            slides[i] = self.friction_excess(at[i], i).excess < -_PRECISE * self.h[i] * at[i]
            i = i[~slides[i]]
        slides[self._earlier_brackets(i, self.last[i])[0]] = True
        return slides

    def _movable(self) -> Index:
        """Pushes that may slide."""
        return np.flatnonzero((self.h > 0.0) & (self.last > 0.0) & np.isfinite(self.last))

    def _solve_brackets(self, i: Index, lo: Array, hi: Array, at: Array, answer: Answer) -> None:
        """Newton's method inside brackets, where the push holds at the lower end.

        It holds at the upper end too if it never slides; that is learned there, at the last ratio.
        """
        lo, hi, at = lo.copy(), hi.copy(), at.copy()
        open_ = np.arange(i.size)
        near = None
        for number in range(_STEPS):
            if not open_.size:
                return
            x, pushes = at[open_], i[open_]
            look = self.friction_excess(x, pushes, x >= self.last[pushes], near)
            value, limit = look.excess, look.limit
            done = np.abs(value) <= _PRECISE * self.h[pushes] * x
            slides = (value < 0.0) | done
            never = ~slides & (x >= self.last[pushes])
            lo[open_], hi[open_] = np.where(slides, lo[open_], x), np.where(slides, x, hi[open_])
            low, high = lo[open_], hi[open_]
            with np.errstate(divide="ignore", invalid="ignore"):
                step = x - value / look.slope
            inside = (step > low) & (step < high) & (number < _NEWTON or number % 2 == 0)
            far = ~slides & (step >= high) & (high >= self.last[pushes])
            at[open_] = np.where(inside, step, np.where(far, high, 0.5 * (low + high)))
            done |= ~never & (high - low <= _PRECISE * high)
            if done.any():
                answer.ratio[pushes[done]] = x[done]
                answer.residual[pushes[done]] = self._residual(x[done], pushes[done], look, done)
                answer.motion[:, pushes[done]] = limit.across[done], limit.turn[done]
            # Toppling comes first: it would slide later, if its loads stayed those at tipping.
            kept = never & np.isfinite(self.tips[pushes])
            answer.ratio[pushes[kept]] = self.mu * limit.ratio[kept] / self.h[pushes[kept]]
            going = ~done & ~never
            open_, near = open_[going], limit.chosen_pushes(going)
        answer.residual[i[open_]] = np.inf

    def _earlier_brackets(self, i: Index, found: Array) -> tuple[Index, Array, Array]:
        """Pushes that slide before those found, where looked at last, and brackets of that.

        While the same points are loaded the loads are linear in r and S is concave in them: a push
        that holds at both ends of such a stretch holds on all of it. So the ends are looked at, or
        even steps where the points are many.
        """
        changed = (self.loaded[:, i] != self._loaded_at_rest).any(axis=0) | (found > self.leaves[i])
        i, found = i[changed], found[changed]
        if not i.size:
            return i, found, found
        if len(self.springs.points) <= _FEW:
            last = np.minimum(found, self.leaves[i])
            begin = np.repeat(self._loaded_at_rest, i.size, axis=1)
            moves = self.start[:, i], self.moves[:, i]
            ends = [*self.springs.load_changes(*moves, last, begin), last]
        else:
            ends = list(np.arange(1, _LOOKS)[:, None] / _LOOKS * found)
        lo, hi, earlier = np.zeros(i.size), found.copy(), np.zeros(i.size, dtype=bool)
        # Few pushes are looked at at many ends at once.
        at_once = max(BLOCK // max(len(self.springs.points) * i.size, 1), 1)
        for start in range(0, len(ends), at_once):
            r = np.array(ends[start : start + at_once])
            slides, holds = np.zeros((2, *r.shape), dtype=bool)
            row, k = np.nonzero((r < found * (1.0 - _SHORT)) & ~earlier)
            if not k.size:
                continue
            excess = self.friction_excess(r[row, k], i[k]).excess
            slides[row, k] = excess < -_PRECISE * self.h[i[k]] * r[row, k]
            holds[row, k] = ~slides[row, k]
            first = np.where(slides, r, np.inf).min(axis=0)
            lo = np.maximum(lo, np.where(holds & (r < first), r, 0.0).max(axis=0))
            hi, earlier = np.minimum(hi, first), earlier | slides.any(axis=0)
        return i[earlier], lo[earlier], hi[earlier]

    @cached_property
    def _loaded_at_rest(self) -> NDArray[np.bool_]:
        """Which points are loaded before anybody pushes, shape (k, 1)."""
        loaded = np.ones((len(self.springs.points), 1), dtype=bool)
        self.springs.loads(self.start[:, :1], self.moves[:, :1], loaded)
        return loaded

    def pressure_centres(self, r: Array, i: Index) -> tuple[Array, Array]:
        """Centres of pressure and how they move with r, each (2, n)."""
        q, dq = self.start[:, i] + r * self.moves[:, i], self.moves[:, i]
        if self.inside is not None:
            beyond = (self.inside.normals @ q / self.inside.offsets[:, None]).max(axis=0)
            beyond = np.maximum(beyond * (1.0 + _SHORT), 1.0)
            q, dq = q / beyond, np.where(beyond > 1.0, 0.0, dq)
        return q, dq

    def friction_excess(
        self, r: Array, i: Index, precise: NDArray[np.bool_] | bool = False,
        near: Limit | None = None,
    ) -> _Look:  # fmt: skip
        """The friction at load ratios: the sign of the excess, and itself where it is small.

        Limits of looks near by spare steps. Where `precise`, the excess is found however large.
        """
        q, dq = self.pressure_centres(r, i)
        loaded = self.loaded[:, i]
        loads, change = self.springs.loads(q, dq, loaded)
        self.loaded[:, i] = loaded
        along, left = self.friction_points(q, i)
        compared = np.where(precise, np.nan, r * self.h[i] / self.mu)
        limit = friction_limit(loads, along, left, compared, near)
        slope = (change * np.hypot(*limit.slip_velocities(along, left))).sum(axis=0)
        if self.scale != 1.0:
            ahead, aside = self.in_push_axes((1.0 - self.scale) * dq, i)
            slope += limit.turn * (loads * (limit.across_i * ahead - limit.along_i * aside)).sum(
                axis=0
            )
        excess, slope = self.mu * limit.ratio - r * self.h[i], self.mu * slope - self.h[i]
        return _Look(excess, slope, limit, q, loads, along, left)

    def in_push_axes(self, q: Array, i: Index) -> tuple[Array, Array]:
        """Vectors (2, n) of B along the pushes and to their left."""
        a, b = self.along[i].T, self.across[i].T
        return a[0] * q[0] + a[1] * q[1], b[0] * q[0] + b[1] * q[1]

    def friction_points(self, q: Array, i: Index) -> tuple[Array, Array]:
        """The points where friction acts, along the pushes and left of their lines, each (k, n)."""
        points = self.springs.points
        along, left = points @ self.along[i].T, points @ self.across[i].T - self.line[i]
        if self.scale != 1.0:
            ahead, aside = self.in_push_axes(q, i)
            along = ahead + self.scale * (along - ahead)
            left = (aside - self.line[i]) + self.scale * (left - (aside - self.line[i]))
        return along, left

    def _residual(self, r: Array, i: Index, look: _Look, done: NDArray[np.bool_]) -> Array:
        """Largest relative violation of what must hold, from the forces themselves."""
        limit = look.limit
        q, loads, along, left = (each[:, done] for each in look[3:])
        d_x, d_y = limit.along_i[:, done], limit.across_i[:, done]
        size = np.sqrt((loads * (along**2 + left**2)).sum(axis=0))
        push = r * self.h[i] / self.mu
        violated = (
            np.abs(loads.sum(axis=0) - 1.0),
            np.abs(self.springs.points.T @ loads - q).max(axis=0) / size,
            np.abs((loads * d_x).sum(axis=0) - push) / push,
            np.abs((loads * d_y).sum(axis=0)) / push,
            np.abs((loads * (along * d_y - left * d_x)).sum(axis=0)) / (push * size),
            np.maximum(np.hypot(d_x, d_y).max(axis=0) - 1.0, 0.0),
            np.abs(limit.ratio[done] - push) / push,  # power dissipated and supplied
        )
        return np.asarray(np.max(violated, axis=0))
