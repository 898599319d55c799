"""How sure an answer is: the values that were told last, with where they come from."""

from __future__ import annotations

import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation


@pytest.fixture
def conversation() -> Conversation:
    return Conversation(Controller("kitchen", seed=1))


def _told(conversation: Conversation, said: str) -> str:
    answer = conversation.say(said, plan_only=True).answer
    assert answer is not None
    return answer.text


def test_a_value_is_told_with_its_source(conversation: Conversation) -> None:
    conversation.say("how heavy is the mug?")
    assert "mug weighs" in _told(conversation, "did you measure that or guess?")
    assert "source" in _told(conversation, "how do you know that?")


def test_both_values_of_a_comparison_are_told(conversation: Conversation) -> None:
    conversation.say("is the mug heavier than the cereal box?")
    told = _told(conversation, "are you certain?")
    assert "mug weighs" in told
    assert "cereal box weighs" in told


def test_what_is_seen_is_told_as_seen(conversation: Conversation) -> None:
    conversation.say("is the ice tea cup closed?")
    assert _told(conversation, "how sure are you?").startswith("That is what I see")


def test_before_any_answer_there_is_nothing_to_be_sure_of(conversation: Conversation) -> None:
    assert conversation.say("how sure are you?").status == "not_understood"
