"""Drags from above: when they are planned, how hard they press, and why not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from planner import plan
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan
from planner.types.refusal import Refusal
from planner.types.world_state import PlanarPose, WorldState
from tests.unit.planner.conftest import RuledReach, frame_of, planned, refused, world

LEFT = "push the book 10 cm to the left"


def hand(most: float = 30.0) -> RuledReach:
    """A hand that presses, with so much at most."""
    return RuledReach(max_press=most)


def book(**beliefs: float) -> WorldState:
    state = world(book=PlanarPose(0.45, -0.1, 0.2))
    seen = state.objects["book"]
    model = seen.model.model_copy(update=beliefs)
    return replace(state, objects={"book": replace(seen, model=model)})


def test_a_flat_thing_is_drawn_straight_to_its_aim() -> None:
    made = planned(LEFT, book(), hand())
    push = made.push
    assert (push.face, push.fingers, len(made.pushes)) == ("top", 1, 1)
    np.testing.assert_allclose(push.direction_W, (0.0, 1.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(push.p_BC, (0.0, 0.0, 0.03), atol=1e-12)
    assert push.stroke == pytest.approx(0.1)
    # Its frictions are not known well enough for the usual probability.
    assert made.probability == pytest.approx(DEFAULTS.drag_probability, abs=1e-3)
    assert "25 mm" in made.notes[0]


def test_what_is_known_is_pressed_less_and_more_surely() -> None:
    known = planned(LEFT, book(friction_sd=0.01, finger_friction_sd=0.02, mass_sd=0.01), hand())
    assert known.probability == pytest.approx(DEFAULTS.probability, abs=1e-3)
    model = book().objects["book"].model
    least = model.friction * model.weight / (model.finger_friction - model.friction)
    assert least < known.push.press < 1.3 * least
    assert known.push.press < planned(LEFT, book(), hand()).push.press


@pytest.mark.parametrize(
    ("state", "most", "code"),
    [
        (book(), 12.0, "drag_slips"),
        (book(), 5.0, "press_too_weak"),
        (book(finger_friction=0.25), 30.0, "finger_too_smooth"),
    ],
)
def test_what_does_not_go_along_is_refused_with_what_decides(
    state: WorldState, most: float, code: str
) -> None:
    found = refused(LEFT, state, hand(most))
    assert found.code == code
    if code == "press_too_weak":
        assert found.numbers["needed_force"] == pytest.approx(6.38, abs=0.01)
        assert found.numbers["max_press"] == most


def test_a_force_that_is_said_holds_as_the_fingertip_lands() -> None:
    grip = planned(LEFT, book(), hand()).push.force_limit
    # Half as much again is felt as the finger begins to slide along.
    assert planned(f"{LEFT} with at most {1.6 * grip:.2f} N", book(), hand())
    found = refused(f"{LEFT} with at most {1.4 * grip:.2f} N", book(), hand())
    assert found.code == "force_not_allowed"
    assert found.numbers["needed_force"] == pytest.approx(1.5 * grip)


def test_sides_come_first_unless_the_top_is_said(kitchen: WorldState) -> None:
    assert planned("push the coffee box 5 cm away", kitchen, hand()).push.press == 0.0
    tall = refused("push the coffee box 5 cm away on its top face", kitchen, hand())
    assert tall.code == "drag_tips"


def test_what_stands_in_the_way_or_turns_refuses_it() -> None:
    beside = world(book=PlanarPose(0.45, -0.1), ice_tea_box=PlanarPose(0.45, 0.12))
    assert refused(LEFT + " on its top face", beside, hand()).code == "in_the_way"
    assert refused("turn the book by 90 degrees", book(), hand()).code != "drag_slips"


@pytest.mark.parametrize(("room", "code"), [(0.0045, "no_top_to_press"), (0.0055, None)])
def test_the_fingertip_presses_5_mm_from_the_edge_of_a_top(room: float, code: str | None) -> None:
    state = book()
    seen = state.objects["book"]
    # Of the 150 mm of the book nearly all of its weight is at one end.
    model = seen.model.model_copy(update={"com": (0.075 - room, 0.0, 0.015)})
    made = plan(
        frame_of(LEFT + " on its top face"),
        replace(state, objects={"book": replace(seen, model=model)}),
        hand(),
    )
    assert (made.code if isinstance(made, Refusal) else None) == code
    if isinstance(made, Plan):
        assert made.push.press > 0.0


def test_an_open_top_is_not_pressed() -> None:
    state = world(mug=PlanarPose(0.45, 0.0))
    assert (
        refused("push the mug 5 cm away on its top face", state, hand()).code == "no_top_to_press"
    )


def test_the_aim_of_the_plan_before_is_kept() -> None:
    first = planned(LEFT, book(), hand())
    state = book()
    seen = state.objects["book"]
    nearly = replace(seen, pose=replace(seen.pose, y=seen.pose.y + 0.09))
    rest = plan(frame_of(LEFT), replace(state, objects={"book": nearly}), hand(), previous=first)
    assert isinstance(rest, Plan)
    assert rest.aim == first.aim
    assert rest.push.stroke == pytest.approx(0.01)


def test_a_drag_that_slipped_is_not_tried_again() -> None:
    from planner.types.robot import FailedPush

    first = planned(LEFT, book(), hand())
    failed = (FailedPush(first.push, "the fingertip slips over it"),)
    again = plan(frame_of(LEFT), book(), hand(), failed=failed)
    assert isinstance(again, Refusal)
    assert not isinstance(again, Plan)
