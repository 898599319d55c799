"""Public logs of pushes: a made-up log in their form is read, converted, fitted and judged."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.pushing_logs.logs import (
    FOLDER,
    LOGS,
    TIP_RADIUS,
    TrackedPush,
    angle_errors,
    held_motions,
    pose_errors,
    read_log,
    read_planar_push,
    triangle_model,
    write_recordings,
    write_touches,
)
from nlcontrol.learning.log_fitting import fit_files
from objectmodels.exact.top_drag import LoadedPoints
from objectmodels.geometry.base_shapes import Array

LOG = "plywood 3pts3"
TRAVEL, APPROACH = 0.013, 0.003


TRUTH = triangle_model(LOG).model_copy(update={"friction": 0.30, "finger_friction": 2.0})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of a repository with one log: fourteen pushes on one side, by a finger that sticks."""
    root = tmp_path_factory.mktemp("logs")
    file = root / FOLDER / LOGS[LOG]
    file.parent.mkdir(parents=True)
    lean = 0.02 * (np.arange(14) - 7)
    d = np.column_stack((np.sin(lean), np.cos(lean), np.zeros(14)))
    point = np.column_stack((-0.03 + 0.008 * np.arange(14), np.full(14, -0.05), np.full(14, 0.01)))
    end = TRUTH.stroke(point, [[0.0, -1.0, 0.0]] * 14, d, TRAVEL, exact=True).pose
    law = LoadedPoints.of_model(TRUTH, point[:, 2])
    force = TRUTH.friction * TRUTH.weight * law.slide_with(point[:, :2], d[:, :2]).force
    pushes = [_push_text(0.4 + 0.1 * k, point[k], d[k, :2], end[k], force[k]) for k in range(14)]
    file.write_text("\n".join(["14", *pushes]) + "\n", encoding="utf-8")
    return root


def _push_text(heading: float, point: Array, d: Array, end: Array, force: Array) -> str:
    """A push in the form of a log; the force keeps its place in the object."""
    x1, y1, turn = end
    base = np.array([0.6, 0.1])
    R = np.array([[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]])

    def body(centre: Array, angle: float) -> str:
        # The tracked frame lies in the corner, (−50, −50) mm from the centroid.
        c, s = np.cos(heading + angle), np.sin(heading + angle)
        corner = base + R @ centre - 0.05 * np.array([c - s, s + c])
        half = (heading + angle) / 2.0
        return f"{1e3 * corner[0]} {1e3 * corner[1]} 17 {np.cos(half)} 0 0 {np.sin(half)}"

    time = np.arange(0.0, 6.4, 0.02)
    gone = -APPROACH + 0.0025 * time
    tips = base + (R @ (point[:2, None] + d[:, None] * gone)).T
    size = np.clip(gone / 0.0003, 0.0, 1.0)
    angle = turn * np.clip(gone / TRAVEL, 0.0, 1.0)
    on_object = np.column_stack(
        (
            np.cos(heading + angle) * force[0] - np.sin(heading + angle) * force[1],
            np.sin(heading + angle) * force[0] + np.cos(heading + angle) * force[1],
        )
    )
    sensor = -(size[:, None] * on_object) @ np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2.0)
    samples = [f"{t} {a - 0.03} {b + 0.02}" for t, (a, b) in zip(time, sensor, strict=True)]
    poses = [f"{t} {1e3 * x} {1e3 * y} 27 1 0 0 0" for t, (x, y) in zip(time, tips, strict=True)]
    ends = [body(np.zeros(2), 0.0), body(np.array([x1, y1]), turn)]
    return "\n".join([*ends, str(len(samples)), *samples, str(len(poses)), *poses])


@pytest.fixture(scope="module")
def pushes(folder: Path) -> list[TrackedPush]:
    return read_log(folder, LOG)


def test_a_log_is_read_into_the_body(pushes: list[TrackedPush]) -> None:
    assert len(pushes) == 14
    # What was made by the model is met by it: times are 20 ms apart, 50 µm of the way.
    assert pose_errors(TRUTH, pushes).max() < 1e-4
    # The force was that at the onset, the motion that of all of the way.
    assert angle_errors(TRUTH, pushes).mean() < 3.0
    assert pose_errors(TRUTH, pushes, exact=False).mean() > 5e-4


@pytest.mark.parametrize("write", [write_touches, write_recordings])
def test_both_forms_are_fitted(tmp_path: Path, pushes: list[TrackedPush], write: object) -> None:
    file = tmp_path / "pushes.csv"
    write(file, pushes)  # type: ignore[operator]
    known = triangle_model(LOG)
    _, report = fit_files(known, [file], ("friction", "friction_radius"))
    # The mean force of a row is read off as the source does; the pushes turn by up to 15°.
    assert report.parameters["friction"].value == pytest.approx(TRUTH.friction, rel=0.05)
    assert sum(report.trials.values()) == 14


def test_a_push_of_a_planar_file_is_read_into_the_body(tmp_path: Path) -> None:
    """The body looks along y of the robot; the rod comes along y and takes it 20 mm ahead."""
    file, t = tmp_path / "push.json", np.linspace(0.0, 4.0, 80)
    y, gone = 0.01 * t - 0.075, np.maximum(0.01 * t - 0.02, 0.0)
    told = {
        "tip_pose": np.column_stack((t, 0.3 + 0.0 * t, y, 0.0 * t)).tolist(),
        "object_pose": np.column_stack((t, 0.3 + 0.0 * t, gone, 0.0 * t + np.pi / 2)).tolist(),
        "ft_wrench": np.column_stack((t, 0.1 + 0.0 * t, -3.0 * (t > 2.0), 0.0 * t)).tolist(),
    }
    file.write_text(json.dumps(told), encoding="utf-8")
    push = read_planar_push(file)
    np.testing.assert_allclose(push.pose, [0.02, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(push.force[-1], [3.0, 0.0], atol=1e-9)
    # The rod's axis is 75 mm behind at first, the contact one radius nearer.
    np.testing.assert_allclose(push.tip[0], [-0.075 + TIP_RADIUS, 0.0], atol=1e-9)


def test_a_plate_that_two_fingers_hold_stays_in_the_hand(tmp_path: Path) -> None:
    file, t = tmp_path / "log.txt", np.linspace(0.0, 1.0, 50)
    angle = 0.5 * t
    hand = np.column_stack((200.0 * np.sin(angle), 200.0 * np.cos(angle), -angle))
    slip = 3.0 * t
    off = 30.0 * np.column_stack((np.cos(-angle), np.sin(-angle)))
    off += slip[:, None] * np.column_stack((np.sin(angle), np.cos(angle)))
    rows = np.column_stack((t, hand[:, :2] + off, hand[:, 2], hand, np.ones(50)))
    np.savetxt(file, rows, delimiter=",")
    ((way, moved, turn),) = held_motions(file)
    assert way > 0.08
    # It slipped by 3 mm in all, of which the last nine tenths are counted.
    assert 0.0025 < moved < 0.003
    assert turn < 1e-6
