"""Public logs of pushes: read, written as data files of `nlcontrol fit`, and held against models.

`read_log`: a triangle that a stiff arm pushed with one fingertip (zhou-2016). A log begins with the
number of its pushes. A push is the pose of the tracked body before and after (x, y, z [mm],
quaternion w, x, y, z), the number of force samples and those (time [s], two parts [N] along the
axes of the sensor), the number of poses of the tip and those (time, pose). The body's frame lies in
the right-angled corner. The sensor is mounted at 45°, feels the force on the tip, and has an
offset, which its first sample shows.

`read_planar_push`: a push of MIT's planar data set, a JSON file. `tip_pose` and `object_pose` have
rows time [s], x, y [m], heading; `ft_wrench` rows time, the force on the tip [N] and a moment; all
in the robot's axes. The tip is a rod.

`held_motions`: plates that two fingertips pushed along curves in closed loop. A row is time [s],
x, y [mm], heading [rad] of the plate, the same of the hand, and the number of the action.

Frame: W is the robot's; B has its origin at the centroid of the triangle, its axes along the legs.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from objectmodels import ObjectModel, PrismModel
from objectmodels.geometry.base_shapes import Array, Polygon, Support
from objectmodels.geometry.rotations import rotate

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
FINGER_FRICTIONS = np.arange(0.20, 0.71, 0.05)
"""Coefficients at the finger that are tried on training pushes."""
TIP_RADIUS = 0.00475
"""Of the rod of the planar data set [m]."""

FOLDER = Path("icra_data_proc", "SensorLogs")
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

_FEET = {
    "3pts1": ((0.03, 0.03), (0.06333, 0.04333), (0.04333, 0.06333)),
    "3pts2": ((0.01, 0.01), (0.01, 0.13), (0.13, 0.01)),
    "3pts3": ((0.03, 0.03), (0.09, 0.03), (0.03, 0.09)),
    "3pts4": ((0.01, 0.01), (0.09, 0.03), (0.01, 0.13)),
}
_QUICKLY = 0.3  # share of the samples at the start that is left out of the mean push
_SENSOR = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2.0)
_CORNER = np.array([LEG, LEG]) / 3.0  # the centroid, in the tracked frame
_APPROACH = 30  # samples before the touch that a recording keeps
_SETTLED = 0.010  # way of a held plate after which the fingers surely touch [m]


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
            rotate(self.tip[keep] - share[:, None] * self.pose[:2], -turn).mean(axis=0),
            rotate(self.force[keep], -turn).mean(axis=0),
        )


def triangle_model(log: str, support: Support | None = None) -> PrismModel:
    """Model of the object of a log, untrained, on its known support or another one."""
    surface, _, name = log.partition(" ")
    if support is None:
        feet = _FEET.get(name)
        support = "uniform" if feet is None else tuple((x - LEG / 3, y - LEG / 3) for x, y in feet)
    a, b = -LEG / 3.0, 2.0 * LEG / 3.0
    return PrismModel(
        name="triangle",
        corners=((a, a), (b, a), (a, b)),
        height=HEIGHT,
        mass=MASS,
        mass_sd=0.002,
        friction=FRICTION[surface],
        friction_sd=0.1 * FRICTION[surface],
        finger_friction=0.35,
        support=support,
    )


def read_log(folder: Path, log: str) -> list[TrackedPush]:
    """Pushes of a log in a copy of the repository of the source."""
    lines = iter((folder / FOLDER / LOGS[log]).read_text("utf-8").splitlines())
    return [_tracked_push(lines) for _ in range(int(next(lines)))]


def _tracked_push(lines: Iterator[str]) -> TrackedPush:
    def rows(count: int) -> Array:
        return np.array([next(lines).split() for _ in range(count)], dtype=np.float64)

    bodies = _level_poses(rows(2))
    samples = rows(int(next(lines)))
    tips = rows(int(next(lines)))
    time, finger = samples[:, 0], _level_poses(tips[:, 1:])
    tip = np.column_stack([np.interp(time, tips[:, 0], finger[:, k]) for k in (0, 1)])
    start, end = (body[:2] + rotate(_CORNER[None], body[2:])[0] for body in bodies)
    before, after = bodies[:, 2]
    force = -(samples[:, 1:] - samples[0, 1:]) @ _SENSOR
    return TrackedPush(
        pose=np.append(rotate((end - start)[None], -before)[0], _wrapped(after - before)),
        time=time - time[0],
        force=rotate(force, finger[0, 2] - before),
        tip=rotate(tip - start, -before),
    )


def _level_poses(rows: Array) -> Array:
    """x, y [m] and heading [rad] of poses x, y, z [mm], w, x, y, z, shape (n, 3)."""
    w, i, j, k = rows[:, 3:].T
    heading = np.arctan2(2.0 * (w * k + i * j), 1.0 - 2.0 * (j * j + k * k))
    return np.column_stack((rows[:, :2] / 1e3, heading))


def _wrapped(angle: Array) -> Array:
    """Angles within half a turn of 0 [rad]."""
    return np.asarray((angle + np.pi) % (2.0 * np.pi) - np.pi)


def read_planar_push(file: Path) -> TrackedPush:
    """The push of a file, its contact one radius ahead of the rod's axis along the force."""
    told = json.loads(file.read_text("utf-8"))
    tips, bodies, wrenches = (
        np.array(told[name]) for name in ("tip_pose", "object_pose", "ft_wrench")
    )
    time = wrenches[:, 0]
    force = -(wrenches[:, 1:3] - wrenches[0, 1:3])
    axis = np.column_stack([np.interp(time, tips[:, 0], tips[:, k]) for k in (1, 2)])
    strongest = force[np.argmax(np.hypot(*force.T))]
    contact = axis + TIP_RADIUS * strongest / np.hypot(*strongest)
    (x, y, before), end = bodies[0, 1:], bodies[-1, 1:]
    move = rotate((end[:2] - [x, y])[None], -before)[0]
    return TrackedPush(
        pose=np.append(move, _wrapped(end[2] - before)),
        time=time - time[0],
        force=rotate(force, -before),
        tip=rotate(contact - [x, y], -before),
    )


def held_motions(file: Path) -> Iterator[tuple[float, float, float]]:
    """Way of a plate [m], its slip [m] and its turn [rad] in the hand's frame, by action.

    What two fingers hold stays where it is in the hand's frame: told is how far it moved there,
    from when it has come a centimetre to the end of each action.
    """
    rows = np.loadtxt(file, delimiter=",", ndmin=2) / [1.0, 1e3, 1e3, 1.0, 1e3, 1e3, 1.0, 1.0]
    for action in np.unique(rows[:, 7]):
        of_action = rows[rows[:, 7] == action]
        plate, hand = of_action[:, 1:4], of_action[:, 4:7]
        gone = np.hypot(*(plate - plate[0])[:, :2].T)
        start = int(np.argmax(gone > _SETTLED))
        if gone[start] <= _SETTLED:
            continue
        seen = rotate(plate[:, :2] - hand[:, :2], -hand[:, 2])
        turn = np.unwrap(plate[:, 2] - hand[:, 2])
        slip = np.hypot(*(seen[-1] - seen[start]))
        yield float(gone[-1] - gone[start]), float(slip), float(abs(turn[-1] - turn[start]))


def write_touches(path: Path, pushes: Sequence[TrackedPush]) -> None:
    """Write a row for each push: its mean force, and the poses before and after."""
    header = ["moved", "x_m", "y_m", "z_m", "fx_n", "fy_n", "fz_n", "turn_deg", "dx_m", "dy_m"]
    rows: list[list[object]] = []
    for push in pushes:
        (x, y), (f_x, f_y) = push.mean_push
        dx, dy, turn = push.pose.tolist()
        rows.append(["slide", x, y, CONTACT_HEIGHT, f_x, f_y, 0.0, np.degrees(turn), dx, dy])
    _write_rows(path, header, rows)


def write_recordings(path: Path, pushes: Sequence[TrackedPush]) -> None:
    """Write a row for each sample; the last one of a push tells the pose then."""
    place, pose = ["x_m", "y_m", "z_m"], ["dx_m", "dy_m", "yaw_deg"]
    header = ["trial", "time_s", "fx_n", "fy_n", "fz_n", *place, "moved", *pose]
    rows: list[list[object]] = []
    for number, push in enumerate(pushes, 1):
        # The end of the approach shows where the force begins to rise.
        size = np.hypot(*push.force.T)
        first = max(int(np.argmax(size > 0.1 * size.max())) - _APPROACH, 0)
        dx, dy, turn = push.pose.tolist()
        for k in range(first, len(size)):
            (f_x, f_y), (x, y) = push.force[k], push.tip[k]
            end = [dx, dy, np.degrees(turn)] if k == len(size) - 1 else ["", "", ""]
            sample = [f_x, f_y, 0.0, x, y, CONTACT_HEIGHT]
            rows.append([number, push.time[k], *sample, "slide", *end])
    _write_rows(path, header, rows)


def _write_rows(path: Path, header: list[str], rows: Iterable[list[object]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        for row in rows:
            writer.writerow([f"{v:.6f}" if isinstance(v, float) else v for v in row])


def angle_errors(model: ObjectModel, pushes: Sequence[TrackedPush]) -> Array:
    """Angles between the twist under each mean push and the one that was seen, shape (n,) [°].

    Turns count as displacements of an `ARM`. That of what topples by the model is 90°.
    """
    p, force = (np.array(v) for v in zip(*(push.mean_push for push in pushes), strict=True))
    level = np.zeros((len(p), 1))
    u = np.column_stack((force / np.hypot(*force.T)[:, None], level))
    t = model.thresholds(np.column_stack((p, level + CONTACT_HEIGHT)), u, exact=True)
    units = [1.0, 1.0, ARM]
    seen = np.array([push.pose for push in pushes]) * units
    told = t.twist[:, [3, 4, 2]] * units
    told[t.outcome != "slide"] = np.nan
    cosine = (seen * told).sum(axis=1) / np.sqrt((seen**2).sum(axis=1) * (told**2).sum(axis=1))
    return np.asarray(np.degrees(np.arccos(np.clip(np.nan_to_num(cosine), -1.0, 1.0))))


def pose_errors(model: ObjectModel, pushes: Sequence[TrackedPush], *, exact: bool = True) -> Array:
    """Distances of predicted poses from those seen at the end, shape (n,) [m].

    A displacement's error and that of the turn times `ARM`, added, as in the source. The prediction
    knows the pose before and the straight way of the tip, a point.
    """
    ways = [_way_from_touch(model, push) for push in pushes]
    p, normal, d, travel = (np.array(v) for v in zip(*ways, strict=True))
    pose = model.stroke(p, normal, d, travel, exact=exact).pose
    change = pose - np.array([push.pose for push in pushes])
    return np.asarray(np.hypot(change[:, 0], change[:, 1]) + ARM * np.abs(_wrapped(change[:, 2])))


def finger_friction(model: ObjectModel, pushes: Sequence[TrackedPush]) -> float:
    """Coefficient at the finger, of `FINGER_FRICTIONS`, with which poses are met best."""
    tried = [
        pose_errors(model.model_copy(update={"finger_friction": float(mu)}), pushes).mean()
        for mu in FINGER_FRICTIONS
    ]
    return float(FINGER_FRICTIONS[int(np.argmin(tried))])


def _way_from_touch(model: ObjectModel, push: TrackedPush) -> tuple[Array, Array, Array, float]:
    """Contact (3,), normal (3,), direction (3,) and travel from where the tip meets the outline."""
    way = push.tip[-1] - push.tip[0]
    length = float(np.hypot(*way))
    d = way / length
    outline = Polygon.convex(model.outline)
    facing = outline.normals @ d
    with np.errstate(divide="ignore"):
        gone = (outline.offsets - outline.normals @ push.tip[0]) / facing
    # Of the sides that it enters by, the last one that it crosses.
    side = int(np.argmax(np.where(facing < 0.0, gone, -np.inf)))
    touch = push.tip[0] + gone[side] * d
    return (
        np.append(touch, CONTACT_HEIGHT),
        np.append(outline.normals[side], 0.0),
        np.append(d, 0.0),
        length - float(gone[side]),
    )
