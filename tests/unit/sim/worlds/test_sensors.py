"""The joints' sensors: what they add to the truth, and that a seed says all of it."""

from __future__ import annotations

import numpy as np
import pytest

from sim.control.object_estimate import mean_pose
from sim.robots.cell_description import JointSensor, TorqueSensor, Vision
from sim.worlds.camera import CameraPort
from sim.worlds.sensors import JointReadings, TorqueReadings

PERIOD = 0.01
FINGERS = ("first", "second", "third", "fourth")
TRUE = np.array([0.30, -0.10, 0.05])
IDEAL = TorqueSensor(noise_nm=0.0, resolution_nm=0.0, bias_nm=0.0)


def _readings(
    sensor: TorqueSensor, *, times: int = 1, seed: int = 0, gain_error: float = 0.0
) -> np.ndarray:
    readings = TorqueReadings(
        sensor, dict.fromkeys(FINGERS, 3), PERIOD, seed, gain_error=gain_error
    )
    return np.array([[readings.read(finger, TRUE) for finger in FINGERS] for _ in range(times)])


def test_an_ideal_torque_sensor_shows_the_truth() -> None:
    # A mean of ten equal numbers is rounded in its last digit.
    np.testing.assert_allclose(_readings(IDEAL)[0], np.tile(TRUE, (4, 1)), rtol=1e-15)


def test_gain_scales_every_joint_alike() -> None:
    high = _readings(IDEAL, gain_error=0.05)
    np.testing.assert_allclose(high[0], np.tile(1.05 * TRUE, (4, 1)), rtol=1e-14)


def test_each_sample_is_rounded_and_their_mean_is_read() -> None:
    coarse = IDEAL.model_copy(update={"resolution_nm": 0.04})
    # Without noise all samples of a step fall on the same mark.
    np.testing.assert_allclose(_readings(coarse)[0, 0], [0.32, -0.08, 0.04], atol=1e-15)
    noisy = coarse.model_copy(update={"noise_nm": 0.02})
    read = _readings(noisy, times=500)
    # Ten samples on marks 40 mN·m apart: means are whole multiples of a tenth of that.
    np.testing.assert_allclose(read / 0.004, np.round(read / 0.004), atol=1e-9)
    # Noise of half a step smooths the steps away: 2000 means of ten samples of (20² + 40²/12)^½
    # mN·m are known to 0.16 mN·m; four of those.
    np.testing.assert_allclose(read.mean(axis=(0, 1)), TRUE, atol=7e-4)


def test_noise_falls_with_the_root_of_the_samples() -> None:
    read = _readings(IDEAL.model_copy(update={"noise_nm": 0.005}), times=1000)
    # Ten samples of a kilohertz in a control step; 4000 readings know it to 1.1 %.
    np.testing.assert_allclose(read.std(axis=(0, 1)), 0.005 / np.sqrt(10.0), rtol=0.05)


def test_bias_is_constant_in_a_world_and_of_its_own_in_each_joint() -> None:
    biased = IDEAL.model_copy(update={"bias_nm": 0.02})
    read = _readings(biased, times=3)
    np.testing.assert_array_equal(read, np.tile(read[0], (3, 1, 1)))
    drawn = np.array([_readings(biased, seed=seed)[0] - TRUE for seed in range(200)])
    assert len(np.unique(drawn)) == drawn.size
    # Of 2400 draws the deviation is known to 1.4 %; four of those.
    assert drawn.std() == pytest.approx(0.02, rel=0.06)


def test_bias_leaves_the_noise_as_it_is() -> None:
    noisy = IDEAL.model_copy(update={"noise_nm": 0.005})
    both = _readings(noisy.model_copy(update={"bias_nm": 0.02}), times=20)
    difference = both - _readings(noisy, times=20)
    np.testing.assert_allclose(difference, np.tile(difference[0], (20, 1, 1)), atol=1e-15)


def test_joint_angles_are_rounded_arm_and_fingers_each_in_their_way() -> None:
    sensor = JointSensor(
        arm_noise_rad=0.0,
        arm_resolution_rad=0.01,
        finger_noise_rad=0.0,
        finger_resolution_rad=0.1,
    )
    read = JointReadings(sensor, 2, 4, 0).read(np.array([0.123, -0.456, 0.123, -0.456]))
    np.testing.assert_allclose(read, [0.12, -0.46, 0.1, -0.5], atol=1e-15)


def test_joint_noise_and_offsets() -> None:
    sensor = JointSensor(
        arm_noise_rad=1e-3, arm_resolution_rad=0.0, arm_offset_rad=2e-3, finger_offset_rad=5e-3
    )
    offsets = []
    for seed in range(100):
        readings = JointReadings(sensor, 7, 23, seed)
        read = np.array([readings.read(np.zeros(23)) for _ in range(50)])
        # 350 numbers: known to 3.8 %; four of those.
        assert (read - read.mean(axis=0))[:, :7].std() == pytest.approx(1e-3, rel=0.15)
        offsets.append(read.mean(axis=0))
    arm, fingers = np.array(offsets)[:, :7], np.array(offsets)[:, 7:]
    # 700 and 1600 numbers, and the means' own noise of 1.4e-4: known to 2.7 % and 1.8 %.
    assert arm.std() == pytest.approx(2e-3, rel=0.11)
    assert fingers.std() == pytest.approx(5e-3, rel=0.08)


def test_what_the_camera_is_wrong_about_it_stays_wrong_about() -> None:
    vision = Vision(
        position_noise_m=0.0,
        angle_noise_deg=0.0,
        position_bias_m=0.004,
        angle_bias_deg=2.0,
        rate_hz=100.0,
        delay_s=0.0,
    )
    poses = {name: (np.eye(3), np.zeros(3)) for name in ("box", "can")}
    wrong = []
    for seed in range(200):
        port = CameraPort(vision, poses, seed=seed)
        for tick in range(3):
            port.observe(tick * PERIOD, poses)
        frames = port.take_arrived_frames(1.0)
        for name in poses:
            seen = [frame.poses[name] for frame in frames]
            np.testing.assert_array_equal(seen[0].p_WB, seen[-1].p_WB)
            assert seen[0].tilt == 0.0
            pose = mean_pose(seen)
            wrong.append((pose.x, pose.y, pose.yaw))
    x, y, yaw = np.array(wrong).T
    # Of 400 numbers the deviation is known to 3.5 %; four of those.
    assert x.std() == pytest.approx(0.004, rel=0.14)
    assert y.std() == pytest.approx(0.004, rel=0.14)
    assert np.degrees(yaw).std() == pytest.approx(2.0, rel=0.14)
