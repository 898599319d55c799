"""Kinematics of the hand: against Drake's own, against finite differences, and their laws."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.robots import finger_kinematics as hand
from sim.robots.four_finger_hand import one_finger_postures, two_finger_postures
from sim.robots.hand import Posture
from sim.robots.robots import HAND
from sim.truth.scene_file import load_scene
from sim.worlds.drake.drake_plant import Plant, add_plant


@pytest.fixture(scope="module")
def model() -> Plant:
    from pydrake.systems.framework import DiagramBuilder

    return add_plant(DiagramBuilder(), load_scene("kitchen"))


def _limits() -> dict[str, ET.Element]:
    """Limits of the joints in the file, by their names."""
    root = ET.fromstring(HAND.model_file.read_text("utf-8"))
    return {
        joint.attrib["name"]: limit
        for joint in root.iter("joint")
        if (limit := joint.find("limit")) is not None
    }


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


def test_stops_of_the_fingers_are_those_of_the_file() -> None:
    limits = _limits()
    for name, stops in zip(HAND.joint_names, np.tile(hand.FINGER_LIMITS, (4, 1)), strict=True):
        found = limits[name]
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
    root = ET.fromstring(HAND.model_file.read_text("utf-8"))
    gains = {float(g.attrib["p"]) for g in root.iter(tag)}
    assert gains == {hand.JOINT_STIFFNESS}


@pytest.mark.parametrize("posture", [*one_finger_postures(), *two_finger_postures(0.04)])
def test_postures_within_the_limits_of_the_file(posture: Posture) -> None:
    limits = _limits()
    for name, angle in zip(HAND.joint_names, posture.joint_angles, strict=True):
        assert float(limits[name].attrib["lower"]) <= angle <= float(limits[name].attrib["upper"])


def test_two_fingers_are_as_far_apart_as_asked() -> None:
    for posture in two_finger_postures(0.04):
        # The abduction is solved for the straight finger's length, which is exact.
        assert np.linalg.norm(posture.tips[0] - posture.tips[1]) == pytest.approx(0.04, abs=1e-9)


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
    # A joint keeps 20 mrad to its stops and a fifth of its 2 N·m; one of them is used up.
    room = np.minimum(given_way - low, high - given_way) - 0.02
    spare = 1.6 - np.abs(torque)
    assert min(room.min(), spare.min()) == pytest.approx(0.0, abs=1e-9)  # rounding


def test_largest_torques_are_those_of_the_file() -> None:
    limits = _limits()
    assert {float(limits[name].attrib["effort"]) for name in HAND.joint_names} == {hand.EFFORT}


def test_spheres_cover_the_palm_of_the_file_and_little_more() -> None:
    root = ET.fromstring(HAND.model_file.read_text("utf-8"))
    found = root.find(".//collision[@name='palm_collision']")
    assert found is not None
    size, middle = (
        np.array([float(x) for x in element.attrib[name].split()])
        for name, element in (("size", found.find("geometry/box")), ("xyz", found.find("origin")))
        if element is not None
    )
    half = 0.5 * size
    grid = np.stack(np.meshgrid(*[np.linspace(-1.0, 1.0, 25)] * 3, indexing="ij"), axis=-1)
    points = middle + half * grid.reshape(-1, 3)
    spheres = HAND.spheres(HAND.resting)
    spheres = spheres[(np.abs(spheres[:, :3] - middle) < half).all(axis=1)]
    apart = np.linalg.norm(points[:, None] - spheres[:, :3], axis=2) - spheres[:, 3]
    # Between four spheres the box stands out by 0.6 mm, less than a fifth of any clearance of it.
    assert apart.min(axis=1).max() < 0.001
    # What stands out before the palm is taken from the room that the hand has beside things.
    beyond = np.abs(spheres[:, 0] - middle[0]) + spheres[:, 3] - half[0]
    assert beyond.max() < 0.008
