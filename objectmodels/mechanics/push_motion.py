"""Motion of an object that one or two fingers push along the table.

Model: quasi-static sliding on the ellipsoidal limit surface, so the motion is normal to it at the
friction wrench: v ∝ F, ω ∝ m_z / c̄² about the centre of pressure (Howe and Cutkosky 1996). Fingers
are points that travel along a straight line and do not turn. A finger sticks while its force stays
in its friction cone, else it slips along the face. Two fingers on one face make a stable push as
long as the friction wrench can be balanced by forces of both (Lynch and Mason 1996); else the
object leaves one of them. The object stays upright; the push is horizontal.

Frame: the object's frame B at the start of the stroke; poses are (x, y, θ) of B in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.vector_arrays import (
    cross,
    left_of,
    require_amount,
    require_finite,
    rotate,
)

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody

STEPS = 200
"""Steps of the integration over a stroke; the pose's error is then below 1 µm for 0.2 m."""

MODES = np.array(["stick", "slip", "turn", "lost"])
"""What the fingers do: all stick; slip; the object turns away from one of two; none touches."""


@dataclass(frozen=True)
class Stroke:
    """Motion by strokes; arrays over n strokes.

    Attributes:
        pose: x, y [m], θ [rad] of B at the end, in B at the start, shape (n, 3).
        path: the same along the way, shape (STEPS + 1, n, 3).
        slipped: how far the first finger has slipped along the face, to the left seen from
            outside positive, shape (n,) [m].
        mode: what the fingers do at the end, of `MODES`, shape (n,).
        stable: whether fingers and object moved as one all the way, shape (n,).
    """

    pose: Array
    path: Array
    slipped: Array
    mode: NDArray[np.str_]
    stable: NDArray[np.bool_]


def integrate_stroke(
    model: PushedBody, points: ArrayLike, normals: ArrayLike, direction: ArrayLike, travel: float
) -> Stroke:
    """See `ObjectModel.stroke`."""
    p, n, d = _checked_stroke(points, normals, direction, travel)
    faces = touched_faces(model, p.mean(axis=1), n)
    if p.shape[1] == 2 and faces[:, 2].any():
        raise ModelError(
            "bad_value",
            "strokes of two fingers on a round side are not modelled",
            suggestions=("give one point per stroke, shape (n, 3)",),
        )
    pushes = _Pushes(model, p, n, d, faces)
    pose, slipped = np.zeros((len(p), 3)), np.zeros(p.shape[:2])
    path, stable = [pose], np.ones(len(p), dtype=bool)
    mode = np.zeros(len(p), dtype=np.intp)
    h = travel / STEPS
    for _ in range(STEPS):
        # The midpoint rule: what the fingers do is taken anew in the middle of each step.
        half = pushes.rates(pose, slipped)
        rate, slip, mode = pushes.rates(pose + 0.5 * h * half[0], slipped + 0.5 * h * half[1])
        pose, slipped = pose + h * rate, slipped + h * slip
        stable &= mode == 0
        path.append(pose)
    if not np.isfinite(pose).all():
        raise ModelError(
            "bad_value",
            "a stroke goes along its face and not against it",
            suggestions=("take a direction nearer to the face's inward normal",),
        )
    return Stroke(pose, np.array(path), slipped[:, 0], np.asarray(MODES[mode]), stable)


def _checked_stroke(
    points: ArrayLike, normals: ArrayLike, direction: ArrayLike, travel: float
) -> tuple[Array, Array, Array]:
    """Contacts (n, k, 2), normals (n, 2) and directions (n, 2) in the table plane."""
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
    require_amount(travel, "a travel of", "give a length in metres")
    level = n[:, :2] / np.hypot(n[:, 0], n[:, 1])[:, None]
    return p[..., :2].copy(), level, d[:, :2].copy()


def touched_faces(model: PushedBody, places: Array, normals: Array) -> Array:
    """Of each touched face: where along it the contact is, half its width, curvature; (n, 3).

    Contacts (n, 2) [m] and horizontal outward unit normals there (n, 2) are in the table plane.

    Raises:
        ModelError: `bad_array` if the object has no such face.
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
        rows.append((at, face.width / 2.0, face.curvature))
    return np.array(rows).reshape(len(places), 3)


def turning_rate(r: Array, force: Array, radius: float) -> Array:
    """Rate ω = r × F / c̄² under forces F, in units of which v = F, at contacts r (n, 2), (n,)."""
    return cross(r, force) / radius**2


def contact_velocity(r: Array, force: Array, radius: float) -> Array:
    """Velocity of the contacts under forces at them: F + ω ẑ × r, shape (n, 2)."""
    return np.asarray(force + turning_rate(r, force, radius)[:, None] * left_of(r))


def sticking_force(r: Array, d: Array, radius: float) -> Array:
    """Forces under which the contacts move as the fingers do: M F = d, M = I + l lᵀ/c̄², (n, 2)."""
    left = left_of(r) / radius
    share = np.sum(left * d, axis=1) / (1.0 + np.sum(left * left, axis=1))
    return np.asarray(d - share[:, None] * left)


class _Pushes:
    """The equations of motion of n strokes with k fingers."""

    def __init__(self, model: PushedBody, p: Array, n: Array, d: Array, face: Array) -> None:
        self.c, self.radius = np.array(model.com[:2]), model.friction_radius
        self.mu = model.finger_friction
        self.p, self.inward, self.d, self.face = p, -n, d, face
        self.tangent = np.column_stack((-n[:, 1], n[:, 0]))

    def rates(self, pose: Array, slipped: Array) -> tuple[Array, Array, NDArray[np.intp]]:
        """Rates of pose (n, 3) and slip (n, k) per travel, and the modes (n,)."""
        # In B: fingers travel along d turned back, contacts have moved along the face.
        d = rotate(self.d, -pose[:, 2])
        at, half, curvature = self.face.T
        here = self.carry_around(curvature * slipped[:, 0])
        flat = (curvature == 0.0)[:, None, None]
        r = here.p + np.where(flat, slipped[..., None] * here.tangent[:, None, :], 0.0) - self.c
        if r.shape[1] == 1:
            v, w, slip, mode = here._one_finger(r[:, 0], d)
            slips = slip[:, None]
        else:
            v, w, slips, mode = here._two_fingers(r, d)
        # On a round side there is always more of it.
        lost = (np.abs(at + slipped[:, 0]) > half) & (curvature == 0.0)
        v[lost], w[lost], slips[lost], mode[lost] = 0.0, 0.0, 0.0, 3
        # Velocity of B's origin, from that of the centre of mass.
        origin = v - w[:, None] * left_of(self.c)
        rate = np.column_stack((rotate(origin, pose[:, 2]), w))
        return rate, slips, mode

    def carry_around(self, angle: Array) -> _Pushes:
        """With contacts and normals carried around a round side by angles (n,)."""
        if not angle.any():
            return self
        centre = (
            self.p[:, 0]
            + self.inward / np.where(self.face[:, 2] > 0.0, self.face[:, 2], 1.0)[:, None]
        )
        moved = centre + rotate(self.p[:, 0] - centre, angle)
        turned = self.pick_strokes(np.arange(len(angle)))
        turned.p, turned.inward = moved[:, None, :], rotate(self.inward, angle)
        turned.tangent = rotate(self.tangent, angle)
        return turned

    def _one_finger(self, r: Array, d: Array) -> tuple[Array, Array, Array, NDArray[np.intp]]:
        """One finger: velocity of the centre of mass, turning rate, slip rate, mode."""
        force = sticking_force(r, d, self.radius)
        pressing = np.sum(force * self.inward, axis=1)
        aside = np.sum(force * self.tangent, axis=1)
        slips = np.abs(aside) > self.mu * pressing
        edge = self.inward + self.mu * np.sign(aside)[:, None] * self.tangent
        edge *= (
            np.sum(d * self.inward, axis=1)
            / np.sum(contact_velocity(r, edge, self.radius) * self.inward, axis=1)
        )[:, None]
        force = np.where(slips[:, None], edge, force)
        contact = contact_velocity(r, force, self.radius)
        slip = np.where(slips, np.sum((d - contact) * self.tangent, axis=1), 0.0)
        return force, turning_rate(r, force, self.radius), slip, slips.astype(np.intp)

    def _two_fingers(self, r: Array, d: Array) -> tuple[Array, Array, Array, NDArray[np.intp]]:
        """Two fingers on one face: as one body, slipping both, or turning about one of them."""
        n, t = self.inward, self.tangent
        zero = np.zeros(len(d))
        speed, aside = np.sum(d * n, axis=1), np.sum(d * t, axis=1)
        along = np.sum(r * t[:, None, :], axis=2)  # places along the face, (n, 2)
        depth = np.sum(r[:, 0] * n, axis=1)  # of the face ahead of the centre, negative
        # Straight: the force d through the centre must lie between the fingers, in the cone.
        at = depth / speed * aside
        between = (at >= along.min(axis=1)) & (at <= along.max(axis=1))
        sticks = between & (np.abs(aside) <= self.mu * speed)
        sign = np.sign(aside)
        edge_at = depth * self.mu * sign
        slips = (np.abs(aside) > self.mu * speed) & (edge_at >= along.min(axis=1))
        slips &= edge_at <= along.max(axis=1)
        v = np.where(slips[:, None], speed[:, None] * n + (self.mu * sign * speed)[:, None] * t, d)
        slip = np.where(slips, aside - self.mu * sign * speed, 0.0)
        mode = np.where(slips, 1, 0)
        w, both = zero.copy(), np.column_stack((slip, slip))
        (i,) = np.nonzero(~sticks & ~slips)
        if i.size:
            # It turns away from one finger: the one that the line of force leaves behind.
            target = np.where(np.abs(aside) > self.mu * speed, edge_at, at)
            stays = np.where(target > along.max(axis=1), along.argmax(axis=1), along.argmin(axis=1))
            alone = self.pick_strokes(i)
            one = alone._one_finger(r[i, stays[i]], d[i])
            v[i], w[i], both[i], mode[i] = one[0], one[1], one[2][:, None], 2
        return v, w, both, mode

    def pick_strokes(self, i: NDArray[np.intp]) -> _Pushes:
        """Some of the strokes."""
        some = object.__new__(_Pushes)
        some.c, some.radius, some.mu = self.c, self.radius, self.mu
        some.p, some.inward, some.d = self.p[i], self.inward[i], self.d[i]
        some.face = self.face[i]
        some.tangent = self.tangent[i]
        return some
