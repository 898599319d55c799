"""From frames to plans and refusals, with a reach that answers by rule."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from planner import plan
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan, Reached
from planner.types.refusal import Refusal
from planner.types.world_state import PlanarPose, WorldState
from tests.unit.planner.conftest import LIMITS, RuledReach, frame_of, planned, refused, world

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
def test_a_push_in_each_direction(
    words: str, face: str, direction: tuple[float, float], kitchen: WorldState, reach: RuledReach
) -> None:
    push = planned(f"push the ice tea box {words} 12 cm", kitchen, reach).push
    assert push.face == face
    assert push.direction_W == pytest.approx((*direction, 0.0), abs=LENGTHS)
    assert push.stroke == pytest.approx(0.12)
    assert (push.fingers, push.spread) == (2, reach.limits.finger_spreads[0])
    # On the face that looks against the push: half the width of 90 mm from the middle.
    assert np.dot(push.p_BC[:2], direction) == pytest.approx(-0.045, abs=LENGTHS)
    assert np.dot(push.normal_W[:2], direction) == pytest.approx(-1.0, abs=LENGTHS)


def test_without_toppling_takes_the_contact_farthest_from_it(
    kitchen: WorldState, reach: RuledReach
) -> None:
    made = planned("push the ice tea box away without toppling it", kitchen, reach)
    assert made.push.p_BC[2] == pytest.approx(reach.limits.lowest_height)
    assert made.push.prediction.outcome == "slide"
    # Golden height b/μ of the ice tea box.
    assert made.push.prediction.critical_height == pytest.approx(0.119, abs=5e-4)
    assert made.push.margins.height > 0.0
    assert made.push.margins.force > 0.0
    assert made.push.margins.force_limit > 0.0
    assert 0.95 <= made.push.prediction.probability <= 1.0
    assert {used.name for used in made.defaults} == {"distance", "speed"}


@pytest.mark.parametrize("words", [
    "push the ice tea box 5 cm away", "turn the ice tea box to the left", "topple the ice tea box",
    "tilt the ice tea box by 3 degrees", "put the ice tea box to x 0.7 y 0.3",
])  # fmt: skip
def test_what_a_holder_keeps_is_not_moved(
    words: str, kitchen: WorldState, reach: RuledReach
) -> None:
    held = replace(kitchen.objects["ice tea box"], fixed=True)
    fixed = replace(kitchen, objects={**kitchen.objects, held.name: held})
    assert refused(words, fixed, reach).code == "is_fixed"


def test_a_better_contact_out_of_reach_is_passed_over(
    kitchen: WorldState, reach: RuledReach
) -> None:
    high = RuledReach(rule=lambda push: push.p_BC[2] > 0.03)
    made = planned("push the ice tea box away", kitchen, high)
    assert made.push.p_BC[2] > 0.03
    assert any("out of reach" in note for note in made.notes)
    single = RuledReach(rule=lambda push: push.fingers == 1)
    assert planned("push the ice tea box away", kitchen, single).push.fingers == 1


def test_nothing_in_reach(kitchen: WorldState) -> None:
    refusal = refused("push the ice tea box away", kitchen, RuledReach(rule=lambda _: False))
    assert refusal.reason == "out_of_reach"
    assert "too far" in refusal.message
    assert refusal.numbers["ways"] > 1


def test_a_narrow_face_takes_fingers_closer_together(
    kitchen: WorldState, reach: RuledReach
) -> None:
    push = planned("push the cereal box to the left", kitchen, reach).push
    # 52 mm wide: both fingertips, 20 mm each, find a place.
    assert push.fingers == 2
    assert push.spread in reach.limits.finger_spreads[1:]
    assert push.spread + 0.02 <= 0.052 + LENGTHS
    # Their edges may overhang a face on which both touch 6 mm from its edges.
    reach.limits = replace(LIMITS, finger_spreads=(0.04, 0.036))
    push = planned("push the cereal box to the left", kitchen, reach).push
    assert (push.fingers, push.spread) == (2, 0.04)
    reach.limits = replace(LIMITS, finger_spreads=(0.042,))
    assert planned("push the cereal box to the left", kitchen, reach).push.fingers == 1


def test_a_face_too_narrow_for_two_fingers(kitchen: WorldState, reach: RuledReach) -> None:
    reach.limits = replace(LIMITS, finger_spreads=(0.06, 0.042))
    refusal = refused("push the cereal box to the left with two fingers", kitchen, reach)
    assert refusal.reason == "impossible"
    assert refusal.message == "the cereal box is 52 mm wide there; two fingertips need 54 mm"
    assert refusal.spans == ((32, 48),)
    assert refusal.suggestions == ("push it with one finger",)


@pytest.mark.parametrize(
    "text",
    [
        "turn the ice tea box 30 degrees with two fingers",
        "topple the ice tea box away with two fingers",
    ],
)
def test_two_fingers_do_not_turn(text: str, reach: RuledReach) -> None:
    # Askew by so much, it is to be turned before it falls.
    askew = world(ice_tea_box=PlanarPose(0.45, 0.0, math.radians(35.0)))
    only_turned = replace(DEFAULTS, side_tolerance=math.radians(30.0))
    made = plan(frame_of(text), askew, reach, defaults=only_turned)
    assert isinstance(made, Refusal)
    assert (made.reason, made.capability) == (
        "unsupported",
        "turning an object with two fingers",
    )
    ((start, end),) = made.spans
    assert text[start:end] == "with two fingers"


def test_what_two_fingers_pushed_is_not_turned_back_by_one(reach: RuledReach) -> None:
    text = "push the ice tea box 10 cm away with two fingers"
    state = world(ice_tea_box=PlanarPose(0.45, 0.0))
    begun = planned(text, state, reach)
    there = world(ice_tea_box=PlanarPose(0.55, 0.0, math.radians(3.0)))
    assert isinstance(plan(frame_of(text), there, reach, previous=begun), Reached)
    one = plan(frame_of(text.removesuffix(" with two fingers")), there, reach, previous=begun)
    assert isinstance(one, Plan)
    assert one.push.ends_on == "turned"


@pytest.mark.parametrize(
    ("text", "distance"),
    [
        ("push the ice tea box away", DEFAULTS.distance),
        ("push the ice tea box away a little", DEFAULTS.distance_little),
        ("push the ice tea box away a lot", DEFAULTS.distance_lot),
        ("push the ice tea box away 7 cm", 0.07),
        ("push the ice tea box", DEFAULTS.distance),
    ],
)
def test_distances(text: str, distance: float, kitchen: WorldState, reach: RuledReach) -> None:
    made = planned(text, kitchen, reach)
    assert made.push.stroke == pytest.approx(distance)
    assert made.push.displacement == pytest.approx((distance, 0.0, 0.0), abs=LENGTHS)


def test_bounds_are_kept_with_the_tolerance_to_spare(
    kitchen: WorldState, reach: RuledReach
) -> None:
    most = planned("push the ice tea box away at most 10 cm", kitchen, reach)
    least = planned("push the ice tea box away at least 10 cm", kitchen, reach)
    assert most.push.stroke == pytest.approx(0.10 - DEFAULTS.distance_tolerance)
    assert least.push.stroke == pytest.approx(0.10 + DEFAULTS.distance_tolerance)


def test_gently_is_slow(kitchen: WorldState, reach: RuledReach) -> None:
    made = planned("gently push the ice tea box away", kitchen, reach)
    assert made.push.speed == DEFAULTS.speed_gentle
    assert "speed" not in {used.name for used in made.defaults}


@pytest.mark.slow
def test_a_force_that_suffices_is_kept(kitchen: WorldState, reach: RuledReach) -> None:
    assert (
        planned("push the ice tea box away with at most 5 N", kitchen, reach).push.force_limit == 5
    )
    refusal = refused("push the ice tea box away with at most 2 N", kitchen, reach)
    assert refusal.reason == "impossible"
    # μ G = 0.378 · 0.995 · 9.81 = 3.69 N, more with the probability that is asked.
    assert 3.69 < refusal.numbers["needed_force"] < 2 * 3.69
    assert refusal.numbers["allowed_force"] == 2.0
    assert refusal.spans


@pytest.mark.slow
def test_at_the_top_it_tips(kitchen: WorldState, reach: RuledReach) -> None:
    refusal = refused("push the ice tea box at the top without toppling it", kitchen, reach)
    assert refusal.reason == "impossible"
    assert refusal.numbers["lowest_top"] == pytest.approx(0.230 * 2 / 3)
    assert refusal.numbers["critical_height"] == pytest.approx(0.119, abs=5e-4)
    assert "153 mm" in refusal.message
    assert "119 mm" in refusal.message


def test_at_the_bottom_is_a_third(kitchen: WorldState, reach: RuledReach) -> None:
    push = planned("push the ice tea box at the bottom", kitchen, reach).push
    assert push.p_BC[2] <= 0.230 / 3


@pytest.mark.parametrize("name", ["ice tea box", "cereal box", "coffee box"])
def test_toppling(name: str, kitchen: WorldState, reach: RuledReach) -> None:
    made = planned(f"topple the {name}", kitchen, reach)
    target = kitchen.objects[name]
    assert made.push.prediction.outcome == "topple"
    assert made.push.prediction.probability >= DEFAULTS.probability
    assert made.push.prediction.critical_height is not None
    assert made.push.p_BC[2] > made.push.prediction.critical_height
    assert made.push.ends_on == "toppled"
    assert made.push.displacement is None
    inward = -np.array(made.push.normal_W)
    angle = target.model.angle_of_no_return(target.pose.R_WB.T @ inward)
    # The stroke leads past the angle of no return.
    assert made.push.stroke > target.model.topple_stroke(inward, made.push.p_BC[2], angle)


def test_toppling_to_a_side(kitchen: WorldState, reach: RuledReach) -> None:
    push = planned("topple the ice tea box to the left", kitchen, reach).push
    assert push.direction_W == pytest.approx((0.0, 1.0, 0.0), abs=LENGTHS)
    assert push.face == "right"


def test_a_box_that_cannot_topple_that_way(kitchen: WorldState, reach: RuledReach) -> None:
    refusal = refused("topple the cereal box to the left", kitchen, reach)
    assert refusal.reason == "impossible"
    assert refusal.numbers["highest_height"] == pytest.approx(0.25)


def test_the_hand_that_is_missing(kitchen: WorldState, reach: RuledReach) -> None:
    refusal = refused("push the ice tea box away with your left hand", kitchen, reach)
    assert (refusal.status, refusal.reason) == ("unsupported", "unsupported")
    assert refusal.capability is not None
    assert "left" in refusal.capability
    assert not reach.asked


def test_fingers_as_said(kitchen: WorldState, reach: RuledReach) -> None:
    assert planned("push the ice tea box away with one finger", kitchen, reach).push.fingers == 1
    assert planned("push the ice tea box away with two fingers", kitchen, reach).push.fingers == 2


@pytest.mark.parametrize(
    "text",
    [
        "lift the ice tea box",
        "open the ice tea box",
        "put the ice tea box on the cereal box",
    ],
)
def test_no_controller_yet(text: str, kitchen: WorldState, reach: RuledReach) -> None:
    refusal = refused(text, kitchen, reach)
    assert refusal.status == "unsupported"
    assert refusal.capability


def test_a_box_turned_by_a_little(reach: RuledReach) -> None:
    slightly = world(ice_tea_box=PlanarPose(0.45, 0.0, math.radians(-12)))
    push = planned("push the ice tea box away", slightly, reach).push
    # It still moves straight away, from the face that is nearly square to that.
    assert push.direction_W == pytest.approx((1.0, 0.0, 0.0), abs=LENGTHS)
    assert push.normal_W[0] == pytest.approx(-math.cos(math.radians(12)))


def test_the_table_ends(kitchen: WorldState, reach: RuledReach) -> None:
    refusal = refused("push the ice tea box 2 m away", kitchen, reach)
    assert refusal.reason == "impossible"
    # From x = 0.495, the box's back, to 1 cm before the edge at 1.2 m.
    assert refusal.numbers["room"] == pytest.approx(1.2 - 0.01 - 0.495)


def test_something_stands_in_the_way(reach: RuledReach) -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0), coffee_box=PlanarPose(0.62, 0.03))
    refusal = refused("push the ice tea box away 15 cm", state, reach)
    assert refusal.reason == "blocked"
    assert "coffee box" in refusal.message
    # Between 0.495 and 0.589, less the clearance of 1 cm.
    assert refusal.numbers["free"] == pytest.approx(0.084)
    assert isinstance(plan(frame_of("push the ice tea box away 8 cm"), state, reach), Plan)


def test_it_does_not_fall_on_another(reach: RuledReach) -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0), coffee_box=PlanarPose(0.62, 0.0))
    refusal = refused("topple the ice tea box away at the top", state, reach)
    assert refusal.reason == "blocked"
    # Said no side, it takes one that is free.
    push = planned("topple the ice tea box", state, reach).push
    assert push.face != "front"


@pytest.mark.parametrize(("way", "along_y"), [("towards", 1.0), ("away from", -1.0)])
def test_towards_and_away_from_another_object(reach: RuledReach, way: str, along_y: float) -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0), coffee_box=PlanarPose(0.45, 0.5))
    push = planned(f"push the ice tea box {way} the coffee box", state, reach).push
    assert push.direction_W == pytest.approx((0.0, along_y, 0.0), abs=LENGTHS)


def test_a_heavy_object_is_too_much_for_the_fingers(kitchen: WorldState) -> None:
    seen = kitchen.objects["ice tea box"]
    heavy = replace(seen, model=seen.model.model_copy(update={"mass": 8.0}))
    state = replace(kitchen, objects={"ice tea box": heavy})
    refusal = refused("push the ice tea box away", state, RuledReach())
    assert refusal.reason == "out_of_reach"
    assert refusal.numbers["allowed_force"] == 20.0


def test_the_same_question_has_the_same_answer(kitchen: WorldState, reach: RuledReach) -> None:
    text = "topple the coffee box"
    assert planned(text, kitchen, reach) == planned(text, kitchen, reach)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("put the mug next to the mug", "place_at_itself"),
        ("push the mug between the ice tea and the ice tea", "between_one"),
    ],
)
def test_a_place_is_told_by_other_objects(kitchen: WorldState, text: str, code: str) -> None:
    refused = plan(frame_of(text), kitchen, RuledReach())
    assert isinstance(refused, Refusal)
    assert (refused.code, refused.spans) == (code, frame_of(text).goal.spans)
