"""Closed form of one push in plain numbers, and of many in blocks.

The formulae are those of `objectmodels.mechanics.push_thresholds`. A call of numpy takes longer
than all operations of one push; of many, a block at a time stays in the processor's cache.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf
from typing import NamedTuple

import numpy as np

from objectmodels.geometry.base_shapes import Array, Base
from objectmodels.mechanics.push_thresholds import (
    LAST_STEP,
    MORE_STEPS,
    is_largest_load,
    load_guess,
    load_step,
    quick_slide_force,
    slide_threshold,
    surely_jams,
    topple_threshold,
    yaw_arm,
)

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
        slide[b] = _quick_slide(body, p[b], u[b])
        topple[b] = topple_threshold(body.base, p[b], u[b], body.com, body.weight)
    (i,) = np.nonzero(np.isnan(slide))
    p, u = p[i], u[i]
    slide[i] = slide_threshold(u, yaw_arm(p, u, body.com), body.friction, body.radius, body.weight)
    return slide, topple


def blocks(n: int) -> Iterator[slice]:
    """Parts of n pushes, one after the other."""
    return (slice(start, start + BLOCK) for start in range(0, n, BLOCK))


def _quick_slide(body: Figures, p: Array, u: Array) -> Array:
    """Forces at which pushes slide, nan where that takes a closer look, (n,) [N]."""
    x, y, w = u[:, 0], u[:, 1], u[:, 2]
    arm = yaw_arm(p, u, body.com)
    a2 = arm * arm * body.radius**-2
    return quick_slide_force(x * x + y * y, w, a2, body.friction, body.weight)


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
