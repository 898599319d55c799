"""Motion of an object that one or two fingers push along the table.

Model: quasi-static sliding, by a `SlidingLaw`. Fingers are round tips of one radius that travel
along a straight line and do not turn; the contact rolls along the face as the object turns. A
finger sticks while its force stays in its friction cone, else it slips. Two fingers on one face
make a stable push as long as the friction wrench can be balanced by forces of both (Lynch and Mason
1996); else the object leaves one of them. The object stays upright; the push is horizontal.

Frame: the object's frame B at the start of the stroke; poses are (x, y, θ) of B in it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array, friction_radius
from objectmodels.geometry.rotations import (
    checked_pairs,
    cross,
    dot,
    left_of,
    require_amount,
    require_finite,
    require_normals,
    rotate,
    vector_tuple,
)
from objectmodels.lazy import remember_answers
from objectmodels.mechanics.friction_limit import (
    Ellipsoid,
    Slide,
    SlidingLaw,
    contact_velocity,
    sticking_force,
    turning_rate,
)
from objectmodels.safety_figure import SafetyFigure

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody
    from objectmodels.geometry.side_faces import Face


STEPS = 200
"""Steps of the integration over a stroke; the pose's error is then below 1 µm for 0.2 m."""

MODES = np.array(["stick", "slip left", "slip right", "turn", "lost"])
"""What the fingers do: all stick; slip to their left or right, seen along the push; the object
turns away from one of two; none touches."""

_STICK, _LEFT, _RIGHT, _TURN, _LOST = range(len(MODES))
BEYOND = 0.010
"""Distance beyond the end of a face at which a round fingertip may still touch it [m]."""

_SETTLING = 3  # looks at how the first push shifts the load


LawOf = Callable[["PushedBody", Array], SlidingLaw]
"""The law of a model, for contacts at heights (n,) [m]."""


@dataclass(frozen=True)
class Stroke:
    """Motion by strokes; arrays over n strokes.

    Attributes:
        pose: x, y [m], θ [rad] of B at the end, in B at the start, shape (n, 3).
        path: the same along the way, shape (STEPS + 1, n, 3).
        slipped: how far the first finger's contact has come along the face, positive along ẑ ×
            normal, to the right seen along the push, shape (n,) [m].
        modes: what the fingers do in each step, of `MODES`, shape (STEPS, n).
    """

    pose: Array
    path: Array
    slipped: Array
    modes: NDArray[np.str_]

    @property
    def mode(self) -> NDArray[np.str_]:
        """Modes at the end, of `MODES`, shape (n,)."""
        return np.asarray(self.modes[-1])

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Return True where fingers and object moved as one all the way, shape (n,)."""
        return np.asarray((self.modes == MODES[_STICK]).all(axis=0))


def integrate_stroke(
    model: PushedBody,
    points: ArrayLike,
    normals: ArrayLike,
    direction: ArrayLike,
    travel: ArrayLike,
    tip_radius: float = 0.0,
    law_of: LawOf = Ellipsoid.of_model,
) -> Stroke:
    """Motion by strokes under a law; see `ObjectModel.stroke`.

    Raises:
        ModelError: `bad_array`, `bad_value`.
    """
    p, heights, n, d = _checked_stroke(points, normals, direction)
    h = _checked_travel(travel, len(p)) / STEPS
    require_amount(tip_radius, "a tip radius of", "give a length in metres, 0 for a point")
    faces = touched_faces(model, p.mean(axis=1), n)
    if p.shape[1] == 2 and faces[:, 2].any():
        raise ModelError(
            "bad_value",
            "strokes of two fingers on a round side are not modelled",
            suggestions=("give one point per stroke, shape (n, 3)",),
        )
    pushes = _Pushes(law_of(model, heights), p, n, d, faces, tip_radius)
    at = _State(np.zeros((len(p), 3)), np.zeros(p.shape[:2]), np.zeros((len(p), 2)))
    for _ in range(_SETTLING):
        at = _State(at.pose, at.slipped, pushes.rates(at)[0].force)
    path, modes = [at.pose], []
    for _ in range(STEPS):
        # The midpoint rule: what the fingers do is taken anew in the middle of each step.
        half, _ = pushes.rates(at)
        rate, mode = pushes.rates(at.state_after(half, 0.5 * h))
        at = at.state_after(rate, h)
        path.append(at.pose)
        modes.append(mode)
    if not np.isfinite(at.pose).all():
        raise ModelError(
            "bad_value",
            "a stroke goes along its face and not against it",
            suggestions=("take a direction nearer to the face's inward normal",),
        )
    return Stroke(at.pose, np.array(path), at.slipped[:, 0], np.asarray(MODES[np.array(modes)]))


def _checked_stroke(
    points: ArrayLike, normals: ArrayLike, direction: ArrayLike
) -> tuple[Array, Array, Array, Array]:
    """Contacts (n, k, 2), heights (n,), normals (n, 2) and directions (n, 2) in the table plane."""
    p, n = np.asarray(points, dtype=np.float64), np.asarray(normals, dtype=np.float64)
    d = np.asarray(direction, dtype=np.float64)
    if p.ndim == 2:
        p = p[:, None, :]
    if p.ndim != 3 or p.shape[1] not in (1, 2) or p.shape[2] != 3 or n.shape != (len(p), 3):
        raise ModelError(
            "bad_array",
            "expected points (n, 3), or (n, 2, 3) for two fingers, and normals (n, 3); "
            f"found {np.shape(points)} and {n.shape}",
            suggestions=("a single stroke has points (1, 3) and normals (1, 3)",),
        )
    if d.shape not in ((3,), n.shape):
        raise ModelError(
            "bad_array",
            f"expected a direction (3,) or (n, 3), found {d.shape}",
            suggestions=("one direction for all strokes is [x, y, 0]",),
        )
    d = np.broadcast_to(d, n.shape)
    require_finite(p, n, d)
    if np.any(np.abs(d[:, 2]) > 1e-9) or np.any(np.abs(np.linalg.norm(d, axis=1) - 1.0) > 1e-6):
        raise ModelError(
            "bad_array",
            "directions must be horizontal unit vectors",
            suggestions=("set z to 0 and divide by the length",),
        )
    if np.any(np.sum(n * d, axis=1) >= 0.0):
        raise ModelError(
            "bad_array",
            "a stroke must go against the face's outward normal",
            suggestions=("turn the direction round, or take the face on the other side",),
        )
    level = n[:, :2] / np.hypot(n[:, 0], n[:, 1])[:, None]
    return p[..., :2].copy(), p[..., 2].mean(axis=1), level, d[:, :2].copy()


def _checked_travel(travel: ArrayLike, n: int) -> Array:
    """Travels of n strokes, shape (n, 1) [m]."""
    way = np.asarray(travel, dtype=np.float64)
    if way.shape not in ((), (n,)):
        raise ModelError(
            "bad_array",
            f"expected one travel or {n} of them, found {way.shape}",
            suggestions=("give a length in metres, or one for each stroke",),
        )
    for length in way.ravel().tolist():
        require_amount(length, "a travel of", "give a length in metres")
    return np.broadcast_to(way, n)[:, None]


def touched_faces(model: PushedBody, places: Array, normals: Array) -> Array:
    """Of each touched face: where along it the contact is, half its width, curvature; (n, 3).

    Contacts (n, 2) [m] and horizontal outward unit normals there (n, 2) are in the table plane.

    Raises:
        ModelError: `bad_array` if the object has no such face; `off_object` if it ends before the
            contact.
    """
    rows = []
    for place, normal in zip(places, normals, strict=True):
        faces = model.faces(np.array([np.arctan2(-normal[1], -normal[0])]))
        level = [np.array(f.normal[:2]) / np.hypot(*f.normal[:2]) for f in faces]
        off = [
            1.0 - m @ normal + abs((place - f.centre[:2]) @ m) / model.footprint.size
            for f, m in zip(faces, level, strict=True)
        ]
        face = faces[int(np.argmin(off))]
        if level[int(np.argmin(off))] @ normal < 1.0 - 1e-4:
            raise ModelError(
                "bad_array",
                f"the {model.name} has no face that looks along {normal}",
                suggestions=("take `face.normal` of one of `model.faces`",),
            )
        at = (place - face.centre[:2]) @ np.array(face.tangent[:2])
        if abs(at) > face.width / 2.0 + BEYOND and face.curvature == 0.0:
            raise ModelError(
                "off_object",
                f"the contact lies {1e3 * (abs(at) - face.width / 2.0):.0f} mm beyond the end of "
                f"the face of the {model.name} that it should touch",
                suggestions=("take a place between the ends of the face",),
            )
        rows.append((at, face.width / 2.0, face.curvature))
    return np.array(rows).reshape(len(places), 3)


@dataclass(frozen=True)
class _State:
    """Poses (n, 3), places of the contacts along the face (n, k), pushes (n, 2); or their rates."""

    pose: Array
    slipped: Array
    force: Array

    def state_after(self, rate: _State, h: Array) -> _State:
        """The state after travels h (n, 1), under the push of that time."""
        return _State(self.pose + h * rate.pose, self.slipped + h * rate.slipped, rate.force)


_Motion = tuple[Slide, Array, NDArray[np.intp]]
"""How the object moves, how its contacts move along the face (n, k), and the modes (n,)."""


class _Pushes:
    """The equations of motion of n strokes with k fingers."""

    def __init__(
        self, law: SlidingLaw, p: Array, n: Array, d: Array, face: Array, tip_radius: float
    ) -> None:
        self.law, self.tip_radius = law, tip_radius
        self.p, self.inward, self.d, self.face = p, -n, d, face
        self.tangent = left_of(n)

    def rates(self, at: _State) -> tuple[_State, NDArray[np.intp]]:
        """Rates of the state per travel, with the push there, and the modes (n,)."""
        # In B: fingers travel along d turned back, contacts have moved along the face.
        d = rotate(self.d, -at.pose[:, 2])
        place, half, curvature = self.face.T
        here = self.carry_around(curvature * at.slipped[:, 0])
        here.law = self.law.law_under(at.force)
        flat = (curvature == 0.0)[:, None, None]
        moved = np.where(flat, at.slipped[..., None] * here.tangent[:, None, :], 0.0)
        r = here.p + moved - here.law.com[:, None, :]
        one = r.shape[1] == 1
        slide, slips, mode = here._one_finger(r[:, 0], d) if one else here._two_fingers(r, d)
        # As the object turns, round tips roll along it.
        rolled = (slips - self.tip_radius * slide.turn[:, None]) / (
            1.0 + self.tip_radius * curvature[:, None]
        )
        # On a round side there is always more of it.
        lost = (np.abs(place + at.slipped[:, 0]) > half) & (curvature == 0.0)
        v = slide.v - slide.turn[:, None] * left_of(here.law.com)  # of B's origin
        rate = np.column_stack((rotate(v, at.pose[:, 2]), slide.turn))
        rate[lost], rolled[lost], mode[lost] = 0.0, 0.0, _LOST
        return _State(rate, rolled, slide.force), mode

    def carry_around(self, angle: Array) -> _Pushes:
        """With contacts and normals carried around a round side by angles (n,)."""
        turned = self.pick_strokes(np.arange(len(angle)))
        if angle.any():
            curvature = np.where(self.face[:, 2] > 0.0, self.face[:, 2], 1.0)[:, None]
            centre = self.p[:, 0] + self.inward / curvature
            turned.p = (centre + rotate(self.p[:, 0] - centre, angle))[:, None, :]
            turned.inward = rotate(self.inward, angle)
            turned.tangent = rotate(self.tangent, angle)
        return turned

    def _one_finger(self, r: Array, d: Array) -> _Motion:
        """One finger, sticking or at the edge of its friction cone."""
        slide, mu = self.law.slide_with(r, d), self.law.finger_friction
        slip, mode = np.zeros(len(d)), np.full(len(d), _STICK)
        pressing, aside = dot(slide.force, self.inward), dot(slide.force, self.tangent)
        (i,) = np.nonzero(~(np.abs(aside) <= mu * pressing))
        if i.size:
            n, t = self.inward[i], self.tangent[i]
            edge = n + (mu[i] * np.sign(aside[i]))[:, None] * t
            moved = self.law.chosen_strokes(i).slide_under(r[i], edge)
            speed = dot(d[i], n) / dot(moved.contact_velocity(r[i]), n)
            slide.v[i], slide.turn[i] = speed[:, None] * moved.v, speed * moved.turn
            slide.force[i] = moved.force
            slip[i] = dot(d[i] - slide.contact_velocity(r)[i], t)
            mode[i] = np.where(slip[i] > 0.0, _RIGHT, _LEFT)
        return slide, slip[:, None], mode

    def _two_fingers(self, r: Array, d: Array) -> _Motion:
        """Two fingers on one face: as one body, slipping both, or turning about one of them."""
        n, t, mu = self.inward, self.tangent, self.law.finger_friction
        speed, aside = dot(d, n), dot(d, t)
        along = np.sum(r * t[:, None, :], axis=2)  # places along the face, (n, 2)
        depth = dot(r[:, 0], n)  # of the face ahead of the centre, negative
        # Straight: the force d through the centre must lie between the fingers, in the cone.
        at = depth / speed * aside
        between = (at >= along.min(axis=1)) & (at <= along.max(axis=1))
        sticks = between & (np.abs(aside) <= mu * speed)
        edge_at = depth * mu * np.sign(aside)
        slips = (np.abs(aside) > mu * speed) & (edge_at >= along.min(axis=1))
        slips &= edge_at <= along.max(axis=1)
        edge = n + (mu * np.sign(aside))[:, None] * t
        v = np.where(slips[:, None], speed[:, None] * edge, d)
        slide = Slide(v, np.zeros(len(d)), v / np.sqrt(dot(v, v))[:, None])
        both = np.tile(np.where(slips, aside - dot(v, t), 0.0)[:, None], 2)
        mode = np.where(slips, np.where(aside > 0.0, _RIGHT, _LEFT), _STICK)
        (i,) = np.nonzero(~sticks & ~slips)
        if i.size:
            # It turns away from one finger: the one that the line of force leaves behind.
            target = np.where(np.abs(aside) > mu * speed, edge_at, at)
            stays = np.where(target > along.max(axis=1), along.argmax(axis=1), along.argmin(axis=1))
            one, slip, _ = self.pick_strokes(i)._one_finger(r[i, stays[i]], d[i])
            slide.v[i], slide.turn[i], slide.force[i] = one.v, one.turn, one.force
            both[i], mode[i] = slip, _TURN
        return slide, both, mode

    def pick_strokes(self, i: NDArray[np.intp]) -> _Pushes:
        """Some of the strokes."""
        return _Pushes(
            self.law.chosen_strokes(i),
            self.p[i],
            -self.inward[i],
            self.d[i],
            self.face[i],
            self.tip_radius,
        )


# Turning an object by pushing it off its middle with one finger.
#
# Model: quasi-static sliding on the ellipsoidal limit surface, so the motion is normal to it at
# the friction wrench: v ∝ F, ω ∝ m_z / c̄² about the centre of mass (Howe and Cutkosky 1996). The
# finger is a point that sticks to a side and moves in a direction that is fixed in B: the finger
# turns with the object. Then the twist in B is constant, and the object turns about a point at
# rest, its pivot,
#
#     p_P = c + ẑ × v / ω,    |p_P − c| = c̄² / lever arm of F about c
#
# so the pose after any turn is exact. The longer the lever arm, the less the object moves as it
# turns: a contact far out on a face, and a force that is slanted outwards. On a round side the
# whole lever arm, R sin of the force's slant, is owed to friction at the finger.
#
# Frame: the object's frame B at the start; poses are (x, y, θ) of B in it. Slants are angles in
# the table plane from the inward normal, counter-clockwise.

Vector3 = tuple[float, float, float]

EDGE: SafetyFigure = 0.010
"""Distance that a chosen contact keeps from the ends of a flat face, a fingertip's radius [m]."""

SIGMAS: SafetyFigure = 1.0
"""Standard deviations of the parameters with which a chosen contact must still stick."""

CONE_SHARE: SafetyFigure = 0.9
"""Slope of the chosen force as a share of the friction coefficient that is left then."""

RADIUS_SIGMAS: SafetyFigure = 2.0
"""Deviations of the friction radius for which a chosen direction and its stroke allow; it is the
least known of all, and large ones slant the force most."""

STROKE_SLACK: SafetyFigure = 0.005
"""What a stroke allows for on top of that [m]."""

_OFFSETS = np.linspace(1.0, 0.2, 17)  # of contacts that are compared, as shares of the farthest
_STRAIGHT = 1e-6  # a push that turns the object by less per travel goes straight [rad/m]


@dataclass(frozen=True)
class Turning:
    """Motion by pushes that turn an object; arrays over n pushes.

    Attributes:
        pose: x, y [m], θ [rad] of B after the turn, shape (n, 3); NaN where it does not turn so.
        travel: way of the contact until then, shape (n,) [m]; infinite where it does not turn so.
        pivot: the point of B about which it turns, shape (n, 2) [m]; NaN likewise.
        slant: of the force at the finger, shape (n,) [rad].
        turns: whether it turns in the sense that is asked for, shape (n,).
        sticks: whether the finger sticks, shape (n,).
    """

    pose: Array
    travel: Array
    pivot: Array
    slant: Array
    turns: NDArray[np.bool_]
    sticks: NDArray[np.bool_]

    @property
    def is_successful(self) -> NDArray[np.bool_]:
        """Return True where the object turns as asked while the finger sticks, shape (n,)."""
        return self.turns & self.sticks


@dataclass(frozen=True)
class TurningPush:
    """A push that turns an object, in B.

    Attributes:
        point: contact p_BC [m].
        normal: outward unit normal there.
        direction: in which the contact moves at first, a horizontal unit vector.
        turn: angle, counter-clockwise [rad].
        travel: way of the contact, predicted [m].
        stroke: the most that may be travelled, with room for what is not known [m].
        pose: x, y [m], θ [rad] of B at the end, predicted.
    """

    point: Vector3
    normal: Vector3
    direction: Vector3
    turn: float
    travel: float
    stroke: float
    pose: Vector3


def turning_motion(
    model: PushedBody,
    points: ArrayLike,
    normals: ArrayLike,
    slants: ArrayLike,
    angle: ArrayLike,
    *,
    sigmas: float = 0.0,
) -> Turning:
    """Motion by pushes that turn an object by an angle.

    Args:
        model: of the object.
        points: contact points p_BC, shape (n, 3) [m].
        normals: outward unit normals there in B, shape (n, 3).
        slants: directions in which the contacts move, shape () or (n,) [rad].
        angle: of the turn, counter-clockwise, not 0, shape () or (n,) [rad].
        sigmas: deviations of the friction at the finger and of the friction radius with which it
            must still stick and turn.

    Raises:
        ModelError: `bad_array`, `bad_value`.
    """
    contact = _Contacts(model, points, normals)
    n = len(contact.r)
    beta, phi = (np.broadcast_to(np.asarray(a, float), (n,)) for a in (slants, angle))
    if not (np.isfinite(beta).all() and np.isfinite(phi).all() and phi.all()):
        raise ModelError(
            "bad_value",
            "slants and angles must be finite, and no angle may be 0",
            suggestions=("give them in radians, an angle above 0 for counter-clockwise",),
        )
    require_amount(sigmas, "sigmas", "2 is a usual margin, 0 takes none")
    d = np.column_stack((np.cos(beta), np.sin(beta)))
    force, rate = contact.sticking_motion(d, model.friction_radius)
    turns, sticks = rate * np.sign(phi) > _STRAIGHT, contact.is_sticking(force, sigmas)
    for doubt in (-sigmas, sigmas) if sigmas else ():
        other, other_rate = contact.sticking_motion(d, _shifted_radius(model, doubt))
        turns = turns & (other_rate * phi > 0.0)
        sticks = sticks & contact.is_sticking(other, sigmas)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        travel = np.where(turns, phi / rate, np.inf)
        # Of the pivot from the centre of mass.
        arm = left_of(force) / np.where(turns, rate, np.nan)[:, None]
    pivot = np.array(model.com[:2]) + contact.in_B(arm)
    moved = np.where(turns[:, None], pivot - rotate(pivot, phi), np.nan)
    pose = np.column_stack((moved, np.where(turns, phi, np.nan)))
    slant = np.arctan2(force[:, 1], force[:, 0])
    return Turning(pose, travel, pivot, slant, turns, sticks)


@remember_answers(1024)
def best_turn(model: PushedBody, face: Face, angle: float, height: float) -> TurningPush | None:
    """The push on a face that turns the object with the least translation, kept.

    Its contact lies far out on the face, and its force is slanted outwards as far as friction
    surely holds for the largest friction radius; farther in where it would slip for the smallest.

    Args:
        model: of the object.
        face: of its side faces; the middle of the strip is taken on a round one.
        angle: of the turn, counter-clockwise, not 0 [rad].
        height: of the contact above the table [m].

    Returns:
        None if no push on this face turns it in this sense.

    Raises:
        ModelError: `bad_value`.
    """
    sense = float(np.sign(angle))
    farthest = 0.0 if face.curvature else max(face.width / 2.0 - EDGE, 0.0)
    p, n = face.points_at(sense * farthest * _OFFSETS, height)
    contacts = _Contacts(model, p, n)
    holds = CONE_SHARE * max(model.finger_friction - SIGMAS * model.finger_friction_sd, 0.0)
    # A force square to its lever arm turns best; more slant than that is of no use.
    along, across = np.abs(contacts.r.T)
    slope = -sense * np.minimum(holds, along / np.maximum(across, 1e-9))
    force = np.column_stack((np.ones(len(p)), slope))
    widest = _shifted_radius(model, RADIUS_SIGMAS)
    d = contact_velocity(contacts.r, force, widest)
    d /= np.linalg.norm(d, axis=1)[:, None]
    predicted = turning_motion(model, p, n, np.arctan2(d[:, 1], d[:, 0]), angle, sigmas=SIGMAS)
    if not predicted.is_successful.any():
        return None
    lever = np.abs(cross(contacts.r, force)) / np.linalg.norm(force, axis=1)
    best = int(np.argmax(np.where(predicted.is_successful, lever, -1.0)))
    slowest = contacts.sticking_motion(d, widest)[1][best]
    direction = contacts.in_B(d)[best]
    return TurningPush(
        point=vector_tuple(p[best]),
        normal=vector_tuple(n[best]),
        direction=vector_tuple(np.append(direction, 0.0)),
        turn=angle,
        travel=float(predicted.travel[best]),
        stroke=float(max(angle / slowest, predicted.travel[best])) + STROKE_SLACK,
        pose=vector_tuple(predicted.pose[best]),
    )


def learned_radius(
    model: PushedBody, point: ArrayLike, direction: ArrayLike, pose: ArrayLike
) -> float:
    """The friction radius that a push has shown which turned the object [m].

    The contact moves at right angles to its arm from the pivot, which B's displacement gives away.

    Args:
        model: of the object, as believed before.
        point: contact point p_BC, shape (3,) [m].
        direction: horizontal unit vector in which the contact moved at first, in B, shape (3,).
        pose: x, y [m], θ [rad] of B after the push, in B before it; θ is not 0.

    Returns:
        At least a share of what was believed, at most that of an object on its corners.

    Raises:
        ModelError: `bad_value`.
    """
    x, y, angle = np.asarray(pose, float)
    if not np.isfinite([x, y, angle]).all() or angle == 0.0:
        raise ModelError(
            "bad_value",
            "nothing is learned from a push that did not turn the object",
            suggestions=("push farther from the middle of the face",),
        )
    # p − R p is the displacement.
    d, moved = np.asarray(direction, float)[:2], np.array([x, y])
    pivot = 0.5 * (moved + left_of(moved) / np.tan(0.5 * angle))
    r = np.asarray(point, float)[:2] - np.array(model.com[:2])
    # With arm ρ = 1 / ω: from ω = (ẑ × r) · d / (c̄² + r²).
    arm = float(left_of(d) @ (pivot - np.array(model.com[:2]) - r))
    squared = arm * float(left_of(r) @ d) - float(r @ r)
    least, most = _shifted_radius(model, -np.inf), _shifted_radius(model, np.inf)
    return float(np.sqrt(np.clip(squared, least**2, most**2)))


class _Contacts:
    """Contacts of n pushes, each in a frame with x along the inward normal, y = ẑ × x.

    Attributes:
        r: contacts from the centre of mass, shape (n, 2) [m].
    """

    def __init__(self, model: PushedBody, points: ArrayLike, normals: ArrayLike) -> None:
        p, n = checked_pairs(points, normals)
        require_normals(n)
        self._model = model
        level = -n[:, :2] / np.hypot(n[:, 0], n[:, 1])[:, None]
        self._axes = np.stack((level, left_of(level)), axis=-1)  # columns, shape (n, 2, 2)
        self.r = np.einsum("nij,ni->nj", self._axes, p[:, :2] - np.array(model.com[:2]))

    def in_B(self, vectors: Array) -> Array:
        """Vectors of shape (n, 2) brought into B."""
        return np.asarray(np.einsum("nij,nj->ni", self._axes, vectors))

    def sticking_motion(self, d: Array, radius: float) -> tuple[Array, Array]:
        """Forces under which the contacts move with velocities d, and the rates of turning."""
        force = sticking_force(self.r, d, radius)
        return force, turning_rate(self.r, force, radius)

    def is_sticking(self, force: Array, sigmas: float) -> NDArray[np.bool_]:
        """Return True for forces inside the friction cone of the finger."""
        mu = self._model.finger_friction - sigmas * self._model.finger_friction_sd
        return np.asarray((force[:, 0] > 0.0) & (np.abs(force[:, 1]) <= mu * force[:, 0]))


def _shifted_radius(model: PushedBody, sigmas: float) -> float:
    """The friction radius with so many deviations more, or less if negative [m].

    No pressure turns harder than that of an object which stands on its corners.
    """
    believed = model.friction_radius
    most = max(believed, friction_radius("corners", model.footprint))
    least = 0.3 * believed  # share of the friction radius that no doubt takes away
    return float(np.clip(believed + sigmas * model.friction_radius_sd, least, most))
