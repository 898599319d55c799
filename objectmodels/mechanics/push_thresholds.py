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

from collections.abc import Iterator
from math import asin, atan2, cos, hypot, inf, pi, sin, sqrt, tan
from statistics import NormalDist
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array, Base
from objectmodels.geometry.rotations import cross, left_of, require_amount

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody


GRAVITY = 9.81
"""Standard acceleration of free fall used throughout [m/s²]."""

Number = TypeVar("Number", float, Array)

QUICK_STEPS, MORE_STEPS = 4, 8
"""Newton steps to the load per force; all but some pushes in a hundred need no more than four."""

LAST_STEP = 1e-8
"""A step of less than this share ends at the root, but for some hundred times its square."""

_STEEP = 0.01
"""Least slope of the quartic at its root, by v³: where it is flatter, another may lie near."""


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
    return h, along, left_of(along)


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
    h2: Array,
    w: Array,
    a2: Array,
    friction: float | Array,
    weight: float,
    steps: int = QUICK_STEPS,
) -> Array:
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
    # More than enough for a bracketed iteration in double precision; usually five are used.
    for _ in range(100):
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


# Closed form of one push in plain numbers, and of many in blocks.
#
# The formulae are those of `objectmodels.mechanics.push_thresholds`. A call of numpy takes longer
# than all operations of one push; of many, a block at a time stays in the processor's cache.

BLOCK = 16384
"""Pushes that are treated at once."""


class Figures(NamedTuple):
    """What the closed form knows of an object.

    Attributes:
        base: over which it topples.
        com: centre of mass, shape (3,) [m].
        friction: μ at the table.
        radius: c̄ [m].
        weight: G [N].
    """

    base: Base
    com: Array
    friction: float
    radius: float
    weight: float


def slide_and_topple_forces(body: Figures, p: Array, u: Array) -> tuple[Array, Array]:
    """Forces at which pushes slide and at which they topple, (n,) each [N].

    Contacts [m] and directions are (n, 3).
    """
    single = _single_forces(body, p, u) if len(p) == 1 else None
    if single is not None:
        return np.array(single[:1]), np.array(single[1:])
    slide, topple = np.empty((2, len(p)))
    for b in blocks(len(p)):
        x, y, w = u[b][:, 0], u[b][:, 1], u[b][:, 2]
        arm = yaw_arm(p[b], u[b], body.com)
        a2 = arm * arm * body.radius**-2
        slide[b] = quick_slide_force(x * x + y * y, w, a2, body.friction, body.weight)
        topple[b] = topple_threshold(body.base, p[b], u[b], body.com, body.weight)
    (i,) = np.nonzero(np.isnan(slide))
    p, u = p[i], u[i]
    slide[i] = slide_threshold(u, yaw_arm(p, u, body.com), body.friction, body.radius, body.weight)
    return slide, topple


def blocks(n: int) -> Iterator[slice]:
    """Parts of n pushes, one after the other."""
    return (slice(start, start + BLOCK) for start in range(0, n, BLOCK))


def _single_forces(body: Figures, p: Array, u: Array) -> tuple[float, float] | None:
    """The two forces of one push [N]; None if sliding takes a closer look."""
    ((x, y, z),), ((u_x, u_y, w),) = p.tolist(), u.tolist()
    (c_x, c_y, _), weight = body.com.tolist(), body.weight
    a = ((x - c_x) * u_y - (y - c_y) * u_x) / body.radius
    slide = _single_slide(u_x * u_x + u_y * u_y, w, a * a, body.friction, weight)
    if slide is None:
        return None
    moment = z * u_x - w * x, z * u_y - w * y
    topple = body.base.single_topple_force((weight * c_x, weight * c_y), moment, w, weight)
    return slide, topple


def _single_slide(h2: float, w: float, a2: float, mu: float, weight: float) -> float | None:
    """Force of `quick_slide_force` for one push [N]; inf if it surely jams, None where that is nan.

    h² and a² are the squares of |u_xy| and of arm / c̄, w is u_z.
    """
    try:
        by_friction = 1.0 / (mu * mu)
        h2, a2 = h2 * by_friction, a2 * by_friction
        v, A, B = load_guess(h2, w, a2), h2 + a2, 2.0 * a2 * w
        C = 0.5 * B * w
        for _ in range(MORE_STEPS):
            step = load_step(v, A, B, C)
            v -= step
            if abs(step) <= LAST_STEP * v:
                break
    except ZeroDivisionError:
        return None
    if is_largest_load(v, step, A, B, v + w) and h2 > 0.0:
        return weight / (v + w)
    return inf if surely_jams(h2, w, a2) else None


# Limits of tilting an object, and the travel of a finger that tilts it.
#
# Model: the object pivots about a base edge that does not slide. Seen along that edge: base
# length L along the push, the finger on the rear face at height h, the pivot at the leading edge,
# b from the centre of mass to the pivot.


def angle_of_no_return(model: PushedBody, direction: ArrayLike, sigmas: float) -> float:
    """Angle atan(b / c_z) past which the object falls by itself [rad].

    Args:
        model: the object.
        direction: horizontal direction in B, shape (3,); it tips over the base edge that looks
            most along it.
        sigmas: take the centre of mass at so many standard deviations towards an earlier fall
            (negative: towards a later one).
    """
    n = _leading_edge(model, direction)
    b = float(model.base.extent(n)) - n @ np.array(model.com[:2])
    b -= sigmas * (np.abs(n) @ np.array(model.com_sd[:2]))
    c_z = model.com[2] + sigmas * model.com_sd[2]
    # A worst case may leave the object: it then falls at once, or only once it lies on its side.
    return atan2(max(b, 0.0), max(c_z, 0.0))


def return_probability(model: PushedBody, direction: ArrayLike, angle: float) -> float:
    """Probability that the object falls back onto its base from a tilt of that angle [rad].

    It does while b − c_z tan θ is positive, which is normal as b and c_z are.
    """
    b, b_sd, c_z, c_z_sd = _weight_lever(model, direction)
    t = tan(angle)
    left, unsure = b - c_z * t, hypot(b_sd, c_z_sd * t)
    return NormalDist().cdf(left / unsure) if unsure > 0.0 else float(left > 0.0)


def largest_return(model: PushedBody, direction: ArrayLike, probability: float) -> float:
    """Largest tilt from which it falls back with at least a probability above a half [rad]."""
    b, b_sd, c_z, c_z_sd = _weight_lever(model, direction)
    z = NormalDist().inv_cdf(probability)
    if b <= z * b_sd:
        return 0.0
    # The smaller root of (b − c t)² = z² (σ_b² + t² σ_c²), in a form that c = z σ_c leaves whole.
    root = sqrt((b * c_z_sd) ** 2 + (c_z * b_sd) ** 2 - (z * b_sd * c_z_sd) ** 2)
    return atan2(b * b - (z * b_sd) ** 2, b * c_z + z * root)


def topple_stroke(model: PushedBody, direction: ArrayLike, height: float, angle: float) -> float:
    """Travel of the finger that tilts the object by an angle, whether it slips or sticks [m].

    It pushes along a horizontal direction in B (3,), at a height of the face [m], to a tilt [rad].
    """
    if not 0.0 <= angle < np.pi / 2:
        raise ModelError(
            "bad_value",
            f"angle {angle} rad is not between 0 and π/2",
            suggestions=("give it in radians: `np.radians(degrees)`",),
        )
    length = _length_pushed(model, direction, height)
    return max(stroke_level(height, length, angle), stroke_stuck(height, length, angle))


def stroke_tilt(
    model: PushedBody, direction: ArrayLike, height: float, travel: float
) -> tuple[float, float]:
    """Tilts after a travel of the finger if it stays level or sticks, the smaller first [rad]."""
    require_amount(travel, "a travel of", "give a length in metres")
    length = _length_pushed(model, direction, height)
    tilts = tilt_level(height, length, travel), tilt_stuck(height, length, travel)
    return min(tilts), max(tilts)


def tilt_level(height: float, length: float, travel: float) -> float:
    """Inverse of `stroke_level`; π/2 if the finger passes over the object before [rad].

    With t = tan(θ/2) it is 2 h t − 2 L t² = d (1 − t²), whose smaller root counts.
    """
    a, b, c = 2.0 * length - travel, 2.0 * height, travel
    inside = b * b - 4.0 * a * c
    return pi / 2.0 if inside < 0.0 else 2.0 * atan2(2.0 * c, b + sqrt(inside))


def tilt_stuck(height: float, length: float, travel: float) -> float:
    """Inverse of `stroke_stuck`; π/2 if it is beyond [rad]."""
    sine = (travel - length) / hypot(height, length)
    return min(atan2(length, height) + asin(sine), pi / 2.0) if sine < 1.0 else pi / 2.0


def stroke_level(height: float, length: float, angle: float) -> float:
    """Travel d = h tan θ − L (sec θ − 1) of a finger that stays at its height [m]."""
    return height * tan(angle) - length * (1.0 / cos(angle) - 1.0)


def stroke_stuck(height: float, length: float, angle: float) -> float:
    """Travel d = h sin θ + L (1 − cos θ) of a finger that sticks to the face [m]."""
    return height * sin(angle) + length * (1.0 - cos(angle))


def _length_pushed(model: PushedBody, direction: ArrayLike, height: float) -> float:
    """The length along a push, if its height is one on the object."""
    if not 0.0 < height <= model.top:
        raise ModelError(
            "bad_value",
            f"height {height} m is not on the object",
            suggestions=(f"take one above 0 and up to {model.top:g} m",),
        )
    return length_along(model, direction)


def length_along(model: PushedBody, direction: ArrayLike) -> float:
    """From the leading edge to the side behind, which may stand out beyond the base [m]."""
    n = _leading_edge(model, direction)
    return float(model.base.extent(n)) + float((model.outline @ -n).max())


def _weight_lever(model: PushedBody, direction: ArrayLike) -> tuple[float, float, float, float]:
    """Lengths b and c_z, each with its standard deviation [m]."""
    n = _leading_edge(model, direction)
    b = float(model.base.extent(n)) - float(n @ np.array(model.com[:2]))
    return b, float(np.hypot(*(n * model.com_sd[:2]))), model.com[2], model.com_sd[2]


def _leading_edge(model: PushedBody, direction: ArrayLike) -> Array:
    """Outward normal of the base edge that looks most along a horizontal direction, (2,)."""
    u = np.asarray(direction, dtype=np.float64)
    if u.shape not in ((2,), (3,)) or not np.isfinite(u).all() or not u[:2].any():
        raise ModelError(
            "bad_array",
            f"direction {u} is not a horizontal direction",
            suggestions=("give [x, y] or [x, y, 0], not all zero",),
        )
    return model.base.facing_normal(u[:2] / np.hypot(*u[:2]))
