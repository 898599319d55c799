"""Whatever the language can say ends in a plan, an answer, or a refusal that says why."""

from __future__ import annotations

from itertools import islice

import pytest

from grammar.sampling import samples
from nlcontrol import Controller, Result
from nlcontrol.errors import CODES

NOUNS = ("ice tea box", "cereal box", "coffee box", "box", "mug")
"""On the table, several of them, and known to the registry alone."""

ENDS = {"planned", "answered", "refused", "unsupported", "not_understood", "done"}


@pytest.fixture(scope="module")
def kitchen() -> Controller:
    return Controller("kitchen")


@pytest.mark.parametrize("seed", range(6))
def test_every_sentence_comes_to_an_end_that_is_told(kitchen: Controller, seed: int) -> None:
    for text, _ in islice(samples(seed, nouns=NOUNS), 25):
        result = kitchen.say(text, plan_only=True)
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
        ("open the coffee box", "opening objects"),
        ("close the lid of the coffee box", "closing objects"),
        ("pour the contents of the ice tea box into the coffee box", "pouring"),
        ("lift the coffee box by 5 cm", "lifting objects"),
        ("hand me the coffee box", "handing objects over"),
        ("pull the coffee box towards me", "pulling objects"),
        ("turn the coffee box a quarter turn", "turning objects"),
        ("stand the coffee box upright", "standing objects up"),
        ("put the coffee box next to the cereal box", "placing objects at places"),
        ("find out how tall the coffee box is", "finding out the height of objects"),
        ("push the coffee box away until it touches the cereal box", "stopping at an event"),
    ],
)
def test_what_has_no_controller_yet_is_named(
    kitchen: Controller, text: str, capability: str
) -> None:
    result = kitchen.say(text, plan_only=True)
    assert (result.status, result.exit_status) == ("unsupported", 4)
    assert result.frames
    assert result.error is not None
    assert result.error.capability == capability
