"""Hands that press from above: clear of the plane, and strong."""

from __future__ import annotations

import numpy as np

from sim.robots.finger_kinematics import TIP_RADIUS, force_noise_gain, max_tip_force
from sim.robots.robots import HAND

HANDS = HAND.pressing_postures()


def test_only_the_fingertip_comes_to_the_plane() -> None:
    spheres = HANDS.spheres_along(np.eye(3)[None], np.zeros((1, 3)))[:, 0, :-1]
    lowest = (spheres[..., 2] - spheres[..., 3]).min()
    # The plane is a radius below the fingertip's centre; the hand keeps 4 mm off it.
    assert lowest >= 0.004 - TIP_RADIUS - 1e-9


def test_the_best_press_as_hard_as_they_say() -> None:
    assert (np.diff(HANDS.strength) < 0.1).all()  # the best first, told to a tenth of a newton
    assert HANDS.strength[0] > 25.0
    posture, R_DP = HANDS.posture_at(0), HANDS.R_DP[0]
    (finger,) = posture.pushing
    down = np.array([0.0, 0.0, -1.0])
    p_PC, angles = posture.tips[0] + TIP_RADIUS * down @ R_DP, posture.angles[finger]
    for along in (0.0, 0.5):
        load = (down + along * np.array([1.0, 0.0, 0.0])) @ R_DP
        assert max_tip_force(finger, angles, p_PC, load) >= HANDS.strength[0] - 1e-9
    assert force_noise_gain(finger, angles, p_PC, down @ R_DP) < 60.0
