"""The first load ratio at which a push slides, for an object that stands on springs.

Model: see `objectmodels.exact.exact_thresholds`. While the same points are loaded, their
loads are linear in the load ratio r and the friction limit S is concave in them.

Arrays are laid out with the k points first and the n pushes last.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from objectmodels.exact.support_springs import Springs
from objectmodels.geometry.base_shapes import Array, Base, hull_polygon
from objectmodels.geometry.rotations import total
from objectmodels.mechanics.friction_limit import (
    Limit,
    certified_limit,
    friction_limit,
    slip_equations,
    start_motion,
)
from objectmodels.mechanics.push_thresholds import push_axes, push_moment

# Slides of pushes while the same points stay loaded: motion and load ratio found together.
#
# Model: see `objectmodels.exact.exact_thresholds`. On such a stretch the loads grow
# evenly, N_i = n_i + r n'_i. So r and the motion (β, ω) follow from three equations at once,
# those of `objectmodels.mechanics.friction_limit` for the least power and r |u_xy| = μ Σ N_i
# |v_i|: by Newton's method, or in closed form if the body turns about one of the points.
#
# Arrays are laid out with the k points first and the n pushes last.

# Slip speed below which friction is smoothed at first, share that is left by each step, and steps.
_QUICK, _PATIENT = (0.01, 0.03, 8), (1.0, 0.3, 24)
_SHARPEST = 1e-13
_LAST_STEP = 1e-10  # an excess from which a step of Newton's ends at the root


class Stretch(NamedTuple):
    """Pushes while the same points are loaded; lengths are in units of the points' spread.

    Attributes:
        ratio: load ratio at which loads and places are given, shape (n,).
        loads, rates: N_i and their derivatives by the load ratio, shape (k, n).
        along, left: places of the points, see `friction_limit`, shape (k, n).
        drift: derivative of `left` by the load ratio, the same for all points, shape (n,).
        demand: |u_xy| / μ, shape (n,).
        last: load ratio at which the push topples, or no support resists, shape (n,).
    """

    ratio: Array
    loads: Array
    rates: Array
    along: Array
    left: Array
    drift: Array
    demand: Array
    last: Array

    def chosen_pushes(self, i: NDArray[np.bool_] | NDArray[np.intp]) -> Stretch:
        """The stretches of some pushes."""
        return Stretch(*(each[..., i] for each in self))

    def moved_to(self, ratio: Array) -> Stretch:
        """The same at other load ratios."""
        way = ratio - self.ratio
        loads = np.maximum(self.loads + way * self.rates, 0.0)
        return self._replace(ratio=ratio, loads=loads, left=self.left + way * self.drift)


@np.errstate(divide="ignore", invalid="ignore", over="ignore")  # points in the centre do not slip
def slides_on(stretch: Stretch, distances: Array, patient: bool) -> tuple[Array, Limit]:
    """Load ratios (n,) at which pushes slide, and the friction limits there.

    Pushes that hold up to the last ratio have that one. Where nothing was found, the limit's
    residual is infinite.

    Args:
        stretch: of the pushes.
        distances: between the points, shape (k, k).
        patient: whether to go slowly to where the centre of rotation nearly is a point.
    """
    ratio, found = _turns_about_points(stretch, distances)
    (i,) = np.nonzero(np.isinf(found.residual))
    if i.size:
        ratio[i], others = _newton_slides(stretch.chosen_pushes(i), patient)
        found.take_over(i, others)
    return ratio, found


def _turns_about_points(stretch: Stretch, distances: Array) -> tuple[Array, Limit]:
    """Slides about the point that gives way first, if it bears what balance asks of it."""
    r, loads, rates, along, left, drift, demand, last = stretch
    # The roots of Σ N_i |x_i − x_j| = r |u_xy| |η_j| / μ, where loads and η_j grow evenly.
    held, more, lead = distances @ loads, distances @ rates, demand * np.sign(left)
    a, b, c = lead * drift, lead * (left + r * drift) - more, lead * r * left - held
    roots = r - 2.0 * c / (b + np.sqrt(b * b - 4.0 * a * c))
    roots[~(roots > 0.0)] = np.inf
    slide = roots.min(axis=0)
    holds = slide >= last
    at_last = (held + (last - r) * more) / np.abs(left + (last - r) * drift)
    about = np.where(holds, at_last, roots).argmin(axis=0)
    own, slide = (about, np.arange(r.size)), np.where(holds, last, slide)

    _, loads, _, along, left, *_ = stretch.moved_to(slide)
    turn, distance = 1.0 / left[own], distances[:, about]
    ratio = total(distance * loads) * np.abs(turn)
    distance[own] = 1.0
    x, y = along - along[own], left - left[own]
    side = np.sign(turn)
    f_x, f_y = -side * y / distance, side * x / distance
    # What is left for the point in the centre to balance the push.
    f_x[own] = (ratio - total(loads * f_x)) / loads[own]
    f_y[own] = -total(loads * f_y) / loads[own]
    balanced = f_x[own] ** 2 + f_y[own] ** 2 <= 1.0
    found = balanced & ~(holds & (ratio < last * demand))
    residual = np.where(found, 0.0, np.inf)
    return slide, Limit(ratio, -along[own] * turn, turn, f_x, f_y, residual)


def _newton_slides(start: Stretch, patient: bool) -> tuple[Array, Limit]:
    """Slides by Newton's method on motion, friction and load ratio."""
    slide, found = start.ratio.copy(), Limit.empty_limit(*start.loads.shape)
    open_, here = np.arange(start.ratio.size), start
    across, turn = start_motion(here.loads, here.along, here.left)
    v_x, v_y = 1.0 - turn * here.left, across + turn * here.along
    slowness = 1.0 / np.sqrt(v_x * v_x + v_y * v_y)
    d_x, d_y = v_x * slowness, v_y * slowness
    smooth, sharper, steps = _PATIENT if patient else _QUICK
    done = np.zeros(open_.size, dtype=bool)
    for _ in range(steps):
        r, slope, across, turn, d_x, d_y = _joint_step(here, across, turn, d_x, d_y, smooth)
        here, smooth = start.moved_to(r), max(sharper * smooth, _SHARPEST)
        limit, precise = certified_limit(here.loads, here.along, here.left, across, turn, d_x, d_y)
        excess, demand = limit.ratio - r * here.demand, r * here.demand
        holds = (r >= here.last) & (excess >= 0.0)
        done = precise & (holds | (np.abs(excess) <= _LAST_STEP * demand))
        if done.any():
            slide[open_[done]] = np.where(holds, r, r - excess / slope)[done]
            found.take_over(open_[done], limit.chosen_pushes(done))
            # To leave the others alone takes as long as a step.
            if done.all():
                break
            if 2 * done.sum() > done.size:
                keep = ~done
                open_, start, here = (
                    open_[keep],
                    start.chosen_pushes(keep),
                    here.chosen_pushes(keep),
                )
                across, turn, d_x, d_y = across[keep], turn[keep], d_x[:, keep], d_y[:, keep]
    return slide, found


def _joint_step(
    here: Stretch, across: Array, turn: Array, d_x: Array, d_y: Array, smooth: float
) -> tuple[Array, Array, Array, Array, Array, Array]:
    """New load ratio, slope of the excess, and new motion and friction."""
    r, loads, rates, along, left, drift, demand, last = here
    e = slip_equations(loads, along, left, across, turn, d_x, d_y, smooth)
    power, by_ratio = total(loads / e.slowness), total(rates / e.slowness)
    by_across = total(rates * e.slip_y)
    by_turn = total(rates * (along * e.slip_y - left * e.slip_x))
    if drift.any():
        pull = drift * total(loads * e.slip_x)
        by_ratio, by_turn = by_ratio - turn * pull, by_turn - pull
    excess, slope = power - r * demand, by_ratio - demand
    b, w = e.motion_against(*e.gradient)
    b_r, w_r = e.motion_against(by_across, by_turn)
    (g_b, g_w) = e.gradient
    step = -(excess + g_b * b + g_w * w) / (slope + g_b * b_r + g_w * w_r)
    new = np.where(r + step <= last, np.maximum(r + step, 0.5 * r), last)
    step = new - r
    b, w = b + step * b_r, w + step * w_r
    d_x, d_y = e.friction_after(d_x, d_y, -w * left - step * turn * drift, b + w * along)
    return new, slope, across + b, turn + w, d_x, d_y


@dataclass(frozen=True, eq=False)
class Standing:
    """An object as it stands; the last three for all pushes, or one for each of n.

    Attributes:
        base: over which it would topple.
        springs: that it stands on.
        scale: factor of their distances from the centre of pressure, shape (1,) or (n,).
        mu: friction coefficient at the table, shape (1,) or (n,).
        com: centre of mass over the base, shape (1, 2) or (n, 2) [m].
    """

    base: Base
    springs: Springs
    scale: Array
    mu: Array
    com: Array

    @cached_property
    def loaded_at_rest(self) -> NDArray[np.bool_]:
        """Which points are loaded before anybody pushes, shape (k, 1) or (k, n)."""
        com = self.com.T
        loaded = np.ones((len(self.springs.points), com.shape[1]), dtype=bool)
        self.springs.loads(com, np.zeros_like(com), loaded)
        return loaded


BLOCK = 16384
"""Points of pushes treated at once, so that the arrays stay in the processor's cache."""

# The centre of pressure stays so much of its way short of the edge, where loads are not unique.
_SHORT = 1e-9
CERTAIN = 1e-6
"""Residual up to which an answer is one."""

_STRETCHES = 3  # sets of loaded points that are tried before brackets are taken
_NEARER = 0.75
_CLOSE = 1e-8  # residual above which what was found at once is sought in brackets too
_STEPS = 100
_MORE = 1e-8  # share by which more friction is used, beyond the precision of its limit
_PRECISE = 1e-12  # of the load ratio
_LOOKS = 16  # even steps in which slides before the one found are looked for
_FEW = 24  # points up to which all changes of the loaded ones are looked at instead
_LOOKS_USED, _FEW_USED = 4, 12  # the same for the largest friction used, which is flat there

Index = NDArray[np.intp]


def push_blocks(n: int, springs: Springs) -> Iterator[slice]:
    """Parts of n pushes that are treated at once."""
    block = max(BLOCK // len(springs.points), 1)
    return (slice(start, start + block) for start in range(0, n, block))


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


class SlideSearch:
    """The first load ratio at which each of n pushes slides."""

    def __init__(self, body: Standing, p: Array, u: Array, tips: Array) -> None:
        n, self.body, self.springs = len(p), body, body.springs
        self.scale, self.mu = np.broadcast_to(body.scale, n), np.broadcast_to(body.mu, n)
        self.scaled = bool((body.scale != 1.0).any())
        # On a round base the points are a polygon; the centre of pressure is kept on that.
        self.inside = hull_polygon(self.springs.points) if body.base.is_round else None
        self.h, self.along, across = push_axes(u)
        self.line = np.sum(p[:, :2] * across, axis=1)
        self.across = across
        self.com = body.com.T
        self.start = np.broadcast_to(self.com, (2, n))
        self.moves = (u[:, 2:] * body.com + push_moment(p, u)).T
        with np.errstate(divide="ignore"):
            straight = self.mu / self.h  # more than that no support resists
        self.tips = tips
        self.leaves = np.full(n, np.inf)
        if self.inside is not None:
            leaves = self.inside.topple_force(self.start.T, self.moves.T, np.zeros(n), 1.0)
            self.leaves = leaves * (1.0 - _SHORT)
        self.last = np.minimum(tips * (1.0 - _SHORT), straight * (1.0 + _SHORT))
        self.loaded = np.ones((len(self.springs.points), n), dtype=bool)

    def first_slides(self, guess: Array) -> Answer:
        """The first ratios at which the pushes slide, from guesses, shape (n,)."""
        n = len(guess)
        answer = Answer(np.full(n, np.inf), np.zeros(n), np.full((2, n), np.nan))
        i = self._movable()
        at = np.minimum(guess, self.last)
        open_ = self._slides_on_stretches(i, at, answer)
        self._solve_brackets(open_, np.zeros(open_.size), self.last[open_], at[open_], answer)
        i, lo, hi = self._earlier_brackets(i, np.minimum(answer.ratio[i], self.last[i]))
        self._solve_brackets(i, lo, hi, 0.5 * (lo + hi), answer)
        (i,) = np.nonzero(~(answer.residual <= CERTAIN))
        at = np.minimum(answer.ratio[i], self.last[i])
        self._solve_brackets(i, np.zeros(i.size), self.last[i], at, answer, precise=True)
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

    def critical_friction(self) -> Array:
        """Friction coefficients below which they slide before they topple, shape (n,).

        r |u_xy| / S is quasi-convex where S is concave: it is largest as the push topples, or where
        the loaded points change. The search is to be made for a friction without end.
        """
        self.mu = np.where(self.h > 0.0, np.inf, 0.0)
        self.mu[self.tips <= 0.0] = 0.0
        i, at = self._movable(), self.last
        self.mu[i] = 1.0
        look = self.friction_excess(at[i], i, precise=True)
        self.mu[i] = at[i] * self.h[i] / look.limit.ratio
        loaded = self.loaded.copy()
        while i.size:
            self.loaded = loaded.copy()
            i, _, earlier = self._earlier_brackets(i, at[i], _FEW_USED, _LOOKS_USED)
            look = self.friction_excess(earlier, i, precise=True)
            used = earlier * self.h[i] / look.limit.ratio
            more = used > self.mu[i] * (1.0 + _MORE)
            i = i[more]
            self.mu[i] = used[more]
        return self.mu

    def _movable(self) -> Index:
        """Pushes that may slide."""
        return np.flatnonzero((self.h > 0.0) & (self.last > 0.0) & np.isfinite(self.last))

    def _slides_on_stretches(self, i: Index, at: Array, answer: Answer) -> Index:
        """Answers the pushes that are found at once, from ratios (n,), and returns the others.

        The ratios of these are then nearer. Where the points are many they let go one after the
        other: then nothing is found so.
        """
        if len(self.springs.points) > _FEW:
            return i
        for number in range(_STRETCHES):
            if not i.size:
                break
            q, dq = self.pressure_centres(at[i], i)
            loaded = self.loaded[:, i]
            loads, rates = self.springs.loads(q, dq, loaded)
            r, limit = self._slides_where_loaded(at[i], i, q, dq, loads, rates, number > 0)
            q, _ = self.pressure_centres(r, i)
            now = loaded.copy()
            loads, _ = self.springs.loads(q, dq, now)
            found = np.isfinite(limit.residual)
            sure = found & (now == loaded).all(axis=0)
            # A start beyond many a slide leads Newton's method astray.
            self.loaded[:, i], at[i] = now, np.where(found, r, _NEARER * r)
            slides = sure & (r < self.last[i])
            look = _Look(r, r, limit, q, loads, *self.friction_points(q, i))
            self._keep(slides, r, i, look, answer)
            self._keep_held(sure & ~slides, i, limit, answer)
            i = i[~sure | (answer.residual[i] > _CLOSE)]
        return i

    def _slides_where_loaded(
        self, r: Array, i: Index, q: Array, dq: Array, loads: Array, rates: Array, patient: bool
    ) -> tuple[Array, Limit]:
        """Load ratios of slides if the same points stay loaded as at r, and the limits there."""
        along, left = self.friction_points(q, i)
        unit = self.springs.spread
        drift = self._drift(dq, i) / unit
        demand = self.h[i] / self.mu[i]
        stretch = Stretch(r, loads, rates, along / unit, left / unit, drift, demand, self.last[i])
        r, limit = slides_on(stretch, self.springs.distances / unit, patient)
        limit.turn /= unit
        return r, limit

    def _solve_brackets(
        self, i: Index, lo: Array, hi: Array, at: Array, answer: Answer, precise: bool = False
    ) -> None:
        """Newton's method inside brackets, where the push holds at the lower end.

        It holds at the upper end too if it never slides; that is learned there, at the last ratio.
        Where `precise`, limits are found from nothing near by, however large the excess.
        """
        if not i.size:
            return
        lo, hi, at = lo.copy(), hi.copy(), at.copy()
        open_ = np.arange(i.size)
        near = None
        for number in range(_STEPS):
            if not open_.size:
                return
            x, pushes = at[open_], i[open_]
            look = self.friction_excess(x, pushes, precise | (x >= self.last[pushes]), near)
            value, limit = look.excess, look.limit
            done = np.abs(value) <= _PRECISE * self.h[pushes] * x
            slides = (value < 0.0) | done
            never = ~slides & (x >= self.last[pushes])
            lo[open_], hi[open_] = np.where(slides, lo[open_], x), np.where(slides, x, hi[open_])
            low, high = lo[open_], hi[open_]
            with np.errstate(divide="ignore", invalid="ignore"):
                step = x - value / look.slope
            inside = (step > low) & (step < high)
            last = inside & ~done & (np.abs(value) <= _LAST_STEP * self.h[pushes] * x)
            # Steps after which every other one halves the bracket.
            inside &= number < 12 or number % 2 == 0
            met = high - low <= _PRECISE * high
            far = ~slides & ((step >= high) | met) & (high >= self.last[pushes])
            at[open_] = np.where(far, high, np.where(inside, step, 0.5 * (low + high)))
            done |= last | (~never & ~far & met)
            self._keep(done, np.where(last, step, x), pushes, look, answer)
            self._keep_held(never, pushes, limit, answer)
            going = ~done & ~never
            open_, near = open_[going], None if precise else limit.chosen_pushes(going)
        answer.residual[i[open_]] = np.inf

    def _keep(
        self, done: NDArray[np.bool_], r: Array, i: Index, look: _Look, answer: Answer
    ) -> None:
        """Takes those that are done, at their load ratios, for the answer."""
        if not done.any():
            return
        at, limit = i[done], look.limit
        answer.ratio[at] = r[done]
        answer.residual[at] = self._residual(r[done], at, look, done)
        turn, across = limit.turn[done], limit.across[done]
        if self.scaled:
            ahead, _ = self.in_push_axes(look.q[:, done], at)
            turn = turn / self.scale[at]
            across = across - turn * (1.0 - self.scale[at]) * ahead
        answer.motion[:, at] = across, turn

    def _keep_held(self, never: NDArray[np.bool_], i: Index, limit: Limit, answer: Answer) -> None:
        """Notes that some pushes never slide; if they topple, what holds them at tipping."""
        # Toppling comes first: it would slide later, if its loads stayed those at tipping.
        kept = never & np.isfinite(self.tips[i])
        answer.ratio[i[kept]] = (self.mu[i] * limit.ratio / self.h[i])[kept]

    def _earlier_brackets(
        self, i: Index, found: Array, few: int = _FEW, looks: int = _LOOKS
    ) -> tuple[Index, Array, Array]:
        """Pushes that slide before those found, where looked at last, and brackets of that.

        While the same points are loaded the loads are linear in r and S is concave in them: a push
        that holds at both ends of such a stretch holds on all of it. So the ends are looked at, or
        even steps where the points are many.
        """
        rest = np.broadcast_to(self.body.loaded_at_rest, self.loaded.shape)[:, i]
        changed = (self.loaded[:, i] != rest).any(axis=0) | (found > self.leaves[i])
        i, found = i[changed], found[changed]
        if not i.size:
            return i, found, found
        if len(self.springs.points) <= few:
            last = np.minimum(found, self.leaves[i])
            way = self.start[:, i], self.moves[:, i], last, rest[:, changed]
            ends = [*self.springs.load_changes(*way), last]
        else:
            ends = list(np.arange(1, looks)[:, None] / looks * found)
        lo, hi, earlier = np.zeros(i.size), found.copy(), np.zeros(i.size, dtype=bool)
        # Few pushes are looked at at many ends at once.
        at_once = max(BLOCK // max(len(self.springs.points) * i.size, 1), 1)
        for start in range(0, len(ends), at_once):
            r = np.array(ends[start : start + at_once])
            slides, holds = np.zeros((2, *r.shape), dtype=bool)
            row, k = np.nonzero((r < found * (1.0 - _SHORT)) & ~earlier)
            if not k.size:
                continue
            sure = self._surely_hold(r[row, k], found[k], i[k])
            holds[row[sure], k[sure]] = True
            row, k = row[~sure], k[~sure]
            excess = self.friction_excess(r[row, k], i[k]).excess
            slides[row, k] = excess < -_PRECISE * self.h[i[k]] * r[row, k]
            holds[row, k] = ~slides[row, k]
            first = np.where(slides, r, np.inf).min(axis=0)
            lo = np.maximum(lo, np.where(holds & (r < first), r, 0.0).max(axis=0))
            hi, earlier = np.minimum(hi, first), earlier | slides.any(axis=0)
        return i[earlier], lo[earlier], hi[earlier]

    def _surely_hold(self, r: Array, held: Array, i: Index) -> NDArray[np.bool_]:
        """Return True for pushes that hold at ratios r (n,) because they do at larger ones.

        Friction that balances the larger push, less in proportion, balances the smaller one. It is
        Coulomb's if no load has grown by more than the push has, which of many points some does.
        (A scale moves the points.)
        """
        if self.scaled or len(self.springs.points) > _FEW:
            return np.zeros(i.size, dtype=bool)
        loads, more = (
            self.springs.loads(*self.pressure_centres(at, i), self.loaded[:, i])[0]
            for at in (r, held)
        )
        return np.asarray((loads * held >= (more - _PRECISE) * r).all(axis=0))

    def pressure_centres(self, r: Array, i: Index) -> tuple[Array, Array]:
        """Centres of pressure and how they move with r, each (2, n)."""
        q, dq = self.start[:, i] + r * self.moves[:, i], self.moves[:, i]
        if self.inside is not None:
            beyond = (self.inside.normals @ q / self.inside.offsets[:, None]).max(axis=0)
            beyond = np.maximum(beyond * (1.0 + _SHORT), 1.0)
            q, dq = q / beyond, np.where(beyond > 1.0, 0.0, dq)
        return q, dq

    def friction_excess(
        self,
        r: Array,
        i: Index,
        precise: NDArray[np.bool_] | bool = False,
        near: Limit | None = None,
    ) -> _Look:
        """The friction at load ratios: the sign of the excess, and itself where it is small.

        Limits of looks near by spare steps. Where `precise`, the excess is found however large.
        """
        q, dq = self.pressure_centres(r, i)
        loaded = self.loaded[:, i]
        loads, change = self.springs.loads(q, dq, loaded)
        self.loaded[:, i] = loaded
        along, left = self.friction_points(q, i)
        mu, h = self.mu[i], self.h[i]
        compared = np.where(precise, np.nan, r * h / mu)
        limit = friction_limit(loads, along, left, compared, near)
        slope = total(change * np.hypot(*limit.slip_velocities(along, left)))
        if self.scaled:
            slope -= limit.turn * self._drift(dq, i) * total(loads * limit.along_i)
        return _Look(mu * limit.ratio - r * h, mu * slope - h, limit, q, loads, along, left)

    def in_push_axes(self, q: Array, i: Index) -> tuple[Array, Array]:
        """Vectors (2, n) of B along the pushes and to their left."""
        a, b = self.along[i].T, self.across[i].T
        return a[0] * q[0] + a[1] * q[1], b[0] * q[0] + b[1] * q[1]

    def friction_points(self, q: Array, i: Index) -> tuple[Array, Array]:
        """The points along the pushes and left of their lines, each (k, n).

        A scale s of the points' distances from q is one of how far q is from the line, 1/s, and of
        the turning rate: as the loads' middle is q, that gives the same slip but for a shift.
        """
        points = self.springs.points
        along, left = points @ self.along[i].T, points @ self.across[i].T - self.line[i]
        if self.scaled:
            _, aside = self.in_push_axes(q, i)
            left += (1.0 / self.scale[i] - 1.0) * (aside - self.line[i])
        return along, left

    def _drift(self, dq: Array, i: Index) -> Array:
        """Derivative of the points' distances to the left of the lines, as q moves by dq, (n,)."""
        if not self.scaled:
            return np.zeros(i.size)
        return (1.0 / self.scale[i] - 1.0) * self.in_push_axes(dq, i)[1]

    def _residual(self, r: Array, i: Index, look: _Look, done: NDArray[np.bool_]) -> Array:
        """Largest relative violation of what must hold, from the forces themselves."""
        limit = look.limit
        q, loads, along, left = (each[:, done] for each in look[3:])
        d_x, d_y = limit.along_i[:, done], limit.across_i[:, done]
        size = np.sqrt(total(loads * (along**2 + left**2)))
        push = r * self.h[i] / self.mu[i]
        violated = (
            np.abs(total(loads) - 1.0),
            np.abs(self.springs.points.T @ loads - q).max(axis=0) / size,
            np.abs(total(loads * d_x) - push) / push,
            np.abs(total(loads * d_y)) / push,
            np.abs(total(loads * (along * d_y - left * d_x))) / (push * size),
            np.maximum(np.hypot(d_x, d_y).max(axis=0) - 1.0, 0.0),
            np.abs(limit.ratio[done] - push) / push,  # power dissipated and supplied
        )
        return np.asarray(np.max(violated, axis=0))
