"""Lifting, putting down and placing: grasps, steps and refusals."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from objectmodels import BoxModel, HullModel
from objectmodels.mechanics.push_thresholds import GRAVITY
from planner import plan
from planner.grasping.lift_planner import why_no_room
from planner.problem.planning_problem import (
    ContactLimits,
    Effort,
    ForceLimits,
    GraspGoal,
    MotionLimits,
    PlanningProblem,
    SearchBudget,
)
from planner.refusals.blocked import Blocked
from planner.types.actions import Carry, Grasp, LiftUp, SetDown
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan, Reached
from planner.types.refusal import Refusal
from planner.types.world_state import Held, PlanarPose, SeenObject, WorldState
from tests.unit.planner.conftest import RuledReach, frame_of, world
from tests.unit.planner.grasping.conftest import RuledHand, planned, refused

LENGTHS = 1e-9  # sums of a few numbers of order one


def test_a_carton_is_held_across_its_narrow_sides(table: WorldState, hand: RuledHand) -> None:
    made = planned("lift the ice tea", table, hand)
    grasp = made.grasp
    assert grasp is not None
    # Its ±x sides, 60 mm apart, look along W's y; 80 mm of the others fit the hand as well.
    assert grasp.width in (pytest.approx(0.06), pytest.approx(0.08))
    assert np.dot(grasp.closing_W, grasp.approach_W) == pytest.approx(0.0, abs=LENGTHS)
    assert grasp.closing_W[2] == pytest.approx(0.0, abs=LENGTHS)
    assert DEFAULTS.grasp_reserve * grasp.needed <= grasp.squeeze <= min(grasp.strongest, 25.0)
    assert made.steps == (LiftUp(height=DEFAULTS.lift_height),)
    assert made.probability >= DEFAULTS.probability
    assert "lift_height" in [used.name for used in made.defaults]


@pytest.mark.parametrize(
    ("words", "height"),
    [("5 cm", 0.05), ("a little", DEFAULTS.lift_little), ("at least 5 cm", 0.06)],
)
def test_how_far(words: str, height: float, table: WorldState, hand: RuledHand) -> None:
    (step,) = planned(f"lift the ice tea {words}", table, hand).steps
    assert isinstance(step, LiftUp)
    assert step.height == pytest.approx(height)


def test_what_is_too_heavy_is_refused_with_both_forces(table: WorldState, hand: RuledHand) -> None:
    made = refused("lift the ice tea box", table, hand)
    assert made.reason == "impossible"
    # 9.76 N at μ 0.57 take 8.6 N; a tenth for what trembles, and half as much again in reserve.
    assert made.numbers["needed_force"] == pytest.approx(14.2, abs=0.3)
    assert made.numbers["strongest"] == 11.0
    assert "needs 14." in made.message
    assert "the fingers have 11.0 N at 90 mm" in made.message
    assert not hand.plans


def test_what_is_too_wide_is_refused_with_both_widths(table: WorldState, hand: RuledHand) -> None:
    hand.limits = replace(hand.limits, grasp_widths=(0.008, 0.04))
    made = refused("lift the ice tea", table, hand)
    assert made.message == "the ice tea is 44 mm wide, the hand opens to 40 mm"


@pytest.mark.parametrize(("length", "held"), [(0.0615, False), (0.0625, True)])
def test_fingers_side_by_side_stay_4_mm_from_the_ends_of_a_side(
    length: float, held: bool, hand: RuledHand
) -> None:
    # Too low for fingers above each other, so that 54 mm of them lie along its sides.
    bar = BoxModel(
        name="bar", size=(0.05, length, 0.035), mass=0.2, friction=0.3, finger_friction=0.8
    )
    state = WorldState({"bar": SeenObject("bar", PlanarPose(0.5, 0.0), bar)})
    if held:
        grasp = planned("lift the bar", state, hand).grasp
        assert grasp is not None
        assert grasp.width == pytest.approx(0.05)
    else:
        assert refused("lift the bar", state, hand).code == "no_room"


def test_a_model_that_does_not_say_how_is_held_by_its_sides(hand: RuledHand) -> None:
    grasp = planned("lift the cereal box", world(cereal_box=PlanarPose(0.5, 0.0)), hand).grasp
    assert grasp is not None
    # The other two sides are 192 mm apart.
    assert grasp.width == pytest.approx(0.052)
    assert abs(grasp.p_BG[1]) <= LENGTHS  # in balance


@pytest.mark.parametrize("depth", [0.0, 0.1])
def test_a_hand_that_is_in_the_way_of_something_deep_makes_room(depth: float) -> None:
    hand = RuledHand(holds=lambda made: made.grasp is not None and made.grasp.depth >= depth)
    grasp = planned("lift the coffee box", world(coffee_box=PlanarPose(0.5, 0.0)), hand).grasp
    assert grasp is not None
    if depth:
        # From above it reaches up to the palm by what is above the middle, to 5 mm.
        assert grasp.depth - 0.005 < 0.18 - grasp.p_BG[2] <= grasp.depth + LENGTHS
    else:
        assert grasp.depth == 0.0


def test_what_says_nowhere_how_to_hold_it_is_pushed_to_its_place_first(hand: RuledHand) -> None:
    state = world(coffee_box=PlanarPose(0.5, 0.0), mug=PlanarPose(0.5, 0.25))
    assert planned("put the coffee box next to the mug", state, hand).pushes
    hand.rule = lambda _: False
    assert planned("put the coffee box next to the mug", state, hand).grasp is not None


@pytest.mark.parametrize("slope", [0.0, 5.0])
def test_sides_that_lean_take_a_part_of_the_friction(slope: float, hand: RuledHand) -> None:
    grasp = planned("lift the flask", _flask(slope), hand).grasp
    assert grasp is not None
    angle = np.radians(slope)
    # In balance, friction bears the weight, and a tenth for what trembles, on both sides.
    bears = 2.0 * (0.8 * np.cos(angle) - np.sin(angle))
    weighs = 0.2 * (GRAVITY + 1.0)
    # A bisection finds it.
    assert grasp.needed == pytest.approx(weighs / bears, rel=1e-4)
    # Half-way up it is so wide, which changes by 4 mm where it may be held.
    assert grasp.width == pytest.approx(0.06 + 0.1 * np.tan(angle), abs=1e-9)


def test_sides_that_lean_more_are_no_sides_to_hold(hand: RuledHand) -> None:
    assert refused("lift the flask", _flask(12.0), hand).code in ("no_two_sides", "too_wide")


def _flask(slope: float) -> WorldState:
    """A hull 10 cm high whose ±x sides lean outwards [degrees]; its ±y sides are too far apart."""
    wide = 0.03 + 0.10 * math.tan(math.radians(slope))
    ends = ((0.0, 0.03), (0.10, wide))
    corners = tuple((x * half, y * 0.06, z) for z, half in ends for x in (-1, 1) for y in (-1, 1))
    flask = HullModel(
        name="flask", vertices=corners, mass=0.2, friction=0.3, finger_friction=0.8,
        com=(0.0, 0.0, 0.05),
    )  # fmt: skip
    return WorldState({"flask": SeenObject("flask", PlanarPose(0.5, 0.0), flask)})


def test_a_robot_without_a_hand_says_so(table: WorldState) -> None:
    made = plan(frame_of("lift the mug"), table, RuledReach())
    assert isinstance(made, Refusal)
    assert made.capability == "lifting objects"


def test_force_that_the_sentence_does_not_allow(table: WorldState, hand: RuledHand) -> None:
    made = refused("lift the ice tea with at most 2 N", table, hand)
    assert made.numbers["allowed_force"] == 2.0
    assert made.spans


def test_gentle_squeezes_less_and_is_slower(table: WorldState, hand: RuledHand) -> None:
    careful = replace(DEFAULTS, grasp_reserve=2.5)
    usual = plan(frame_of("lift the ice tea"), table, hand, defaults=careful)
    gentle = plan(frame_of("lift the ice tea gently"), table, hand, defaults=careful)
    assert isinstance(usual, Plan)
    assert isinstance(gentle, Plan)
    assert usual.grasp is not None
    assert gentle.grasp is not None
    assert gentle.grasp.squeeze < usual.grasp.squeeze
    assert gentle.speed is not None
    assert usual.speed is not None
    assert gentle.speed == DEFAULTS.carry_speed_gentle < usual.speed


def test_where_it_is_held(table: WorldState, hand: RuledHand) -> None:
    grasp = planned("lift the ice tea at the top", table, hand).grasp
    assert grasp is not None
    assert grasp.p_BG[2] > 2.0 / 3.0 * 0.16


@pytest.mark.parametrize("words", ["within 2 s", "with one finger", "hard"])
def test_what_no_hand_keeps_is_refused_by_its_words(
    words: str, table: WorldState, hand: RuledHand
) -> None:
    made = refused(f"lift the ice tea {words}", table, hand)
    assert made.reason == "unsupported"
    assert made.spans


def test_what_stands_in_the_way_is_named(table: WorldState) -> None:
    made = refused("lift the ice tea", table, RuledHand(holds=lambda _: False, blocker="mug"))
    assert made.reason == "blocked"
    assert made.suggestions == ("move the mug first",)
    assert refused("lift the mug", table, RuledHand(holds=lambda _: False)).reason == "out_of_reach"


def test_the_hand_looks_at_so_many_ways(table: WorldState) -> None:
    hand = RuledHand(holds=lambda _: False)
    few = replace(DEFAULTS, most_grasps=3)
    plan(frame_of("lift the ice tea"), table, hand, defaults=few, budget=SearchBudget())
    # Where its file says or anywhere, square or askew each, and where the hand makes room; what
    # one of these has in common with another is asked for once.
    assert 3 * 3 < len(hand.plans) <= 3 * 5
    assert len({made.actions for made in hand.plans}) == len(hand.plans)


def test_the_hand_looks_for_so_much_work(table: WorldState) -> None:
    hand = RuledHand(holds=lambda _: False)
    few = replace(DEFAULTS, most_work=3)
    made = plan(frame_of("lift the ice tea"), table, hand, defaults=few)
    assert isinstance(made, Refusal)
    assert (made.code, len(hand.plans)) == ("work_used_up", 3)
    assert made.numbers["untried"] > 0.0


# -- what the hand holds ------------------------------------------------------------------------


@pytest.fixture
def holding(table: WorldState, hand: RuledHand) -> WorldState:
    """The ice tea is held 10 cm above the table."""
    grasp = planned("lift the ice tea", table, hand).grasp
    assert isinstance(grasp, Grasp)
    return replace(table, held=Held("ice tea", grasp, 0.10))


def test_what_is_held_is_lifted_on(holding: WorldState, hand: RuledHand) -> None:
    made = planned("lift the ice tea 5 cm", holding, hand)
    assert made.grasp is not None
    assert made.grasp.held
    assert holding.held is not None
    for field in Grasp.model_fields:
        assert getattr(made.grasp, field) == getattr(holding.held.grasp, field)
    assert made.steps == (LiftUp(height=0.05),)


@pytest.mark.parametrize(("held", "up"), [(0.10, 0.10), (0.25, -0.05)])
def test_a_height_above_the_table_is_measured_from_there(
    held: float, up: float, holding: WorldState, hand: RuledHand
) -> None:
    assert holding.held is not None
    state = replace(holding, held=replace(holding.held, height=held))
    (step,) = planned("hold the ice tea 20 cm above the table", state, hand).steps
    assert isinstance(step, LiftUp)
    assert step.height == pytest.approx(up)


def test_what_is_held_so_high_already_is_left_there(holding: WorldState, hand: RuledHand) -> None:
    made = plan(frame_of("hold the ice tea 10 cm above the table"), holding, hand)
    assert isinstance(made, Reached)


def test_what_is_held_is_placed_from_there(holding: WorldState, hand: RuledHand) -> None:
    made = planned("put the ice tea to the left of the ice tea cup", holding, hand)
    assert [step.kind for step in made.steps] == ["lift_up", "carry", "set_down"]
    up = made.steps[0]
    assert isinstance(up, LiftUp)
    # Over the cup of 0.12 m, from 0.10 m.
    assert up.height == pytest.approx(0.12 + DEFAULTS.carry_clearance - 0.10)


@pytest.mark.parametrize("text", ["lift the mug", "push the mug away", "push the ice tea away"])
def test_a_hand_that_holds_something_does_nothing_else(
    text: str, holding: WorldState, hand: RuledHand
) -> None:
    made = refused(text, holding, hand)
    assert made.message == "the hand holds the ice tea: put it down first"


# -- placing ------------------------------------------------------------------------------------


def test_placing_carries_over_what_is_in_the_way(table: WorldState, hand: RuledHand) -> None:
    made = planned("put the ice tea to the left of the ice tea cup", table, hand)
    up, over, down = made.steps
    assert isinstance(up, LiftUp)
    assert up.height == pytest.approx(0.12 + DEFAULTS.carry_clearance)
    assert isinstance(over, Carry)
    assert over.to == made.aim
    assert isinstance(down, SetDown)


def test_what_cannot_be_held_is_pushed_there(table: WorldState, hand: RuledHand) -> None:
    text = "put the ice tea box to the left of the ice tea cup"
    pushed = plan(frame_of(text), table, RuledReach())
    assert isinstance(pushed, Plan)
    assert plan(frame_of(text), table, hand) == pushed


def test_what_is_pushed_by_word_is_pushed(table: WorldState, hand: RuledHand) -> None:
    made = plan(frame_of("push the mug next to the ice tea cup"), table, hand)
    assert isinstance(made, Plan)
    assert not hand.plans


def test_a_place_that_is_taken(table: WorldState, hand: RuledHand) -> None:
    mug = table.objects["mug"]
    beside = replace(mug, pose=PlanarPose(0.24, 0.3056))
    taken = replace(table, objects={**table.objects, "mug": beside})
    held = planned("lift the ice tea", taken, hand).grasp
    assert held is not None
    taken = replace(taken, held=Held("ice tea", held, 0.1))
    made = refused("put the ice tea to the left of the ice tea cup", taken, hand)
    assert made.reason == "blocked"
    assert "the mug stands there" in made.message


@pytest.mark.parametrize(("share", "stands"), [(0.6, True), (0.4, False)])
def test_half_of_a_wanted_gap_is_left_at_least(
    share: float, stands: bool, table: WorldState, hand: RuledHand
) -> None:
    carton, box, gap = table.objects["ice tea"], table.objects["ice tea box"], 0.01
    d = DEFAULTS
    problem = PlanningProblem(
        frame_of("lift the ice tea"), carton, table, hand, d, GraspGoal("placing"),
        ContactLimits(), ForceLimits(d.grasp_reserve), MotionLimits(d.carry_speed),
        Effort.from_defaults(d),
    )  # fmt: skip
    # Its ±x sides are 60 mm apart, the box's 90 mm.
    beside = replace(carton, pose=PlanarPose(0.60 - 0.03 - 0.045 - share * gap, 0.0))
    assert (why_no_room(problem, beside, {box.name: gap}) is None) == stands
    why = why_no_room(problem, beside, {})
    assert isinstance(why, Blocked)
    assert why.obstacles == (box.name,)


@pytest.mark.slow
def test_a_low_mug_is_held_by_fingers_that_come_down_askew(
    table: WorldState, hand: RuledHand
) -> None:
    hand.limits = replace(
        hand.limits, lowest_grasp=0.06
    )  # where the mug may not be touched by all three fingers any more
    grasp = planned("lift the mug", table, hand).grasp
    assert grasp is not None
    assert -1.0 < grasp.approach_W[2] < 0.0
    assert np.dot(grasp.closing_W, grasp.approach_W) == pytest.approx(0.0, abs=LENGTHS)
    # Steeply enough that three fingers side by side, 27 mm apart, lie within its 15 to 70 mm.
    rise = 0.027 * np.hypot(*grasp.approach_W[:2])
    assert grasp.p_BG[2] - rise >= 0.015 - LENGTHS
    assert grasp.p_BG[2] + rise <= 0.07 + LENGTHS
