"""Friction limit of a body on loaded points: the push that makes it slide, and how it then moves.

Model: points of known loads N_i with Coulomb friction on a plane. In the plane the upper-bound
theorem holds: the body slides at the least ratio of power dissipated to power supplied, over all
twists, and the twist that attains it is how it slides.

Take axes along and across the push, its line of action as the first one. For a twist that advances
the line of action at unit speed, point i slips at v_i = (1 − ω η_i, β + ω ξ_i), where ξ_i is its
place along the push and η_i its distance to the left of the line. So the push slides at

    s |u_xy| = μ min over (β, ω) of Σ N_i |v_i|

a sum of norms, convex in two unknowns. Either a point carries the centre of rotation, which can be
checked directly, or the sum is smooth at its least; there the primal-dual Newton method for sums of
norms converges (Andersen, Christiansen, Conn, Overton 2000). The friction forces come with it, and
certify the answer: if they balance and obey Coulomb's law, their push is a lower bound.

Arrays are laid out with the k points first and the n pushes last.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.rotations import cross, dot, left_of, total

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody


PRECISE = 1e-10
"""Relative residual at which a limit counts as found."""

_SAME = 1e-12
"""Distance below which two points are one: rounding alone [m]."""

_FEW = 12
_STEPS, _STEPS_MANY = 40, 16
_SHARPEST = 1e-13


@dataclass
class Limit:
    """The friction limit of n pushes, per unit of friction coefficient and of load.

    Attributes:
        ratio: least Σ N_i |v_i|, shape (n,).
        across, turn: β and ω [1/m] of the sliding motion, shape (n,).
        along_i, across_i: friction at the points as shares of its limit, against the motion,
            shape (k, n).
        residual: relative gap between the bounds from the motion and from the forces, (n,).
    """

    ratio: Array
    across: Array
    turn: Array
    along_i: Array
    across_i: Array
    residual: Array

    @classmethod
    def empty_limit(cls, k: int, n: int) -> Limit:
        """Not yet found."""
        one, each = np.zeros(n), np.zeros((k, n))
        return cls(one, one.copy(), one.copy(), each, each.copy(), np.full(n, np.inf))

    def take_over(self, i: NDArray[np.intp] | NDArray[np.bool_], other: Limit) -> None:
        """Takes over the limits of some pushes."""
        for name in ("ratio", "across", "turn", "residual"):
            getattr(self, name)[i] = getattr(other, name)
        self.along_i[:, i], self.across_i[:, i] = other.along_i, other.across_i

    def chosen_pushes(self, i: NDArray[np.bool_] | NDArray[np.intp]) -> Limit:
        """The limits of some pushes."""
        return Limit(
            self.ratio[i],
            self.across[i],
            self.turn[i],
            self.along_i[:, i],
            self.across_i[:, i],
            self.residual[i],
        )

    def slip_velocities(self, along: Array, left: Array) -> tuple[Array, Array]:
        """Slip velocities of the points, along and across the push, each (k, n)."""
        return 1.0 - self.turn * left, self.across + self.turn * along


@np.errstate(divide="ignore", invalid="ignore", over="ignore")  # points in the centre do not slip
def friction_limit(
    loads: Array,
    along: Array,
    left: Array,
    compared: Array | None = None,
    near: Limit | None = None,
) -> Limit:
    """The push that the loaded points resist.

    Args:
        loads: N_i as shares of the whole, shape (k, n).
        along: places of the points along the push, ξ_i, shape (k, n) [m].
        left: their distances to the left of its line of action, η_i, shape (k, n) [m].
        compared: ratios, shape (n,); a coarse limit will do that lies on the same side of them.
        near: limits for loads and places that differ a little, to begin with.
    """
    compared = np.full(loads.shape[1], np.nan) if compared is None else compared
    # Few points carry the centre of rotation often, one of many hardly ever.
    methods = [_about_a_point, _by_newton, _by_descent]
    if len(loads) > _FEW:
        methods = [_by_newton, _about_a_point, _by_descent]
    if near is not None:
        methods.insert(methods.index(_by_newton), _from_another)
    found = methods[0](loads, along, left, compared, near)
    for method in methods[1:]:
        (rest,) = np.nonzero(np.isinf(found.residual))
        if not rest.size:
            break
        begin = None if near is None else near.chosen_pushes(rest)
        args = loads[:, rest], along[:, rest], left[:, rest], compared[rest], begin
        found.take_over(rest, method(*args))
    return found


def _about_a_point(
    loads: Array, along: Array, left: Array, compared: Array, near: Limit | None
) -> Limit:
    """The limits of those pushes that turn the body about one of the points.

    The friction of all other points is then known; what balance asks of that one must not exceed
    its limit. Others keep an infinite residual.
    """
    k, n = loads.shape
    # Points of centres of pushes that are looked at together.
    at_once = max(65536 // max(k * n, 1), 1)
    least, about, pushes = np.full(n, np.inf), np.zeros(n, dtype=np.intp), np.arange(n)
    for first in range(0, k, at_once):
        # Centres first, then all points, then pushes.
        x, y = along[first : first + at_once, None], left[first : first + at_once, None]
        off_x, off_y = along - x, left - y
        power = (loads * np.sqrt(off_x * off_x + off_y * off_y)).sum(axis=1) / np.abs(y[:, 0])
        power[np.isnan(power)] = np.inf
        here = power.argmin(axis=0)
        power = power[here, pushes]
        less = power < least
        least[less], about[less] = power[less], first + here[less]
    # If it turns about a point, then about the one that takes the least power.
    own = about, pushes
    x, y, turn = along - along[own], left - left[own], 1.0 / left[own]
    r, sense = np.hypot(x, y), np.sign(turn)
    ratio = total(loads * r) * np.abs(turn)
    # A thumb and a finger opposite to it are two points in one place.
    centre = r <= _SAME
    r[centre] = 1.0
    d_x, d_y = -sense * y / r, sense * x / r
    # What is left for the points in the centre to balance the push.
    d_x[centre], d_y[centre] = 0.0, 0.0
    borne = total(loads * centre)
    lack_x, lack_y = (ratio - total(loads * d_x)) / borne, -total(loads * d_y) / borne
    d_x += centre * lack_x
    d_y += centre * lack_y
    holds = np.hypot(lack_x, lack_y) <= 1.0
    return Limit(ratio, -along[own] * turn, turn, d_x, d_y, np.where(holds, 0.0, np.inf))


def start_motion(loads: Array, along: Array, left: Array) -> tuple[Array, Array]:
    """The ellipsoid's motion, β and ω, for a start."""
    m, o = total(loads * left), total(loads * along)
    spread = total(loads * ((left - m) ** 2 + (along - o) ** 2))
    turn = m / (m * m + spread)
    return -turn * o, turn


def _by_newton(
    loads: Array, along: Array, left: Array, compared: Array, near: Limit | None
) -> Limit:
    """The limits by the primal-dual Newton method; an infinite residual where it fails."""
    begin = Limit.empty_limit(*loads.shape)
    begin.across, begin.turn = start_motion(loads, along, left)
    v_x, v_y = begin.slip_velocities(along, left)
    speed = np.hypot(v_x, v_y) + 1e-3
    begin.along_i, begin.across_i = v_x / speed, v_y / speed
    steps = _STEPS if len(loads) <= _FEW else _STEPS_MANY
    # Slip speed below which friction is smoothed at first.
    return _newton_limit(loads, along, left, compared, begin, 0.1, steps)


def _from_another(
    loads: Array, along: Array, left: Array, compared: Array, near: Limit | None
) -> Limit:
    """The same, beginning with limits near by, in a few steps."""
    assert near is not None, "else another method is taken"
    # From limits near by a few steps do, with little smoothing.
    return _newton_limit(loads, along, left, compared, near, 1e-4, 8)


def _newton_limit(
    loads: Array,
    along: Array,
    left: Array,
    compared: Array,
    begin: Limit,
    smooth: float,
    steps: int,
) -> Limit:
    """The limits by Newton steps from others, with friction smoothed at first below a slip."""
    # Lengths in units of the support's size keep the equations well scaled.
    unit = _spread(along, left)
    along, left = along / unit, left / unit
    across, turn = begin.across, begin.turn * unit
    d_x, d_y = begin.along_i, begin.across_i
    found = Limit.empty_limit(*loads.shape)
    left_over = np.arange(loads.shape[1])
    for _ in range(steps):
        across, turn, d_x, d_y = _newton_step(loads, along, left, across, turn, d_x, d_y, smooth)
        smooth = max(0.03 * smooth, _SHARPEST)  # by which that shrinks in every step
        found_now, done = certified_limit(loads, along, left, across, turn, d_x, d_y)
        done |= _is_beside(found_now, compared)
        if done.all() and len(done) == len(found.ratio):
            found = found_now
            break
        if done.any():
            found.take_over(left_over[done], found_now.chosen_pushes(done))
            keep = ~done
            left_over, compared = left_over[keep], compared[keep]
            loads, along, left = loads[:, keep], along[:, keep], left[:, keep]
            across, turn, d_x, d_y = across[keep], turn[keep], d_x[:, keep], d_y[:, keep]
        if not left_over.size:
            break
    found.turn /= unit
    return found


def _spread(along: Array, left: Array) -> Array:
    """Root of the mean squared distance of the points from their middle, shape (n,) [m]."""
    k = len(along)
    off_x, off_y = along - total(along) / k, left - total(left) / k
    return np.asarray(np.sqrt(total(off_x * off_x + off_y * off_y) / k))


class SlipEquations(NamedTuple):
    """Newton's equations of n motions and the friction under them, smoothed below a slip speed.

    Attributes:
        slip_x, slip_y: directions of the points' slip, shape (k, n).
        slowness: one over their slip speeds, shape (k, n).
        gradient: derivatives of the power Σ N_i |v_i| by β and ω, each (n,).
        curvature: its second derivatives by β, by both, and by ω, each (n,).
    """

    slip_x: Array
    slip_y: Array
    slowness: Array
    gradient: tuple[Array, Array]
    curvature: tuple[Array, Array, Array]

    def motion_against(self, by_across: Array, by_turn: Array) -> tuple[Array, Array]:
        """Changes of β and ω, each (n,), that take these off the gradient."""
        bb, bw, ww = self.curvature
        scale = 1.0 / (bb * ww - bw * bw)
        return (by_turn * bw - by_across * ww) * scale, (by_across * bw - by_turn * bb) * scale

    def friction_after(self, d_x: Array, d_y: Array, v_x: Array, v_y: Array) -> tuple[Array, Array]:
        """Friction at the points as their slip changes by v, all of shape (k, n)."""
        dot = (self.slip_x * v_x + self.slip_y * v_y) * self.slowness
        new_x = self.slip_x + v_x * self.slowness - d_x * dot
        new_y = self.slip_y + v_y * self.slowness - d_y * dot
        shorter = 1.0 / np.maximum(1.0, np.sqrt(new_x * new_x + new_y * new_y))
        return new_x * shorter, new_y * shorter


def slip_equations(
    loads: Array,
    along: Array,
    left: Array,
    across: Array,
    turn: Array,
    d_x: Array,
    d_y: Array,
    smooth: float,
) -> SlipEquations:
    """The equations for β and ω, (n,), and friction at the points, (k, n), together."""
    v_x, v_y = 1.0 - turn * left, across + turn * along
    slowness = 1.0 / np.sqrt(v_x * v_x + v_y * v_y + smooth * smooth)
    x, y, c = v_x * slowness, v_y * slowness, loads * slowness
    p_x, p_y = c * d_x, c * d_y
    xx, yy, xy = c - p_x * x, c - p_y * y, -0.5 * (p_x * y + p_y * x)
    off = along * yy - left * xy
    gradient = total(loads * y), total(loads * (along * y - left * x))
    h_ww = total(along * off - left * (along * xy - left * xx))
    return SlipEquations(x, y, slowness, gradient, (total(yy), total(off), h_ww))


def _newton_step(
    loads: Array,
    along: Array,
    left: Array,
    across: Array,
    turn: Array,
    d_x: Array,
    d_y: Array,
    smooth: float,
) -> tuple[Array, Array, Array, Array]:
    """One Newton step on slip and friction together."""
    equations = slip_equations(loads, along, left, across, turn, d_x, d_y, smooth)
    more_across, more_turn = equations.motion_against(*equations.gradient)
    w_x, w_y = -more_turn * left, more_across + more_turn * along
    d_x, d_y = equations.friction_after(d_x, d_y, w_x, w_y)
    return across + more_across, turn + more_turn, d_x, d_y


def certified_limit(
    loads: Array, along: Array, left: Array, across: Array, turn: Array, d_x: Array, d_y: Array
) -> tuple[Limit, NDArray[np.bool_]]:
    """The limit that motion and forces make out, and which ones are precise enough."""
    speed = np.hypot(1.0 - turn * left, across + turn * along)
    upper = total(loads * speed)
    lower = total(loads * d_x)
    off_across = np.abs(total(loads * d_y))
    off_turn = np.abs(total(loads * (along * d_y - left * d_x)))
    # What the forces lack in balance counts by the motion that it would feed.
    residual = (
        np.abs(upper - lower)
        + off_across * (np.abs(across) + 1.0)
        + off_turn * (np.abs(turn) + 1.0)
    ) / upper
    return Limit(upper, across, turn, d_x, d_y, residual), residual <= PRECISE


def _is_beside(limit: Limit, ratio: Array) -> NDArray[np.bool_]:
    """Return True where the limit is surely more or less than a ratio, which may be nan."""
    # The motion is an upper bound; forces that nearly balance make a lower one by the residual, and
    # by more where one point bears nearly all, which the body then turns about.
    less = limit.ratio < (1.0 - PRECISE) * ratio
    # Residuals that the limit may lie below that of a motion.
    return np.asarray(less | (limit.ratio * (1.0 - 10.0 * limit.residual) > ratio))


def _by_descent(
    loads: Array, along: Array, left: Array, compared: Array, near: Limit | None
) -> Limit:
    """The few that Newton's method does not settle, by a slower continuation."""
    unit = _spread(along, left)
    along, left = along / unit, left / unit
    across, turn = start_motion(loads, along, left)
    d_x, d_y = np.zeros_like(loads), np.zeros_like(loads)
    smooth, best = 1.0, Limit.empty_limit(*loads.shape)
    while smooth > _SHARPEST:
        for _ in range(3):
            across, turn, d_x, d_y = _newton_step(
                loads, along, left, across, turn, d_x, d_y, smooth
            )
        smooth *= 0.6
        now, _ = certified_limit(loads, along, left, across, turn, d_x, d_y)
        better = now.residual < best.residual
        if better.any():
            best.take_over(better, now.chosen_pushes(better))
    best.turn /= unit
    return best


# What motion goes with what force as an object slides under a finger.
#
# Model: quasi-static sliding on the table. The law here is the ellipsoidal limit surface, to
# which the motion is normal: v ∝ F and ω ∝ m_z / c̄² about the centre of mass (Howe and Cutkosky
# 1996). `objectmodels.exact.top_drag` has the law of the loaded points.
#
# Frame: velocities and forces are in the table plane, along the axes of B; contacts r (n, 2) are
# counted from the centre of mass.


@dataclass(frozen=True)
class Slide:
    """Sliding motion of n objects.

    Attributes:
        v: velocity of the centre of mass, shape (n, 2).
        turn: turning rate, shape (n,).
        force: horizontal push that keeps it up, as a share of μ times the weight, shape (n, 2).
    """

    v: Array
    turn: Array
    force: Array

    def contact_velocity(self, r: Array) -> Array:
        """Velocity at contacts r (n, 2) from the centre of mass, shape (n, 2)."""
        return np.asarray(self.v + self.turn[:, None] * left_of(r))


class SlidingLaw(Protocol):
    """What motion goes with what force, for n strokes; contacts r (n, 2) are from the centre."""

    @property
    def com(self) -> Array:
        """Centres of mass in B, shape (n, 2) [m]."""

    @property
    def finger_friction(self) -> Array:
        """μ at the finger, shape (n,)."""

    def law_under(self, force: Array) -> Self:
        """The law while a push acts, a share (n, 2) of μ times the weight."""

    def slide_with(self, r: Array, d: Array) -> Slide:
        """Motion in which the contacts move at d (n, 2)."""

    def slide_under(self, r: Array, f: Array) -> Slide:
        """Motion under forces along f (n, 2) at the contacts, of any speed."""

    def chosen_strokes(self, i: NDArray[np.intp]) -> Self:
        """The law of some of the strokes."""


@dataclass(frozen=True)
class Ellipsoid:
    """The law of the ellipsoidal limit surface, with friction radii c̄ of shape (n,) [m]."""

    com: Array
    finger_friction: Array
    radius: Array

    @classmethod
    def of_model(cls, model: PushedBody, heights: Array) -> Ellipsoid:
        """The law of a model; the ellipsoid does not depend on the contacts' heights (n,)."""
        n = len(heights)
        com, finger, radius = model.com[:2], model.finger_friction, model.friction_radius
        return cls(np.tile(com, (n, 1)), np.full(n, finger), np.full(n, radius))

    def law_under(self, force: Array) -> Ellipsoid:
        """The same: the ellipsoid does not know where the load is."""
        return self

    def slide_with(self, r: Array, d: Array) -> Slide:
        """Motion in which the contacts move at d (n, 2)."""
        return self._slide(r, sticking_force(r, d, self.radius))

    def slide_under(self, r: Array, f: Array) -> Slide:
        """Motion v = F under forces f (n, 2) at the contacts."""
        return self._slide(r, f)

    def _slide(self, r: Array, f: Array) -> Slide:
        turn = turning_rate(r, f, self.radius)
        size = np.sqrt(dot(f, f) + (turn * self.radius) ** 2)
        return Slide(f, turn, f / size[:, None])

    def chosen_strokes(self, i: NDArray[np.intp]) -> Ellipsoid:
        """The law of some of the strokes."""
        return Ellipsoid(self.com[i], self.finger_friction[i], self.radius[i])


def turning_rate(r: Array, force: Array, radius: float | Array) -> Array:
    """Rate ω = r × F / c̄² under forces F, in units of which v = F, at contacts r (n, 2), (n,)."""
    return cross(r, force) / radius**2


def contact_velocity(r: Array, force: Array, radius: float) -> Array:
    """Velocity of the contacts under forces at them: F + ω ẑ × r, shape (n, 2)."""
    return np.asarray(force + turning_rate(r, force, radius)[:, None] * left_of(r))


def sticking_force(r: Array, d: Array, radius: float | Array) -> Array:
    """Forces under which the contacts move as the fingers do: M F = d, M = I + l lᵀ/c̄², (n, 2)."""
    left = left_of(r) / np.reshape(radius, (-1, 1))
    share = np.sum(left * d, axis=1) / (1.0 + np.sum(left * left, axis=1))
    return np.asarray(d - share[:, None] * left)
