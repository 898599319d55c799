"""The hand closes about widths: where its fingertips are, and what its joints bear."""

from dataclasses import replace

import numpy as np
import pytest

from objectmodels.geometry.side_faces import SidePress
from objectmodels.models.kinds import CylinderModel
from sim.robots.finger_kinematics import (
    FINGERS,
    JOINT_STIFFNESS,
    TIP_RADIUS,
    angles_reaching,
    finger_jacobian,
    finger_points,
)
from sim.robots.four_finger_hand import (
    HOLDING,
    NARROWEST,
    WIDEST,
    FourFingerGrasp,
    closing_direction,
)
from sim.robots.robots import HAND

WIDTHS = (NARROWEST, 0.03, 0.06, 0.09, WIDEST)


def _grip(width: float) -> FourFingerGrasp:
    grip = HAND.grasp_posture(width)
    assert isinstance(grip, FourFingerGrasp)
    return grip


@pytest.mark.parametrize("finger", FINGERS)
def test_a_finger_bends_to_where_its_tip_was(finger: str) -> None:
    tip = finger_points(finger, (0.0, 0.2, 0.7))[3]
    bent = angles_reaching(finger, tip)
    assert bent is not None
    # The bend is interpolated between a few thousand.
    assert bent == pytest.approx((0.0, 0.2, 0.7), abs=1e-5)


def test_a_finger_does_not_bend_beyond_its_length() -> None:
    assert angles_reaching("middle", np.array([0.0, 0.0, 0.30])) is None


@pytest.mark.parametrize("width", WIDTHS)
def test_fingertips_touch_two_sides_a_width_apart(width: float) -> None:
    grip = _grip(width)
    for finger in FINGERS:
        side = grip.middle - width / 2.0 * closing_direction(finger)
        x, _, z = grip.touch_point(finger)
        assert x == pytest.approx(side[0], abs=1e-6)
        assert z == pytest.approx(grip.middle[2], abs=1e-6)


@pytest.mark.parametrize("width", WIDTHS)
def test_the_open_hand_stands_off_both_sides(width: float) -> None:
    grip = _grip(width)
    opened = grip.posture_at(grip.opening)
    for finger in FINGERS:
        x = (
            finger_points(finger, opened.angles[finger])[3, 0]
            + TIP_RADIUS * closing_direction(finger)[0]
        )
        off = (grip.middle[0] - x) * closing_direction(finger)[0] - width / 2.0
        assert off == pytest.approx(grip.opening, abs=1e-6)


def test_no_grip_where_the_hand_does_not_close() -> None:
    assert HAND.grasp_posture(0.9 * NARROWEST) is None
    assert HAND.grasp_posture(1.1 * WIDEST) is None


@pytest.mark.parametrize("width", WIDTHS)
def test_no_joint_is_overloaded_by_the_strongest_squeeze(width: float) -> None:
    grip = _grip(width)
    torques = JOINT_STIFFNESS * grip.squeeze_offsets * grip.grip.strongest
    assert np.abs(torques).max() <= 1.6 + 1e-9  # four fifths of the joints' 2 N·m, and rounding
    assert grip.grip.strongest > 10.0  # what the hand was made for [N]


def _forces(grip: FourFingerGrasp, commanded: np.ndarray) -> np.ndarray:
    """What the fingers exert if their springs are wound up so, in P, shape (4, 3) [N]."""
    torques = dict(zip(FINGERS, JOINT_STIFFNESS * commanded.reshape(4, 3), strict=True))
    angles = grip.posture_at().angles
    return np.array([
        np.linalg.solve(finger_jacobian(f, angles[f], grip.touch_point(f)).T, torques[f])
        for f in HOLDING
    ])  # fmt: skip


def test_a_squeeze_pushes_nothing_aside() -> None:
    grip = _grip(0.06)
    forces = _forces(grip, 5.0 * grip.squeeze_offsets)
    np.testing.assert_allclose(forces.sum(axis=0), 0.0, atol=1e-9)
    assert forces[0, 0] == pytest.approx(-5.0)
    assert forces[1:, 0].sum() == pytest.approx(5.0)


def test_springs_that_bear_a_weight_exert_it() -> None:
    grip = _grip(0.06)
    wanted = np.array([0.5, 3.0, -1.0])
    forces = _forces(grip, grip.force_offsets(wanted))
    np.testing.assert_allclose(forces.sum(axis=0), wanted, atol=1e-9)


def test_about_a_round_side_all_fingertips_touch() -> None:
    radius = 0.04
    grip = _grip(2.0 * radius)
    side = CylinderModel(
        name="mug", radius=radius, height=0.08, mass=0.1, friction=0.3, finger_friction=0.6
    ).faces([0.0])[0]
    # From above: the axis of the side stands across the plane in which they are side by side.
    down, closing = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])
    press = SidePress.on_face(side, closing, down, grip.grip.contacts, TIP_RADIUS)
    posture = replace(grip, press=press).posture_at()
    for finger in FINGERS:
        tip = finger_points(finger, posture.angles[finger])[3]
        off = np.hypot(*(tip - grip.middle)[:2])
        assert off == pytest.approx(radius + TIP_RADIUS, abs=1e-5)
