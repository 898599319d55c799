"""Falls of what stands askew, where there is no room, and where the hand does not get to."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from planner import plan
from planner.types.actions import FALLING
from planner.types.refusal import Refusal
from planner.types.world_state import PlanarPose, WorldState
from tests.unit.planner.conftest import RuledReach, frame_of, planned, refused, world

EXACT = 1e-9  # of a few rotations


def _askew(degrees: float) -> WorldState:
    return world(ice_tea_box=PlanarPose(0.5, 0.0, math.radians(degrees)))


def test_what_stands_askew_is_turned_first(reach: RuledReach) -> None:
    made = planned("topple the ice tea box away", _askew(35.0), reach)
    assert [made.push.ends_on, made.pushes[-1].ends_on] == ["turned", "toppled"]
    assert made.pushes[-1].direction_W == pytest.approx((1.0, 0.0, 0.0), abs=EXACT)


def test_where_it_may_not_be_turned_it_falls_askew_to_the_side_that_is_asked(
    reach: RuledReach,
) -> None:
    made = planned("topple the ice tea box away at the top", _askew(41.0), reach)
    assert len(made.pushes) == 1
    heading = math.atan2(made.push.direction_W[1], made.push.direction_W[0])
    assert heading == pytest.approx(math.radians(41.0), abs=EXACT)
    # As likely to one side as to the other.
    refusal = refused("topple the ice tea box away at the top", _askew(43.0), reach)
    assert refusal.reason == "impossible"
    assert "turned by 43° first" in refusal.message


@pytest.mark.slow
def test_it_falls_askew_where_the_hand_does_not_turn_it() -> None:
    only_falls = RuledReach(lambda push: push.ends_on == "toppled")
    made = planned("topple the ice tea box away", _askew(35.0), only_falls)
    assert made.push.ends_on == "toppled"
    assert len(made.pushes) == 1


def test_a_fall_has_30_mm_of_travel_for_what_the_model_does_not_know(reach: RuledReach) -> None:
    state = _askew(0.0)
    push = planned("topple the ice tea box away", state, reach).push
    model, inward = state.objects["ice tea box"].model, np.array([1.0, 0.0, 0.0])
    # Beyond the angle of no return, in the worst case believed, it falls by itself.
    angle = model.angle_of_no_return(inward, sigmas=-push.margins.sigmas) + FALLING
    spare = push.stroke - model.topple_stroke(inward, push.p_BC[2], angle)
    assert spare == pytest.approx(0.03, abs=EXACT)


def _crowded() -> WorldState:
    """An ice tea box, 220 mm high, with another box 120 mm ahead."""
    return world(ice_tea_box=PlanarPose(0.45, 0.0), coffee_box=PlanarPose(0.62, 0.0))


def test_without_room_it_is_brought_elsewhere_and_falls_there(reach: RuledReach) -> None:
    made = planned("topple the ice tea box away", _crowded(), reach)
    first, (then,) = made.push, made.pushes[1:]
    assert (first.ends_on, then.ends_on) == ("stroke", "toppled")
    assert abs(first.direction_W[1]) == pytest.approx(1.0, abs=EXACT)
    # Past the coffee box, 100 mm wide, with half its own width of 90 mm and room to spare.
    assert first.stroke > 0.05 + 0.045
    assert then.direction_W == pytest.approx((1.0, 0.0, 0.0), abs=EXACT)
    assert "would fall on the coffee box" in made.notes[0]


@pytest.mark.parametrize("words", ["away at the top", "away within 9 s"])
def test_what_is_said_about_the_push_keeps_it_where_it_is(words: str, reach: RuledReach) -> None:
    refusal = refused(f"topple the ice tea box {words}", _crowded(), reach)
    assert refusal.reason == "blocked"
    assert "would fall on the coffee box" in refusal.message


def test_a_tilt_stays_where_it_is(reach: RuledReach) -> None:
    near = world(ice_tea_box=PlanarPose(0.45, 0.0), coffee_box=PlanarPose(0.56, 0.0))
    assert refused("tilt the ice tea box away by 10 degrees", near, reach).reason == "blocked"


def test_where_the_hand_does_not_get_it_is_brought_elsewhere() -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0))

    class Sideways(RuledReach):
        def reach(self, push, state, effort="usual"):  # type: ignore[no-untyped-def]
            y = state.objects["ice tea box"].pose.y
            self.rule = lambda push: push.ends_on == "stroke" or abs(y) > 0.08
            return super().reach(push, state, effort)

    made = planned("topple the ice tea box away", state, Sideways())
    assert made.push.ends_on == "stroke"
    assert made.push.stroke == pytest.approx(0.10)
    assert abs(made.push.direction_W[1]) == pytest.approx(1.0, abs=EXACT)


def test_no_room_on_the_sides_that_would_do_is_no_impossibility(reach: RuledReach) -> None:
    # Over its short edges it slides, over the long ones there is no room.
    state = world(
        cereal_box=PlanarPose(0.5, 0.0),
        mug=PlanarPose(0.62, 0.0),
        coffee_box=PlanarPose(0.38, 0.0),
    )
    refusal = refused("topple the cereal box at the top", state, reach)
    assert refusal.reason == "blocked"
    alone = replace(state, objects={"cereal box": state.objects["cereal box"]})
    planned("topple the cereal box at the top", alone, reach)


def test_a_hand_that_does_not_get_there_looks_thoroughly() -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0))
    reach = RuledReach(lambda _: False, last=lambda push: push.p_BC[2] < 0.05)
    made = planned("push the ice tea box away", state, reach)
    assert made.push.p_BC[2] < 0.05
    # First as usual, with two fingertips and with one.
    assert len(reach.asked) > 12


def test_what_was_tried_before_is_no_reason_to_look_thoroughly() -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0))

    class Failed(RuledReach):
        def reach(self, push, state, effort="usual"):  # type: ignore[no-untyped-def]
            answer = super().reach(push, state, effort)
            return replace(answer, reason="failed")

    reach = Failed(lambda _: False, last=lambda _: True)
    assert refused("push the ice tea box away", state, reach).reason == "out_of_reach"


@pytest.mark.slow
def test_what_is_foreseen_must_be_reached_as_usual() -> None:
    # An aim askew of the faces takes two pushes, of which only the first may be looked at closely.
    frame, state = "push the ice tea box 20 cm away and to the left", _askew(0.0)
    nothing = RuledReach(lambda _: False, last=lambda _: True)
    assert isinstance(plan(frame_of(frame), state, nothing), Refusal)
    either = RuledReach(lambda push: push.face == "right", last=lambda _: True)
    made = planned(frame, state, either)
    assert [made.push.face, made.pushes[1].face] == ["front", "right"]
