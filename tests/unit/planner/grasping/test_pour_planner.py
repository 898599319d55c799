"""Pouring: amounts, the tilt, the place of the lip, and refusals with volumes."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from grammar.frames.command import Frame, ObjectRef, Pour
from planner import plan
from planner.grasping.pour_planner import Amount, poured_amount
from planner.refusals.blocked import Blocked
from planner.types.actions import PourOut
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan, Reached
from planner.types.refusal import Refusal
from planner.types.world_state import Held, WorldState
from sim.motion.held_object_path import HeldObject, step_segments
from tests.unit.planner.grasping.conftest import RuledHand, planned

MUG = 3.285e-4  # what the mug of the registry holds [m³]


@pytest.fixture
def known(table: WorldState) -> WorldState:
    """0.30 l are in the carton, known to 15 ml, so that the mug surely takes them."""
    carton = table.objects["ice tea"]
    assert carton.model.container is not None
    container = carton.model.container.model_copy(
        update={"contents_l": 0.3, "contents_l_sd": 0.015}
    )
    model = carton.model.model_copy(update={"container": container})
    return replace(table, objects={**table.objects, "ice tea": replace(carton, model=model)})


def _pour(state: WorldState, hand: RuledHand, **said: object) -> object:
    frame = Frame(
        action="pour",
        object=ObjectRef(text="ice tea", id="ice tea"),
        goal=Pour.model_validate({"into": ObjectRef(text="mug", id="mug"), **said}),
    )
    return plan(frame, state, hand)


def _step(made: object) -> PourOut:
    assert isinstance(made, Plan), made
    return next(step for step in made.steps if isinstance(step, PourOut))


@pytest.mark.parametrize(("ml", "empty"), [(0.7, True), (1.4, False)])
def test_a_drop_is_nothing(ml: float, empty: bool) -> None:
    problem: Any = SimpleNamespace(target=SimpleNamespace(name="ice tea"), defaults=DEFAULTS)
    source: Any = SimpleNamespace(container=SimpleNamespace(contents=ml * 1e-6))
    into: Any = SimpleNamespace(room=MUG)
    goal = Pour.model_validate({"into": ObjectRef(text="mug", id="mug")})
    poured = poured_amount(problem, source, into, goal)
    if empty:
        assert isinstance(poured, Blocked)
        assert poured.code == "is_empty"
    else:
        assert isinstance(poured, Amount)
        assert poured.volume == pytest.approx(ml * 1e-6)


def test_everything_is_poured_with_the_carton_set_down_again(
    known: WorldState, hand: RuledHand
) -> None:
    made = planned("pour the contents of the ice tea into the mug", known, hand)
    assert [step.kind for step in made.steps] == ["lift_up", "pour_out", "set_down"]
    poured = _step(made).prediction
    assert poured.received >= 0.9 * 3e-4
    assert poured.spilled <= 0.02 * 3e-4
    assert poured.received + poured.spilled + poured.left == pytest.approx(3e-4, rel=0.01)
    assert poured.level_after == pytest.approx(poured.received / MUG, rel=0.01)
    assert made.probability >= DEFAULTS.probability


def test_the_lip_is_where_the_stream_falls_into_the_opening(
    known: WorldState, hand: RuledHand
) -> None:
    made = planned("pour the ice tea into the mug", known, hand)
    step = _step(made)
    # The opening is at the carton's +x side, which looks to W's −y at a heading of −91°.
    assert step.heading == pytest.approx(math.radians(-91.0), abs=1e-6)
    mug, lip = known.objects["mug"], np.array(step.lip_W)
    assert lip[2] == pytest.approx(mug.model.top + DEFAULTS.pour_clearance)
    ahead = mug.pose.p_WB[:2] - lip[:2]
    along = np.array([math.cos(step.heading), math.sin(step.heading)])
    # A few centimetres ahead, and straight.
    assert 0.01 < ahead @ along < 0.04
    assert np.linalg.norm(ahead - (ahead @ along) * along) < 1e-9
    assert step.volume is None
    assert math.pi / 2 < step.angle < math.radians(150.0)


@pytest.mark.slow
def test_it_leans_along_the_line_between_thumb_and_fingers(
    known: WorldState, hand: RuledHand
) -> None:
    made = planned("pour the ice tea into the mug", known, hand)
    assert made.grasp is not None
    lean = np.array([math.cos(_step(made).heading), math.sin(_step(made).heading), 0.0])
    assert abs(lean @ np.array(made.grasp.closing_W)) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.slow
def test_where_the_arm_does_not_reach_it_is_turned_first(known: WorldState) -> None:
    hand = RuledHand(holds=lambda made: any(step.kind == "carry" for step in made.steps))
    made = planned("pour the ice tea into the mug", known, hand)
    kinds = [step.kind for step in made.steps]
    assert kinds == ["lift_up", "carry", "pour_out", "carry", "set_down"]


@pytest.mark.parametrize(
    ("said", "volume"),
    [
        ({"volume": 1e-4}, 1e-4),
        ({"fraction": 0.5}, 1.5e-4),
        pytest.param({"fill": 0.5}, 0.5 * MUG, marks=pytest.mark.slow),
        pytest.param({"amount": "little"}, DEFAULTS.pour_little, marks=pytest.mark.slow),
        pytest.param({"amount": "lot"}, DEFAULTS.pour_lot * 3e-4, marks=pytest.mark.slow),
    ],
)
def test_parts_of_it(
    said: dict[str, object], volume: float, known: WorldState, hand: RuledHand
) -> None:
    made = _pour(known, hand, **said)
    step = _step(made)
    assert step.volume == pytest.approx(volume, rel=1e-3)
    assert isinstance(made, Plan)
    assert step.prediction.poured == pytest.approx(volume, rel=0.02)


@pytest.mark.slow
def test_all_as_a_share_is_everything(known: WorldState, hand: RuledHand) -> None:
    assert _step(_pour(known, hand, fraction=1.0)).volume is None


def test_more_than_fits_is_refused_with_the_most_that_does(
    known: WorldState, hand: RuledHand
) -> None:
    made = _pour(known, hand, volume=5e-4)
    assert isinstance(made, Refusal)
    assert made.message == "500 ml do not fit into the mug: it has room for 329 ml"
    assert made.numbers == pytest.approx({"volume": 5e-4, "room": MUG, "contents": 3e-4}, rel=1e-3)
    assert made.suggestions == ("pour up to 270 ml, which is all that is surely there",)


def test_no_more_is_told_to_pour_than_is_surely_there(known: WorldState, hand: RuledHand) -> None:
    carton = known.objects["ice tea"]
    container = carton.model.container
    assert container is not None
    unsure = container.model_copy(update={"contents_l": 0.2, "contents_l_sd": 0.07})
    model = carton.model.model_copy(update={"container": unsure})
    state = replace(known, objects={**known.objects, "ice tea": replace(carton, model=model)})
    made = _pour(state, hand, volume=2.5e-4)
    assert isinstance(made, Refusal)
    assert DEFAULTS.sigmas == 2.0
    assert made.suggestions == ("pour up to 60 ml",)


def test_more_than_there_is(known: WorldState, hand: RuledHand) -> None:
    made = _pour(known, hand, volume=3.1e-4)
    assert isinstance(made, Refusal)
    assert made.message == "310 ml are asked; 300 ml are in the ice tea"


def test_what_may_run_over_is_too_uncertain(known: WorldState, hand: RuledHand) -> None:
    carton = known.objects["ice tea"]
    container = carton.model.container
    assert container is not None
    doubt = carton.model.model_copy(
        update={"container": container.model_copy(update={"contents_l_sd": 0.06})}
    )
    unsure = replace(carton, model=doubt)
    made = _pour(replace(known, objects={**known.objects, "ice tea": unsure}), hand)
    assert isinstance(made, Refusal)
    assert made.reason == "too_uncertain"
    assert made.numbers["probability"] < DEFAULTS.probability


@pytest.mark.parametrize(
    ("into", "message"),
    [
        ("ice tea", "the ice tea cannot be poured into itself"),
        ("ice tea cup", "the ice tea cup is closed"),
    ],
)
def test_what_nothing_is_poured_into(
    into: str, message: str, known: WorldState, hand: RuledHand
) -> None:
    made = _pour(known, hand, into=ObjectRef(text=into, id=into))
    assert isinstance(made, Refusal)
    assert made.message == message


def test_nothing_to_pour_into(known: WorldState, hand: RuledHand) -> None:
    made = _pour(known, hand, into=None)
    assert isinstance(made, Refusal)
    assert "something to pour into" in made.message


def test_what_is_full_enough_is_left(known: WorldState, hand: RuledHand) -> None:
    mug = known.objects["mug"]
    container = mug.model.container
    assert container is not None
    half = mug.model.model_copy(
        update={"container": container.model_copy(update={"contents_l": 0.17})}
    )
    state = replace(known, objects={**known.objects, "mug": replace(mug, model=half)})
    assert isinstance(_pour(state, hand, fill=0.5), Reached)


@pytest.mark.slow
def test_what_is_held_is_not_set_down(known: WorldState, hand: RuledHand) -> None:
    grasp = planned("pour the ice tea into the mug", known, hand).grasp
    assert grasp is not None
    made = _pour(replace(known, held=Held("ice tea", grasp, 0.2)), hand)
    assert isinstance(made, Plan)
    assert [step.kind for step in made.steps] == ["pour_out"]


@pytest.mark.parametrize("share", [0.5, 0.995, 1.0])
def test_a_part_takes_no_more_tilt_than_everything(
    known: WorldState, hand: RuledHand, share: float
) -> None:
    """Also where what may be in it is hardly more than what is asked."""
    container = known.objects["ice tea"].model.container
    assert container is not None
    least = container.contents - DEFAULTS.sigmas * container.contents_sd
    part = _step(_pour(known, hand, volume=share * least))
    everything = _step(_pour(known, hand))
    # The tilts that are looked at are up to 5° apart; the last drop takes the longest.
    assert part.angle <= everything.angle + math.radians(5.0)


def test_it_is_carried_at_the_speed_that_is_said(known: WorldState, hand: RuledHand) -> None:
    made = planned("pour 100 ml of the ice tea into the mug at 8 cm/s", known, hand)
    assert made.speed == pytest.approx(0.08)
    legs = [leg for step in step_segments(HeldObject.from_plan(made, known)) for leg in step]
    fastest = max(legs, key=lambda leg: leg.speed)
    assert fastest.phase == "carry"
    assert fastest.speed == pytest.approx(0.08)
