"""Ways over the table to an aim: legs, detours, turns, and what stops them."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from planner import plan
from planner.problem.footprints import footprint, free_travel, gap
from planner.types.actions import Aim, Push
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan, Reached
from planner.types.robot import ReachAnswer, ReachEffort
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from tests.unit.planner.conftest import RuledReach, frame_of, planned, refused, world

RING = [(0.1, 0.0), (-0.1, 0.0), (0.1, 0.1), (-0.1, 0.1), (0.1, -0.1), (-0.1, -0.1),
        (0.0, 0.16), (0.0, -0.16)]  # fmt: skip
LENGTHS = 1e-9  # sums of a few floats [m]


def end(made: Plan, start: SeenObject) -> np.ndarray:
    """Where straight pushes take an object."""
    ways = [push.stroke * np.array(push.direction_W) for push in made.pushes]
    return np.asarray(start.pose.p_WB + np.sum(ways, axis=0))


def alone(x: float = 0.5, y: float = 0.0, degrees: float = 0.0) -> WorldState:
    return world(ice_tea_box=PlanarPose(x, y, math.radians(degrees)))


# -- legs -------------------------------------------------------------------------------------


def test_two_directions_take_two_pushes() -> None:
    state = alone()
    made = planned("push the ice tea box 14 cm away and to the left", state)
    assert made.aim is not None
    assert [push.face for push in made.pushes] in (["front", "right"], ["right", "front"])
    goal = np.array([0.5, 0.0, 0.0]) + 0.14 / math.sqrt(2) * np.array([1.0, 1.0, 0.0])
    assert end(made, state.objects["ice tea box"]) == pytest.approx(goal, abs=LENGTHS)
    assert (made.aim.x, made.aim.y) == pytest.approx(tuple(goal[:2]), abs=LENGTHS)


def test_a_box_that_stands_askew_goes_along_its_faces() -> None:
    state = alone(degrees=30.0)
    made = planned("push the ice tea box away", state)
    seen = state.objects["ice tea box"]
    assert end(made, seen) == pytest.approx([0.6, 0.0, 0.0], abs=LENGTHS)
    for push in made.pushes:
        inward = -seen.pose.R_WB.T @ np.array(push.normal_W)
        assert inward @ seen.pose.R_WB.T @ np.array(push.direction_W) == pytest.approx(1.0)


def test_a_pull_is_a_push_from_behind() -> None:
    made = planned("pull the ice tea box 10 cm towards me", alone())
    assert made.push.face == "back"
    assert made.push.direction_W[0] == pytest.approx(-1.0)


def test_a_pull_comes_nearer_if_nothing_else_is_said() -> None:
    made = planned("pull the ice tea box", alone())
    assert made.push.displacement == pytest.approx((-DEFAULTS.distance, 0.0, 0.0))
    (used,) = (default for default in made.defaults if default.name == "direction")
    assert (used.value, used.reason) == (math.pi, "no direction said: toward")


def test_a_round_thing_goes_straight_anywhere() -> None:
    state = world(soup_can=PlanarPose(0.5, 0.0, 0.3))
    made = planned("push the soup can 14 cm away and to the left", state)
    assert len(made.pushes) == 1
    assert made.push.direction_W == pytest.approx((math.sqrt(0.5), math.sqrt(0.5), 0.0))


def test_it_goes_around_what_stands_in_the_way() -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0), mug=PlanarPose(0.60, 0.0))
    made = planned("push the ice tea box 30 cm away", state)
    assert len(made.pushes) == 3
    here = state.objects["ice tea box"]
    assert end(made, here) == pytest.approx([0.75, 0.0, 0.0], abs=LENGTHS)
    for push in made.pushes:
        for share in np.linspace(0.0, 1.0, 11):
            way = share * push.stroke * np.array(push.direction_W)
            x, y, _ = (here.pose.p_WB + way).tolist()
            on_it = replace(here, pose=PlanarPose(x, y))
            apart = gap(footprint(on_it), footprint(state.objects["mug"]))
            assert apart > DEFAULTS.clearance - 1e-6
        here = on_it


def test_a_round_thing_is_led_around_by_one_side_step() -> None:
    state = world(soup_can=PlanarPose(0.45, 0.0), mug=PlanarPose(0.60, -0.06))
    made = planned("push the soup can 30 cm away", state)
    aside, ahead = made.pushes
    # From there it is straight ahead, so that the next plan needs no other side step.
    assert aside.stroke < 0.1
    assert ahead.stroke > 0.28


class CrowdedBehind(RuledReach):
    """A robot whose hand does not get to the left face of what stands nearer than 0.5 m.

    Where it stood then is kept.
    """

    def __init__(self) -> None:
        super().__init__()
        self.denied: set[tuple[float, float]] = set()

    def reach(self, push: Push, state: WorldState, effort: ReachEffort = "usual") -> ReachAnswer:
        pose = state.objects[push.object].pose
        if push.face == "left" and pose.x < 0.5:
            self.denied.add((pose.x, pose.y))
            return ReachAnswer(
                ok=False, reason="obstacle", code="told", words={"text": "a jar"}, blocker="jar"
            )
        return super().reach(push, state, effort)


def test_it_goes_out_across_and_back_where_the_hand_finds_no_room_behind_it() -> None:
    hand, state = CrowdedBehind(), alone(0.45)
    made = planned("push the ice tea box 6 cm to the right", state, hand)
    assert [push.face for push in made.pushes] == ["front", "left", "back"]
    assert end(made, state.objects["ice tea box"]) == pytest.approx([0.45, -0.06, 0.0], abs=LENGTHS)
    # What the hand did not get to is not asked for again where it would find the same.
    assert all(math.dist(*pair) >= 0.05 for pair in combinations(hand.denied, 2))


def test_fragile_things_are_given_a_wide_berth() -> None:
    # 40 mm between the box's side and the mug's.
    state = world(ice_tea_box=PlanarPose(0.45, 0.0), mug=PlanarPose(0.65, 0.109))
    assert len(planned("push the ice tea box 30 cm away", state).pushes) == 1
    mug = replace(state.objects["mug"], fragile=True)
    careful = replace(state, objects={**state.objects, "mug": mug})
    close = world(ice_tea_box=PlanarPose(0.45, 0.0), mug=PlanarPose(0.65, 0.105))
    mug = replace(close.objects["mug"], fragile=True)
    close = replace(close, objects={**close.objects, "mug": mug})
    assert planned("push the ice tea box 30 cm away", close).pushes[1:]
    assert len(planned("push the ice tea box 10 cm away", careful).pushes) == 1


@pytest.mark.parametrize(("way", "pushes"), [("toward me", 1), ("to the left", 1), ("away", 3)])
def test_it_gets_away_from_what_it_stands_close_to(way: str, pushes: int) -> None:
    # 8 mm between them, and 30 mm are kept from what is fragile.
    state = world(
        ice_tea_box=PlanarPose(0.45, 0.0), mug=PlanarPose(0.45 + 0.045 + 0.04 + 0.008, 0.0)
    )
    mug = replace(state.objects["mug"], fragile=True)
    state = replace(state, objects={**state.objects, "mug": mug})
    text = f"push the ice tea box {'30' if way == 'away' else '8'} cm {way}"
    assert len(planned(text, state).pushes) == pushes


def test_without_touching_keeps_the_distance_that_is_said() -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0), mug=PlanarPose(0.65, 0.12))
    near = planned("push the ice tea box 30 cm away without touching the mug", state)
    assert near.push.limits.clear_of == (("mug", DEFAULTS.clearance),)
    assert len(near.pushes) == 1


def test_the_hand_decides_between_two_orders() -> None:
    left_first = RuledReach(lambda push: push.face == "right" or push.p_BC[1] != 0.0)
    made = planned("push the ice tea box 14 cm away and to the left", alone(), left_first)
    assert made.pushes[0].face == "right" or made.push.face == "front"
    never = RuledReach(lambda push: push.face != "front")
    refusal = refused("push the ice tea box 10 cm away", alone(), never)
    assert refusal.reason == "out_of_reach"


def test_without_time_for_a_second_push_two_fingers_push_steeply() -> None:
    text = "push the ice tea box 10 cm heading 24 degrees"
    assert len(planned(text, alone()).pushes) == 2
    made = planned(f"{text} within 8 s", alone())
    assert (len(made.pushes), made.push.fingers) == (1, 2)
    heading = math.atan2(made.push.direction_W[1], made.push.direction_W[0])
    assert heading == pytest.approx(math.radians(24.0))
    # Its friction of 0.693 ± 0.069 lets fingertips slip at 29° in the worst case.
    assert refused("push the ice tea box 10 cm heading 27 degrees within 8 s", alone()).reason == (
        "out_of_time"
    )
    one = "push the ice tea box 10 cm heading 24 degrees within 8 s with one finger"
    assert refused(one, alone()).reason == "out_of_time"


@pytest.mark.slow
def test_a_steep_push_keeps_the_aim_of_the_plan_before() -> None:
    heading = math.radians(24.0)

    def steep(push: Push) -> bool:
        x, y, _ = push.direction_W
        return math.isclose(math.atan2(y, x), heading, abs_tol=1e-6)

    frame = frame_of("push the ice tea box 10 cm heading 24 degrees")
    before = plan(frame, alone(), RuledReach(steep))
    assert isinstance(before, Plan)
    assert len(before.pushes) == 1
    assert before.push.stroke == pytest.approx(0.10)
    start = alone().objects["ice tea box"].pose
    half = replace(
        start, x=start.x + 0.05 * math.cos(heading), y=start.y + 0.05 * math.sin(heading)
    )
    here = WorldState({"ice tea box": replace(alone().objects["ice tea box"], pose=half)})
    made = plan(frame, here, RuledReach(steep), previous=before)
    assert isinstance(made, Plan)
    assert made.push.stroke == pytest.approx(0.05)


@pytest.mark.parametrize("seconds", [2, 4, 5])
def test_too_little_time_is_told_of_the_shortest_way(seconds: int) -> None:
    refusal = refused(f"push the ice tea box 10 cm away within {seconds} s", alone())
    assert refusal.reason == "out_of_time"
    assert "over 100 mm takes" in refusal.message


# -- places -----------------------------------------------------------------------------------


def test_next_to_something() -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0), mug=PlanarPose(0.6, 0.3))
    made = planned("put the ice tea box to the left of the mug", state)
    assert made.aim is not None
    here = state.objects["ice tea box"]
    there = replace(here, pose=PlanarPose(made.aim.x, made.aim.y, made.aim.yaw or 0.0))
    mug = state.objects["mug"]
    assert gap(footprint(there), footprint(mug)) == pytest.approx(DEFAULTS.place_gap, abs=1e-5)
    assert made.aim.y > mug.pose.y


def test_against_something_ends_where_they_touch() -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0), mug=PlanarPose(0.75, 0.0))
    made = planned("push the ice tea box against the mug", state)
    assert (made.push.until, made.push.meets) == ("touching", "mug")
    # A little farther than the gap, so that it is surely felt; the mug is a polygon.
    assert made.push.stroke == pytest.approx(0.30 - 0.045 - 0.04 + 0.008, abs=1e-3)
    assert made.aim is not None


def test_what_stands_between_is_to_be_moved_first() -> None:
    poses = {f"book_{i}": PlanarPose(0.65, -0.6 + 0.2 * i) for i in range(7)}
    books = world(book=PlanarPose(0.65, 0.0)).objects["book"]
    wall = {name: replace(books, name=name, pose=pose) for name, pose in poses.items()}
    state = world(ice_tea_box=PlanarPose(0.45, 0.0), mug=PlanarPose(1.0, 0.0))
    state = replace(state, objects={**state.objects, **wall})
    to_a_place = refused("put the ice tea box in front of the mug", state)
    assert to_a_place.reason == "blocked"
    (instead,) = to_a_place.suggestions
    assert re.fullmatch(r"move the book_\d first", instead)
    far = refused("push the ice tea box 40 cm away", state)
    assert far.reason == "blocked"
    assert far.suggestions[0].startswith("up to ")


def test_a_share_of_the_way_towards_something() -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0), mug=PlanarPose(0.75, 0.0))
    # All the way is to where it stands next to the mug.
    whole = 0.30 - 0.045 - 0.04 - DEFAULTS.place_gap
    made = planned("push the ice tea box halfway to the mug", state)
    assert made.push.stroke == pytest.approx(whole / 2, abs=2e-3)  # the mug is a polygon


def test_until_it_touches_goes_on_to_where_it_would() -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0), mug=PlanarPose(0.65, 0.0))
    made = planned("push the ice tea box until it touches the mug", state)
    assert (made.push.until, made.push.meets) == ("touching", "mug")
    assert made.push.stroke > 0.20 - 0.045 - 0.04
    aside = refused("push the ice tea box to the left until it touches the mug", state)
    assert aside.reason == "impossible"


@pytest.mark.parametrize(
    ("degrees", "away"), [(25.0, (0.2, 0.0)), (40.0, (0.16, -0.06)), (45.0, (0.19, 0.07))]
)
def test_of_two_pushes_the_one_comes_last_that_meets_in_the_asked_direction(
    degrees: float, away: tuple[float, float]
) -> None:
    # In the other order they touch 15° off it, since the second push ends well before the aim.
    mug = PlanarPose(0.45 + away[0], away[1])
    state = world(ice_tea_box=PlanarPose(0.45, 0.0, math.radians(degrees)), mug=mug)
    made = planned("push the ice tea box towards the mug until it touches the mug", state)
    first, last = made.pushes
    here, other = state.objects["ice tea box"], footprint(state.objects["mug"])
    x, y, _ = (here.pose.p_WB + first.stroke * np.array(first.direction_W)).tolist()
    there = replace(here, pose=replace(here.pose, x=x, y=y))
    u = np.array(last.direction_W[:2])
    went = np.array([x, y]) + free_travel(footprint(there), other, u, 0.0) * u - (0.45, 0.0)
    off = math.atan2(*went[::-1]) - math.atan2(*away[::-1])
    assert abs(off) < 0.7 * DEFAULTS.direction_tolerance


def test_it_is_not_turned_into_what_it_is_to_meet() -> None:
    # A gap of 10 mm, in which a corner would come 18 mm farther.
    state = world(ice_tea_box=PlanarPose(0.45, 0.0), mug=PlanarPose(0.545, 0.0))
    text = "push the ice tea box until it touches the mug"
    askew = Aim(x=0.465, y=0.0, yaw=math.radians(45.0))
    before = planned(text, state).model_copy(update={"aim": askew, "later": ()})
    made = plan(frame_of(text), state, RuledReach(), previous=before)
    assert isinstance(made, Plan)
    assert made.push.ends_on == "turned"
    assert made.push.displacement is not None
    x, y, _ = (state.objects["ice tea box"].pose.p_WB + made.push.displacement).tolist()
    there = replace(state.objects["ice tea box"], pose=PlanarPose(x, y, made.push.turn))
    # Seven tenths of the gap are kept.
    assert gap(footprint(there), footprint(state.objects["mug"])) > 0.0069


def test_it_meets_what_it_is_to_meet_with_its_last_push_only() -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0, math.radians(30.0)), mug=PlanarPose(0.6, 0.03))
    made = planned("push the ice tea box away until it touches the mug", state)
    *first, last = made.pushes
    assert first
    here = state.objects["ice tea box"]
    for push in first:
        x, y, _ = (here.pose.p_WB + push.stroke * np.array(push.direction_W)).tolist()
        here = replace(here, pose=replace(here.pose, x=x, y=y))
        assert gap(footprint(here), footprint(state.objects["mug"])) > DEFAULTS.clearance - 1e-6
        assert push.until is None
    assert last.until == "touching"


# -- turns ------------------------------------------------------------------------------------


def test_until_it_moves_is_one_push_however_it_stands() -> None:
    straight = planned("push the ice tea box away until it moves", alone(degrees=5.0))
    assert straight.push.direction_W == pytest.approx((1.0, 0.0, 0.0))
    # Turned by more than the fingers stick at, it is pushed square to the face that is nearest.
    askew = planned("push the ice tea box away until it moves", alone(degrees=30.0))
    for made in (straight, askew):
        assert len(made.pushes) == 1
        assert made.push.until == "moves"
    inward = -np.array(askew.push.normal_W)
    assert inward @ np.array(askew.push.direction_W) == pytest.approx(1.0)
    assert askew.push.direction_W[0] == pytest.approx(math.cos(math.radians(30.0)))


def test_a_turn_is_parted_so_that_displacements_cancel() -> None:
    state = alone()
    made = planned("turn the ice tea box by 90 degrees to the left", state)
    outer, middle, last = made.pushes[:3]
    assert {push.ends_on for push in (outer, middle, last)} == {"turned"}
    assert outer.turn == pytest.approx(last.turn)
    assert middle.turn > outer.turn > 0.0
    total = sum(push.turn for push in (outer, middle, last))
    assert total == pytest.approx(math.radians(90.0), abs=DEFAULTS.aim_angle)
    assert made.aim is not None
    assert made.aim.yaw == pytest.approx(math.radians(90.0))
    here = state.objects["ice tea box"].pose
    assert (made.aim.x, made.aim.y) == (here.x, here.y)
    # Each by itself displaces the object by more than all of them together.
    assert made.push.displacement is not None
    assert math.hypot(*made.push.displacement[:2]) > DEFAULTS.aim_drift


def test_half_turns_keep_their_sense() -> None:
    left = planned("turn the ice tea box 180 degrees to the left", alone())
    right = planned("turn the ice tea box 180 degrees clockwise", alone())
    assert all(push.turn > 0.0 for push in left.pushes if push.ends_on == "turned")
    assert all(push.turn < 0.0 for push in right.pushes if push.ends_on == "turned")


def test_a_turn_without_room_is_made_near_by() -> None:
    state = world(cereal_box=PlanarPose(0.5, 0.0), mug=PlanarPose(0.59, 0.0))
    made = planned("turn the cereal box a quarter turn to the left", state)
    first, *others = made.pushes
    assert first.ends_on == "stroke"
    assert [push.ends_on for push in others[:2]] == ["turned", "turned"]
    # Nothing is left beside it where it would have to stay.
    ring = {f"mug {i}": PlanarPose(0.5 + x, y) for i, (x, y) in enumerate(RING)}
    plain = state.objects["mug"].model
    objects = {name: SeenObject(name, pose, plain) for name, pose in ring.items()}
    shut_in = replace(state, objects={"cereal box": state.objects["cereal box"], **objects})
    refusal = refused("turn the cereal box a quarter turn to the left", shut_in)
    assert refusal.reason == "blocked"
    assert "mug" in refusal.message


# -- towards an aim again ---------------------------------------------------------------------


def towards(aim: Aim) -> Plan:
    """A plan to an aim, whose first push was made."""
    made = planned("push the ice tea box away", alone())
    return made.model_copy(update={"aim": aim, "later": ()})


def test_a_turn_goes_on_as_it_was_begun() -> None:
    frame = frame_of("turn the ice tea box by 90 degrees to the left")
    start = alone()
    before = planned("turn the ice tea box by 90 degrees to the left", start)
    first, second = before.pushes[:2]
    assert before.push.displacement is not None
    # It has turned 2° less than it should, and the plan's other sides would do as well.
    x, y, _ = (start.objects["ice tea box"].pose.p_WB + before.push.displacement).tolist()
    turned = first.turn - math.radians(2.0)
    here = world(ice_tea_box=PlanarPose(x, y, turned))
    made = plan(frame, here, RuledReach(), previous=before)
    assert isinstance(made, Plan)
    assert made.push.p_BC == pytest.approx(second.p_BC)
    left = math.radians(90.0) - turned
    rest = [push.turn for push in before.pushes[1:]]
    assert made.push.turn == pytest.approx(rest[0] * left / sum(rest))
    assert made.aim == before.aim


def test_a_turn_is_made_at_its_aim_if_the_hand_does_not_bring_it_there_after_it() -> None:
    def along_x(push: Push) -> bool:
        return push.ends_on == "turned" or abs(push.direction_W[1]) < 0.1

    frame = frame_of("turn the ice tea box by 60 degrees to the left")
    aim = Aim(x=0.5, y=0.0, yaw=math.radians(60.0))
    made = plan(frame, alone(0.45), RuledReach(along_x), previous=towards(aim))
    assert isinstance(made, Plan)
    first, *others = made.pushes
    assert (first.ends_on, {push.ends_on for push in others}) == ("stroke", {"turned"})
    assert first.stroke == pytest.approx(0.05)


def test_a_turn_without_room_goes_on_at_its_aim() -> None:
    here = world(cereal_box=PlanarPose(0.5, 0.0), mug=PlanarPose(0.59, 0.0))
    frame = frame_of("turn the cereal box a quarter turn to the left")
    aim = Aim(x=0.4, y=0.0, yaw=math.radians(90.0))
    made = plan(frame, here, RuledReach(), previous=towards(aim))
    assert isinstance(made, Plan)
    assert (made.push.ends_on, made.pushes[1].ends_on) == ("stroke", "turned")
    assert made.push.stroke == pytest.approx(0.1)


def test_nothing_is_left_to_be_done_at_the_aim() -> None:
    frame, aim = frame_of("push the ice tea box away"), Aim(x=0.5005, y=0.0, yaw=0.005)
    made = plan(frame, alone(), RuledReach(), previous=towards(aim))
    assert isinstance(made, Reached)
    assert made.off == pytest.approx(0.0005)


def test_the_last_millimetres_are_no_reason_to_go_there_and_back() -> None:
    def long(push: Push) -> bool:
        return push.stroke > 0.01

    frame = frame_of("push the ice tea box away")
    for off, kind in ((0.003, Reached), (0.006, Plan)):
        made = plan(
            frame, alone(), RuledReach(long), previous=towards(Aim(x=0.5 + off, y=0.0, yaw=0.0))
        )
        assert isinstance(made, kind)
    # Where the hand gets there, it corrects them.
    assert isinstance(
        plan(frame, alone(), RuledReach(), previous=towards(Aim(x=0.503, y=0.0, yaw=0.0))), Plan
    )


def test_what_is_missed_is_corrected_towards_the_same_aim() -> None:
    frame, aim = frame_of("push the ice tea box away"), Aim(x=0.49, y=0.004, yaw=0.0)
    made = plan(frame, alone(degrees=2.0), RuledReach(), previous=towards(aim))
    assert isinstance(made, Plan)
    assert made.aim == aim
    assert made.pushes[0].direction_W[0] < -0.9
    # The fingers square it up on the way.
    assert made.pushes[0].turn == pytest.approx(math.radians(-2.0))


# -- taps -------------------------------------------------------------------------------------


@pytest.mark.parametrize(("words", "face"), [("", "front"), ("from the left", "left")])
def test_a_tap_touches_a_side_and_ends_as_it_gives_way(words: str, face: str) -> None:
    made = planned(f"tap the ice tea box {words}", alone())
    assert (made.push.face, made.push.until) == (face, "moves")
    assert made.push.stroke == pytest.approx(DEFAULTS.tap)
    assert len(made.pushes) == 1


@pytest.mark.parametrize(("free", "offered"), [(0.009, False), (0.011, True)])
def test_a_shorter_way_is_offered_if_it_is_a_centimetre(
    free: float, offered: bool, reach: RuledReach
) -> None:
    # Half of each box, 10 mm that are kept, and what is free.
    beyond = 0.045 + 0.031 + 0.010 + free
    state = world(ice_tea_box=PlanarPose(0.45, 0.0), coffee_box=PlanarPose(0.45 + beyond, 0.0))
    refusal = refused("push the ice tea box 10 cm away", state, reach)
    assert refusal.numbers["free"] == pytest.approx(free)
    assert (refusal.code == "in_the_way_so_far") == offered
