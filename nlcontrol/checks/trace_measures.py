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

    from sim.traces.trace import Trace

Array = NDArray[np.float64]

FORCE_WINDOW = 0.15
"""Averaging time of the felt force [s]; shorter ones let sensor noise through as peaks."""

SPEED_WINDOW = 0.10
"""Time over which a travelled distance is taken as a speed [s]."""

LEAST_WAY = 0.005
"""A push whose fingertips went less far than this has no direction of its own [m]."""

ON_TABLE = 0.001
"""Corners of a base that are no higher than this above its lowest one stand on the table [m]."""

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


def stretches(trace: Trace, phases: Sequence[str]) -> list[NDArray[np.intp]]:
    """Samples of each stretch of time that belongs to the phases, in order of time."""
    samples = np.flatnonzero(during(trace, phases))
    breaks = np.flatnonzero(np.diff(samples) > 1) + 1
    return [part for part in np.split(samples, breaks) if len(part)]


def largest_push_force(trace: Trace) -> float | None:
    """Largest felt force of all fingers along the push while in contact, averaged [N].

    None if nothing was felt: no finger has a sensor, or none pushed.

    Each push has the direction in which the fingertips went; one that went nowhere that of the
    trace.
    """
    largest: float | None = None
    for i in stretches(trace, ("touch", "push")) if trace.felt else ():
        way = midpoint(trace)[i[-1]] - midpoint(trace)[i[0]]
        length = float(np.linalg.norm(way))
        along = way / length if length > LEAST_WAY else trace.direction
        felt = np.sum([force[i] @ along for force in trace.felt.values()], axis=0)
        peak = float(windowed_mean(trace.time[i], felt, FORCE_WINDOW).max())
        largest = peak if largest is None else max(largest, peak)
    return largest


def midpoint(trace: Trace) -> Array:
    """Midpoint of the pushing fingertips in W over time, shape (n, 3) [m]; nan if none pushes."""
    if not trace.tips:
        return np.full((len(trace.time), 3), np.nan)
    mean: Array = np.mean(list(trace.tips.values()), axis=0)
    return mean


def largest_push_speed(trace: Trace) -> float | None:
    """Largest speed of the fingertips' midpoint while pushing [m/s]; None if none is known."""
    if not trace.tips:
        return None
    return _largest_speed(trace, ("push",), midpoint(trace))


def _largest_speed(trace: Trace, phases: Sequence[str], points: Array) -> float | None:
    """Largest speed of a point, shape (n, 3), during some phases [m/s]; None without any."""
    largest: float | None = None
    for i in stretches(trace, phases):
        if len(i) < 2:
            continue
        time, p = trace.time[i], points[i]
        a = np.maximum(time - SPEED_WINDOW / 2, time[0])
        b = np.minimum(time + SPEED_WINDOW / 2, time[-1])
        travel = [np.interp(b, time, x) - np.interp(a, time, x) for x in p.T]
        peak = float((np.linalg.norm(travel, axis=0) / (b - a)).max())
        largest = peak if largest is None else max(largest, peak)
    return largest


HELD = ("lift", "carry", "pour", "set_down")
"""Phases in which something is moved in the hand."""


def largest_squeeze(trace: Trace) -> float | None:
    """Largest force of a finger on what is held, averaged [N]; None if nothing was felt.

    What holds is pressed from two sides with the same force, so that the finger that stands alone
    on its side feels all of it, whatever it is called.
    """
    held = during(trace, ("grasp", *HELD))
    if not trace.felt or not held.any():
        return None
    forces = (np.linalg.norm(force, axis=1) for force in trace.felt.values())
    means = [windowed_mean(trace.time, felt, FORCE_WINDOW)[held] for felt in forces]
    return float(np.max(means))


def largest_held_speed(trace: Trace, name: str) -> float | None:
    """Largest speed of what is moved in the hand [m/s]; None if it never was in the hand."""
    return _largest_speed(trace, ("lift", "carry", "set_down"), trace.poses[name][:, 4:])


def push_duration(trace: Trace) -> float | None:
    """Time that the object is pushed, over all pushes [s]; None if it never is."""
    pushing = during(trace, ("push",))
    if not pushing.any():
        return None
    together = pushing[1:] & pushing[:-1]
    return float(np.diff(trace.time)[together].sum())


def largest_force_limit(trace: Trace) -> float | None:
    """The largest force that a push was ready to press with [N]; None if there was no push."""
    pushing = during(trace, ("push",))
    return float(trace.force_limit[pushing].max()) if pushing.any() else None


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


def contacts(
    trace: Trace, name: str, phases: Sequence[str] = ("push",)
) -> list[tuple[Array, Array]]:
    """Places of the fingertips, seen from the object, when each push begins, or each grasp ends.

    Returns:
        Their midpoint p_BT in B [m] and the rotation R_WB, for each push.
    """
    found = []
    for i in stretches(trace, phases):
        at = i[0] if "push" in phases else i[-1]
        pose = trace.poses[name][at]
        R_WB = rotation(pose)
        found.append((R_WB.T @ (midpoint(trace)[at] - pose[4:]), R_WB))
    return found


def turn(trace: Trace, name: str) -> Array:
    """Angle by which an object has turned about the vertical over time, shape (n,) [rad].

    It is the twist about the vertical, which a tilt about whatever horizontal axis leaves alone, so
    that what falls over does not turn; counter-clockwise, from 0 at the start.
    """
    w, _, _, z = trace.poses[name][:, :4].T
    twist = np.unwrap(2.0 * np.arctan2(z, w))
    return np.asarray(twist - twist[0])


def tilt_at_end(trace: Trace, name: str) -> tuple[float, float]:
    """Smallest and largest tilt during the last `REST_WINDOW` [rad]."""
    last = trace.time >= trace.time[-1] - REST_WINDOW
    tilt = trace.tilt(name)[last]
    return float(tilt.min()), float(tilt.max())


def axis_tilt_at_end(trace: Trace, name: str, axis: Array) -> float:
    """Largest angle between an axis of B, (3,), and the vertical in the `REST_WINDOW` [rad]."""
    last = trace.time >= trace.time[-1] - REST_WINDOW
    upwards = [float(rotation(pose)[2] @ axis) for pose in trace.poses[name][last]]
    return float(np.arccos(np.clip(min(upwards), -1.0, 1.0)))


def tilt_heading(trace: Trace, name: str, sample: int = -1) -> float:
    """Heading of the object's axis B_z in W [rad]: where it leans, or where it fell."""
    axis = rotation(trace.poses[name][sample])[:, 2]
    return float(np.arctan2(axis[1], axis[0]))


def base_corners(trace: Trace, name: str, outline: Array) -> Array:
    """Corners of an object's base in W over time, (n, k, 3) [m], from those in B, (k, 2) [m]."""
    poses = trace.poses[name]
    corners = np.column_stack([outline, np.zeros(len(outline))])
    R_WB = np.array([rotation(pose) for pose in poses])
    return np.asarray(poses[:, None, 4:] + np.einsum("nij,kj->nki", R_WB, corners))


def slip(trace: Trace, name: str, outline: Array) -> float:
    """Largest way of what an object stood on, along the table [m].

    What it stands on are the lowest corners of its base: all of them, or the edge over which it
    tips, which stays where it is as long as nothing slides. A turn on the spot is no slide either.
    """
    corners = base_corners(trace, name, outline)
    moved = (corners - corners[0])[..., :2]
    height = corners[..., 2]
    lowest = height < height.min(axis=1, keepdims=True) + ON_TABLE
    middle = np.einsum("nk,nki->ni", lowest, moved) / lowest.sum(axis=1, keepdims=True)
    return float(np.linalg.norm(middle, axis=1).max())


def rise(trace: Trace, name: str, outline: Array) -> float:
    """Height by which the lowest corner of an object's base came off the table [m]."""
    height = base_corners(trace, name, outline)[..., 2]
    return float((height.min(axis=1) - height[0].min()).max())
