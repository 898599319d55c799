"""Tests of the simulated camera."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels.geometry.rotations import rot_z
from sim.control.object_estimate import mean_poses
from sim.robots.cell_description import Vision
from sim.truth.scene_file import load_scene
from sim.worlds.camera import CameraPort, initial_frames

PERIOD = 0.01


def _still() -> dict[str, tuple[np.ndarray, np.ndarray]]:
    return {"box": (rot_z(0.3), np.array([0.5, 0.1, 0.0]))}


def test_frames_come_late_and_at_their_rate() -> None:
    vision = Vision(rate_hz=20.0, delay_s=0.05)
    port = CameraPort(vision, ["box"], seed=0)
    arrivals = []
    for tick in range(101):
        port.observe(tick * PERIOD, _still())
        arrivals += [
            (tick * PERIOD, frame.time) for frame in port.take_arrived_frames(tick * PERIOD)
        ]
    assert len(arrivals) == 20
    for now, taken in arrivals:
        assert now - taken == pytest.approx(vision.delay_s, abs=1e-9)


def test_noise_of_the_frames() -> None:
    vision = Vision(position_noise_m=0.002, angle_noise_deg=1.0, rate_hz=100.0, delay_s=0.0)
    port = CameraPort(vision, ["box"], seed=3)
    seen = []
    for tick in range(2000):
        port.observe(tick * PERIOD, _still())
        seen += [frame.poses["box"] for frame in port.take_arrived_frames(tick * PERIOD)]
    positions = np.array([pose.p_WB for pose in seen])
    yaws = np.array([np.arctan2(pose.R_WB[1, 0], pose.R_WB[0, 0]) for pose in seen])
    # Of 2000 samples the standard deviation is known to 1.6 %; 6 % is four times that.
    np.testing.assert_allclose(positions.std(axis=0), 0.002, rtol=0.06)
    assert yaws.std() == pytest.approx(np.radians(1.0), rel=0.06)
    np.testing.assert_allclose(positions.mean(axis=0), [0.5, 0.1, 0.0], atol=2e-4)


def test_a_camera_without_noise_or_delay_shows_the_truth() -> None:
    scene = load_scene("kitchen").model_copy(
        update={"vision": Vision(position_noise_m=0.0, angle_noise_deg=0.0, delay_s=0.0)}
    )
    for item in scene.objects:
        pose = mean_poses(initial_frames(scene, 0.1, seed=0))[item.name]
        assert (pose.x, pose.y) == pytest.approx((item.pose.x_m, item.pose.y_m), abs=1e-12)
        assert pose.yaw == pytest.approx(np.radians(item.pose.yaw_deg), abs=1e-12)


def test_a_very_late_camera_is_waited_for() -> None:
    scene = load_scene("kitchen").model_copy(update={"vision": Vision(delay_s=3.0)})
    assert set(mean_poses(initial_frames(scene, 0.5, seed=0))) == set(scene.names)
