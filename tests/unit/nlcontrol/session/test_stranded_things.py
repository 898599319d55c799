"""What fell to where the hand does not get to it is told with the answer."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nlcontrol.results.result import Result
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.fallen_objects import fallen_things, unreachable_after_fall
from planner.types.refusal import Refusal
from planner.types.world_state import WorldState
from sim.supervision import StopToken

NO_REACH = Refusal(code="no_push_reached", reason="out_of_reach", message="out of reach")


@pytest.fixture(scope="module")
def toppled() -> tuple[Controller, Result]:
    controller = Controller("kitchen", seed=1)
    return controller, Conversation(controller).say("topple the ice tea box")


def test_what_fell_and_can_be_pushed_on_is_not_spoken_of(
    toppled: tuple[Controller, Result],
) -> None:
    _, result = toppled
    assert result.status == "done"
    assert result.trace is not None
    assert fallen_things(result.trace) == ["ice tea box"]
    assert result.notes == ()


def test_what_fell_out_of_reach_is_named_with_its_place(
    toppled: tuple[Controller, Result], monkeypatch: pytest.MonkeyPatch
) -> None:
    controller, result = toppled
    assert result.trace is not None
    asked = []

    def refuse(frame: Any, *_: Any, **__: Any) -> Refusal:
        asked.append(frame.goal.kind)
        return NO_REACH

    monkeypatch.setattr(controller, "planner", refuse)
    (told,) = unreachable_after_fall(controller, result.trace, controller.look, StopToken())
    assert "the ice tea box lies at x " in told
    assert asked == [*["displace"] * 4, "lift"]


def test_nothing_is_looked_through_when_nothing_fell(
    toppled: tuple[Controller, Result],
) -> None:
    controller, result = toppled
    assert result.trace is not None

    def no_look() -> WorldState:
        pytest.fail("nothing is looked for")

    seen = {
        name: np.repeat(poses[:1], len(poses), axis=0) for name, poses in result.trace.seen.items()
    }
    still = replace(result.trace, seen=seen)
    assert list(unreachable_after_fall(controller, still, no_look, StopToken())) == []
