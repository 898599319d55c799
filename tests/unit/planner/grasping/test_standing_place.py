"""Putting things on others and taking them off: places, predictions and refusals."""

from __future__ import annotations

from dataclasses import replace

import pytest

from planner import plan
from planner.problem.footprints import footprint, gap
from planner.problem.planning_problem import SearchBudget
from planner.problem.predicted_states import state_after
from planner.problem.stacks import put_on
from planner.types.actions import Carry, LiftUp, SetDown, SetOn
from planner.types.defaults import DEFAULTS
from planner.types.plan import Reached
from planner.types.refusal import Refusal
from planner.types.world_state import PlanarPose, WorldState
from tests.unit.planner.conftest import frame_of, world
from tests.unit.planner.grasping.conftest import RuledHand, planned, refused

LENGTHS = 1e-9  # sums of a few numbers of order one


@pytest.fixture
def shelf() -> WorldState:
    """Things that may stand on one another."""
    return world(
        book=PlanarPose(0.45, 0.10),
        mug=PlanarPose(0.30, -0.25),
        sugar_box=PlanarPose(0.25, 0.25),
        ice_tea=PlanarPose(0.60, -0.30),
        jar=PlanarPose(0.70, 0.30),
    )


def stacked(state: WorldState, upper: str, lower: str) -> WorldState:
    """A state once one object stands on the middle of another."""
    below = state.objects[lower]
    pose = PlanarPose(below.pose.x, below.pose.y)
    seen = state.objects[upper]
    moved = put_on(type(seen)(seen.name, pose, seen.model), below)
    return WorldState({**state.objects, upper: moved}, state.table)


def test_it_is_put_on_the_middle_of_a_top(shelf: WorldState, hand: RuledHand) -> None:
    made = planned("put the mug on the book", shelf, hand)
    lift, carry, down = made.steps
    assert isinstance(lift, LiftUp)
    assert isinstance(carry, Carry)
    assert isinstance(down, SetOn)
    mug, book = (shelf.objects[name].model for name in ("mug", "book"))
    assert lift.height == pytest.approx(book.top + DEFAULTS.carry_clearance)
    assert down.onto == "book"
    assert down.height == pytest.approx(book.top)
    assert carry.to.x == pytest.approx(0.45 - mug.com[0], abs=LENGTHS)
    assert carry.to.y == pytest.approx(0.10 - mug.com[1], abs=LENGTHS)
    # The mug stands on a disc of 30 mm in radius, of which a polygon's sides are nearer.
    assert 0.029 < down.prediction.margin <= 0.030
    assert made.probability <= down.prediction.stands


def test_afterwards_it_is_believed_to_stand_there(shelf: WorldState, hand: RuledHand) -> None:
    made = planned("put the mug on the book", shelf, hand)
    after = state_after(made, shelf)
    assert after is not None
    assert after.objects["mug"].on == "book"
    assert after.objects["mug"].pose.z == pytest.approx(0.03)
    assert plan(frame_of("put the mug on the book"), after, hand) == Reached()


@pytest.mark.parametrize("said", ["take the mug off the book", "put the mug on the table"])
def test_it_is_taken_off_and_put_on_the_table(
    said: str, shelf: WorldState, hand: RuledHand
) -> None:
    high = stacked(shelf, "mug", "book")
    made = planned(said, high, hand)
    assert isinstance(made.steps[-1], SetDown)
    lift = made.steps[0]
    assert isinstance(lift, LiftUp)
    # It is up there already.
    assert lift.height == pytest.approx(DEFAULTS.carry_clearance)
    after = state_after(made, high)
    assert after is not None
    assert after.objects["mug"].on is None
    assert after.objects["mug"].pose.z == 0.0


def test_what_is_on_the_table_is_put_down_already(shelf: WorldState, hand: RuledHand) -> None:
    assert plan(frame_of("put the mug on the table"), shelf, hand) == Reached()


@pytest.mark.parametrize(
    ("said", "code"),
    [
        ("put the mug on the jar", "no_level_top"),
        ("put the sugar box on the mug", "falls_in"),
        ("put the book on the ice tea", "too_wide"),
    ],
)
def test_what_does_not_go_is_refused(
    said: str, code: str, shelf: WorldState, hand: RuledHand
) -> None:
    assert refused(said, shelf, hand).code == code


def test_what_carries_another_stays_where_it_is(shelf: WorldState, hand: RuledHand) -> None:
    high = stacked(shelf, "mug", "sugar box")
    for said in ("push the sugar box to the left", "lift the sugar box", "turn the sugar box"):
        assert refused(said, high, hand).code == "carries"
    assert refused("push the mug to the left", high, hand).code == "stands_on"


def test_a_stack_that_would_not_stand_is_refused_with_its_margin(
    shelf: WorldState, hand: RuledHand
) -> None:
    """Wherever it is put, the mug's own 30 mm leave no more than that; a wide doubt takes it."""
    unsure = shelf.objects["mug"].model.model_copy(update={"com_sd": (0.02, 0.02, 0.0)})
    mug = type(shelf.objects["mug"])("mug", shelf.objects["mug"].pose, unsure)
    state = WorldState({**shelf.objects, "mug": mug}, shelf.table)
    found = refused("put the mug on the book", state, hand)
    assert found.code == "may_fall_off"
    assert found.numbers["margin"] == pytest.approx(0.03, abs=0.001)
    assert found.numbers["probability"] < DEFAULTS.probability


@pytest.fixture
def table() -> WorldState:
    """An open box, and things that may stand in it."""
    return world(
        storage_bin=PlanarPose(0.45, 0.0),
        mug=PlanarPose(0.30, -0.35),
        sugar_box=PlanarPose(0.25, 0.35),
        book=PlanarPose(0.70, -0.40, 1.5707963),
        jar=PlanarPose(0.70, 0.40),
    )


def test_it_is_put_into_an_open_box_over_its_rim(table: WorldState, hand: RuledHand) -> None:
    made = planned("put the mug into the storage bin", table, hand)
    lift, carry, down = made.steps
    assert isinstance(lift, LiftUp)
    assert isinstance(carry, Carry)
    assert isinstance(down, SetOn)
    assert lift.height == pytest.approx(0.06 + DEFAULTS.carry_clearance)
    assert (carry.to.x, carry.to.y) == pytest.approx((0.45, 0.0), abs=LENGTHS)
    assert (down.onto, down.height, down.inside) == ("storage bin", 0.004, True)
    after = state_after(made, table)
    assert after is not None
    assert (after.objects["mug"].on, after.objects["mug"].pose.z) == ("storage bin", 0.004)
    assert plan(frame_of("put the mug into the storage bin"), after, hand) == Reached()


def test_it_is_taken_out_of_a_box_and_stands_beside_it(table: WorldState, hand: RuledHand) -> None:
    full = stacked(table, "mug", "storage bin")
    made = planned("take the mug out of the storage bin", full, hand)
    lift = made.steps[0]
    assert isinstance(lift, LiftUp)
    # Its base is 4 mm up already.
    assert lift.height == pytest.approx(0.06 + DEFAULTS.carry_clearance - 0.004)
    assert isinstance(made.steps[-1], SetDown)
    after = state_after(made, full)
    assert after is not None
    assert (after.objects["mug"].on, after.objects["mug"].pose.z) == (None, 0.0)
    mug, box = (footprint(after.objects[name]) for name in ("mug", "storage bin"))
    # Straight gaps are right to 10 µm.
    assert gap(mug, box) == pytest.approx(DEFAULTS.place_gap, abs=1e-5)
    assert plan(frame_of("take the mug out of the storage bin"), after, hand) == Reached()


@pytest.mark.parametrize(
    ("said", "code"),
    [
        ("put the mug into the jar", "not_open"),
        ("put the mug on the storage bin", "no_level_top"),
        ("put the book into the storage bin", "too_long_for_box"),
    ],
)
def test_where_nothing_is_put_in(said: str, code: str, table: WorldState, hand: RuledHand) -> None:
    assert refused(said, table, hand).code == code


def test_a_full_box_takes_nothing_and_is_not_pushed(table: WorldState, hand: RuledHand) -> None:
    full = stacked(table, "mug", "storage bin")
    straight = replace(full.objects["book"], pose=PlanarPose(0.70, -0.40))
    full = WorldState({**full.objects, "book": straight}, full.table)
    said = "put the book into the storage bin"
    refusal = plan(frame_of(said), full, hand, budget=SearchBudget())
    assert isinstance(refusal, Refusal)
    assert (refusal.code, refusal.reason) == ("box_is_full", "blocked")
    # Without the mug the hand could not hold the book either, so the mug is not what is told.
    assert refused(said, full, hand).code == "too_wide"
    assert refused("push the storage bin away by 5 cm", full, hand).code == "contains"
    assert refused("push the mug to the left", full, hand).code == "stands_in"
