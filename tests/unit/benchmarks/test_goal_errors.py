"""How far off a step ended, from poses made by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from benchmarks.goals.final import final
from planner.types.actions import Aim, LiftUp, Push
from tests.plans import push_plan
from tests.unit.benchmarks.box_traces import BOX, frame, trace

PUSH = Push(
    object=BOX, face="front", p_BC=(0.0, 0.0, 0.03), normal_W=(-1.0, 0.0, 0.0),
    direction_W=(1.0, 0.0, 0.0), force_limit=5.0, speed=0.05, stroke=0.1, fingers=1, spread=0.0,
    ends_on="stroke",
)  # fmt: skip
PLAN = push_plan(PUSH, aim=Aim(x=0.6, y=0.1, yaw=0.5))


@pytest.mark.parametrize(
    ("words", "moved", "expected"),
    [
        ("push {} 10 cm away", {"x": 0.103, "y": 0.002}, {"along": 0.003, "across": 0.002}),
        ("push {} 10 cm to the left", {"x": 0.002, "y": 0.1}, {"along": 0.0, "across": -0.002}),
        ("push {} a little away", {"x": 0.05}, {"along": 0.0, "across": 0.0}),
        ("push {} at least 10 cm away", {"x": 0.2}, {"across": 0.0}),
    ],
)
def test_displacements(words: str, moved: dict[str, float], expected: dict[str, float]) -> None:
    errors = final(frame(words), trace(**moved, yaw=0.1), PLAN)
    assert errors == pytest.approx({**expected, "yaw": 0.1})


def test_what_a_hand_does_has_no_errors_of_a_push() -> None:
    lifted = PLAN.model_copy(update={"task": "lift", "actions": (LiftUp(height=0.1),)})
    assert final(frame("lift {} 10 cm"), trace(), lifted) == {}


def test_a_round_thing_has_no_yaw() -> None:
    errors = final(frame("push {} 10 cm away"), trace(x=0.1, yaw=0.1), PLAN, turns=False)
    assert set(errors) == {"along", "across"}


def test_a_turn() -> None:
    errors = final(frame("turn {} 45 degrees clockwise"), trace(x=0.003, y=0.004, yaw=-0.8), PLAN)
    assert errors == pytest.approx({"turn": math.radians(45.0) - 0.8, "drift": 0.005})


def test_a_place_that_is_said_and_one_that_was_aimed_at() -> None:
    done = trace(x=0.1, y=0.1, yaw=0.52)
    said = final(frame("push {} to x 0.6 y 0.13"), done, PLAN)
    assert said == pytest.approx({"off": 0.03, "yaw": 0.02})
    assert final(frame("push {} to the middle of the table"), done, PLAN)["off"] < 1e-9


def test_where_two_meet_is_left_open() -> None:
    words = "push {} against the mug"
    assert final(frame(words), trace(x=0.1, y=0.0), PLAN) == {}


def test_a_tilt_there_and_back() -> None:
    errors = final(frame("tilt {} by 10 degrees"), trace(tilts=math.radians(11.0)), PLAN)
    # The largest of fifty samples of a sine.
    assert errors == pytest.approx(
        {"angle": math.radians(1.0), "back": 0.0, "drift": 0.0}, abs=2e-4
    )


def test_a_tilt_drifts_while_it_is_tilted() -> None:
    done = trace(x=0.02, tilts=math.radians(11.0))
    phase = done.phase.copy()
    phase[30:40] = "look"  # between two pushes, the second of which begins after 40 of 49 parts
    turned_first = replace(done, phase=phase)
    errors = final(frame("tilt {} by 10 degrees"), turned_first, PLAN)
    assert errors["drift"] == pytest.approx(0.02 * 9 / 49)


def test_a_topple() -> None:
    fell = trace(tilts=math.radians(90.0))
    assert final(frame("topple {} to the left"), fell, PLAN) == pytest.approx({"side": 0.0})
    aside = final(frame("topple {} away"), fell, PLAN)["side"]
    assert aside == pytest.approx(math.radians(90.0))
    assert final(frame("topple {} away"), trace(), PLAN) == {}
    assert final(frame("push {} 10 cm away"), fell, PLAN) == {}


def test_an_event_has_no_error() -> None:
    assert final(frame("push {} away until it moves"), trace(x=0.01), PLAN) == {}
