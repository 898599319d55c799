"""Sentences of the refusals: each in its words, with its numbers as people read them."""

from __future__ import annotations

import json
import math
import re
import string
from pathlib import Path

import pytest

from grammar import parse
from planner.refusals.blocked import QUANTITIES, dead_end
from planner.refusals.sentences import FACTS, SENTENCES

ROOT = Path(__file__).parents[4]
GOLDEN = json.loads((ROOT / "tests/data/refusals.json").read_text(encoding="utf-8"))
NUMBER = 0.1234


def _values(*texts: str) -> dict[str, object]:
    """A value for each name in some texts: a number where one is read, else the name itself."""
    parts = [part for text in texts for part in string.Formatter().parse(text)]
    return {name: NUMBER if spec else name.upper() for _, name, spec, _ in sorted(
        ((a, b, c, d) for a, b, c, d in parts if b), key=lambda part: bool(part[2])
    )}  # fmt: skip


def _said(code: str) -> dict[str, object]:
    one = SENTENCES[code]
    values = _values(one.text, *(cure.text for cure in one.cures), one.capability or "")
    found = dead_end(code, **values).refusal  # type: ignore[arg-type]
    return {
        "reason": found.reason,
        "message": found.message,
        "suggestions": list(found.suggestions),
        "capability": found.capability,
    }


def test_the_file_has_every_sentence() -> None:
    assert list(GOLDEN) == list(SENTENCES)


@pytest.mark.parametrize("code", SENTENCES)
def test_each_sentence_is_in_its_words(code: str) -> None:
    assert _said(code) == GOLDEN[code]


@pytest.mark.parametrize("number", [math.inf, -math.inf, math.nan])
@pytest.mark.parametrize("code", SENTENCES)
def test_what_is_no_finite_number_is_in_no_refusal(code: str, number: float) -> None:
    one = SENTENCES[code]
    values = _values(one.text, *(cure.text for cure in one.cures), one.capability or "")
    odd = {name: number for name, value in values.items() if value == NUMBER}
    heights = {"critical_height": number, "lowest_height": 0.1}
    words = {**values, **odd}
    found = dead_end(code, {**odd, **heights}, **words).refusal  # type: ignore[arg-type]
    assert found.numbers == {"lowest_height": 0.1}
    told = " ".join((found.message, *found.suggestions))
    assert not re.search(r"\b(inf|nan)\b", told)


@pytest.mark.parametrize("code", SENTENCES)
def test_each_refusal_says_what_would_do(code: str) -> None:
    assert SENTENCES[code].cures
    assert all(cure.text for cure in SENTENCES[code].cures)


PLACES = {cure.text for one in SENTENCES.values() for cure in one.cures if "{other}" in cure.text}


@pytest.mark.parametrize("text", sorted(text for text in PLACES if "next to" in text))
def test_another_place_is_a_sentence(text: str) -> None:
    (frame,) = parse(text.format(other="mug")).frames
    assert frame.action == "place"


def test_every_sentence_is_used() -> None:
    source = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "planner").rglob("*.py"))
    for key in (*SENTENCES, *FACTS):
        code = key.partition(".")[0]
        # What tells sentences of a code apart may be put together from what is known.
        assert len(re.findall(rf'"{key}"|f"{code}[.{{]|"{code}"', source)) > 1, key


@pytest.mark.parametrize(
    ("quantity", "value", "text"),
    [
        ("mm", 0.0312, "31 mm"),
        ("deg", -0.5236, "30°"),
        ("deg_exact", 0.0873, "5°"),
        ("deg_floor", 0.0872, "4.9°"),
        ("N", 3.68, "3.7 N"),
        ("N_up", 3.1, "3.5 N"),
        ("ml", 2.5e-4, "250 ml"),
        ("share", 0.987, "0.99"),
        ("chance", 0.9496, "0.950"),
        ("chance", 1.0, "over 0.999"),
        ("chance", 0.0, "below 0.001"),
    ],
)
def test_how_a_number_is_read(quantity: str, value: float, text: str) -> None:
    assert QUANTITIES[quantity](value) == text


def test_a_refusal_bears_its_code_and_the_numbers_that_decide() -> None:
    numbers = {"needed_force": 3.2, "min_force": 9.0}
    found = dead_end("too_light", numbers, spans=((1, 3),), object="cup").refusal
    assert (found.code, found.reason, found.numbers) == ("too_light", "impossible", numbers)
    assert found.spans == ((1, 3),)
    doubted = dead_end("too_light", numbers, reason="too_uncertain", object="cup").refusal
    assert doubted.reason == "too_uncertain"
