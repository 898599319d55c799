"""Places of fingertips on a narrow face."""

from __future__ import annotations

import pytest

from objectmodels import BoxModel
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from tests.unit.planner.conftest import LIMITS, planned, refused

TEXT = "push the ice tea box away with two fingers"


def _narrow(width: float) -> WorldState:
    model = BoxModel(
        name="ice tea box", size=(0.09, width, 0.06), mass=0.3, friction=0.3,
        finger_friction=0.6,
    )  # fmt: skip
    return WorldState({"ice tea box": SeenObject("ice tea box", PlanarPose(0.5, 0.0), model)})


def test_two_fingertips_stay_6_mm_from_the_edges_of_a_face() -> None:
    closest = LIMITS.finger_spreads[-1]
    assert planned(TEXT, _narrow(closest + 0.0125)).push.spread == closest
    refusal = refused(TEXT, _narrow(closest + 0.0115))
    assert refusal.code == "too_narrow_for_two"
    assert refusal.numbers["needed_width"] == pytest.approx(closest + 0.012)
