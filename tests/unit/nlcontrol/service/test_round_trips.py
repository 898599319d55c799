"""Documents come back from JSON as they were."""

from __future__ import annotations

import pytest

from grammar.frames.command import Command
from nlcontrol.results.result import Result
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation

SENTENCES = (
    "push the ice tea box 20 cm to the left without toppling it",
    "turn the ice tea box 15 degrees to the left, then push the mug 5 cm away",
    "tilt the cereal box 5 degrees",
    "lift the mug",
    "push the mug 3 m away",
    "frobnicate the mug",
    "how heavy is the ice tea box?",
    "what happens if I push the cereal box at the top?",
    "why did you do that?",
)


@pytest.fixture(scope="module")
def controller() -> Controller:
    return Controller("kitchen")


@pytest.mark.parametrize("sentence", SENTENCES)
def test_results(controller: Controller, sentence: str) -> None:
    result = Conversation(controller).say(sentence, plan_only=True)
    back = Result.model_validate_json(result.to_json())
    assert back == Result.model_validate_json(back.to_json())
    assert back.to_json() == result.to_json()
    assert back.plan == result.plan
    assert back.frames == result.frames
    assert back.report() == result.report()


def test_commands(controller: Controller) -> None:
    command = controller.parse(SENTENCES[1])
    assert Command.model_validate_json(command.model_dump_json()) == command
