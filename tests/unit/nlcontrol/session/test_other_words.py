"""What is said in few words is meant as in many, after what was said before it."""

from __future__ import annotations

from typing import Any

import pytest

from grammar.frames.command import Frame
from nlcontrol.results.result import Result
from nlcontrol.session.conversation import Conversation


def _last(conversation: Conversation, *said: str) -> Result:
    """The result of the last of some sentences, each of them planned."""
    return [conversation.say(text, plan_only=True) for text in said][-1]


def _only(result: Result) -> Frame:
    (frame,) = result.frames
    return frame


LEFT = "push the mug 3 cm to the left"


@pytest.mark.parametrize(
    ("before", "said", "goal"),
    [
        (LEFT, "make it 4", {"distance": 0.04}),
        (LEFT, "hmm, maybe 4", {"distance": 0.04}),
        (LEFT, "no, just half of it", {"distance": 0.015}),
        (LEFT, "twice as far", {"distance": 0.06}),
        ("turn the mug by 30 degrees", "only half as far", {"angle": 0.261799}),
        ("put the mug left of the cereal box", "to the other side", {"relation": "right_of"}),
    ],
)
def test_what_is_left_out_is_as_it_was_said(
    conversation: Conversation, before: str, said: str, goal: dict[str, Any]
) -> None:
    frame = _only(_last(conversation, before, said))
    assert frame.object is not None
    assert frame.object.id == "mug"
    found = frame.goal.model_dump()
    assert {key: found[key] for key in goal} == pytest.approx(goal, abs=1e-6)


@pytest.mark.parametrize(
    ("before", "said"),
    [
        ("push the mug 3 cm to the left with one finger", "I meant 2"),  # fingers?
        ("push the mug 3 cm to the left with at most 4 N", "make it 2"),
        ("push the mug to the left", "make it 2"),
        ("push the mug to the left", "half as far"),
        (LEFT, "and to the coffee box"),
    ],
)
def test_of_two_meanings_none_is_guessed(
    conversation: Conversation, before: str, said: str
) -> None:
    assert _last(conversation, before, said).status == "not_understood"


def test_an_amount_has_the_unit_of_the_one_before_it_in_the_sentence(
    conversation: Conversation,
) -> None:
    said = "push the mug 5 cm away and then to the right by three"
    goals = [frame.goal.model_dump() for frame in _last(conversation, said).frames]
    assert [goal["distance"] for goal in goals] == [0.05, 0.03]


def test_a_unit_is_kept_over_a_question_that_was_not_read(conversation: Conversation) -> None:
    frame = _only(_last(conversation, LEFT, "is the mug any glorp?", "make it 4"))
    assert frame.goal.model_dump()["distance"] == 0.04


def test_which_way_asks_for_no_object(conversation: Conversation) -> None:
    frame = _only(_last(conversation, LEFT, "which way would it glorp?", "turn it by 5 degrees"))
    assert frame.object is not None
    assert frame.object.id == "mug"


def test_just_one_of_both_is_meant_alone(conversation: Conversation) -> None:
    both = "push the mug and the coffee box 3 cm to the left"
    frame = _only(_last(conversation, both, "just the coffee box"))
    assert frame.object is not None
    assert frame.object.id == "coffee box"


def test_the_same_is_all_that_was_done_to_one_thing(conversation: Conversation) -> None:
    both = "push the mug 5 cm away, then 3 cm to the left"
    frames = _last(conversation, both, "the same with the coffee box").frames
    assert [frame.object and frame.object.id for frame in frames] == ["coffee box"] * 2


def test_a_thing_and_where_to_is_moved_there(conversation: Conversation) -> None:
    frame = _only(_last(conversation, "mug 10 cm to the left, please"))
    assert (frame.action, frame.object and frame.object.id) == ("move", "mug")


def test_what_was_done_first_is_told_and_spoken_of(conversation: Conversation) -> None:
    told = _last(conversation, LEFT, "push the coffee box away", "which one did you move first?")
    assert told.answer is not None
    assert told.answer.objects == ("mug",)
    last = _last(conversation, "and what did you move last?")
    assert last.answer is not None
    assert (last.answer.objects, len(last.answer.lines)) == (("coffee box",), 1)


def test_a_command_begun_anew_takes_back_its_beginning(conversation: Conversation) -> None:
    frame = _only(_last(conversation, "push the, no, pull the coffee box 3 cm toward you"))
    assert (frame.action, frame.object and frame.object.id) == ("pull", "coffee box")


def test_the_same_after_a_command_that_was_not_read_is_asked_back(
    conversation: Conversation,
) -> None:
    asked = _last(conversation, LEFT, "push the glorp with the mug", "the coffee box too")
    assert asked.status == "not_understood"
