"""Slides of pushes while the same points stay loaded: motion and load ratio found together.

Model: see `objectmodels.mechanics.exact.exact_thresholds`. On such a stretch the loads grow evenly,
N_i = n_i + r n'_i. So r and the motion (β, ω) follow from three equations at once, those of
`objectmodels.mechanics.friction_limit` for the least power and r |u_xy| = μ Σ N_i |v_i|: by
Newton's method, or in closed form if the body turns about one of the points.

Arrays are laid out with the k points first and the n pushes last.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.vector_arrays import total
from objectmodels.mechanics.friction_limit import (
    Limit,
    certified_limit,
    slip_equations,
    start_motion,
)

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
