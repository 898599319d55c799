"""Motion at the instant at which a force is applied suddenly, inertia included.

Model: nothing moves below the onset of the closed form. Beyond it, the accelerations of a rigid
body from rest, seen in an upright plane through the centre of mass: along the force, or across the
edge that the object would topple over. Its base touches the table at a front and a back edge, with
Coulomb friction. Each way of moving is tried, and the one whose contact forces are possible counts.

Frame: x along the horizontal part of the force, z up, origin at the centre of mass; angles tip the
top forwards.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.exact.support_springs import push_axes
from objectmodels.mechanics.push_outcomes import (
    OUTCOMES,
    closed_form_thresholds,
    size_and_direction,
)

if TYPE_CHECKING:
    from objectmodels.geometry.mechanical import Mechanical


@dataclass(frozen=True)
class SuddenPush:
    """Classes and accelerations of suddenly applied forces; arrays over n pushes.

    Attributes:
        outcome: `none`, `slide`, `topple`, `slide+topple` or `lift`.
        acceleration: of the centre of mass along the horizontal part of the force, (n,) [m/s²].
        angular: of the tilt, forwards positive, shape (n,) [rad/s²].
    """

    outcome: NDArray[np.str_]
    acceleration: Array
    angular: Array


def sudden_push(model: Mechanical, p: Array, f: Array) -> SuddenPush:
    """See `ObjectModel.sudden`, which checks its arguments."""
    force, u = size_and_direction(f)
    t = closed_form_thresholds(model, p, u)
    c, m, mu = np.array(model.com), model.mass, model.friction
    _, level, _ = push_axes(f)
    # Across the edge that it would topple over first, if it topples first; else along the force.
    tips = (t.code == 2)[:, None]
    along = np.where(tips, t.tipping_normal, level)
    across = np.column_stack((-along[:, 1], along[:, 0]))
    fx, fz = np.sum(f[:, :2] * along, axis=1), f[:, 2]
    r = p - c
    x, z = np.sum(r[:, :2] * along, axis=1), r[:, 2]
    ahead = model.base.extent(along) - along @ c[:2]
    behind = model.base.extent(-along) + along @ c[:2]
    k_x, k_y, _ = model.gyration
    # About the axis across.
    inertia = m * (k_x * across[:, 0] ** 2 + k_y * across[:, 1] ** 2)
    load, torque, c_z, zero = model.weight - fz, z * fx - x * fz, c[2], np.zeros_like(fx)

    slides = _both_edges(torque + c_z * mu * load, load, ahead, behind) & (fx > mu * load)
    # What moves by turning about the vertical too, or slides aside, seems to rest in the plane.
    rests = _both_edges(torque + c_z * fx, load, ahead, behind) & (np.abs(fx) <= mu * load)
    ways = [
        (force < t.onset, "none", zero, zero),
        (rests, "", zero, zero),
        *_tipping_ways(fx, load, torque, inertia, m, mu, c_z, ahead),
        (slides, "slide", (fx - mu * load) / m, zero),
        *_tipping_ways(-fx, load, -torque, inertia, m, mu, c_z, behind, sign=-1.0),
        (np.ones(len(fx), dtype=bool), "lift", fx / m, torque / inertia),
    ]
    which = np.argmax([way[0] for way in ways], axis=0)
    row = np.arange(len(fx))
    outcome = np.array([way[1] for way in ways], dtype=OUTCOMES.dtype)[which]
    return SuddenPush(
        outcome=np.where(which == 1, t.outcome, outcome),
        acceleration=np.array([way[2] for way in ways])[which, row],
        angular=np.array([way[3] for way in ways])[which, row],
    )


def _both_edges(moment: Array, load: Array, ahead: Array, behind: Array) -> NDArray[np.bool_]:
    """Return True where both edges press for a moment that the normal forces must balance."""
    front = (moment + behind * load) / (ahead + behind)
    return np.asarray((front >= 0.0) & (front <= load))


Way = tuple[NDArray[np.bool_], str, Array, Array]


def _tipping_ways(
    fx: Array, load: Array, torque: Array, inertia: Array,
    m: float, mu: float, c_z: float, b: Array, sign: float = 1.0,
) -> list[Way]:  # fmt: skip
    """Tipping about the edge ahead, which stays or slides either way.

    About an edge that stays I α = torque + c_z f_x − b load − m α (b² + c_z²).
    """
    ways: list[Way] = []
    stays = (torque + c_z * fx - b * load) / (inertia + m * (b * b + c_z * c_z))
    normal, friction = load + m * stays * b, m * stays * c_z - fx
    possible = (stays > 0.0) & (normal >= 0.0) & (np.abs(friction) <= mu * normal)
    ways.append((possible, "topple", sign * stays * c_z, sign * stays))
    for slip in (1.0, -1.0):  # the edge slides ahead, or back
        alpha = (torque + (slip * mu * c_z - b) * load) / (inertia + m * b * (b - slip * mu * c_z))
        normal = load + m * alpha * b
        ahead = (fx - slip * mu * normal) / m
        possible = (alpha > 0.0) & (normal >= 0.0) & (slip * (ahead - alpha * c_z) > 0.0)
        ways.append((possible, "slide+topple", sign * ahead, sign * alpha))
    return ways
