"""Hands that flip a lid: how near they come to the table."""

from __future__ import annotations

import math

import pytest

from sim.robots.lid_path import LidShape
from sim.robots.robots import HAND

OPEN = math.radians(100.0)


@pytest.mark.parametrize("height", [0.05, 0.08])
def test_a_hand_that_closes_a_low_lid_keeps_5_mm_from_the_table(height: float) -> None:
    lid = LidShape(0.07, 0.035, 0.02, height, OPEN, 0.0, HAND.tip_radius)
    hands = HAND.flip_postures(lid)
    rest = hands.path_spheres[:, :, :-1]  # the fingertip comes last
    # E stands at the height of the hinge.
    nearest = float((rest[..., 2] - rest[..., 3]).min()) + height
    # Of some 500 hands one is hardly higher than it must be.
    assert 0.005 <= nearest < 0.0055
