"""Forces at which a pushed object starts to slide or to topple: closed forms over whole arrays.

Model: a rigid object with a flat convex base on a rigid horizontal table, Coulomb friction at the
table, one point force F = s u whose size s grows slowly from zero. Toppling is exact for any such
base (`objectmodels.geometry.base_shapes`). Sliding follows the ellipsoidal limit surface with
friction radius c̄:
|F_xy|² + (m_z / c̄)² = (μ N)², m_z about the centre of pressure, N = G − F_z.

Frame: everything is in B, origin at the centre of the base, z up. Sources: the paper "Prediction of
action outcomes using an object model" for the questions; Howe and Cutkosky 1996 and Lynch,
Maekawa and Tanie 1992 for the limit surface.

Functions broadcast over leading axes; p, u and c have three components in their last axis. A
threshold that is never met is infinite.
"""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np

from objectmodels.geometry.base_shapes import Array, Base
from objectmodels.geometry.vector_arrays import cross

GRAVITY = 9.81
"""Standard acceleration of free fall used throughout [m/s²]."""

Number = TypeVar("Number", float, Array)

QUICK_STEPS, MORE_STEPS = 4, 8
"""Newton steps to the load per force; all but some pushes in a hundred need no more than four."""

LAST_STEP = 1e-8
"""A step of less than this share ends at the root, but for some hundred times its square."""

_STEEP = 0.01
"""Least slope of the quartic at its root, by v³: where it is flatter, another may lie near."""

# More than enough for a bracketed Newton iteration in double precision; usually five are used.
_MAX_ITERATIONS = 100


def push_moment(p: Array, u: Array) -> Array:
    """Moment p_z u_xy − u_z p_xy that a unit push adds to load times place, shape (..., 2) [m]."""
    # One component after the other: numpy is much faster on arrays that lie in a row.
    x, y = (p[..., 2] * u[..., k] - u[..., 2] * p[..., k] for k in (0, 1))
    return np.moveaxis(np.array([x, y]), 0, -1)


def push_axes(u: Array) -> tuple[Array, Array, Array]:
    """Horizontal part of directions, shape (n,), and unit vectors along and to the left, (n, 2)."""
    h = np.hypot(u[:, 0], u[:, 1])
    with np.errstate(invalid="ignore", divide="ignore"):
        along = np.where(h[:, None] > 0.0, u[:, :2] / h[:, None], [1.0, 0.0])
    return h, along, np.column_stack((-along[:, 1], along[:, 0]))


def topple_threshold(
    base: Base, p: Array, u: Array, c: Array, weight: float, shift: Array | float = 0.0
) -> Array:
    """Force at which the centre of pressure reaches the edge of the base, shape (...) [N].

    About edge k: s_k = G (d_k − n_k·c_xy) / (p_z n_k·u_xy − u_z (n_k·p_xy − d_k)).

    Args:
        base: what it stands on.
        p: contact points, shape (..., 3) [m].
        u: directions of the force, shape (..., 3); s counts in lengths of u.
        c: centre of mass, shape (..., 3) [m].
        weight: G [N].
        shift: the centre of mass may be nearer to every edge by this, along x and y [m].
    """
    return base.topple_force(weight * c[..., :2], push_moment(p, u), u[..., 2], weight, shift)


def yaw_arm(p: Array, u: Array, c: Array) -> Array:
    """Arm [(p − c) × u]_z of the force about the vertical through the centre of mass [m]."""
    return cross(p[..., :2] - c[..., :2], u)


def slide_threshold(
    u: Array, arm: Array, friction: float | Array, radius: float | Array, weight: float
) -> Array:
    """Force at which the box starts to slide, yaw included [N].

    With v = N/s: v² |u_xy|² + (v + u_z)² (arm/c̄)² = μ² v⁴, then s = G / (v + u_z); the largest
    root counts, none means that the push jams (never slides, however strong).

    Args:
        u: directions of the force, shape (..., 3); s counts in lengths of u.
        arm: from `yaw_arm`, shape (...) [m]; zero leaves yaw out: s = μ G / (|u_xy| + μ u_z).
        friction: μ between object and table.
        radius: friction radius c̄ [m].
        weight: G [N].
    """
    x, y, w = u[..., 0], u[..., 1], u[..., 2]
    h2, a, mu = x * x + y * y, np.abs(arm) / radius, np.asarray(friction)
    if mu.ndim or h2.shape != a.shape:
        h2, w, a, mu = np.broadcast_arrays(h2, w, a, mu)
    s = quick_slide_force(h2, w, a * a, mu, weight, MORE_STEPS)
    i = np.isnan(s)
    if i.any():
        h2, w, a, mu = (np.broadcast_to(each, i.shape)[i] for each in (h2, w, a, mu))
        with np.errstate(divide="ignore", invalid="ignore"):
            jams = surely_jams(h2 / mu**2, w, (a / mu) ** 2)
        r, rest = np.full(len(w), np.inf), ~jams
        r[rest] = _careful_load_ratio(np.sqrt(h2[rest]), w[rest], a[rest], mu[rest])
        s[i] = force_at(r, w, weight)
    return s


def quick_slide_force(
    h2: Array, w: Array, a2: Array, friction: float | Array, weight: float,
    steps: int = QUICK_STEPS,
) -> Array:  # fmt: skip
    """`slide_threshold` for squares of |u_xy| and of arm/c̄; nan where it takes a closer look [N].

    All of one shape (...).
    """
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        by_friction = 1.0 / np.square(friction)
        h2, a2 = h2 * by_friction, a2 * by_friction
        v, A, B = load_guess(h2, w, a2), h2 + a2, 2.0 * a2 * w
        C = 0.5 * B * w
        for _ in range(steps):
            step = load_step(v, A, B, C)
            v -= step
        load = v + w
        sure = is_largest_load(v, step, A, B, load) & (h2 > 0.0)
        return np.where(sure, weight / load, np.nan)


def force_at(r: Array, w: Array, weight: Array | float) -> Array:
    """Force s = r G / (1 + r u_z) of a load ratio r = s/N; inf for r = inf [N]."""
    with np.errstate(invalid="ignore"):
        return np.where(np.isfinite(r), r * weight / (1.0 + r * w), np.inf)


def ratio_at(s: Array, w: Array, weight: float) -> Array:
    """Load ratio r = s / (G − s u_z) of a force; −1/u_z of an infinite one that presses down."""
    with np.errstate(divide="ignore", invalid="ignore"):
        far = np.where(w < 0.0, -1.0 / w, np.inf)
        load = weight - s * w
        return np.where(np.isinf(s), far, np.where(load > 0.0, s / load, np.inf))


def load_guess(h2: Number, w: Number, a2: Number) -> Number:
    """A load per force v = N/s near that of sliding: exact without arm, or for a horizontal push.

    Sliding: v⁴ = h² v² + a² (v + w)², with |u_xy|/μ, u_z and |arm|/(μ c̄) for h, w and a.
    """
    y = 1.0 + w / (h2 + a2) ** 0.5
    v: Number = (h2 + a2 * y * y) ** 0.5
    return v


def load_step(v: Number, A: Number, B: Number, C: Number) -> Number:
    """Newton's step, to be taken off v, on v⁴ − A v² − B v − C: h² + a², 2 a² w and a² w²."""
    t = v * v
    r = t - A
    return (v * (v * r - B) - C) / (2.0 * v * (r + t) - B)


def is_largest_load(v: Number, step: Number, A: Number, B: Number, load: Number) -> Any:
    """Return True where v, found by a last step, surely is the largest root, and v + w positive."""
    t = v * v
    # Beyond v² = A/6 the quartic is convex: from a root there at which it rises it never returns.
    rises = (2.0 * v * (t + t - A) - B >= 2.0 * _STEEP * t * v) & (6.0 * t >= A)
    return rises & (load > 0.0) & (abs(step) <= LAST_STEP * v)


def surely_jams(h2: Number, w: Number, a2: Number) -> Any:
    """Return True where friction surely grows faster than the push; a, w and h as in `load_guess`.

    To be asked only where no load was found.
    """
    return (w < 0.0) & (h2 <= w * w) & (a2 <= 8.0 * h2)


def _careful_load_ratio(h: Array, w: Array, a: Array, mu: Array) -> Array:
    """Smallest r > 0 with r sqrt(h² + (1 + r w)² a²) = μ, shape (n,); inf if there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        flat = mu / np.hypot(h, a)  # one side of the bracket
        straight = mu / h  # exact without yaw
    r = np.where(a == 0.0, straight, flat)
    r[(h == 0.0) | ((w < 0.0) & (a == 0.0) & (h <= -mu * w))] = np.inf
    (i,) = np.nonzero((w != 0.0) & (a != 0.0) & (h > 0.0) & (mu > 0.0))
    if i.size:
        r[i] = _solve_load_ratio(h[i], w[i], a[i], mu[i], flat[i])
    return r


def _solve_load_ratio(h: Array, w: Array, a: Array, mu: Array, flat: Array) -> Array:
    """The general case of `_careful_load_ratio`, by Newton's method in a bracket of the root."""
    pull = w > 0.0
    lo = np.where(pull, 0.0, flat)
    with np.errstate(divide="ignore"):
        hi = np.where(pull, flat, np.minimum(mu / h, -1.0 / w))
    # A force pressing down far off-centre can have its moment rise, peak and fall again before
    # the ratio reaches 1/|w|: the first root then lies before the peak, if that reaches μ.
    bent = ~pull & (a * a > 8.0 * h * h)
    peak = (np.sqrt(np.where(bent, 1.0 - 8.0 * (h / a) ** 2, 0.0)) - 3.0) / (4.0 * w)
    passed = bent & (_friction_used(peak, h, w, a) >= mu)
    hi = np.where(passed, np.minimum(hi, peak), hi)
    jams = ~pull & ~passed & (h <= -mu * w)
    r = 0.5 * (lo + hi)
    for _ in range(_MAX_ITERATIONS):
        y = 1.0 + r * w
        q = np.sqrt(h * h + (y * a) ** 2)
        f = r * q - mu
        lo, hi = np.where(f < 0.0, r, lo), np.where(f < 0.0, hi, r)
        step = r - f / (q + r * w * y * a * a / q)
        new = np.where((step >= lo) & (step <= hi), step, 0.5 * (lo + hi))
        change = np.abs(new - r)
        r = new
        if np.all(jams | (change <= 4.0 * np.finfo(float).eps * r)):
            break
    return np.where(jams, np.inf, r)


def critical_friction(
    u: Array, arm: Array, topple: Array, radius: float | Array, weight: float
) -> Array:
    """Friction coefficient μ* below which the box slides before it topples, shape (...).

    It is the friction that the push uses by the time it would topple: the largest
    r sqrt(|u_xy|² + (1 + r u_z)² (arm/c̄)²) up to r = s/N at s = s_topple.

    Args:
        u: directions of the force, shape (..., 3).
        arm: from `yaw_arm`, shape (...) [m].
        topple: from `topple_threshold` for the same u, shape (...) [N].
        radius: friction radius c̄ [m].
        weight: G [N].
    """
    h, w, a = np.hypot(u[..., 0], u[..., 1]), u[..., 2], np.abs(arm) / radius
    r = ratio_at(topple, w, weight)
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(1.0 - 8.0 * (h / a) ** 2)
        peak = (root - 3.0) / (4.0 * w)
        used = np.where(np.isinf(r), np.where(h > 0.0, np.inf, 0.0), _friction_used(r, h, w, a))
        bent = (w < 0.0) & (a * a > 8.0 * h * h) & (peak < r)
        return np.where(bent, np.maximum(used, _friction_used(peak, h, w, a)), used)


def _friction_used(r: Array, h: Array, w: Array, a: Array) -> Array:
    """Friction that a push uses at the load ratio r: r sqrt(h² + (1 + r w)² a²)."""
    return np.asarray(r * np.sqrt(h * h + ((1.0 + r * w) * a) ** 2))


def centre_of_pressure(p: Array, force: Array, c: Array, weight: float) -> Array:
    """Centre of pressure q = (G c_xy − F_z p_xy + p_z F_xy) / N in the base, shape (..., 2) [m].

    Points p and c [m] and forces [N] are (..., 3), in B; N = G − F_z must be positive, G is in [N].
    """
    moment = weight * c[..., :2] - force[..., 2:] * p[..., :2] + p[..., 2:] * force[..., :2]
    return np.asarray(moment / (weight - force[..., 2:]))


def sliding_twist(p: Array, u: Array, c: Array, s: Array, radius: float, weight: float) -> Array:
    """Incipient twist of a sliding box, shape (n, 6): angular, then linear velocity of B's origin.

    The twist is normal to the limit surface at the friction wrench: v ∝ F_xy, ω ∝ m_z / c̄², taken
    at the centre of pressure; scaled so that the contact moves at 1 m/s along u.
    """
    load = weight - s * u[:, 2]
    q = centre_of_pressure(p, s[:, None] * u, c, weight)
    omega = weight / load * yaw_arm(p, u, c) / radius**2
    twist = np.zeros((len(p), 6))
    twist[:, 2] = omega
    twist[:, 3] = u[:, 0] + omega * q[:, 1]
    twist[:, 4] = u[:, 1] - omega * q[:, 0]
    return twist / _contact_speed(twist, p, u)[:, None]


def toppling_twist(p: Array, u: Array, n: Array, d: Array) -> Array:
    """Incipient twist of an object that topples about an edge, shape (n, 6), scaled alike.

    Contacts p [m] and directions u of the force are (n, 3), the edges' outward normals n are (n, 2)
    and their offsets d are (n,) [m].
    """
    twist = np.zeros((len(p), 6))
    twist[:, 0], twist[:, 1] = -n[:, 1], n[:, 0]  # ω = ẑ × n
    twist[:, 5] = d  # ω × (0 − d n)
    return twist / _contact_speed(twist, p, u)[:, None]


def _contact_speed(twist: Array, p: Array, u: Array) -> Array:
    """Velocity of the contact along u under each twist, shape (n,)."""
    velocity = twist[:, 3:] + np.cross(twist[:, :3], p)
    return np.asarray(np.sum(velocity * u, axis=1))
