"""What is too small to be told from nothing is refused, with the least amount that can be told."""

from __future__ import annotations

import math

import pytest

from planner.types.defaults import DEFAULTS
from planner.types.world_state import WorldState
from tests.unit.planner.conftest import RuledReach, planned, refused

LEAST_WAY = 3.0 * DEFAULTS.aim_position
LEAST_ANGLE = 3.0 * DEFAULTS.aim_angle


@pytest.mark.parametrize(
    ("text", "least"),
    [
        ("push the ice tea box 1 mm away", LEAST_WAY),
        ("push the ice tea box 5 mm away", LEAST_WAY),
        ("turn the ice tea box by 1 degree", LEAST_ANGLE),
        ("turn the ice tea box by 0.5 degrees to the left", LEAST_ANGLE),
        ("tilt the ice tea box by 2 degrees", LEAST_ANGLE),
        ("tilt the ice tea box by at most 2 degrees", LEAST_ANGLE),
        ("lift the ice tea box by 5 mm", LEAST_WAY),
    ],
)
def test_an_amount_within_what_is_aimed_to_is_refused(
    text: str, least: float, kitchen: WorldState, reach: RuledReach
) -> None:
    refusal = refused(text, kitchen, reach)
    assert (refusal.code, refusal.reason) == ("too_small", "too_small")
    assert refusal.numbers["least_amount"] == pytest.approx(least)
    assert refusal.numbers["asked_amount"] < least


def test_the_least_amount_is_planned(kitchen: WorldState, reach: RuledReach) -> None:
    way = planned("push the ice tea box 6 mm away", kitchen, reach).push
    assert way.displacement is not None
    assert way.displacement[0] == pytest.approx(LEAST_WAY, abs=1e-6)
    turn = planned("turn the ice tea box by 3 degrees to the left", kitchen, reach).push
    assert abs(turn.turn) == pytest.approx(LEAST_ANGLE, rel=0.2)


def test_the_amount_and_the_least_are_told(kitchen: WorldState, reach: RuledReach) -> None:
    refusal = refused("push the ice tea box 1 mm away", kitchen, reach)
    assert refusal.message == "1 mm cannot be told from nothing; 6 mm is the least that can"
    assert refusal.suggestions == ("6 mm or more would do",)
    assert math.isclose(DEFAULTS.least_amount(DEFAULTS.aim_position), LEAST_WAY)
