"""Gaps and amounts put right, what is nearer, and "it" after a place that is missing."""

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


LEFT = "push the mug 6 cm to the left"
BESIDE = "put the mug next to the coffee box"


@pytest.mark.parametrize(
    ("before", "said", "goal"),
    [
        (LEFT, "not 6, 4 cm", {"direction": "left", "distance": 0.04}),
        (LEFT, "sorry, 4 cm, in the same direction", {"direction": "left", "distance": 0.04}),
        (LEFT, "4 is plenty", {"direction": "left", "distance": 0.04}),
        (BESIDE, "no, keep five centimetres between the two", {"distance": 0.05}),
        (BESIDE, "leave some space, 5 cm or so", {"relation": "next_to", "distance": 0.05}),
        ("move the mug toward the coffee box", "not so near, leave 5 cm", {"relation": "next_to"}),
        (BESIDE, "no, behind", {"relation": "behind"}),
        (BESIDE, "well, perhaps left of it would be better", {"relation": "left_of"}),
        ("pour half of the ice tea into the mug", "or rather 40 ml", {"volume": 0.00004}),
        ("pour 90 ml of the ice tea into the mug", "make it 40", {"volume": 0.00004}),
    ],
)
def test_only_what_is_put_right_is_other(
    conversation: Conversation, before: str, said: str, goal: dict[str, Any]
) -> None:
    assert goal.items() <= _only(_last(conversation, before, said)).goal.model_dump().items()


def test_nearer_is_nearer_to_what_it_was_put_beside(conversation: Conversation) -> None:
    goal = _only(_last(conversation, BESIDE, "a little nearer")).goal
    assert goal.model_dump()["toward"]["id"] == "coffee box"
    goal = _only(_last(conversation, "a little nearer to me")).goal
    assert goal.model_dump()["direction"] == "toward"


def test_it_is_what_was_to_go_to_a_place_that_is_missing(conversation: Conversation) -> None:
    said = ("push the coffee box away", "put the mug in the bin", "put it left of the cereal box")
    moved = _only(_last(conversation, *said)).object
    assert moved is not None
    assert moved.id == "mug"


def test_the_same_is_asked_of_another_object(conversation: Conversation) -> None:
    asked = _only(_last(conversation, "how heavy is the mug?", "now the same with the coffee box"))
    assert asked.query == "value"
    assert asked.object is not None
    assert asked.object.id == "coffee box"


@pytest.mark.parametrize("said", ["50 ml", "no, 50 ml"])
def test_an_amount_of_liquid_is_refused_after_a_push(conversation: Conversation, said: str) -> None:
    assert _last(conversation, LEFT, said).status == "not_understood"


@pytest.mark.parametrize(
    ("said", "query"),
    [
        ("it will not tip over, will it?", "predict"),
        ("and could you lift it, if you needed to?", "possible"),
    ],
)
def test_a_question_in_doubt_does_nothing(
    conversation: Conversation, said: str, query: str
) -> None:
    assert _only(_last(conversation, LEFT, said)).query == query


@pytest.mark.parametrize("said", ["may I have the mug?"])
def test_who_asks_for_a_thing_wants_it_handed_over(conversation: Conversation, said: str) -> None:
    assert _only(_last(conversation, LEFT, said)).action == "hand_over"
