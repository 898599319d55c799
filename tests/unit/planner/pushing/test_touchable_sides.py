"""Faces by name: what looks between two directions has no name of its own."""

from __future__ import annotations

import math

import pytest

from planner.types.world_state import PlanarPose
from tests.unit.planner.conftest import refused, world


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("degrees", "reason"), [(38.0, "impossible"), (42.0, "unsupported")])
def test_within_5_degrees_of_the_next_name_a_face_is_unclear(
    degrees: float, reason: str, sign: float
) -> None:
    turned = world(ice_tea_box=PlanarPose(0.45, 0.0, sign * math.radians(degrees)))
    refusal = refused("push the ice tea box at its front", turned)
    # Turned less, it is known which face is meant, but the push would meet it askew.
    assert refusal.reason == reason
    assert ("turned" in refusal.numbers) == (reason == "unsupported")
