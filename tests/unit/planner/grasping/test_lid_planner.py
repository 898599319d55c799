"""Lids: flipped, lifted off, turned and put back, or refused with the forces that decide."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from objectmodels.containers.lids import flip
from objectmodels.identification.belief_update import belief_of_stiffer_lid
from objectmodels.models.object_parts import FlipLid, LiftOffLid
from planner import plan
from planner.types.actions import Carry, FlipOver, LiftUp, PutOn, TurnCap
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan, Reached
from planner.types.refusal import Refusal
from planner.types.robot import FailedHold
from planner.types.world_state import Held, PlanarPose, SeenObject, WorldState
from tests.unit.planner.conftest import frame_of, world
from tests.unit.planner.grasping.conftest import RuledHand, planned, refused


@pytest.fixture
def pantry() -> WorldState:
    """A cup with a flip lid, a jar with a lid that lifts off, a bottle with a cap."""
    return world(
        ice_tea_cup=PlanarPose(0.30, 0.20, 0.5),
        jar=PlanarPose(0.45, -0.10),
        water_bottle=PlanarPose(0.60, 0.30),
    )


def _with(state: WorldState, name: str, **changes: object) -> WorldState:
    seen: SeenObject = replace(state.objects[name], **changes)  # type: ignore[arg-type]
    return replace(state, objects={**state.objects, name: seen})


def test_a_flip_lid_is_opened_by_a_fingertip(pantry: WorldState, hand: RuledHand) -> None:
    made = planned("open the ice tea cup", pantry, hand)
    assert made.grasp is None
    (step,) = made.steps
    assert isinstance(step, FlipOver)
    assert (step.start, step.end) == (0.0, DEFAULTS.lid_open)
    assert step.heading == pytest.approx(0.5)
    found = step.prediction
    assert found.slide_force is not None
    assert found.topple_force is not None
    assert step.force_limit > found.lid_force
    cup = pantry.objects["ice tea cup"].model
    assert isinstance(cup.lid, FlipLid)
    arc = flip(cup, cup.lid, end=DEFAULTS.lid_open)
    assert arc.least_margin >= DEFAULTS.lid_reserve
    # Where the cup comes nearest to giving way, which need not be where the lid takes most.
    assert found.topple_force == pytest.approx(arc.topple[arc.weakest_index])
    assert found.nearest_force == pytest.approx(arc.force[arc.weakest_index])
    assert found.nearest_force < found.topple_force
    assert made.probability >= DEFAULTS.probability


def test_the_force_limit_is_what_the_cup_bears_where_the_lid_is(
    pantry: WorldState, hand: RuledHand
) -> None:
    (step,) = planned("open the ice tea cup", pantry, hand).steps
    assert isinstance(step, FlipOver)
    cup = pantry.objects["ice tea cup"].model
    assert isinstance(cup.lid, FlipLid)
    arc = flip(cup, cup.lid, end=DEFAULTS.lid_open)
    bears = np.minimum(arc.slide, arc.topple)
    at = np.linspace(step.start, step.end, len(step.force_limits))
    limits = np.array(step.force_limits)
    # Between two angles of the arc what it bears is about straight: to a hundredth of it.
    assert (limits <= 1.01 * np.interp(at, arc.angles, bears)).all()
    # The catch may take half as much again, which the open lid would tip the cup with.
    assert limits[0] == pytest.approx(1.5 * arc.largest_force)
    assert limits[-1] == pytest.approx(bears[-1])
    assert limits[-1] < arc.largest_force


def test_after_a_failed_try_the_next_is_harder_or_refused(
    pantry: WorldState, hand: RuledHand
) -> None:
    model, limits = pantry.objects["ice tea cup"].model, []
    for _ in range(8):
        made = plan(
            frame_of("open the ice tea cup"), _with(pantry, "ice tea cup", model=model), hand
        )
        if not isinstance(made, Plan):
            break
        (step,) = made.steps
        assert isinstance(step, FlipOver)
        limits.append(step.force_limit)
        model = belief_of_stiffer_lid(model, step.force_limit).model
    assert len(limits) >= 2
    assert np.diff(limits).min() > 0.0
    assert isinstance(made, Refusal)
    assert made.code in ("gives_way", "may_give_way")
    assert made.numbers["largest_lid_force"] > limits[-1] / 1.5


@pytest.mark.parametrize("text", ["open the ice tea cup", "lift the jar"])
def test_the_same_is_not_tried_a_third_time(text: str, pantry: WorldState, hand: RuledHand) -> None:
    made = planned(text, pantry, hand)
    once = (FailedHold(made, "the fingers slipped"),)
    assert plan(frame_of(text), pantry, hand, failed=once) == made
    again = plan(frame_of(text), pantry, hand, failed=2 * once)
    if isinstance(again, Plan):
        assert not once[0].repeats(again)
    else:
        assert made.grasp is None  # there is one way to flip a lid
        assert isinstance(again, Refusal)
        assert "the fingers slipped" in again.message


def test_a_cup_too_light_for_its_lid_is_refused_with_both_forces(
    pantry: WorldState, hand: RuledHand
) -> None:
    cup = pantry.objects["ice tea cup"].model
    lid = cup.lid
    assert isinstance(lid, FlipLid)
    stiff = cup.model_copy(update={"lid": lid.model_copy(update={"friction_torque": 0.06})})
    made = refused("open the ice tea cup", _with(pantry, "ice tea cup", model=stiff), hand)
    assert made.reason == "impossible"
    assert made.numbers["margin"] < DEFAULTS.lid_reserve
    assert made.numbers["lid_force"] > 0.0
    assert "tips at" in made.message
    # In a holder it neither slides nor topples.
    fixed = _with(pantry, "ice tea cup", model=stiff, fixed=True)
    (step,) = planned("open the ice tea cup", fixed, hand).steps
    assert isinstance(step, FlipOver)
    assert step.prediction.topple_force is None


@pytest.mark.parametrize(
    ("text", "name", "lid"),
    [
        ("open the ice tea cup", "ice tea cup", math.radians(85.0)),
        ("close the ice tea cup", "ice tea cup", 0.0),
        ("open the jar", "jar", 0.3),
        ("close the jar", "jar", 0.0),
    ],
)
def test_nothing_is_left_to_be_done(
    text: str, name: str, lid: float, pantry: WorldState, hand: RuledHand
) -> None:
    state = _with(pantry, name, lid=lid)
    assert plan(frame_of(text), state, hand) == Reached(lid=lid)


def test_an_open_flip_lid_is_closed(pantry: WorldState, hand: RuledHand) -> None:
    (step,) = planned("close the ice tea cup", _with(pantry, "ice tea cup", lid=1.6), hand).steps
    assert isinstance(step, FlipOver)
    assert (step.start, step.end) == (1.6, 0.0)


def test_a_lid_is_lifted_off_and_put_aside(pantry: WorldState, hand: RuledHand) -> None:
    made = planned("open the jar", pantry, hand)
    assert [step.kind for step in made.steps] == ["lift_up", "carry", "set_down"]
    assert made.grasp is not None
    assert made.grasp.part == "lid"
    assert made.grasp.approach_W == (0.0, 0.0, -1.0)
    pull, carry, _ = made.steps
    assert isinstance(carry, Carry)
    assert isinstance(pull, LiftUp)
    assert pull.prediction is not None
    jar = pantry.objects["jar"]
    # Free of the jar: both are 42 mm in radius.
    assert np.hypot(carry.to.x - jar.pose.x, carry.to.y - jar.pose.y) > 0.084
    # Retention 1.5 N and the lid's 60 g.
    assert pull.prediction.lid_force == pytest.approx(1.5 + 0.06 * 9.81, abs=1e-3)


@pytest.mark.parametrize(("apart", "free"), [(0.049, False), (0.052, True)])
def test_a_lid_lies_5_cm_from_what_stands_there(apart: float, free: bool, hand: RuledHand) -> None:
    jar, radius, can = PlanarPose(0.45, -0.10), 0.042, 0.033  # the radii of lid and soup can
    (first,) = [
        s for s in planned("open the jar", world(jar=jar), hand).steps if isinstance(s, Carry)
    ]
    place = np.array([first.to.x, first.to.y])
    way = place - [jar.x, jar.y]
    # Round outlines have corners, up to 0.4 mm outside of them.
    assert np.linalg.norm(way) - 2.0 * radius == pytest.approx(0.05, abs=0.0005)
    x, y = (place + (radius + apart + can) * way / np.linalg.norm(way)).tolist()
    beside = world(jar=jar, soup_can=PlanarPose(x, y))
    (then,) = [s for s in planned("open the jar", beside, hand).steps if isinstance(s, Carry)]
    assert (then.to == first.to) == free


def test_a_lid_goes_back_from_where_it_lies(pantry: WorldState, hand: RuledHand) -> None:
    off = _with(pantry, "jar", lid=0.3)
    assert "not seen" in refused("close the jar", off, hand).message
    lies = _with(pantry, "jar", lid=0.3, lid_at=(0.6, 0.0, 0.0))
    made = planned("close the jar", lies, hand)
    assert [step.kind for step in made.steps] == ["lift_up", "carry", "put_on"]
    carry, on = made.steps[1:]
    assert isinstance(carry, Carry)
    assert (carry.to.x, carry.to.y) == pytest.approx((0.45, -0.10))
    assert isinstance(on, PutOn)
    assert on.onto == "jar"
    # Fingers of a friction of 0.55 bear the 3 N that press it on.
    assert made.grasp is not None
    assert made.grasp.squeeze > on.press / (2 * 0.55)


def test_a_cap_that_is_off_is_not_set_on_its_thread(pantry: WorldState, hand: RuledHand) -> None:
    off = _with(pantry, "water bottle", fixed=True, lid=math.tau)
    made = refused("screw the cap back on the water bottle", off, hand)
    assert made.status == "unsupported"
    assert "thread" in made.message
    loose = _with(pantry, "water bottle", fixed=True, lid=2.0)
    (step,) = planned("close the water bottle", loose, hand).steps
    assert isinstance(step, TurnCap)
    assert step.angle == pytest.approx(-2.0)


def test_a_hand_that_holds_the_object_does_not_open_it(pantry: WorldState, hand: RuledHand) -> None:
    body = planned("lift the jar", pantry, hand).grasp
    assert body is not None
    lifted = replace(pantry, held=Held("jar", body, 0.1))
    made = refused("open the jar", lifted, hand)
    assert made.message == "the hand holds the jar: put it down first"


def test_a_lid_is_held_where_the_fingertips_find_room(pantry: WorldState, hand: RuledHand) -> None:
    jar = pantry.objects["jar"].model
    assert isinstance(jar.lid, LiftOffLid)
    grasp = planned("open the jar", pantry, hand).grasp
    assert grasp is not None
    grip = hand.grasp(grasp.width, pinch=True)
    assert grip is not None
    assert grasp.p_BG[2] > jar.top + jar.lid.height + grip.ahead
    flat = jar.model_copy(update={"lid": jar.lid.model_copy(update={"knob_height": 0.015})})
    made = refused("open the jar", _with(pantry, "jar", model=flat), hand)
    assert made.reason == "impossible"
    assert made.numbers["height"] == pytest.approx(0.015)
    assert made.numbers["needed"] > 0.015


def test_a_cap_takes_a_holder(pantry: WorldState, hand: RuledHand) -> None:
    made = refused("open the water bottle", pantry, hand)
    assert made.reason == "impossible"
    assert made.numbers["needed"] == pytest.approx(0.06)
    # μ G c̄ of the free bottle.
    assert made.numbers["held"] < made.numbers["needed"]
    assert "N·m" in made.message
    known = pantry.objects["water bottle"].model.model_copy(update={"finger_friction_sd": 0.05})
    fixed = _with(pantry, "water bottle", model=known, fixed=True)
    opened = planned("open the water bottle", fixed, hand)
    assert [step.kind for step in opened.steps] == ["turn_cap", "lift_up", "carry", "set_down"]
    turn = opened.steps[0]
    assert isinstance(turn, TurnCap)
    assert turn.angle == pytest.approx(math.tau)
    assert turn.torque_limit > 0.06
    assert turn.prediction.turning_torque is None


def test_what_has_no_lid(table: WorldState, hand: RuledHand) -> None:
    assert refused("open the mug", table, hand).message == "the mug has no lid"


def test_less_force_than_the_lid_takes(pantry: WorldState, hand: RuledHand) -> None:
    made = refused("open the ice tea cup with at most 0.2 N", pantry, hand)
    assert made.numbers["allowed_force"] == 0.2
    assert made.spans
