"""Kinematics of the arm: against Drake's own, against finite differences, and their laws."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from sim.robots.hand import Mount
from sim.robots.lwr_arm import LIMITS, LwrKinematics, shoulder_to_wrist
from sim.robots.robots import ARM, HAND
from sim.truth.scene_file import load_scene
from sim.worlds.drake.drake_plant import Plant, add_plant

# Both sides compute a few dozen products of numbers of order one.
ROUNDING = 1e-12

arm = LwrKinematics()

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def model() -> Plant:
    from pydrake.systems.framework import DiagramBuilder

    return add_plant(DiagramBuilder(), load_scene("kitchen"))


def _limits() -> dict[str, ET.Element]:
    """Limits of the joints in the file, by their names."""
    root = ET.fromstring(arm.model_file.read_text("utf-8"))
    return {
        joint.attrib["name"]: limit
        for joint in root.iter("joint")
        if (limit := joint.find("limit")) is not None
    }


def _random_arms(n: int) -> Array:
    return np.random.default_rng(7).uniform(-1.0, 1.0, (n, 7)) * LIMITS


def test_palm_pose_as_in_drake(model: Plant) -> None:
    mount = Mount.from_cell(load_scene("kitchen").robot, ARM, HAND)
    context = model.plant.CreateDefaultContext()
    for q in _random_arms(20):
        for name, angle in zip(arm.joint_names, q, strict=True):
            model.plant.GetJointByName(name).set_angle(context, angle)
        X_WP = model.plant.GetFrameByName("palm").CalcPoseInWorld(context)
        R_WP, p_WP = mount.palm_poses(q)
        np.testing.assert_allclose(R_WP, X_WP.rotation().matrix(), rtol=0, atol=ROUNDING)
        np.testing.assert_allclose(p_WP, X_WP.translation(), rtol=0, atol=ROUNDING)


@given(
    q=st.lists(st.floats(-0.95, 0.95), min_size=7, max_size=7),
    elbow=st.floats(-3.1, 3.1),
)
def test_inverse_leads_where_forward_was(q: list[float], elbow: float) -> None:
    R, p = arm.forward(np.array(q) * LIMITS)
    solutions, valid = arm.inverse(R[None], p[None], np.array([elbow]))
    for found in solutions[0][valid[0]]:
        R_again, p_again = arm.forward(found)
        # arccos of a direction cosine near ±1 halves the digits.
        np.testing.assert_allclose(p_again, p, atol=1e-7)
        np.testing.assert_allclose(R_again, R, atol=1e-6)
        assert (np.abs(found) <= LIMITS).all()


def test_each_pose_may_ask_for_its_own_branch() -> None:
    R, p = arm.forward(0.8 * _random_arms(24))
    elbows, branch = np.linspace(-3.0, 3.0, 24), np.arange(24) % arm.branches
    every, valid = arm.inverse(R, p, elbows)
    some, usable = arm.inverse(R, p, elbows, branch[:, None])
    np.testing.assert_array_equal(some[:, 0], every[np.arange(24), branch])
    np.testing.assert_array_equal(usable[:, 0], valid[np.arange(24), branch])


def test_spheres_go_from_the_shoulder_by_the_elbow_to_the_wrist() -> None:
    q = _random_arms(20)
    origins, spheres = arm.joint_origins(q), arm.spheres(q)
    # Of lengths below a metre nothing but rounding is off.
    np.testing.assert_allclose(spheres[:, 3, :3], origins[:, 3], atol=1e-12)
    np.testing.assert_allclose(spheres[:, -1, :3], origins[:, 5], atol=1e-12)
    middle = 0.5 * (spheres[:, 3, :3] + spheres[:, -1, :3])
    np.testing.assert_allclose(spheres[:, 6:8, :3].mean(axis=1), middle, atol=1e-12)


def test_one_of_the_inverses_is_the_arm_itself() -> None:
    found = 0
    elbows = np.linspace(-np.pi, np.pi, 721)
    for q in 0.8 * _random_arms(10):
        if abs(q[5]) < 0.1:
            continue
        R, p = arm.forward(q)
        n = len(elbows)
        solutions, valid = arm.inverse(np.repeat(R[None], n, 0), np.repeat(p[None], n, 0), elbows)
        nearest = np.abs(solutions - q).max(axis=-1)[valid].min()
        # Elbow angles are half a degree apart, and joints near a stretched arm turn faster.
        assert nearest < 0.05
        found += 1
    assert found >= 8


def test_pose_out_of_reach_has_no_solution() -> None:
    _, valid = arm.inverse(np.eye(3)[None], np.array([[0.0, 0.0, 2.0]]), np.zeros(1))
    assert not valid.any()


def test_limits_are_those_of_the_file() -> None:
    limits = _limits()
    for name, limit in zip(arm.joint_names, LIMITS, strict=True):
        found = limits[name]
        # The file has six digits.
        assert float(found.attrib["upper"]) == pytest.approx(limit, abs=1e-5)
        assert float(found.attrib["lower"]) == pytest.approx(-limit, abs=1e-5)


@given(seed=st.integers(0, 10**6))
def test_holding_a_force_is_the_work_it_does(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q, f_A = rng.uniform(-1.0, 1.0, 7) * LIMITS, rng.normal(size=3)
    R_AF, p_AF = arm.forward(q)
    p_FC = rng.uniform(-0.2, 0.2, 3)
    torques = arm.torques(q, p_AF + R_AF @ p_FC, f_A)
    step = 1e-6
    for joint in range(7):
        places = []
        for sign in (-1.0, 1.0):
            R, p = arm.forward(q + sign * step * np.eye(7)[joint])
            places.append(p + R @ p_FC)
        work = f_A @ (places[1] - places[0]) / (2.0 * step)
        # Central differences of lengths of a metre, 1e-6 apart: rounding is 1e-10.
        assert torques[joint] == pytest.approx(work, abs=1e-8)


def test_largest_torques_are_those_of_the_urdf() -> None:
    limits = _limits()
    efforts = [float(limits[name].attrib["effort"]) for name in arm.joint_names]
    assert efforts == arm.efforts.tolist()


def test_the_wrist_stays_within_the_arms_stretch() -> None:
    q = _random_arms(200)
    joints = arm.joint_origins(q)
    distance = np.linalg.norm(joints[:, 5] - joints[:, 1], axis=1)
    expected = [shoulder_to_wrist(angle) for angle in q[:, 3]]
    np.testing.assert_allclose(distance, expected, rtol=0, atol=ROUNDING)
