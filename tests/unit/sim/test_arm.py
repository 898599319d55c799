"""Kinematics of arm and hand: against Drake's own, against finite differences, and their laws."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from importlib import resources

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from sim.arms.lwr.lwr_kinematics import LIMITS, LwrKinematics, shoulder_to_wrist
from sim.hands.four_finger import hand_kinematics as hand
from sim.hands.four_finger.pushing_postures import one_finger_postures, two_finger_postures
from sim.hands.hand_model import Posture
from sim.hands.mount import Mount
from sim.standard_robot import ARM, HAND
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


_FOLDERS = {"lwr_arm": "arms/lwr", "four_finger_hand": "hands/four_finger"}


def _urdf(name: str) -> ET.Element:
    text = (resources.files("sim") / _FOLDERS[name] / f"{name}.urdf").read_text("utf-8")
    return ET.fromstring(text)


def _random_arms(n: int) -> Array:
    return np.random.default_rng(7).uniform(-1.0, 1.0, (n, 7)) * LIMITS


def test_palm_pose_as_in_drake(model: Plant) -> None:
    mount = Mount.of(load_scene("kitchen").robot, ARM, HAND)
    context = model.plant.CreateDefaultContext()
    for q in _random_arms(20):
        for name, angle in zip(arm.joint_names, q, strict=True):
            model.plant.GetJointByName(name).set_angle(context, angle)
        X_WP = model.plant.GetFrameByName("palm").CalcPoseInWorld(context)
        R_WP, p_WP = mount.palm(q)
        np.testing.assert_allclose(R_WP, X_WP.rotation().matrix(), rtol=0, atol=ROUNDING)
        np.testing.assert_allclose(p_WP, X_WP.translation(), rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("finger", hand.FINGERS)
def test_fingertips_as_in_drake(model: Plant, finger: str) -> None:
    context = model.plant.CreateDefaultContext()
    angles = (0.1, 0.5, 0.7)
    for name, angle in zip(hand.FINGER_JOINTS, (*angles, angles[2]), strict=True):
        model.plant.GetJointByName(f"{finger}_{name}").set_angle(context, angle)
    palm = model.plant.GetFrameByName("palm")
    tip = model.plant.GetFrameByName(f"{finger}_tip")
    p_PT = model.plant.CalcPointsPositions(context, tip, [0.0, 0.0, hand.LINKS[2]], palm).ravel()
    # The thumb's lean stands in the file with a limited number of digits.
    np.testing.assert_allclose(hand.finger_points(finger, angles)[3], p_PT, rtol=0, atol=1e-7)


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


@pytest.mark.parametrize("finger", hand.FINGERS)
def test_jacobian_against_differences(finger: str) -> None:
    angles, nudge = np.array([0.1, 0.4, 0.8]), 1e-6
    tip = hand.finger_points(finger, (0.1, 0.4, 0.8))[3]
    J = hand.finger_jacobian(finger, (0.1, 0.4, 0.8), tip)
    for joint in range(3):  # the middle joint also moves the distal one
        moved = angles.copy()
        moved[joint] += nudge
        a, b, c = moved.tolist()
        rate = (hand.finger_points(finger, (a, b, c))[3] - tip) / nudge
        # Forward differences err by the nudge times a curvature of order 0.1 m.
        np.testing.assert_allclose(J[:, joint], rate, atol=1e-6)


def test_stiffness_gives_back_the_force_of_a_spring() -> None:
    angles, force = (0.05, 0.4, 0.8), np.array([0.02, -0.01, 0.015])
    tip = hand.finger_points("index", angles)[3]
    nudge = 1e-6
    # Move by the joint deflections that the force causes: δ = J k⁻¹ Jᵀ f.
    J = np.column_stack(
        [
            (hand.finger_points("index", tuple(np.array(angles) + nudge * unit))[3] - tip) / nudge
            for unit in np.eye(3)
        ]
    )
    moved = J @ (J.T @ force) / hand.JOINT_STIFFNESS
    stiffness = hand.tip_stiffness("index", angles, tip)
    np.testing.assert_allclose(stiffness @ moved, force, rtol=1e-4)  # differences as above
    np.testing.assert_allclose(stiffness, stiffness.T, rtol=1e-9)


def test_limits_are_those_of_the_file() -> None:
    joints = {j.attrib["name"]: j for j in _urdf("lwr_arm").iter("joint") if j.get("type")}
    for name, limit in zip(arm.joint_names, LIMITS, strict=True):
        found = joints[name].find("limit")
        assert found is not None
        # The file has six digits.
        assert float(found.attrib["upper"]) == pytest.approx(limit, abs=1e-5)
        assert float(found.attrib["lower"]) == pytest.approx(-limit, abs=1e-5)


def test_stops_of_the_fingers_are_those_of_the_file() -> None:
    joints = {j.attrib["name"]: j for j in _urdf("four_finger_hand").iter("joint") if j.get("type")}
    for name, stops in zip(HAND.joint_names, np.tile(hand.FINGER_LIMITS, (4, 1)), strict=True):
        found = joints[name].find("limit")
        assert found is not None
        # The file has six digits.
        file = float(found.attrib["lower"]), float(found.attrib["upper"])
        assert file == pytest.approx(tuple(stops), abs=1e-5)
    assert hand.is_at_stop((0.0, -0.697, 0.5))
    assert not hand.is_at_stop((0.0, -0.65, 0.5))


@pytest.mark.parametrize(("room", "is_there"), [(0.004, True), (0.006, False)])
def test_a_joint_is_at_its_stop_within_5_milliradians(room: float, is_there: bool) -> None:
    low, high = hand.FINGER_LIMITS.T
    middle = 0.5 * (low + high)
    for joint in range(3):
        for stop, inward in ((low, 1.0), (high, -1.0)):
            angles = middle.copy()
            angles[joint] = stop[joint] + inward * room
            assert hand.is_at_stop((angles[0], angles[1], angles[2])) == is_there


def test_finger_stiffness_is_that_of_the_file() -> None:
    tag = "{http://drake.mit.edu}controller_gains"
    gains = {float(g.attrib["p"]) for g in _urdf("four_finger_hand").iter(tag)}
    assert gains == {hand.JOINT_STIFFNESS}


@pytest.mark.parametrize("posture", [*one_finger_postures(), *two_finger_postures(0.04)])
def test_postures_within_the_limits_of_the_file(posture: Posture) -> None:
    limits = {
        j.attrib["name"]: limit
        for j in _urdf("four_finger_hand").iter("joint")
        if (limit := j.find("limit")) is not None
    }
    for name, angle in zip(HAND.joint_names, posture.joints, strict=True):
        assert float(limits[name].attrib["lower"]) <= angle <= float(limits[name].attrib["upper"])


def test_two_fingers_are_as_far_apart_as_asked() -> None:
    for posture in two_finger_postures(0.04):
        # The abduction is solved for the straight finger's length, which is exact.
        assert np.linalg.norm(posture.tips[0] - posture.tips[1]) == pytest.approx(0.04, abs=1e-9)


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
    efforts = {
        joint.attrib["name"]: float(limit.attrib["effort"])
        for name in ("lwr_arm", "four_finger_hand")
        for joint in _urdf(name).iter("joint")
        if (limit := joint.find("limit")) is not None
    }
    assert [efforts[name] for name in arm.joint_names] == arm.efforts.tolist()
    assert {efforts[name] for name in HAND.joint_names} == {hand.EFFORT}


@given(
    finger=st.sampled_from(hand.FINGERS[:3]),
    share=st.tuples(*[st.floats(0.1, 0.9)] * 3),
    push=st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1),
)
def test_a_finger_bears_its_strength_and_no_more(
    finger: str, share: tuple[float, float, float], push: tuple[float, float, float]
) -> None:
    low, high = hand.FINGER_LIMITS.T
    angles = tuple((low + np.array(share) * (high - low)).tolist())
    load = np.array(push)
    p_PC = hand.finger_points(finger, angles)[3] + hand.TIP_RADIUS * load / np.linalg.norm(load)
    most = float(hand.max_tip_force(finger, angles, p_PC, load))
    torque = most * hand.finger_jacobian(finger, angles, p_PC).T @ load
    given_way = np.array(angles) - torque / hand.JOINT_STIFFNESS
    room = np.minimum(given_way - low, high - given_way) - hand.STOP_ROOM
    spare = hand.EFFORT_SHARE * hand.EFFORT - np.abs(torque)
    assert min(room.min(), spare.min()) == pytest.approx(0.0, abs=1e-9)  # rounding


def test_the_wrist_stays_within_the_arms_stretch() -> None:
    q = _random_arms(200)
    _, _, joints = arm.joint_origins(q)
    distance = np.linalg.norm(joints[:, 5] - joints[:, 1], axis=1)
    expected = [shoulder_to_wrist(angle) for angle in q[:, 3]]
    np.testing.assert_allclose(distance, expected, rtol=0, atol=ROUNDING)
