"""Free motion by a point attractor: a bounded velocity pulls a point to its target.

The velocity points at the target, is no faster than allowed and changes no faster than an
acceleration allows; near the target it is what still lets it stop there. The point may be that of
the fingertips in W or the joint angles of the arm: a point that starts at rest then moves on the
straight line to its target, which is what was checked for collisions.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sim.rotations import Array

_ARRIVED = 1e-6


def attractor_points(
    start: Array, target: Array, *, speed: float, acceleration: float, period: float
) -> Iterator[Array]:
    """Points on the way from `start` to `target`, one per period; the last one is the target.

    Args:
        start: where the point is, at rest, shape (n,).
        target: where it is pulled, shape (n,).
        speed: largest speed [units/s].
        acceleration: largest change of the velocity [units/s²].
        period: time between two points [s].
    """
    point, velocity = np.array(start, dtype=float), np.zeros(len(start))
    while True:
        way = target - point
        distance = float(np.linalg.norm(way))
        if distance < _ARRIVED:
            if distance > 0.0:
                yield target.copy()
            return
        # Speed from which it can stop at the target, in whole periods.
        stopping = np.sqrt(2.0 * acceleration * distance + (acceleration * period / 2) ** 2)
        allowed = min(speed, max(stopping - acceleration * period / 2, _ARRIVED / period))
        change = allowed * way / distance - velocity
        most = acceleration * period
        velocity = velocity + change * min(1.0, most / max(float(np.linalg.norm(change)), 1e-12))
        step = velocity * period
        point = target.copy() if np.linalg.norm(step) >= distance else point + step
        yield point
