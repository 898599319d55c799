"""Refusals name the phrase that was not understood, and what was, as a sentence that is read."""

from __future__ import annotations

import re

import pytest

from benchmarks.sentences import refused
from grammar.errors import ParseError
from grammar.parser import parse

_UNDERSTOOD = re.compile(r'this much is understood: "(.+)"')
_JOINING = {"the", "a", "an", "of", "to", "in", "on", "at", "from", "with", "by", "for", "into"}


@pytest.fixture(scope="module")
def errors() -> list[tuple[str, ParseError]]:
    """Sentences that are refused, with why."""
    found = []
    for text in refused():
        try:
            parse(text)
        except ParseError as error:
            found.append((text, error))
    return found


def test_no_refusal_of_words_blames_a_joining_word_alone(
    errors: list[tuple[str, ParseError]],
) -> None:
    spans = [(text, e.span) for text, e in errors if e.code == "unexpected_words" and e.span]
    within = [(text, span) for text, span in spans if span[1] < len(text)]
    blamed = [text for text, (start, end) in within if text[start:end].casefold() in _JOINING]
    assert not blamed


def test_what_is_said_to_be_understood_is_read_as_it_is_said(
    errors: list[tuple[str, ParseError]],
) -> None:
    said = [m[1] for _, e in errors for s in e.suggestions if (m := _UNDERSTOOD.fullmatch(s))]
    assert len(said) > 50
    for sentence in said:
        assert parse(sentence).paraphrase == sentence


@pytest.mark.parametrize(
    ("text", "words", "understood"),
    [
        ("push the jar away of the bowl", "of the bowl", "push the jar away"),
        ("lift the jar to the left", "to the left", "lift the jar"),
        ("push the jar to the right edge behind the mug", "behind the mug", None),
    ],
)
def test_refusal_names_the_words_and_what_was_understood(
    text: str, words: str, understood: str | None
) -> None:
    with pytest.raises(ParseError) as raised:
        parse(text)
    assert raised.value.span is not None
    start, end = raised.value.span
    assert text[start:end] == words
    sentence = f'this much is understood: "{understood or "push the jar to the right edge"}"'
    assert sentence in raised.value.suggestions
