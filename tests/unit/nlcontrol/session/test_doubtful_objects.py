"""Objects that were spoken of: told apart by an answer, or in doubt, so that it is asked back."""

from __future__ import annotations

import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.remarks.follow_up_targets import asks


@pytest.mark.parametrize(
    ("said", "lighter", "other"),
    [
        ("the lighter one", "tea tin", "cereal box"),
        ("the heavier one", "cereal box", "tea tin"),
    ],
)
def test_what_an_answer_ranked_is_told_apart_by_it(said: str, lighter: str, other: str) -> None:
    talk = Conversation(Controller("workbench", seed=1))
    answer = talk.say("is the cereal box heavier than the tin?", plan_only=True).answer
    assert answer is not None
    assert answer.objects == ("cereal box",)
    for words, name in ((said, lighter), ("the other one", other)):
        (frame,) = talk.say(f"push {words} 2 cm to the left", plan_only=True).frames
        assert frame.object is not None
        assert frame.object.id == name


def test_what_no_answer_ranked_is_asked_back_if_it_is_about_as_heavy() -> None:
    talk = Conversation(Controller("workbench", seed=1))
    talk.say("is the cereal box taller than the tin?", plan_only=True)
    doubtful = talk.say("tilt the lighter one by 5 degrees", plan_only=True)
    assert doubtful.error is not None
    assert doubtful.error.code == "ambiguous_object"


def test_it_is_asked_back_after_an_object_was_told_apart_by_one_that_is_unknown() -> None:
    talk = Conversation(Controller("pantry", seed=1))
    talk.say("remove the lid from the jar", plan_only=True)
    talk.say("unscrew the cap of the bottle in the holder", plan_only=True)
    closed = talk.say("close it again", plan_only=True)
    assert closed.error is not None
    assert closed.error.code == "no_antecedent"


def test_a_synonym_in_what_was_not_understood_is_what_it_may_mean() -> None:
    talk = Conversation(Controller("kitchen", seed=1))
    talk.say("push the mug 2 cm to the left", plan_only=True)
    talk.say("the carton glorps sadly", plan_only=True)
    (frame,) = talk.say("turn it by 5 degrees", plan_only=True).frames
    assert frame.object is not None
    assert frame.object.id == "ice tea"


def test_a_statement_is_not_taken_for_a_name() -> None:
    talk = Conversation(Controller("breakfast", seed=1))
    result = talk.say("The bottle can break. Push it 2 cm to the left.", plan_only=True)
    assert result.error is not None
    assert result.error.code == "unknown_object"
    assert result.plan is None


def test_it_is_asked_back_after_a_question_for_the_most_that_was_not_read() -> None:
    talk = Conversation(Controller("kitchen", seed=1))
    assert talk.say("push the mug to the left by 10 cm", plan_only=True).status == "planned"
    assert talk.say("heaviest thingummy over yonder?", plan_only=True).status == "not_understood"
    pushed = talk.say("push it away from you", plan_only=True)
    assert pushed.error is not None
    assert pushed.error.code == "no_antecedent"


def test_a_request_is_no_question() -> None:
    assert asks("would you move it?")
    assert not asks("Would you do me a favour and put the can there?")
