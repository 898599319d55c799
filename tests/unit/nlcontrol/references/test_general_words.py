"""Things by what they are where none is called so: the carton, the red tin, the loose one."""

from __future__ import annotations

import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation


@pytest.mark.parametrize(
    ("scene", "text", "name"),
    [
        ("kitchen", "push the big carton away", "ice tea box"),
        ("kitchen", "push the little carton away", "ice tea"),
        ("kitchen", "push the red carton away", "cereal box"),
        ("counter", "push the red tin away", "soup can"),
        ("counter", "push the blue cup away", "mug"),
        ("pantry", "push the loose bottle to the left", "free bottle"),
        ("pantry", "push the one that isn't fixed to the left", "free bottle"),
        ("pantry", "push the lidded cup away", "ice tea cup"),
    ],
)
def test_a_general_word_fits_what_is_so(scene: str, text: str, name: str) -> None:
    result = Conversation(Controller(scene, seed=1)).say(text, plan_only=True)
    assert [frame.object and frame.object.id for frame in result.frames] == [name]


@pytest.mark.parametrize(
    ("scene", "text"),
    [
        ("pantry", "push the container away"),
        ("workbench", "push all three boxes away"),
        ("workbench", "push all three away"),
    ],
)
def test_of_several_that_fit_none_is_guessed(scene: str, text: str) -> None:
    result = Conversation(Controller(scene, seed=1)).say(text, plan_only=True)
    assert result.status == "not_understood"


def test_everything_on_a_side_is_all_that_stands_there() -> None:
    result = Conversation(Controller("breakfast", seed=1)).say(
        "push everything on the left away", plan_only=True
    )
    assert {frame.object and frame.object.id for frame in result.frames} == {
        "cereal box",
        "water bottle",
    }


def test_those_two_are_the_two_that_were_spoken_of() -> None:
    conversation = Conversation(Controller("counter", seed=1))
    for text in ("push the mug to the left", "push the tin away"):
        conversation.say(text, plan_only=True)
    result = conversation.say("push those two to the right", plan_only=True)
    assert {frame.object and frame.object.id for frame in result.frames} == {"mug", "tea tin"}


def test_of_three_that_were_spoken_of_those_two_are_none() -> None:
    conversation = Conversation(Controller("counter", seed=1))
    for text in ("push the mug to the left", "push the tin away", "push the can away"):
        conversation.say(text, plan_only=True)
    assert conversation.say("push those two to the right", plan_only=True).error is not None
