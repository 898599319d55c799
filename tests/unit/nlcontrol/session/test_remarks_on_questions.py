"""A remark on any question ends in a result; what frames say has words, or is told to have none."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import pytest
import yaml

import grammar
from grammar.frames import command as g
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.remarks.follow_up_targets import by_name, without_spans

COMMANDS = Path(__file__).parents[3] / "data" / "commands"

QUESTIONS = (
    "which one is the biggest?",
    "which box is the heaviest?",
    "which is heavier, the mug or the tea tin?",
    "how heavy is the mug?",
    "how far is the mug from the tea tin?",
    "is the mug next to the tea tin?",
    "is the mug standing?",
    "where is the mug?",
    "which of them can you push?",
    "can you push the mug to the left?",
    "how hard do you have to push the mug?",
    "where do I have to push the mug to topple it?",
    "what would happen if you pushed the mug?",
    "will the mug topple if you push it?",
    "where will the mug be if you push it?",
    "what do you see?",
    "what did you do?",
)
REMARKS = (
    "again",
    "and the soup can?",
    "more",
    "no, the soup can",
    "do it",
    "why?",
    "the other way",
)
"""One of each way in which a remark goes on."""


@pytest.mark.parametrize("question", QUESTIONS)
def test_remarks_on_a_question_end_in_a_result(question: str) -> None:
    conversation = Conversation(Controller("counter", seed=1))
    for remark in REMARKS:
        asked = conversation.say(question, plan_only=True)
        told = conversation.say(remark, plan_only=True)
        assert asked.error is None or asked.error.code != "internal", remark
        assert told.error is None or told.error.code != "internal", remark


def test_again_asks_the_same_of_the_biggest() -> None:
    conversation = Conversation(Controller("counter", seed=1))
    first = conversation.say("which one is the biggest?", plan_only=True)
    again = conversation.say("again", plan_only=True)
    assert again.status == "answered"
    assert again.frames[0].object is not None
    assert again.frames[0].object.id == "tea tin"
    assert again.paraphrase == first.paraphrase


def _resolved(ref: g.ObjectRef) -> g.ObjectRef:
    return by_name(ref.model_copy(update={"id": "mug"}))


def _sentences() -> list[str]:
    rows = (row for path in COMMANDS.glob("*") for row in yaml.safe_load(path.read_text("utf-8")))
    return [*QUESTIONS, *(row["text"] for row in rows)]


def test_frames_with_resolved_objects_have_words_or_none() -> None:
    for text in _sentences():
        with suppress(grammar.ParseError):
            for frame in grammar.parse(text).frames:
                with suppress(ValueError):  # the language may have no words, and says so
                    assert grammar.paraphrase(without_spans(frame, _resolved))
