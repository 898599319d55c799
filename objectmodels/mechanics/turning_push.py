"""Turning an object by pushing it off its middle with one finger.

Model: quasi-static sliding on the ellipsoidal limit surface, so the motion is normal to it at the
friction wrench: v ∝ F, ω ∝ m_z / c̄² about the centre of mass (Howe and Cutkosky 1996). The finger
is a point that sticks to a side and moves in a direction that is fixed in B: the finger turns with
the object. Then the twist in B is constant, and the object turns about a point at rest, its pivot,

    p_P = c + ẑ × v / ω,    |p_P − c| = c̄² / lever arm of F about c

so the pose after any turn is exact. The longer the lever arm, the less the object moves as it
turns: a contact far out on a face, and a force that is slanted outwards. On a round side the whole
lever arm, R sin of the force's slant, is owed to friction at the finger.

Frame: the object's frame B at the start; poses are (x, y, θ) of B in it. Slants are angles in the
table plane from the inward normal, counter-clockwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.support_points import friction_radius
from objectmodels.geometry.vector_arrays import (
    checked_pairs,
    cross,
    left_of,
    require_amount,
    require_normals,
    rotate,
)
from objectmodels.mechanics.sliding_law import contact_velocity, sticking_force, turning_rate

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody
    from objectmodels.geometry.side_faces import Face

Vector3 = tuple[float, float, float]

EDGE = 0.010
"""Distance that a chosen contact keeps from the ends of a flat face, a fingertip's radius [m]."""

SIGMAS = 1.0
"""Standard deviations of the parameters with which a chosen contact must still stick."""

CONE_SHARE = 0.9
"""Slope of the chosen force as a share of the friction coefficient that is left then."""

RADIUS_SIGMAS = 2.0
"""Deviations of the friction radius for which a chosen direction and its stroke allow; it is the
least known of all, and large ones slant the force most."""

STROKE_SLACK = 0.005
"""What a stroke allows for on top of that [m]."""

_OFFSETS = np.linspace(1.0, 0.2, 17)  # of contacts that are compared, as shares of the farthest
_STRAIGHT = 1e-6  # a push that turns the object by less per travel goes straight [rad/m]
_SMALLEST_RADIUS = 0.3  # share of the friction radius that no doubt takes away


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


def best_turn(
    model: PushedBody,
    face: Face,
    angle: float,
    height: float,
    *,
    sigmas: float = SIGMAS,
    edge: float = EDGE,
) -> TurningPush | None:
    """The push on a face that turns the object with the least translation.

    Its contact lies far out on the face, and its force is slanted outwards as far as friction
    surely holds for the largest friction radius; farther in where it would slip for the smallest.

    Args:
        model: of the object.
        face: of its side faces; the middle of the strip is taken on a round one.
        angle: of the turn, counter-clockwise, not 0 [rad].
        height: of the contact above the table [m].
        sigmas: deviations of the parameters with which the finger must still stick.
        edge: least distance of the contact from the ends of a flat face [m].

    Returns:
        None if no push on this face turns it in this sense.

    Raises:
        ModelError: `bad_value`.
    """
    sense = float(np.sign(angle))
    farthest = 0.0 if face.curvature else max(face.width / 2.0 - edge, 0.0)
    p, n = face.points_at(sense * farthest * _OFFSETS, height)
    contacts = _Contacts(model, p, n)
    holds = CONE_SHARE * max(model.finger_friction - sigmas * model.finger_friction_sd, 0.0)
    # A force square to its lever arm turns best; more slant than that is of no use.
    along, across = np.abs(contacts.r.T)
    slope = -sense * np.minimum(holds, along / np.maximum(across, 1e-9))
    force = np.column_stack((np.ones(len(p)), slope))
    widest = _shifted_radius(model, RADIUS_SIGMAS)
    d = contact_velocity(contacts.r, force, widest)
    d /= np.linalg.norm(d, axis=1)[:, None]
    predicted = turning_motion(model, p, n, np.arctan2(d[:, 1], d[:, 0]), angle, sigmas=sigmas)
    if not predicted.is_successful.any():
        return None
    lever = np.abs(cross(contacts.r, force)) / np.linalg.norm(force, axis=1)
    best = int(np.argmax(np.where(predicted.is_successful, lever, -1.0)))
    slowest = contacts.sticking_motion(d, widest)[1][best]
    direction = contacts.in_B(d)[best]
    return TurningPush(
        point=_vector_tuple(p[best]),
        normal=_vector_tuple(n[best]),
        direction=_vector_tuple(np.append(direction, 0.0)),
        turn=angle,
        travel=float(predicted.travel[best]),
        stroke=float(max(angle / slowest, predicted.travel[best])) + STROKE_SLACK,
        pose=_vector_tuple(predicted.pose[best]),
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
    least = _SMALLEST_RADIUS * believed
    return float(np.clip(believed + sigmas * model.friction_radius_sd, least, most))


def _vector_tuple(v: Array) -> Vector3:
    x, y, z = v.tolist()
    return x, y, z
