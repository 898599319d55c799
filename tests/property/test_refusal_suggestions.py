"""What a refusal offers is read: sentences as they stand, units where the number stands."""

from __future__ import annotations

import re
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.sentences import refused
from grammar import ParseError, parse
from tests.property.test_grammar_properties import PHRASES, SEEDS, damaged_sentence, read
from tests.sizes import examples

_SENTENCE = re.compile(
    r"^(?:say, for example,|ask, for example,|to have it done:|to ask:|this much is understood:)"
    r' "(.+)"$'
)


def unread(text: str) -> list[str]:
    """The sentences that the refusal of a text offers and that are not read."""
    try:
        parse(text)
    except ParseError as refusal:
        offered = [m[1] for s in refusal.suggestions if (m := _SENTENCE.match(s))]
        return [sentence for sentence in offered if read(sentence) is None]
    return []


def test_sentences_offered_in_the_test_set_are_read() -> None:
    assert not {text: found for text in refused() if (found := unread(text))}


@settings(max_examples=examples(400), deadline=None)
@given(SEEDS, st.integers(0, 9), PHRASES, st.sampled_from(["", "?"]))
def test_sentences_offered_for_damaged_ones_are_read(
    seed: int, damage: int, phrase: str, mark: str
) -> None:
    assert not unread(damaged_sentence(Random(seed), damage, phrase) + mark)


def test_a_quoted_name_follows_on() -> None:
    for text in ('push the box on "75" away', 'push the box on "75"', 'put the mug on "tin 3"'):
        command = parse(text)
        assert parse(command.paraphrase).paraphrase == command.paraphrase


def test_no_is_no_correction_at_the_beginning_of_a_phrase() -> None:
    words = parse("push the tin left, no nearer than 14 cm").paraphrase
    assert words == parse("push the tin to the left by at least 14 cm").paraphrase


@pytest.mark.parametrize(
    ("text", "units"),
    [
        ("push the tin by 3", ("3 cm", "3 seconds")),
        ("push the tin away at 3", ("3 N", "3 cm/s")),
        ("pour 3 into the mug", ("3 ml",)),
        ("turn the mug by 30", ("30 degrees", "30 seconds")),
    ],
)
def test_units_are_offered_that_the_sentence_can_have(text: str, units: tuple[str, ...]) -> None:
    with pytest.raises(ParseError) as raised:
        parse(text)
    assert raised.value.suggestions == units
