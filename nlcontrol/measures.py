"""Quantities of an execution that a clause may be about, measured on its trace.

Model: poses are those that an observer of the world recorded; forces are what the finger's
joints felt, averaged over `FORCE_WINDOW` against the sensors' noise; speeds are those of the
fingertips' midpoint over `SPEED_WINDOW`. Frames: W is the world, B the object, T a fingertip.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sim.trace import Trace

Array = NDArray[np.float64]

FORCE_WINDOW = 0.15
"""Averaging time of the felt force [s]; shorter ones let sensor noise through as peaks."""

SPEED_WINDOW = 0.10
"""Time over which a travelled distance is taken as a speed [s]."""

REST_WINDOW = 0.2
"""Time at the end during which an object must be at rest [s]."""


def windowed_mean(time: Array, values: Array, window: float) -> Array:
    """Mean of a signal over a window centred at each sample, shorter at both ends.

    Args:
        time: sample times, increasing, shape (n,) [s].
        values: the signal, shape (n,).
        window: length of the window [s].
    """
    steps = np.diff(time) * 0.5 * (values[1:] + values[:-1])
    integral = np.concatenate([[0.0], np.cumsum(steps)])
    a = np.maximum(time - window / 2, time[0])
    b = np.minimum(time + window / 2, time[-1])
    span = b - a
    mean = np.interp(b, time, integral) - np.interp(a, time, integral)
    return np.where(span > 0.0, mean / np.where(span > 0.0, span, 1.0), values)


def during(trace: Trace, phases: Sequence[str]) -> NDArray[np.bool_]:
    """Which samples belong to the phases, shape (n,)."""
    return np.isin(trace.phase, list(phases))


def largest_push_force(trace: Trace) -> float:
    """Largest felt force of all fingers along the push while in contact, averaged [N]."""
    i = during(trace, ("touch", "push"))
    if not i.any():
        return 0.0
    return float(windowed_mean(trace.time[i], trace.push_force()[i], FORCE_WINDOW).max())


def midpoint(trace: Trace) -> Array:
    """Midpoint of the pushing fingertips in W over time, shape (n, 3) [m]."""
    mean: Array = np.mean(list(trace.tips.values()), axis=0)
    return mean


def largest_push_speed(trace: Trace) -> float:
    """Largest speed of the fingertips' midpoint while pushing [m/s]."""
    i = during(trace, ("push",))
    if np.count_nonzero(i) < 2:
        return 0.0
    time, p_WT = trace.time[i], midpoint(trace)[i]
    a = np.maximum(time - SPEED_WINDOW / 2, time[0])
    b = np.minimum(time + SPEED_WINDOW / 2, time[-1])
    travel = [np.interp(b, time, x) - np.interp(a, time, x) for x in p_WT.T]
    return float((np.linalg.norm(travel, axis=0) / (b - a)).max())


def push_start(trace: Trace) -> int | None:
    """Index of the first sample of the push; None if nothing was pushed."""
    found = np.flatnonzero(during(trace, ("push",)))
    return int(found[0]) if len(found) else None


def rotation(pose: Array) -> Array:
    """Rotation matrix R_WB, shape (3, 3), of a pose (w, x, y, z, position)."""
    w, x, y, z = pose[:4]
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def first_contact(trace: Trace, name: str) -> tuple[Array, Array] | None:
    """Where the fingertips are, seen from the object, when the push begins.

    Returns:
        Their midpoint p_BT in B [m] and the rotation R_WB; None if nothing was pushed.
    """
    start = push_start(trace)
    if start is None:
        return None
    pose = trace.poses[name][start]
    R_WB = rotation(pose)
    return R_WB.T @ (midpoint(trace)[start] - pose[4:]), R_WB


def tilt_at_end(trace: Trace, name: str) -> tuple[float, float]:
    """Smallest and largest tilt during the last `REST_WINDOW` [rad]."""
    last = trace.time >= trace.time[-1] - REST_WINDOW
    tilt = trace.tilt(name)[last]
    return float(tilt.min()), float(tilt.max())


def fall_heading(trace: Trace, name: str) -> float:
    """Heading of the object's axis B_z in W at the end [rad]; where a toppled one fell."""
    axis = rotation(trace.poses[name][-1])[:, 2]
    return float(np.arctan2(axis[1], axis[0]))
