"""The limit surface of an object on its support points: wrench of a twist, twist of a wrench.

Model: as in `objectmodels.exact.top_drag`, pushed level with the table, so that the
loads are those of the standing object.

Frame: twists (v_x, v_y, ω) [m/s, rad/s] and wrenches (f_x, f_y, m_z) [N, N m] are about the origin
of B and along its axes. The wrench is that of the push, which friction balances.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.errors import ModelError
from objectmodels.exact.top_drag import LoadedPoints
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.rotations import cross, dot, left_of, require_finite

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody


_FARTHEST = 1e6  # arm of a force, in sizes of the base, that stands for a mere moment


def wrench_of_twist(model: PushedBody, twists: ArrayLike) -> Array:
    """Wrenches that keep up sliding motions, shape (n, 3); the motions' speed does not matter.

    Args:
        model: of the object.
        twists: shape (n, 3). A point at rest adds nothing, though it could hold.

    Raises:
        ModelError: `bad_array` if a shape or a value is wrong, or nothing moves.
    """
    twist = _checked_rows(twists, "twists")
    size = model.footprint.size
    twist = twist / np.hypot(np.hypot(twist[:, 0], twist[:, 1]), size * twist[:, 2])[:, None]
    law = LoadedPoints.of_model(model, np.zeros(len(twist)))
    slide = law.slide_at(-law.com, twist[:, :2], twist[:, 2])
    moment = law.friction_moment(slide) + cross(law.com, slide.force)
    return model.friction * model.weight * np.column_stack((slide.force, moment))


def twist_of_wrench(model: PushedBody, wrenches: ArrayLike) -> Array:
    """Sliding motions under wrenches, shape (n, 3); the origin of B, or its rim, moves at 1 m/s.

    Args:
        model: of the object.
        wrenches: shape (n, 3); only their directions count.

    Raises:
        ModelError: `bad_array` if a shape or a value is wrong, or nothing pushes.
    """
    wrench = _checked_rows(wrenches, "wrenches")
    size, law = model.footprint.size, LoadedPoints.of_model(model, np.zeros(len(wrench)))
    moment = wrench[:, 2] - cross(law.com, wrench[:, :2])
    least = np.abs(moment) / (_FARTHEST * size)
    force = wrench[:, :2].copy()
    weak = np.hypot(*force.T) < least
    force[weak] = np.column_stack((least, np.zeros_like(least)))[weak]
    r = -(moment / dot(force, force))[:, None] * left_of(force)
    slide = law.slide_under(r, force)
    v = slide.v - slide.turn[:, None] * left_of(law.com)
    speed = np.hypot(np.hypot(*v.T), size * slide.turn)
    return np.column_stack((v, slide.turn)) / speed[:, None]


def _checked_rows(rows: ArrayLike, name: str) -> Array:
    """Finite rows of three that are not zero, shape (n, 3)."""
    found = np.asarray(rows, dtype=np.float64)
    if found.ndim != 2 or found.shape[1] != 3 or not found.any(axis=1).all():
        raise ModelError(
            "bad_array",
            f"expected {name} of shape (n, 3), none of them zero, found {found.shape}",
            suggestions=("a single one is an array of shape (1, 3)",),
        )
    require_finite(found)
    return found
