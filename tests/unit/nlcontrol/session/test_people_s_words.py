"""Questions, amounts and corrections as different people put them."""

from __future__ import annotations

import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation


@pytest.mark.parametrize(
    ("scene", "before", "text", "query"),
    [
        ("kitchen", "", "Heaviest thing on the table?", "compare"),
        ("kitchen", "", "Suppose I pushed the ice tea box near the top, would it fall?", "predict"),
        ("pantry", "", "Could the free bottle tip if you pushed it near the cap?", "predict"),
        ("kitchen", "put the mug next to the coffee box", "How far apart are they now?", "value"),
        ("counter", "", "Is it the tin or the can that weighs more?", "compare"),
        ("workbench", "push the coffee box away", "What friction do you assume for it?", "value"),
        ("workbench", "tilt the cereal box 5°", "At what force does it start to tip?", "how_hard"),
        ("pantry", "open the jar", "Would you be able to shut it again later?", "possible"),
        ("kitchen", "", "Are you strong enough to lift the mug?", "possible"),
        ("counter", "push the mug 3 cm to the left", "It won't fall over, will it?", "predict"),
        ("counter", "", "Could you lift the mug, if you had to?", "possible"),
        ("breakfast", "how heavy is the sugar box?", "How tall is this box?", "value"),
        ("counter", "push the tin 2 cm away", "Tell me, how far away is the can?", "value"),
        ("kitchen", "put the mug behind the coffee box", "Is there enough space?", "possible"),
    ],
)
def test_a_question_in_any_words_is_answered(
    scene: str, before: str, text: str, query: str
) -> None:
    talk = Conversation(Controller(scene, seed=1))
    if before:
        talk.say(before, plan_only=True)
    answer = talk.say(text, plan_only=True).answer
    assert answer is not None
    assert answer.query == query


@pytest.mark.parametrize(
    ("scene", "before", "text", "goal"),
    [
        ("workbench", "push the coffee box 20 cm to the left", "Increase that to 25.",
         {"distance": 0.25, "direction": "left"}),
        ("workbench", "tilt the cereal box by 5 degrees toward you", "Make the angle 8 degrees.",
         {"angle": pytest.approx(0.139626, abs=1e-6)}),
        ("breakfast", "put the sugar box to the left of the coffee box",
         "I said left, but I meant right.", {"relation": "right_of"}),
        ("kitchen", "put the coffee box next to the cereal box",
         "Wait, no, not next to it. Behind it.", {"relation": "behind"}),
    ],
)  # fmt: skip
def test_what_is_put_right_takes_the_place_of_what_was_said(
    scene: str, before: str, text: str, goal: dict[str, object]
) -> None:
    talk = Conversation(Controller(scene, seed=1))
    first = talk.say(before, plan_only=True)
    (frame,) = talk.say(text, plan_only=True).frames
    assert frame.object is not None
    assert first.frames[0].object is not None
    assert frame.object.id == first.frames[0].object.id
    assert goal.items() <= frame.goal.model_dump().items()


@pytest.mark.parametrize("text", ["Not the jar, the cup.", "The cup, not the jar."])
def test_what_is_not_meant_may_be_the_place(text: str) -> None:
    talk = Conversation(Controller("pantry", seed=1))
    talk.say("put the mug next to the jar", plan_only=True)
    (frame,) = talk.say(text, plan_only=True).frames
    assert frame.object is not None
    assert frame.object.id == "mug"
    assert [ref["id"] for ref in frame.goal.model_dump()["reference"]] == ["ice tea cup"]
