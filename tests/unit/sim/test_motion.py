"""Free motion, vision port and steering, each on its own."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.attractor import attracted
from sim.rotations import rot_z
from sim.scene import Vision, load_scene
from sim.steering import LineKeeper, PushedBox
from sim.vision import SeenPose, VisionPort, first_look

PERIOD = 0.01
numbers = st.floats(-2.0, 2.0)


@given(
    start=st.lists(numbers, min_size=3, max_size=3),
    target=st.lists(numbers, min_size=3, max_size=3),
    speed=st.floats(0.05, 2.0),
    acceleration=st.floats(0.2, 5.0),
)
def test_attractor_keeps_its_bounds_and_arrives(
    start: list[float], target: list[float], speed: float, acceleration: float
) -> None:
    a, b = np.array(start), np.array(target)
    points = np.array([a, *attracted(a, b, speed=speed, acceleration=acceleration, period=PERIOD)])
    np.testing.assert_array_equal(points[-1], b if len(points) > 1 else points[-1])
    assert np.linalg.norm(points[-1] - b) < 1e-6
    velocity = np.diff(points, axis=0) / PERIOD
    assert (np.linalg.norm(velocity, axis=1) <= speed * (1 + 1e-9)).all()
    # The last step snaps to the target, which is less than one period of braking off.
    change = np.linalg.norm(np.diff(velocity, axis=0), axis=1)
    assert (change <= acceleration * PERIOD * 2.5).all()
    # On the straight line: what was checked for collisions.
    line = (b - a) / max(float(np.linalg.norm(b - a)), 1e-12)
    off = points - a - ((points - a) @ line)[:, None] * line
    assert np.abs(off).max() < 1e-9


def _still() -> dict[str, tuple[np.ndarray, np.ndarray]]:
    return {"box": (rot_z(0.3), np.array([0.5, 0.1, 0.0]))}


def test_frames_come_late_and_at_their_rate() -> None:
    vision = Vision(rate_hz=20.0, delay_s=0.05)
    port = VisionPort(vision, ["box"], seed=0)
    arrivals = []
    for tick in range(101):
        port.observe(tick * PERIOD, _still())
        arrivals += [(tick * PERIOD, frame.time) for frame in port.arrived(tick * PERIOD)]
    assert len(arrivals) == 20
    for now, taken in arrivals:
        assert now - taken == pytest.approx(vision.delay_s, abs=1e-9)


def test_noise_of_the_frames() -> None:
    vision = Vision(position_noise_m=0.002, angle_noise_deg=1.0, rate_hz=100.0, delay_s=0.0)
    port = VisionPort(vision, ["box"], seed=3)
    seen = []
    for tick in range(2000):
        port.observe(tick * PERIOD, _still())
        seen += [frame.poses["box"] for frame in port.arrived(tick * PERIOD)]
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
        pose = first_look(scene, 0.1, seed=0)[item.name]
        assert (pose.x, pose.y) == pytest.approx((item.pose.x_m, item.pose.y_m), abs=1e-12)
        assert pose.yaw == pytest.approx(np.radians(item.pose.yaw_deg), abs=1e-12)


def test_a_very_late_camera_is_waited_for() -> None:
    scene = load_scene("kitchen").model_copy(update={"vision": Vision(delay_s=3.0)})
    assert set(first_look(scene, 0.5, seed=0)) == set(scene.names)


@pytest.mark.parametrize("true_radius", [0.0344, 0.05, 0.0636])
@pytest.mark.parametrize("seed", range(3))
def test_steering_holds_the_line_of_its_own_model(true_radius: float, seed: int) -> None:
    """The box of the model, its friction radius up to 1.85 times the believed one, is held."""
    rng = np.random.default_rng(seed)
    ahead, stroke, step = 0.055, 0.20, 0.0005
    truth = PushedBox(ahead, true_radius)
    theta, contact = np.radians(rng.normal(0.0, 1.5)), rng.normal(0.0, 0.001)
    middle = np.array([0.5, 0.0])
    tip = middle - _turn(theta) @ np.array([ahead, -contact])
    keeper = LineKeeper(
        PushedBox(ahead, 0.0344),
        0.0,
        tip,
        (middle[0], middle[1], theta + rng.normal(0.0, np.radians(0.2))),
        deviations=(0.006, 0.001),
        camera=(0.002, np.radians(1.0)),
    )
    first = theta
    for i in range(int(stroke / step)):
        slope = keeper.slope(stroke - i * step)
        theta += step * (truth.alpha * (theta - slope) - truth.beta * contact)
        tip = tip + step * np.array([1.0, slope])
        middle = tip + _turn(theta) @ np.array([ahead, -contact])
        time = (i + 1) * 0.01
        keeper.moved(time, tip)
        if i % 3 == 0:
            noise = rng.normal(0.0, 0.002, 3)
            R = np.eye(3)
            R[:2, :2] = _turn(theta + rng.normal(0.0, np.radians(1.0)))
            keeper.seen(time, SeenPose(R, np.array([*middle, 0.0]) + noise))
    # The project's own bound for straight pushes, and half the tolerance of distances.
    assert abs(np.degrees(theta - first)) < 3.0
    assert abs(middle[1]) < 0.008


def _turn(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])
