"""Logs of a triangle that a stiff arm pushed with one fingertip (zhou-2016), read and extracted.

A log begins with the number of its pushes. A push is the pose of the tracked body before and after
(x, y, z [mm], quaternion w, x, y, z), the number of force samples and those (time [s], two parts
[N] along the axes of the sensor), the number of poses of the tip and those (time, pose). The body's
frame lies in the right-angled corner. The sensor is mounted at 45°, feels the force on the tip, and
has an offset, which its first sample shows.

Frame: W is the robot's; B has its origin at the centroid of the triangle, its axes along the legs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from objectmodels import PrismModel
from objectmodels.geometry.base_shapes import Array, Support

LEG = 0.150
"""Length of the two legs [m]."""
MASS = 1.518
HEIGHT = 0.02
"""Of the plate; it is not told, and only bounds where a push may be [m]."""
CONTACT_HEIGHT = 0.01
"""Of the fingertip above the table, half-way up the plate [m]."""
ARM = np.sqrt(2.0) * LEG / 3.0
"""Length by which turns count as displacements, as in the source [m]."""
FRICTION = {"plywood": 5.0 / (MASS * 9.8), "hardboard": 4.2 / (MASS * 9.8)}
"""Mean coefficients that the source tells."""

_FEET = {
    "3pts1": ((0.03, 0.03), (0.06333, 0.04333), (0.04333, 0.06333)),
    "3pts2": ((0.01, 0.01), (0.01, 0.13), (0.13, 0.01)),
    "3pts3": ((0.03, 0.03), (0.09, 0.03), (0.03, 0.09)),
    "3pts4": ((0.01, 0.01), (0.09, 0.03), (0.01, 0.13)),
}
_FOLDER = Path("icra_data_proc", "SensorLogs")
LOGS = {
    "plywood 3pts1": "wood_30_63.33_43.33_30_43.33_63.33/exp_08_18_1330_50.txt",
    "plywood 3pts2": "wood_10_130_10_10_10_130/exp_08_17_50.txt",
    "plywood 3pts3": "wood_30_90_30_30_30_90/exp_08_17_0922_50.txt",
    "plywood 3pts4": "wood_10_90_10_10_30_130/exp_08_18_1100_50.txt",
    "plywood patch": "wood_patch/exp_08_17_0839_50.txt",
    "hardboard 3pts1": "30_63.33_43.33_30_43.33_63.33/exp_08_17_50.txt",
    "hardboard 3pts2": "10_130_10_10_10_130/exp_08_17_50.txt",
    "hardboard 3pts3": "30_90_30_30_30_90/exp_08_11_50_mixed.txt",
    "hardboard 3pts4": "10_90_10_10_30_130/exp_08_15_50.txt",
    "hardboard patch": "patch/exp_08_18_1435_50.txt",
}
"""Surface and support of each log, and its file."""

_QUICKLY = 0.3  # share of the samples at the start that is left out of the mean push
_SENSOR = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2.0)
_CORNER = np.array([LEG, LEG]) / 3.0  # the centroid, in the tracked frame


@dataclass(frozen=True)
class TrackedPush:
    """A push over time, in B as it was before.

    Attributes:
        pose: x, y [m], θ [rad] of B afterwards.
        time: of the force samples, from 0 on, shape (n,) [s].
        force: on the object, shape (n, 2) [N].
        tip: of the finger, shape (n, 2) [m].
    """

    pose: Array
    time: Array
    force: Array
    tip: Array

    @property
    def mean_push(self) -> tuple[Array, Array]:
        """Mean contact (2,) [m] and mean force (2,) [N] while it slides, in the axes of B then.

        As in the source: samples after the first three tenths, with a force above the mean one.
        """
        size = np.hypot(*self.force.T)
        late = np.arange(len(size)) >= np.ceil(_QUICKLY * len(size)) - 1
        keep = late & (size >= np.hypot(*self.force.mean(axis=0)))
        share = np.linspace(0.0, 1.0, keep.sum())
        turn = share * self.pose[2]
        return (
            _turned(self.tip[keep] - share[:, None] * self.pose[:2], -turn).mean(axis=0),
            _turned(self.force[keep], -turn).mean(axis=0),
        )


def known_support(log: str) -> Support:
    """Feet of the object of a log in B; `uniform` for the patch."""
    feet = _FEET.get(log.partition(" ")[2])
    if feet is None:
        return "uniform"
    return tuple((x - LEG / 3.0, y - LEG / 3.0) for x, y in feet)


def triangle_model(log: str, support: Support | None = None) -> PrismModel:
    """Model of the object of a log, untrained, on its known support or another one."""
    a, b = -LEG / 3.0, 2.0 * LEG / 3.0
    friction = FRICTION[log.partition(" ")[0]]
    return PrismModel(
        name="triangle",
        corners=((a, a), (b, a), (a, b)),
        height=HEIGHT,
        mass=MASS,
        mass_sd=0.002,
        friction=friction,
        friction_sd=0.1 * friction,
        finger_friction=0.35,
        support=known_support(log) if support is None else support,
    )


def read_log(folder: Path, log: str) -> list[TrackedPush]:
    """Pushes of a log in a copy of the repository of the source."""
    lines = iter((folder / _FOLDER / LOGS[log]).read_text("utf-8").splitlines())
    return [_tracked_push(lines) for _ in range(int(next(lines)))]


def _tracked_push(lines: Iterator[str]) -> TrackedPush:
    bodies = _level_poses(_rows(lines, 2))
    samples = _rows(lines, int(next(lines)))
    tips = _rows(lines, int(next(lines)))
    time, finger = samples[:, 0], _level_poses(tips[:, 1:])
    force = -(samples[:, 1:] - samples[0, 1:]) @ _SENSOR
    tip = np.column_stack([np.interp(time, tips[:, 0], finger[:, k]) for k in (0, 1)])
    start, end = (body[:2] + _turned(_CORNER[None], body[2:])[0] for body in bodies)
    before = bodies[0, 2]
    turn = (bodies[1, 2] - before + np.pi) % (2.0 * np.pi) - np.pi
    move = _turned((end - start)[None], -before)[0]
    return TrackedPush(
        pose=np.append(move, turn),
        time=time - time[0],
        force=_turned(force, finger[0, 2] - before),
        tip=_turned(tip - start, -before),
    )


def _rows(lines: Iterator[str], count: int) -> Array:
    return np.array([next(lines).split() for _ in range(count)], dtype=np.float64)


def _level_poses(rows: Array) -> Array:
    """x, y [m] and heading [rad] of poses x, y, z [mm], w, x, y, z, shape (n, 3)."""
    w, i, j, k = rows[:, 3:].T
    heading = np.arctan2(2.0 * (w * k + i * j), 1.0 - 2.0 * (j * j + k * k))
    return np.column_stack((rows[:, :2] / 1e3, heading))


def _turned(v: Array, angle: Array | float) -> Array:
    """Vectors (n, 2) turned counter-clockwise by one angle or by (n,) of them [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack((c * v[:, 0] - s * v[:, 1], s * v[:, 0] + c * v[:, 1]))
