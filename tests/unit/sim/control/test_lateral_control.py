"""Tests of steering with one fingertip."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sim.control.push_control import LateralController, Pushed
from sim.robots.finger_kinematics import TIP_RADIUS
from sim.worlds.ports import SeenPose

FLAT = Pushed(0.045, 0.0344, TIP_RADIUS)
ROUND = Pushed(0.033, 0.033, TIP_RADIUS, curvature=1.0 / 0.033)


class _Slid:
    """An object that slides as the model says, pushed by a steered fingertip and seen late.

    Args:
        believed: what the robot believes of it.
        true: how it is.
        seed: of where it stands and of the camera's noise.
        turn: by which it is to turn [rad].
        limit: largest turn on the way [rad].
    """

    def __init__(
        self,
        believed: Pushed,
        true: Pushed,
        *,
        seed: int,
        turn: float = 0.0,
        limit: float = np.inf,
    ) -> None:
        self.true, self.rng = true, np.random.default_rng(seed)
        self.theta, self.contact = np.radians(self.rng.normal(0.0, 0.5)), self.rng.normal(0.0, 3e-4)
        self.first = self.theta
        self.most = 0.0
        self.tip = np.array([0.5, 0.0]) - true.middle(self.theta, self.contact)[0]
        self.keeper = LateralController(
            believed,
            0.0,
            self.tip,
            (0.5, 0.0, self.theta + self.rng.normal(0.0, np.radians(0.2))),
            turn=turn,
            limit=limit,
            deviations=(0.006, 0.001, 0.003, 0.45 * believed.friction_radius),
            camera=(0.002, np.radians(1.0)),
        )

    @property
    def middle(self) -> np.ndarray:
        return self.tip + self.true.middle(self.theta, self.contact)[0]

    def pushed(self, stroke: float, step: float = 0.0005) -> None:
        """Carries out a stroke, seen in every third step and five steps late."""
        frames = []
        for i in range(int(stroke / step)):
            slope = self.keeper.slope(stroke - i * step)
            turning = self.true.turning(step, step * slope)
            turned = turning @ [self.theta, self.contact, self.true.centre, 1.0]
            self.theta += turned
            self.most = max(self.most, abs(self.theta - self.first))
            self.contact += self.true.rolling * TIP_RADIUS * turned
            self.tip = self.tip + step * np.array([1.0, slope])
            self.keeper.update_from_tip(i * 0.01, self.tip)
            R = np.eye(3)
            R[:2, :2] = _turn(self.theta + self.rng.normal(0.0, np.radians(1.0)))
            p = np.array([*self.middle, 0.0]) + self.rng.normal(0.0, 0.002, 3)
            frames.append((i * 0.01, SeenPose(R, p)))
            if i % 3 == 2 and i > 5:
                self.keeper.update_from_camera(*frames[i - 5])


@pytest.mark.parametrize(
    ("believed", "share", "off", "turned"),
    [
        (FLAT, 0.7, 0.003, 2.0),
        (FLAT, 1.0, 0.003, 2.0),
        (FLAT, 1.3, 0.004, 2.0),
        (ROUND, 0.7, 0.003, 2.0),
        (ROUND, 1.0, 0.003, 2.0),
        # It rolls off faster than the filter finds out; the next push corrects what is left.
        (ROUND, 1.3, 0.010, 4.5),
    ],
)
@pytest.mark.parametrize("seed", range(3))
def test_steering_holds_the_line_of_its_own_model(
    believed: Pushed, share: float, off: float, turned: float, seed: int
) -> None:
    """The friction radius is up to 1.3 times the believed one, which the filter finds late."""
    true = dataclasses.replace(believed, friction_radius=share * believed.friction_radius)
    slid = _Slid(believed, true, seed=seed)
    slid.pushed(0.15)
    # The goals for displacements are 3 mm and 2°; a frame has noise of 2 mm and 1°.
    assert abs(slid.middle[1]) < off
    assert abs(np.degrees(slid.theta - slid.first)) < turned
    assert slid.keeper.travelled_distance == pytest.approx(slid.middle[0] - 0.5, abs=0.0005)


@pytest.mark.parametrize("believed", [FLAT, ROUND])
@pytest.mark.parametrize("centre", [-0.001, 0.001])
def test_steering_finds_the_centre_of_friction(believed: Pushed, centre: float) -> None:
    slid = _Slid(believed, dataclasses.replace(believed, centre=centre), seed=1)
    slid.pushed(0.15)
    # Pushed beside its centre of friction, it goes straight only at an angle and turns back last.
    assert abs(slid.middle[1]) < 0.004
    assert abs(np.degrees(slid.theta - slid.first)) < 3.0


def test_a_limit_of_the_turn_keeps_the_object_steady() -> None:
    beside = dataclasses.replace(FLAT, centre=0.002)
    free, steady = (_Slid(FLAT, beside, seed=3, limit=limit) for limit in (np.inf, 0.07))
    free.pushed(0.15)
    steady.pushed(0.15)
    assert steady.most < 0.07 < free.most


def test_steering_turns_a_little_if_asked() -> None:
    slid = _Slid(FLAT, FLAT, seed=2, turn=np.radians(3.0))
    slid.pushed(0.15)
    assert np.degrees(slid.theta - slid.first) == pytest.approx(3.0, abs=2.0)


@pytest.mark.parametrize("pushed", [FLAT, ROUND])
def test_a_fingertip_rolls_on_the_face(pushed: Pushed) -> None:
    """No slip: the object's point under a tip that does not turn goes with the tip."""
    theta, contact, turned, h = 0.1, 0.004, 1e-3, pushed.rolling * TIP_RADIUS
    before, by = pushed.middle(theta, contact)
    after = pushed.middle(theta + turned, contact + h * turned)[0]
    np.testing.assert_allclose(after - before, by @ [turned, h * turned], atol=1e-6)
    normal = theta - pushed.curvature * contact
    to_contact = TIP_RADIUS * np.array([np.cos(normal), np.sin(normal)]) - before
    carried = turned * np.array([-to_contact[1], to_contact[0]])
    np.testing.assert_allclose(after - before + carried, 0.0, atol=1e-6)


def _turn(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])
