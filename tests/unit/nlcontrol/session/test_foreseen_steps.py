"""Several steps are planned to their end before anything moves."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from nlcontrol.session import foresight, step_search
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.foresight import lasting_lift
from planner.types.defaults import CLEARED, DEFAULTS
from planner.types.plan import Plan, PlanningResult
from sim.simulated_executor import simulation


def test_a_later_step_that_cannot_be_done_is_told_before_anything_moves() -> None:
    controller = Controller("kitchen")
    result = Conversation(controller).say("topple the ice tea box, then lift it by 5 cm")
    assert (result.status, result.exit_status) == ("refused", 4)
    assert result.error is not None
    assert result.error.code == "impossible"
    assert "nothing is moved: after “topple the ice tea box”" in result.error.message
    assert not simulation(controller.executor).is_built
    assert [step.plan for step in result.steps] == [None]


@pytest.mark.parametrize("then", ["push it 5 cm to the left", "topple it"])
def test_a_first_step_is_planned_as_if_it_were_alone(then: str) -> None:
    controller = Controller("kitchen")
    alone = Conversation(controller).say("push the ice tea box 5 cm away", plan_only=True)
    result = Conversation(controller).say(
        f"push the ice tea box 5 cm away, then {then}", plan_only=True
    )
    assert isinstance(result.plan, Plan)
    assert result.plan == alone.plan


def test_something_is_held_so_that_it_can_be_put_down() -> None:
    controller = Controller("kitchen")
    alone = Conversation(controller).say("pick up the mug", plan_only=True).plan
    both = (
        Conversation(controller)
        .say("pick up the mug and put it next to the coffee box", plan_only=True)
        .plan
    )
    assert alone is not None
    assert both is not None
    assert alone.grasp is not None
    assert both.grasp is not None
    # The grasp that is best for a lift alone would bring the hand into the coffee box.
    assert both.grasp.closing_W != alone.grasp.closing_W


def test_a_lift_for_what_comes_after_it_is_looked_for_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = []

    def noted(*args: Any) -> PlanningResult:
        asked.append(args)
        return lasting_lift(*args)

    for module in (foresight, step_search):
        monkeypatch.setattr(module, "lasting_lift", noted)
    # Nothing may be moved, so every round of the search for other steps begins alike.
    controller = Controller("kitchen", defaults=replace(DEFAULTS, clear=CLEARED.index("no")))
    result = Conversation(controller).say(
        "pick up the mug and put it at x 0.9 y 0.5", plan_only=True
    )
    assert result.status == "refused"
    assert len(asked) == 1
