"""Bounds of the exact tier over every way in which the support points may share the load.

*Optimistic*: the largest push that some loads and friction forces at the points balance, all of
them pressing and inside their friction cones: a second-order cone programme, solved for all pushes
at once by a barrier method on its dual. That dual is a motion in space, whose least dissipation it
is; by it the points slip at (v_x, v_y) and are lifted by a + b·r ≥ |v|. (It says how far the push
can be held, not how the object moves: Coulomb friction is not associated.)

*Pessimistic*: the smallest push that some admissible loads cannot hold. The friction limit is
concave in the loads, so the worst ones are at a corner of those that are admissible: they rest on
three points around the centre of pressure.

Pushes are measured by the load ratio r = s/N, as in `objectmodels.exact`.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.base import Array
from objectmodels.errors import ModelError
from objectmodels.exact import axes
from objectmodels.limit import friction_limit
from objectmodels.thresholds import force_at, push_moment, ratio_at

if TYPE_CHECKING:
    from objectmodels.exact import ExactThresholds

BLOCK = 512

MOST_POINTS = 12
"""Of more points than these the bounds take the corners of the hull only: they are extreme."""

_STEEPER = 8.0  # by which the barrier's weight grows
_PRECISE = 1e-9  # relative gap at which the barrier method stops
_CENTRING = 4  # Newton steps for each weight, at most
_RIDGE = 1e-14
_LOOKS = 12
_HALVINGS = 45


def optimistic(t: ExactThresholds) -> Array:
    """Onset under the best sharing of the load, shape (n,) [N]."""
    (p, u), (_, c, _, weight) = t.push, t.body
    points = _extreme(t)
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


def _extreme(t: ExactThresholds) -> Array:
    """The support points, or the corners of their hull if they are many, shape (k, 2) [m]."""
    points, _, scale = t.support
    if scale != 1.0 and len(points) <= MOST_POINTS:
        # A fitted friction radius says that other points carry than were assumed.
        middle = t.support[1] @ points
        points = np.asarray(middle + min(scale, 1.0) * (points - middle))
    extreme: Array = points if len(points) <= MOST_POINTS else t.body[0].corners
    return extreme


def _largest_ratio(points: Array, com: Array, p: Array, u: Array, mu: float) -> Array:
    """Largest load ratio at which the points can hold a push, shape (n,).

    In units of μ/|u_xy|: least a + b·c over (β, ω, a, b) with a + b·r_i ≥ |v_i| for all points,
    v_i = (1 + κ b·g − ω η_i, β + ω ξ_i), κ = μ/|u_xy| and g = u_z c + p_z u_xy − u_z p_xy.
    """
    size = float(np.hypot(*np.ptp(points, axis=0)))
    h, along, across = axes(u)
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
        weight *= _STEEPER
        for _ in range(_CENTRING):
            step, decrement = _newton(x, weight, cost, lift, v_x, v_y)
            x = x + _inside(x, step, lift, v_x, v_y) * step
            if decrement.max() < 1e-3:
                break
    return np.asarray(kappa * (x * cost).sum(axis=1))


def _cone(x: Array, lift: Array, v_x: Array, v_y: Array) -> tuple[Array, Array, Array, Array]:
    """Lift and slip of the points, and lift² − slip², each (k, n)."""
    z, a, b = (lift * x).sum(-1), 1.0 + (v_x * x).sum(-1), (v_y * x).sum(-1)
    return z, a, b, z * z - a * a - b * b


def _newton(
    x: Array, weight: float, cost: Array, lift: Array, v_x: Array, v_y: Array
) -> tuple[Array, Array]:
    """Newton step of weight · cost − Σ log(lift² − slip²), and its decrement."""
    z, a, b, d = _cone(x, lift, v_x, v_y)
    grown = (z[..., None] * lift - a[..., None] * v_x - b[..., None] * v_y) * (2.0 / d)[..., None]
    gradient = weight * cost - grown.sum(axis=0)
    root = np.sqrt(2.0 / d)[..., None]
    rows = np.stack((lift * root, v_x * root, v_y * root))
    signs = np.array([-1.0, 1.0, 1.0])
    hessian = np.einsum("skni,sknj->nij", rows * signs[:, None, None, None], rows)
    hessian += np.einsum("kni,knj->nij", grown, grown)
    # Near an optimum that is an edge the equations lose rank but for rounding.
    scale = 1.0 / np.sqrt(np.einsum("nii->ni", hessian))
    scaled = hessian * scale[:, :, None] * scale[:, None, :] + _RIDGE * np.eye(5)
    step = -scale * np.linalg.solve(scaled, (scale * gradient)[..., None])[..., 0]
    return step, -(gradient * step).sum(axis=1)


def _inside(x: Array, step: Array, lift: Array, v_x: Array, v_y: Array) -> Array:
    """Shares of steps that stay well inside all cones, shape (n, 1)."""
    share = np.ones(len(x))
    for _ in range(40):
        z, _, _, d = _cone(x + share[:, None] * step, lift, v_x, v_y)
        out = ((d <= 0.0) | (z <= 0.0)).any(axis=0)
        if not out.any():
            break
        share[out] *= 0.6
    return np.where(share < 1.0, 0.9 * share, share)[:, None]


def pessimistic(t: ExactThresholds) -> Array:
    """Onset under the worst sharing of the load, shape (n,) [N].

    Raises:
        ModelError: `too_many_points` for a support without few points to rest on.
    """
    (p, u), (_, c, _, weight) = t.push, t.body
    points = _extreme(t)
    if len(points) > 2 * MOST_POINTS:
        raise ModelError("too_many_points", f"three of {len(points)} points are too many choices")
    h, along, across = axes(u)
    e = u[:, 2:] * c[:2] + push_moment(p, u)
    w, mu = u[:, 2], t.coefficient
    with np.errstate(divide="ignore"):
        last = np.minimum(ratio_at(t.topple, w, weight), mu / h)
    worst = np.full(len(p), np.inf)
    for three in combinations(range(len(points)), 3):
        corner = points[list(three)]
        area = np.linalg.det(np.column_stack((np.ones(3), corner)))
        if abs(area) < 1e-12 * np.ptp(points) ** 2:
            continue
        # Loads of the three grow evenly with the load ratio: N = n0 + r n1.
        share = np.linalg.inv(np.vstack((np.ones(3), corner.T)))
        n0 = (share @ np.append(1.0, c[:2]))[:, None]
        n1 = share[:, 1:] @ e.T
        first, end = _carried(n0, n1, last)
        (i,) = np.nonzero((first < end) & (h > 0.0) & (first < worst))
        if i.size:
            xi = corner @ along[i].T
            eta = corner @ across[i].T - np.sum(p[i, :2] * across[i], axis=1)
            r = _first_slide(n0, n1[:, i], xi, eta, mu / h[i], first[i], end[i])
            worst[i] = np.minimum(worst[i], r)
    return np.minimum(force_at(worst, w, weight), t.topple)


def _carried(n0: Array, n1: Array, last: Array) -> tuple[Array, Array]:
    """Between which load ratios three loads n0 + r n1 all press, shape (n,) each."""
    with np.errstate(divide="ignore", invalid="ignore"):
        zero = -n0 / n1
    first = np.where(n1 > 0.0, zero, np.where((n1 == 0.0) & (n0 < 0.0), np.inf, 0.0)).max(axis=0)
    end = np.where(n1 < 0.0, zero, np.inf).min(axis=0)
    return np.maximum(first, 0.0), np.minimum(end, last)


def _first_slide(
    n0: Array, n1: Array, xi: Array, eta: Array, kappa: Array, first: Array, end: Array
) -> Array:
    """First r in an interval at which r ≥ κ S for three loads; inf if there is none, (n,)."""

    def slides(r: Array) -> Array:
        loads = np.maximum(n0 + r * n1, 0.0)
        # A point without load has no friction, yet the equations need all three.
        loads = np.maximum(loads, 1e-12)
        return np.asarray(r >= kappa * friction_limit(loads, xi, eta).ratio)

    lo, hi = first.copy(), np.full(len(first), np.inf)
    for k in range(_LOOKS + 1):
        r = first + (end - first) * k / _LOOKS
        yes = slides(r) & np.isinf(hi)
        hi = np.where(yes, r, hi)
        lo = np.where(np.isinf(hi), r, lo)
    (i,) = np.nonzero(np.isfinite(hi) & (hi > lo))
    n1, xi, eta, kappa = n1[:, i], xi[:, i], eta[:, i], kappa[i]
    for _ in range(_HALVINGS):
        if not i.size:
            break
        r = 0.5 * (lo[i] + hi[i])
        yes = slides(r)
        hi[i], lo[i] = np.where(yes, r, hi[i]), np.where(yes, lo[i], r)
    return hi
