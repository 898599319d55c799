"""The estimate of how far an object has turned: from the fingertip's way and late frames."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels.geometry.rotations import Array, rot_z
from sim.control.object_estimate import TurnedObject, TurnEstimator
from sim.worlds.ports import SeenPose

RADIUS = 0.010
INWARD = np.array([1.0, 0.0])
DIRECTION = np.array([np.cos(0.5), np.sin(0.5)])
CONTACT = np.array([0.40, 0.03])
MIDDLE = np.array([0.45, 0.0])
PERIOD, DELAY = 0.01, 0.05
NOISE, ANGLE_NOISE = 0.002, np.radians(1.0)


def _rotation(angle: float) -> Array:
    return np.asarray(rot_z(angle)[:2, :2])


class Truth:
    """A finger that sticks to an object which turns about a pivot at a rate per travel."""

    def __init__(self, rate: float) -> None:
        self.rate = rate
        # The contact moves at right angles to the pivot, at unit speed.
        self.pivot = CONTACT + np.array([-DIRECTION[1], DIRECTION[0]]) / rate

    def at(self, travel: float, place: Array) -> Array:
        """Where a point of the object, or of the finger, is after so much travel."""
        turned = _rotation(self.rate * travel) @ (place - self.pivot)
        return np.asarray(self.pivot + turned)

    def pose(self, travel: float, rng: np.random.Generator) -> SeenPose:
        """What a camera shows of the object then."""
        seen = self.rate * travel + rng.normal(0.0, ANGLE_NOISE)
        place = self.at(travel, MIDDLE) + rng.normal(0.0, NOISE, 2)
        return SeenPose(rot_z(seen), np.append(place, 0.0))


def _keeper(believed: float, slip: float = 0.0, turn_sd: float = 0.006) -> TurnEstimator:
    tip = CONTACT - RADIUS * INWARD
    body = TurnedObject(0.0, INWARD, MIDDLE - tip, DIRECTION, RADIUS, believed)
    return TurnEstimator(body, tip, slip, deviations=(turn_sd, 0.001), camera=(NOISE, ANGLE_NOISE))


def _pushed(keeper: TurnEstimator, truth: Truth, travel: float, *, seed: int, speed: float) -> None:
    """Feeds a push of so much travel, frames at 25 Hz as late as the camera's."""
    rng, tip = np.random.default_rng(seed), CONTACT - RADIUS * INWARD
    ways = np.arange(0.0, travel, speed * PERIOD)
    late = round(DELAY / PERIOD)
    for k, way in enumerate(ways):
        keeper.update_from_tip(k * PERIOD, truth.at(way, tip))
        if k % 4 == 0 and k > late:
            keeper.update_from_camera((k - late) * PERIOD, truth.pose(ways[k - late], rng))


@pytest.mark.parametrize("rate", [-12.0, 8.0])
def test_between_frames_it_goes_by_the_rate_and_the_way_of_the_contact(rate: float) -> None:
    keeper, truth, tip = _keeper(rate), Truth(rate), CONTACT - RADIUS * INWARD
    for k in range(200):
        keeper.update_from_tip(k * PERIOD, truth.at(k * 2e-4, tip))
    travel = 199 * 2e-4
    # Each step is taken along the direction at its beginning, a thousandth of a radian off.
    assert keeper.travel == pytest.approx(travel, rel=5e-4)
    assert keeper.turn_angle == pytest.approx(rate * travel, rel=5e-4)


@pytest.mark.parametrize("share", [0.6, 1.0, 1.7])
def test_a_wrong_rate_is_found(share: float) -> None:
    errors, rates = [], []
    for seed in range(8):
        truth, keeper = Truth(-8.0), _keeper(-8.0 * share)
        _pushed(keeper, truth, 0.06, seed=seed, speed=0.02)
        errors.append(keeper.turn_angle - truth.rate * keeper.travel)
        rates.append(keeper.rate)
    # 75 frames of 1°, of which the last dozen count most, and a first heading known to 0.3°.
    assert np.degrees(np.sqrt(np.mean(np.square(errors)))) < 0.4
    assert np.degrees(abs(np.mean(errors))) < 0.2
    assert np.mean(rates) == pytest.approx(-8.0, rel=0.08)


def test_a_late_frame_does_not_pull_the_turn_back() -> None:
    truth, keeper = Truth(-10.0), _keeper(-10.0)
    tip, travel = CONTACT - RADIUS * INWARD, 0.0
    for k in range(101):
        travel = k * 0.05 * PERIOD
        keeper.update_from_tip(k * PERIOD, truth.at(travel, tip))
    before = keeper.turn_angle
    then = travel - 0.05 * DELAY
    place = truth.at(then, MIDDLE)
    keeper.update_from_camera(
        1.0 - DELAY, SeenPose(rot_z(truth.rate * then), np.append(place, 0.0))
    )
    # It shows 1.4° less than now, and just that is expected of it.
    assert np.degrees(abs(truth.rate * 0.05 * DELAY)) > 1.4
    assert keeper.turn_angle == pytest.approx(before, abs=3e-4)


def test_slip_along_the_face_is_seen() -> None:
    truth, keeper = Truth(-8.0), _keeper(-8.0)
    slip = 0.004
    offset = -slip * np.array([-INWARD[1], INWARD[0]])
    rng, tip = np.random.default_rng(3), CONTACT - RADIUS * INWARD
    for k in range(300):
        travel = k * 2e-4
        keeper.update_from_tip(k * PERIOD, truth.at(travel, tip))
        if k % 4 == 0 and k:
            seen = truth.pose(travel, rng)
            shifted = seen.p_WB[:2] + _rotation(truth.rate * travel) @ offset
            keeper.update_from_camera(k * PERIOD, SeenPose(seen.R_WB, np.append(shifted, 0.0)))
    # 75 frames of 2 mm, forgotten as the finger may slip by 0.8 mm per centimetre.
    assert keeper.slip == pytest.approx(slip, abs=0.0015)


def test_a_finger_that_slips_slowly_is_followed_and_noise_is_not() -> None:
    errors = []
    for seed in range(30):
        truth, keeper = Truth(-8.0), _keeper(-8.0)
        rng, tip = np.random.default_rng(seed), CONTACT - RADIUS * INWARD
        for k in range(300):
            travel = k * 2e-4
            slip = 0.05 * travel  # 3 mm over 6 cm
            offset = slip * np.array([INWARD[1], -INWARD[0]])
            keeper.update_from_tip(k * PERIOD, truth.at(travel, tip))
            if k % 4 == 0 and k:
                seen = truth.pose(travel, rng)
                shifted = seen.p_WB[:2] + _rotation(truth.rate * travel) @ offset
                keeper.update_from_camera(k * PERIOD, SeenPose(seen.R_WB, np.append(shifted, 0.0)))
        errors.append(keeper.slip - slip)
    # It lags by the way on which a slip is believed, and single frames of 2 mm hardly move it.
    assert -0.65e-3 < np.mean(errors) < 0.0
    assert np.std(errors) < 0.65e-3


# -- how fast it learns, from frames without noise ------------------------------------------------

WAY = 2e-4
"""Of the contact in a control step [m]."""


def _follow(keeper: TurnEstimator, rates: Array) -> float:
    """Feeds a push whose rate may change from step to step; how far it turned in truth [rad]."""
    contact, turn = CONTACT, 0.0
    for k, rate in enumerate(rates):
        contact = contact + WAY * _rotation(turn + 0.5 * rate * WAY) @ DIRECTION
        turn += rate * WAY
        keeper.update_from_tip(k * PERIOD, contact - _rotation(turn) @ (RADIUS * INWARD))
        if k % 4 == 0:
            place = contact + _rotation(turn) @ (MIDDLE - CONTACT)
            keeper.update_from_camera(k * PERIOD, SeenPose(rot_z(turn), np.append(place, 0.0)))
    return turn


def test_the_rate_of_a_model_is_soon_believed_less_than_frames() -> None:
    believed, rate = -5.7, -8.0
    keeper = _keeper(believed)
    _follow(keeper, np.full(25, rate))
    # Nearly half of the difference on half a centimetre.
    assert 0.3 < (keeper.rate - believed) / (rate - believed) < 0.55


def test_a_rate_that_changes_on_the_way_is_followed() -> None:
    rate, changed = -8.0, -11.0
    keeper = _keeper(rate)
    _follow(keeper, np.repeat([rate, changed], [300, 100]))
    # Most of the change on two centimetres, not all: frames may be wrong.
    assert 0.48 < (keeper.rate - rate) / (changed - rate) < 0.75


def test_a_jerk_that_does_not_change_the_rate_is_followed() -> None:
    jerk = np.radians(-2.0)
    rates = np.full(350, -0.5)  # so slow that what is not known of the rate does not count
    rates[300] += jerk / WAY
    keeper = _keeper(-0.5)
    left = _follow(keeper, rates) - keeper.turn_angle
    # Two thirds of it on one centimetre.
    assert 0.22 < left / jerk < 0.40
