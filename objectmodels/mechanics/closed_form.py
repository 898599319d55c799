"""Closed form of one push in plain numbers, and of many in blocks.

The formulae are those of `objectmodels.mechanics.push_thresholds`. A call of numpy takes longer
than all operations of one push; of many, a block at a time stays in the processor's cache.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from objectmodels.geometry.base_shapes import Array, Base
from objectmodels.mechanics.push_thresholds import (
    QUICK_STEPS,
    is_first_ratio,
    nearer_ratio,
    slide_threshold,
    topple_threshold,
    yaw_arm,
)

BLOCK = 8192
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
    for start in range(0, len(p), BLOCK):
        b = slice(start, start + BLOCK)
        arm = yaw_arm(p[b], u[b], body.com)
        slide[b] = slide_threshold(u[b], arm, body.friction, body.radius, body.weight)
        topple[b] = topple_threshold(body.base, p[b], u[b], body.com, body.weight)
    return slide, topple


def _single_forces(body: Figures, p: Array, u: Array) -> tuple[float, float] | None:
    """The two forces of one push [N]; None if its load ratio takes a closer look."""
    ((x, y, z),), ((u_x, u_y, w),) = p.tolist(), u.tolist()
    (c_x, c_y, _), weight = body.com.tolist(), body.weight
    arm = (x - c_x) * u_y - (y - c_y) * u_x
    r = _single_ratio(float(np.hypot(u_x, u_y)), w, abs(arm) / body.radius, body.friction)
    if r is None:
        return None
    moment = z * u_x - w * x, z * u_y - w * y
    topple = body.base.single_topple_force((weight * c_x, weight * c_y), moment, w, weight)
    return (r * weight / (1.0 + r * w) if r < inf else inf), topple


def _single_ratio(h: float, w: float, a: float, mu: float) -> float | None:
    """Load ratio at which one push slides, inf if never; None if it takes a closer look.

    h is the length of u_xy, w is u_z, a is |arm| / c̄.
    """
    h2, a2 = h * h, a * a
    try:
        r = mu / sqrt(h2 + a2)
        for _ in range(QUICK_STEPS if a else 0):
            r = nearer_ratio(r, w, h2, a2, mu)
    except ZeroDivisionError:
        return None
    if is_first_ratio(r, w, h2, a2, mu):
        return r
    jams = w < 0.0 and h <= -mu * w and a2 <= 8.0 * h2
    return inf if jams else None
