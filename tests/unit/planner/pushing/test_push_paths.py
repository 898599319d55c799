"""How far from square to a face a push may be."""

from __future__ import annotations

import math

import pytest

from objectmodels import BoxModel
from planner.pushing.push_paths import largest_obliqueness
from planner.types.world_state import PlanarPose, SeenObject


def _seen(friction: float, sd: float = 0.0) -> SeenObject:
    model = BoxModel(
        name="box", size=(0.09, 0.09, 0.23), mass=1.0, friction=0.4,
        finger_friction=friction, finger_friction_sd=sd,
    )  # fmt: skip
    return SeenObject("box", PlanarPose(0.5, 0.0), model)


def test_fingertips_that_stick_push_up_to_a_fifth_of_a_right_angle() -> None:
    assert 14.0 < math.degrees(largest_obliqueness(_seen(0.8), 0.0)) < 22.0


def test_slippery_fingertips_push_no_more_oblique_than_they_stick() -> None:
    assert largest_obliqueness(_seen(0.1), 2.0) == pytest.approx(math.atan(0.1))
    assert largest_obliqueness(_seen(0.1, sd=0.02), 2.0) == pytest.approx(math.atan(0.06))


def test_something_is_left_to_slipping_where_nothing_else_is() -> None:
    slips = math.atan(0.6)
    assert 0.75 * slips < largest_obliqueness(_seen(0.6), 0.0, steep=True) < 0.95 * slips
