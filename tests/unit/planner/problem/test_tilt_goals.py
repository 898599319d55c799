"""Tilts that come back: how far, from where, and why not."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from planner import plan
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan
from planner.types.refusal import Refusal
from planner.types.world_state import PlanarPose, WorldState
from tests.unit.planner.conftest import RuledReach, frame_of, planned, refused, world

LENGTHS = 1e-9  # sums of a few numbers of order one


@pytest.mark.parametrize(
    ("words", "face", "direction"),
    [
        ("away", "front", (1.0, 0.0)),
        ("towards me", "back", (-1.0, 0.0)),
        ("to the left", "right", (0.0, 1.0)),
        ("to the right", "left", (0.0, -1.0)),
    ],
)
def test_a_tilt_to_each_side(
    words: str, face: str, direction: tuple[float, float], kitchen: WorldState, reach: RuledReach
) -> None:
    made = planned(f"tilt the ice tea box by 8 degrees {words}", kitchen, reach)
    push = made.push
    assert (push.ends_on, push.face, push.until) == ("tilted", face, None)
    assert push.tilt == pytest.approx(math.radians(8.0))
    assert push.direction_W == pytest.approx((*direction, 0.0), abs=LENGTHS)
    assert (made.push.prediction.outcome, made.push.displacement) == ("topple", None)
    # High enough that it tilts before it slides: golden height b/μ of 119 mm.
    assert push.p_BC[2] > 0.119
    # The stroke covers the tilt with its tolerance: h sin θ at least, for a finger that sticks.
    assert push.limits.tilt == pytest.approx(math.radians(10.0))
    assert push.stroke > push.p_BC[2] * math.sin(math.radians(10.0))
    # And 15 mm for what the model does not know.
    model, inward = kitchen.objects["ice tea box"].model, np.array([1.0, 0.0, 0.0])
    most = model.topple_stroke(inward, push.p_BC[2], math.radians(10.0))
    assert push.stroke - most == pytest.approx(0.015, abs=LENGTHS)


@pytest.mark.parametrize(
    ("text", "angle"),
    [
        ("tilt the ice tea box", 10.0),
        ("tilt the ice tea box a little", 5.0),
        # b / c_z = 45 / 115: it falls by itself from 21.4° on.
        ("tilt the ice tea box a lot", DEFAULTS.tilt_lot * math.degrees(math.atan(45 / 115))),
        ("tilt the ice tea box by 6 degrees", 6.0),
        ("tilt the ice tea box by at least 6 degrees", 8.0),
        ("tilt the ice tea box by at most 6 degrees", 4.0),
        # 26 / 130 across its thin side: 10° would be too near to 11.3°.
        ("tilt the cereal box", DEFAULTS.tilt_lot * math.degrees(math.atan(26 / 130))),
        ("tilt the cereal box a little", 5.0),
    ],
)
def test_angles(text: str, angle: float, kitchen: WorldState, reach: RuledReach) -> None:
    made = planned(text, kitchen, reach)
    assert math.degrees(made.push.tilt) == pytest.approx(angle)
    assert ("tilt" in {used.name for used in made.defaults}) == ("degrees" not in text)


def test_what_might_not_come_back_is_refused(kitchen: WorldState, reach: RuledReach) -> None:
    refusal = refused("tilt the cereal box by 10 degrees away", kitchen, reach)
    assert refusal.reason == "too_uncertain"
    assert refusal.numbers["stay_on_base_angle"] == pytest.approx(math.atan(26 / 130))
    possible = refusal.numbers["sure_return"] - DEFAULTS.tilt_tolerance
    # What is offered instead, rounded down to a tenth of a degree, is possible.
    (offered, *_) = refusal.suggestions
    said = float(offered.split("°")[0].removeprefix("up to "))
    assert 0.0 <= math.degrees(possible) - said < 0.1
    planned(f"tilt the cereal box by {said} degrees away", kitchen, reach)
    assert refused("tilt the cereal box by 20 degrees away", kitchen, reach).reason == "impossible"


def test_what_is_known_well_may_be_tilted_further(reach: RuledReach) -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0))
    text = "tilt the ice tea box by 15 degrees"
    assert refused(text, state, reach).reason == "too_uncertain"
    (target,) = state.objects.values()
    known = target.model.model_copy(update={"com_sd": (0.001, 0.001, 0.003)})
    sure = WorldState({target.name: replace(target, model=known)}, state.table)
    assert planned(text, sure, reach).push.tilt == pytest.approx(math.radians(15.0))


def test_what_slides_first_is_refused(kitchen: WorldState, reach: RuledReach) -> None:
    refusal = refused("tilt the cereal box by 3 degrees to the left", kitchen, reach)
    assert refusal.reason == "impossible"
    assert "slides" in refusal.message


def test_room_to_lean_over(reach: RuledReach) -> None:
    # Tilted by 10 + 2°, the top of 230 mm leans over by 48 mm; 10 mm are kept free.
    for gap, free in ((0.057, False), (0.059, True)):
        state = world(
            ice_tea_box=PlanarPose(0.45, 0.0),
            coffee_box=PlanarPose(0.45 + 0.045 + 0.031 + gap, 0.0),
        )
        made = plan(frame_of("tilt the ice tea box by 10 degrees away"), state, reach)
        assert isinstance(made, Plan) == free
        if isinstance(made, Refusal):
            assert made.reason == "blocked"
            assert made.numbers["leans_over"] == pytest.approx(0.23 * math.sin(math.radians(12.0)))


def test_until_it_almost_tips_is_a_tilt(kitchen: WorldState, reach: RuledReach) -> None:
    push = planned("push the ice tea box away until it almost tips", kitchen, reach).push
    assert push.ends_on == "tilted"
    # A share of its angle of no return.
    assert math.degrees(push.tilt) == pytest.approx(DEFAULTS.tilt_lot * 21.37, abs=0.01)
    assert push.p_BC[2] > 0.119


def test_until_it_tips_is_a_topple(kitchen: WorldState, reach: RuledReach) -> None:
    push = planned("push the ice tea box away until it tips", kitchen, reach).push
    assert push.ends_on == "toppled"
    assert push.direction_W[0] == pytest.approx(1.0)


def test_without_toppling_it_is_what_a_tilt_does_anyway(
    kitchen: WorldState, reach: RuledReach
) -> None:
    tilt = "tilt the ice tea box by 10 degrees"
    careful = planned(f"{tilt} without toppling it", kitchen, reach)
    assert careful.push == planned(tilt, kitchen, reach).push
