"""Whatever the language can say ends in a plan, an answer, or a refusal that says why."""

from __future__ import annotations

from itertools import islice

import pytest

from grammar.paraphrasing.sentence_sampler import random_sentences
from nlcontrol import Result
from nlcontrol.errors import CODES
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.types.plan import Plan

NOUNS = ("ice tea box", "cereal box", "coffee box", "box", "ice tea", "mug", "soup can")
"""On the table, several of them, and known to the registry alone."""

ENDS = {"planned", "answered", "refused", "unsupported", "not_understood", "done"}


@pytest.fixture(scope="module")
def kitchen() -> Controller:
    return Controller("kitchen")


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_every_sentence_comes_to_an_end_that_is_told(kitchen: Controller, seed: int) -> None:
    for text, _ in islice(random_sentences(seed, nouns=NOUNS), 25):
        result = Conversation(kitchen).say(text, plan_only=True)
        assert result.status in ENDS, text
        assert result.paraphrase, text
        assert result.ok == (result.error is None), text
        assert str(result).startswith("I understood: "), text
        assert Result.model_validate_json(result.to_json()).frames == result.frames
        if result.error:
            assert result.error.code in CODES, (text, result.error)
            assert result.error.code != "internal", (text, result.error)
            assert result.error.message, text
        if result.status == "unsupported":
            assert result.error is not None
            assert result.error.capability or result.error.code == "uncheckable", text


@pytest.mark.parametrize(
    ("text", "capability"),
    [
        ("hand me the coffee box", "handing objects over"),
        ("push the coffee box onto the cereal box", "putting objects on others"),
        ("push the coffee box away with your left hand", "a second (left) hand"),
        ("turn the coffee box on its top face", "pushing on the top face"),
        ("find out how tall the coffee box is", "finding out the height of objects"),
    ],
)
def test_what_has_no_controller_yet_is_named(
    kitchen: Controller, text: str, capability: str
) -> None:
    result = Conversation(kitchen).say(text, plan_only=True)
    assert (result.status, result.exit_status) == ("unsupported", 4)
    assert result.frames
    assert result.error is not None
    assert result.error.capability == capability


@pytest.mark.parametrize(
    ("text", "ends_on", "pushes"),
    [
        ("pull the coffee box 10 cm towards me", "stroke", 1),
        ("turn the coffee box a quarter turn", "turned", 2),
        ("put the coffee box next to the cereal box", "stroke", 1),
        ("tilt the ice tea box by 5 degrees", "tilted", 1),
        ("push the coffee box to the left until it is next to the ice tea box", "stroke", 1),
    ],
)
def test_what_pushes_do_is_planned_to_its_end(
    kitchen: Controller, text: str, ends_on: str, pushes: int
) -> None:
    result = Conversation(kitchen).say(text, plan_only=True)
    assert (result.status, result.exit_status) == ("planned", 0)
    assert isinstance(result.plan, Plan)
    assert result.plan.push.ends_on == ends_on
    assert 1 + len(result.plan.pushes[1:]) >= pushes
    assert (result.plan.aim is None) == (ends_on == "tilted")


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        ("lift the ice tea by 5 cm", ["lift_up"]),
        ("put the ice tea next to the mug", ["lift_up", "set_down"]),
        ("open the ice tea cup", ["flip_over"]),
        ("pour the ice tea into the mug", ["lift_up", "pour_out", "set_down"]),
    ],
)
def test_what_a_hand_does_is_planned_to_its_end(
    kitchen: Controller, text: str, steps: list[str]
) -> None:
    result = Conversation(kitchen).say(text, plan_only=True)
    assert (result.status, result.exit_status) == ("planned", 0)
    assert isinstance(result.plan, Plan)
    # Whether it is carried in between depends on where things stand.
    assert [step.kind for step in result.plan.steps if step.kind != "carry"] == steps


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("open the coffee box", "the coffee box has no lid"),
        ("close the ice tea", "the ice tea has no lid"),
        ("pour the ice tea into the coffee box", "the coffee box is no container"),
        ("lift the ice tea box", "lifting the ice tea box needs "),
    ],
)
def test_what_no_hand_can_do_is_refused(kitchen: Controller, text: str, message: str) -> None:
    result = Conversation(kitchen).say(text, plan_only=True)
    assert result.error is not None
    assert (result.status, result.error.code) == ("refused", "impossible")
    assert result.error.message.startswith(message)


def test_what_is_never_met_is_refused(kitchen: Controller) -> None:
    result = Conversation(kitchen).say(
        "push the coffee box away until it touches the cereal box", plan_only=True
    )
    assert result.error is not None
    assert (result.status, result.error.code) == ("refused", "impossible")
    assert "push it towards the cereal box" in result.error.suggestions
