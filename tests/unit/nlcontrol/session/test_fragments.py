"""What is said in a few words takes the last command that fits, with these in place of its own."""

from __future__ import annotations

import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation

LEFT = {"direction": "left"}
RIGHT = {"direction": "right"}


@pytest.mark.parametrize(
    ("said", "name", "goal"),
    [
        ("Half that.", "mug", {**LEFT, "distance": 0.03}),
        ("Twice that.", "mug", {**LEFT, "distance": 0.12}),
        ("A third of that.", "mug", {**LEFT, "distance": 0.02}),
        ("Correction: 4 cm, not 6.", "mug", {**LEFT, "distance": 0.04}),
        ("8 cm instead of 6.", "mug", {**LEFT, "distance": 0.08}),
        ("That should have been 8.", "mug", {**LEFT, "distance": 0.08}),
        ("To the right instead of to the left.", "mug", {**RIGHT, "distance": 0.06}),
        ("The coffee box should have gone to the right.", "coffee box", RIGHT),
        ("For the coffee box, three centimetres.", "coffee box", {**LEFT, "distance": 0.03}),
        ("The coffee box, but only half as far.", "coffee box", {**LEFT, "distance": 0.03}),
        ("Now the coffee box, but the other way.", "coffee box", {**RIGHT, "distance": 0.06}),
        ("Same distance for the coffee box, opposite direction.", "coffee box", RIGHT),
        ("It should be 5 cm.", "mug", {**LEFT, "distance": 0.05}),
        ("Make the coffee box do that too.", "coffee box", {**LEFT, "distance": 0.06}),
        ("Same for the coffee box, only to the right.", "coffee box", {**RIGHT, "distance": 0.06}),
        ("Repeat with 40 mm.", "mug", {**LEFT, "distance": 0.04}),
        ("Could you push it back a little?", "mug", {**RIGHT, "amount": "little"}),
        ("Could the coffee box come a little closer as well, please?", "coffee box",
         {"direction": "toward", "amount": "little"}),
    ],
)  # fmt: skip
def test_a_fragment_takes_the_place_of_what_was_said(
    said: str, name: str, goal: dict[str, object]
) -> None:
    talk = Conversation(Controller("breakfast", seed=1))
    talk.say("push the mug to the left by 6 cm", plan_only=True)
    result = talk.say(said, plan_only=True)
    (frame,) = [each for each in result.frames if each not in result.aside]
    assert frame.object is not None
    assert frame.object.id == name
    meant = frame.goal.model_dump()
    assert {key: meant[key] for key in goal} == pytest.approx(goal)


def test_a_share_has_no_unit_of_its_own() -> None:
    talk = Conversation(Controller("breakfast", seed=1))
    talk.say("turn the mug by 30 degrees", plan_only=True)
    (frame,) = talk.say("Only a third.", plan_only=True).frames
    assert frame.goal.model_dump()["angle"] == pytest.approx(0.1745, abs=1e-4)  # 10 degrees


def test_what_is_taken_together_is_pushed_and_not_lifted() -> None:
    talk = Conversation(Controller("breakfast", seed=1))
    said = "take the coffee box and the sugar box and push each of them 6 cm to the right"
    frames = talk.say(said, plan_only=True).frames
    assert [frame.action for frame in frames] == ["push", "push"]
    assert [frame.object and frame.object.id for frame in frames] == ["coffee box", "sugar box"]
