"""What is toppled and could not be stood up again is told before it is toppled."""

from __future__ import annotations

import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation

TOLD = "where it will lie I could not stand it up again"


def is_told(name: str) -> bool:
    plan = Conversation(Controller("kitchen")).say(f"topple the {name}", plan_only=True).plan
    assert plan is not None
    return any(TOLD in note for note in plan.notes)


@pytest.mark.parametrize(("name", "told"), [("ice tea box", True), ("coffee box", False)])
def test_what_will_not_stand_up_again_is_told(name: str, told: bool) -> None:
    assert is_told(name) == told


@pytest.mark.slow
def test_what_was_told_comes_true() -> None:
    talk = Conversation(Controller("kitchen"))
    assert talk.say("topple the ice tea box").status == "done"
    assert talk.say("stand it up", plan_only=True).status == "refused"
