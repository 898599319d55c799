"""Drags: a fingertip presses on top of an object and draws it along.

Model: the fingertip touches a level face at p, h above the table, presses down on it with N and is
led slowly along d. It transmits no moment, and along the face at most μ_f N. The table then feels
an object of weight W = G + N whose centre of mass lies over

    c' = (G c + N p) / W

and which is pushed at p. While the contact goes along d, the friction of the loaded support points
(`objectmodels.exact.top_drag`) has no moment about it; that takes a force F along
the face, which moves the centre of pressure to q = c' + h F / W and the loads with it.

- drags: |F| ≤ μ_f N, the object goes along;
- slips: |F| > μ_f N, the fingertip slips over it, whether or not it moves;
- tips: q is beyond an edge of the base under the force that is transmitted.

It drags while the friction at the table is less than a critical one, under which the fingertip is
about to slip or the object to tip. Over the centre of mass nothing turns, and what drags is
N > μ G / (μ_f − μ), in flat things.

Frame: points and directions are in B; turning rates are counter-clockwise seen from above.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objectmodels.errors import ModelError
from objectmodels.exact.exact_thresholds import springs_of
from objectmodels.exact.support_springs import Springs
from objectmodels.geometry.base_shapes import Array, Base, Polygon, hull_polygon
from objectmodels.geometry.rotations import (
    checked_pairs,
    cross,
    dot,
    left_of,
    require_finite,
    require_units,
)
from objectmodels.mechanics.friction_limit import Slide, friction_limit
from objectmodels.mechanics.outcome_probability import draw_parameters, friction_below, normal_nodes

if TYPE_CHECKING:
    from collections.abc import Callable

    from objectmodels.geometry.pushed_body import PushedBody


# Sliding of an object on its loaded points, under one finger.
#
# Model: the support points carry what springs carry
# (`objectmodels.exact.support_springs`) and resist by Coulomb friction. The loads are
# those of the centre of pressure q = c + (μ z) f, z the contact's height and f the push as a
# share of μ times the weight. Friction dissipates as little as it can:
#
# - under a force along a line the motion is that of the friction limit
#   (`objectmodels.mechanics.friction_limit`);
# - a contact at r that is led at d leaves the turning rate ω unknown. The sum
#   Σ N_i |d + ω ẑ × (x_i − r)| is convex in it, and where it is least the friction has no moment
#   about the contact.
#
# A friction radius other than the support's own scales the points' distances from the centre of
# pressure.

_STEPS = 60  # of Newton's method for the turning rate, bisections included
_STILL = 1e-7  # speed of a point, of the contact's, below which its friction counts as less


@dataclass(frozen=True)
class LoadedPoints:
    """The law of loaded points, for n strokes; see `SlidingLaw`.

    Attributes:
        com: centres of mass in B, shape (n, 2) [m].
        finger_friction: shape (n,).
        springs: the points on which the object stands.
        scale: factors of the points' distances from the centre of pressure, shape (n,).
        lever: μ times the height of the contact, shape (n,) [m].
        loads: N_i as shares of the weight, shape (k, n).
        places: x_i, the points from the centre of mass, shape (k, n, 2) [m].
    """

    com: Array
    finger_friction: Array
    springs: Springs
    scale: Array
    lever: Array
    loads: Array
    places: Array

    @classmethod
    def of_model(cls, model: PushedBody, heights: Array) -> LoadedPoints:
        """The law of a model for contacts at heights (n,) [m]."""
        n, springs = len(heights), springs_of(model)
        return cls.of_draws(
            springs,
            com=np.tile(model.com[:2], (n, 1)),
            finger_friction=np.full(n, model.finger_friction),
            radius=np.full(n, model.friction_radius),
            lever=model.friction * heights,
        )

    @classmethod
    def of_draws(
        cls, springs: Springs, *, com: Array, finger_friction: Array, radius: Array, lever: Array
    ) -> LoadedPoints:
        """The law for n objects on the same points: centres of mass (n, 2), the others (n,)."""
        none = np.zeros((len(springs.points), len(com)))
        law = cls(
            com, finger_friction, springs, radius / springs.radius, lever, none, none[..., None]
        )
        return law.law_under(np.zeros_like(com))

    def law_under(self, force: Array) -> LoadedPoints:
        """The law while a push acts, a share (n, 2) of μ times the weight."""
        q = (self.com + self.lever[:, None] * force).T
        loaded = np.ones_like(self.loads, dtype=bool)
        loads, _ = self.springs.loads(q, np.zeros_like(q), loaded)
        places = q.T + self.scale[:, None] * (self.springs.points[:, None, :] - q.T) - self.com
        return replace(self, loads=loads, places=places)

    def slide_with(self, r: Array, d: Array) -> Slide:
        """Motion in which the contacts r (n, 2) move at unit velocities d (n, 2)."""
        return self.slide_at(r, d, self.turning_rate(r, d))

    def slide_at(self, r: Array, d: Array, turn: Array) -> Slide:
        """Motion in which contacts r (n, 2) move at d (n, 2) and the object turns at rates (n,)."""
        v = d - turn[:, None] * left_of(r)
        return Slide(v, turn, self._pushes(v, turn).sum(axis=0))

    def friction_moment(self, slide: Slide) -> Array:
        """Moment about the centre of mass that keeps it up, of μ times the weight, (n,) [m]."""
        return np.asarray(cross(self.places, self._pushes(slide.v, slide.turn)).sum(axis=0))

    def _pushes(self, v: Array, turn: Array) -> Array:
        """Forces against the friction of each point, shape (k, n, 2)."""
        slip = v + turn[:, None] * left_of(self.places)
        speed = np.sqrt(dot(slip, slip) + _STILL**2)
        return np.asarray((self.loads / speed)[..., None] * slip)

    def turning_rate(self, r: Array, d: Array) -> Array:
        """Turning rates (n,) at which the friction has no moment about contacts r led at d."""
        arm = left_of(self.places - r)
        square, along = dot(arm, arm), dot(arm, d)
        # What turns faster dissipates more than what does not turn.
        most = 2.0 / (self.loads * np.sqrt(square)).sum(axis=0)
        found, loads = np.zeros(len(d)), self.loads
        left_over, low, high, turn = np.arange(len(d)), -most, most, found.copy()
        for _ in range(_STEPS):
            advance = along + turn * square  # arm · slip
            inverse = 1.0 / np.sqrt(1.0 + turn * (along + advance) + _STILL**2)
            share = loads * inverse
            moment = (share * advance).sum(axis=0)
            slope = (share * (square - (advance * inverse) ** 2)).sum(axis=0)
            low, high = np.where(moment < 0.0, turn, low), np.where(moment > 0.0, turn, high)
            with np.errstate(divide="ignore", invalid="ignore"):
                ahead = turn - moment / slope
            # A point that hardly slips bends the moment sharply: then the middle is safer.
            ahead = np.where((ahead > low) & (ahead < high), ahead, 0.5 * (low + high))
            found[left_over] = ahead
            # Step of the turning rate, relative to the largest that there can be.
            (i,) = np.nonzero(np.abs(ahead - turn) > 1e-12 * most)
            if not i.size:
                break
            turn, low, high, most = ahead[i], low[i], high[i], most[i]
            if i.size < len(left_over):
                left_over, loads = left_over[i], loads[:, i]
                square, along = square[:, i], along[:, i]
        return found

    def slide_under(self, r: Array, f: Array) -> Slide:
        """Motion under forces along f (n, 2) at contacts r, of unit speed along their line."""
        along = f / np.sqrt(dot(f, f))[:, None]
        across = left_of(along)
        left = dot(r, across)
        limit = friction_limit(self.loads, dot(self.places, along), dot(self.places, across) - left)
        v = (1.0 + limit.turn * left)[:, None] * along + limit.across[:, None] * across
        return Slide(v, limit.turn, limit.ratio[:, None] * along)

    def chosen_strokes(self, i: NDArray[np.intp]) -> LoadedPoints:
        """The law of some of the strokes."""
        return LoadedPoints(
            self.com[i],
            self.finger_friction[i],
            self.springs,
            self.scale[i],
            self.lever[i],
            self.loads[:, i],
            self.places[:, i],
        )


DragOutcome = Literal["drags", "slips", "tips"]

DRAWS = 64
"""Points of the sequence that a probability is averaged over."""

_SETTLING = 12  # looks at how the force shifts the load; each leaves a share of about h / size
_SHORT = 1e-6  # share of its way by which the centre of pressure stays short of the edge
_FORCES, _HALVINGS = 16, 14  # forces between those two, and steps to the limit between two of them


@dataclass(frozen=True)
class TopDrag:
    """Outcomes of n fingertips that press on top of an object and are led along it.

    Attributes:
        force: F with which the contact goes along, in B, shape (n, 2) [N].
        grip: μ_f N, the most that the fingertip transmits, shape (n,) [N].
        turn: of the object per travel of the contact if it goes along, shape (n,) [rad/m].
        critical_friction: at the table; it drags while that is less, shape (n,).
        tip_ratio: multiple of the transmitted force under which it tips, shape (n,); inf if none
            does, 0 if the pressing alone tips it.
    """

    force: Array
    grip: Array
    turn: Array
    critical_friction: Array
    tip_ratio: Array

    @property
    def outcome(self) -> NDArray[np.str_]:
        """Classes of `DragOutcome`, shape (n,)."""
        slips = np.hypot(*self.force.T) > self.grip
        return np.where(self.tip_ratio < 1.0, "tips", np.where(slips, "slips", "drags"))


def top_drag(
    model: PushedBody, points: ArrayLike, directions: ArrayLike, press: ArrayLike
) -> TopDrag:
    """Outcomes of n fingertips that press on an object and are led along.

    Args:
        model: what is believed of it.
        points: contacts p_BC on a level face, shape (n, 3) [m].
        directions: horizontal unit vectors in B along which the contacts are led, shape (n, 3).
        press: N, of all or of each, shape () or (n,) [N].

    Raises:
        ModelError: `bad_array` if a shape or a value is wrong.
    """
    p, d, force = _checked(points, directions, press)
    n = len(p)
    nominal = draw_parameters(model, np.zeros((1, 5)))
    pressed = _Pressed.of_draws(
        model,
        p,
        d,
        force,
        com=np.tile(nominal.com[:, :2], (n, 1)),
        weight=np.full(n, model.weight),
        finger_friction=np.full(n, model.finger_friction),
        radius=np.full(n, model.friction_radius),
    )
    led, turn, tip_ratio = pressed.led_force(model.friction)
    return TopDrag(led, pressed.grip, turn, pressed.critical_friction(), tip_ratio)


def drag_probability(
    model: PushedBody, points: ArrayLike, directions: ArrayLike, press: ArrayLike
) -> Array:
    """Probabilities that n fingertips drag an object of which not all is known, shape (n,).

    Arguments and errors are those of `top_drag`. The friction at the table integrates in closed
    form, below the critical one; the other parameters are averaged over a fixed sequence.
    """
    p, d, force = _checked(points, directions, press)
    draw = draw_parameters(model, normal_nodes(DRAWS, mass=True))
    n, k = len(p), len(draw.com)
    pressed = _Pressed.of_draws(
        model,
        np.repeat(p, k, axis=0),
        np.repeat(d, k, axis=0),
        np.repeat(force, k),
        com=np.tile(draw.com[:, :2], (n, 1)),
        weight=np.tile(draw.weight, n),
        finger_friction=np.tile(draw.finger_friction, n),
        radius=np.tile(draw.friction_radius, n),
    )
    critical = pressed.critical_friction().reshape(n, k)
    below = friction_below(model, critical, draw.friction, draw.friction_sd)
    return np.asarray(np.where(critical > 0.0, below, 0.0).mean(axis=1))


def press_range(
    model: PushedBody,
    point: ArrayLike,
    direction: ArrayLike,
    most: float,
    probability: float | None = None,
) -> tuple[float, float] | None:
    """The least and the largest force with which a fingertip drags an object [N].

    Args:
        model: what is believed of it.
        point: contact p_BC on a level face, shape (3,) [m].
        direction: horizontal unit vector in B, shape (3,).
        most: largest force that the fingertip presses with [N].
        probability: with which it is to drag; if not given, with everything as believed.

    Returns:
        The ends of the first range of forces up to `most` that drag; None if there is none.

    Raises:
        ModelError: `bad_array` if a shape or a value is wrong.
    """
    p, d, _ = _checked(np.atleast_2d(point), np.atleast_2d(direction), most)

    def drags(forces: Array) -> NDArray[np.bool_]:
        at, along = np.tile(p, (len(forces), 1)), np.tile(d, (len(forces), 1))
        if probability is None:
            return np.asarray(top_drag(model, at, along, forces).outcome == "drags")
        return np.asarray(drag_probability(model, at, along, forces) >= probability)

    # Least pressing force that is looked at, as a share of the largest.
    forces = np.geomspace(1e-3 * most, most, _FORCES)
    good = drags(forces)
    if not good.any():
        return None
    first = int(good.argmax())
    after = first + int(np.append(~good[first:], True).argmax())
    least = forces[0] if first == 0 else _limit_between(drags, forces[first], forces[first - 1])
    largest = most if after == _FORCES else _limit_between(drags, forces[after - 1], forces[after])
    return float(least), float(largest)


def _limit_between(drags: Callable[[Array], NDArray[np.bool_]], good: float, bad: float) -> float:
    """The force next to `bad` that is still good, found by halving [N]."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if drags(np.array([middle]))[0] else (good, middle)
    return good


def _checked(
    points: ArrayLike, directions: ArrayLike, press: ArrayLike
) -> tuple[Array, Array, Array]:
    """Contacts (n, 3), horizontal directions (n, 3) and forces (n,)."""
    p, d = checked_pairs(points, directions)
    require_units(d)
    force = np.asarray(press, dtype=np.float64)
    if force.shape not in ((), (len(p),)) or (d[:, 2] != 0.0).any():
        raise ModelError(
            "bad_array",
            f"expected horizontal directions and one pressing force or {len(p)} of them, "
            f"found forces of shape {force.shape}",
            suggestions=("a fingertip is led along the table: set z to 0",),
        )
    require_finite(force)
    if (force <= 0.0).any():
        raise ModelError(
            "bad_array",
            "a fingertip presses with a force of more than 0 N",
            suggestions=("give the force downwards, as a positive number of newtons",),
        )
    return p, d, np.broadcast_to(force, len(p))


@dataclass(frozen=True)
class _Pressed:
    """Objects under n fingertips, as the table feels them.

    Attributes:
        base: over which they tip.
        law: of the loaded points under W, its lever in metres per newton of F, h / W.
        com: c', shape (n, 2) [m].
        r: contacts from the centre of mass of the law, shape (n, 2) [m].
        d: directions of the contacts, shape (n, 2).
        weight: W, shape (n,) [N].
        grip: μ_f N, shape (n,) [N].
        hull: of the points on which they stand.
        tips_at_once: whether the pressing alone tips them, shape (n,).
    """

    base: Base
    law: LoadedPoints
    com: Array
    r: Array
    d: Array
    weight: Array
    grip: Array
    hull: Polygon
    tips_at_once: NDArray[np.bool_]

    @classmethod
    def of_draws(
        cls,
        model: PushedBody,
        p: Array,
        d: Array,
        press: Array,
        *,
        com: Array,
        weight: Array,
        finger_friction: Array,
        radius: Array,
    ) -> _Pressed:
        """Of n objects that differ in what is not known of them."""
        springs: Springs = springs_of(model)
        whole = weight + press
        c = (weight[:, None] * com + press[:, None] * p[:, :2]) / whole[:, None]
        hull = hull_polygon(springs.points)
        # What tips at once carries no loads; then the law is that of a place on the edge.
        middle = springs.weights @ springs.points / springs.weights.sum()
        way = np.tile(middle, (len(c), 1)), c - middle, np.zeros(len(c)), 1.0
        reach = (1.0 - _SHORT) * hull.topple_force(*way)
        inside = middle + np.minimum(1.0, reach)[:, None] * (c - middle)
        law = LoadedPoints.of_draws(
            springs,
            com=inside,
            finger_friction=finger_friction,
            radius=radius,
            lever=p[:, 2] / whole,
        )
        grip = finger_friction * press
        beyond = model.base.topple_force(*way) < 1.0
        return cls(model.base, law, c, p[:, :2] - inside, d[:, :2], whole, grip, hull, beyond)

    def led_force(self, friction: float) -> tuple[Array, Array, Array]:
        """Force F (n, 2) [N], turn per travel (n,) and tip ratio (n,), for a friction below."""
        share, turn, tip_ratio = self._settled(friction * self.weight)
        return (friction * self.weight)[:, None] * share, turn, tip_ratio

    def critical_friction(self) -> Array:
        """Friction at the table at which the fingertip slips or the object tips, shape (n,)."""
        share, _, tip_ratio = self._settled(np.full_like(self.weight, np.inf))
        at_slip = self.grip / (self.weight * np.hypot(*share.T))
        return np.asarray(at_slip * np.minimum(1.0, tip_ratio))

    def _settled(self, limit: Array) -> tuple[Array, Array, Array]:
        """Force as a share of μ W, turn and tip ratio, once loads and force fit each other.

        The force that shifts the loads is that share of a limit (n,), at most the grip [N].
        """
        share, force = self.d, np.zeros_like(self.d)
        for _ in range(_SETTLING):
            slide = self.law.law_under(self._inside(force)).slide_with(self.r, self.d)
            share, turn = slide.force, slide.turn
            size, before = np.hypot(*share.T), force
            force = (np.minimum(limit * size, self.grip) / size)[:, None] * share
            # Change of the force, as a share of the grip.
            if (np.hypot(*(force - before).T) <= 1e-9 * self.grip).all():
                break
        tip_ratio = self._tip_ratio(self.base, self.com, force)
        return share, turn, np.where(self.tips_at_once, 0.0, tip_ratio)

    def _inside(self, force: Array) -> Array:
        """Forces (n, 2), less where they would move the pressure beyond the support points."""
        room = self._tip_ratio(self.hull, self.law.com, force)
        return np.minimum(1.0, (1.0 - _SHORT) * room)[:, None] * force

    def _tip_ratio(self, base: Base, com: Array, force: Array) -> Array:
        """Multiples of forces (n, 2) under which the centre of pressure leaves a base, (n,)."""
        none = np.zeros(len(force))
        return base.topple_force(com, self.law.lever[:, None] * force, none, 1.0)
