"""Sentences that `benchmarks.fuzz_parser` found to raise something else than `ParseError`."""

from __future__ import annotations

import sys
from contextlib import suppress

import pytest

from grammar import ParseError, parse
from grammar.words.normalisation import MAX_LENGTH

MOST_CALLS = 100_000
"""Calls that a sentence may take: some 40 ms, and more than twice what the longest text takes."""


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("no, push", "no, push it"),
        ("why can you not pull", "why can you not pull it?"),
        ("open the lid of thehow large jar", "open the lid of the thehow large jar"),
        (
            "push the tin at half the height of the mug",
            "push the tin at half the height of the mug",
        ),
        ("push the tin low", "push the tin at the bottom"),
        ("push robot, away", 'push "robot" away'),
        ("push the tin at two box heights", "push the tin at twice the height of the box"),
    ],
)
def test_whatever_is_read_can_be_said(text: str, said: str) -> None:
    paraphrase = parse(text).paraphrase
    assert paraphrase == said
    assert parse(paraphrase).paraphrase == paraphrase


@pytest.mark.parametrize(
    ("text", "code", "at"),
    [
        ("again the box", "no_verb", "box"),
        ("separate the away from the edge", "does_not_apply", "from the edge"),
        ("to do it again", "no_verb", "it"),
        ("pour from the cup into the tin then the mug", "no_verb", "mug"),
        ("pull the box so that it does not move", "contradiction", "so that it does not move"),
        ("poke what is the height of the red can?", "unsupported_question", "poke"),
        ("push it away?;w", "unexpected_words", "w"),
    ],
)
def test_what_says_nothing_whole_is_refused(text: str, code: str, at: str) -> None:
    with pytest.raises(ParseError) as caught:
        parse(text)
    assert caught.value.code == code
    assert caught.value.span is not None
    assert text[slice(*caught.value.span)] == at


@pytest.mark.parametrize(
    "repeated", ["a ", "how ", "no, ", '"a" ', "½", "the box of the ", "1", "whoa "]
)
def test_no_repetition_takes_long(repeated: str) -> None:
    for begun, end in (("push the box on ", ""), ("", ""), ("", " boxes")):
        text = (begun + repeated * MAX_LENGTH)[: MAX_LENGTH - len(end)] + end
        assert _calls(text) < MOST_CALLS


def _calls(text: str) -> int:
    """Calls of functions, Python's and others, that a text takes to be read or refused."""
    with suppress(ParseError):
        parse(text)  # what is compiled once is compiled by now
    counted = 0

    def count(_frame: object, event: str, _arg: object) -> None:
        nonlocal counted
        counted += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        with suppress(ParseError):
            parse(text)
    finally:
        sys.setprofile(before)
    return counted


@pytest.mark.parametrize(
    ("words", "quality"),
    [
        ("more slippery", "slippery"),
        ("the least slippery", "rough"),
        ("grippier", "rough"),
        ("heavier", "heavy"),
    ],
)
def test_which_of_several_is_more_so_is_asked(words: str, quality: str) -> None:
    (frame,) = parse(f"which of them is {words}?").frames
    assert frame.query == "compare"
    assert frame.object is not None
    assert frame.object.qualities == (quality,)


@pytest.mark.parametrize("text", ["at the top. move?", "would. move if you poke it?"])
def test_a_question_that_only_says_where_first_is_refused_or_read(text: str) -> None:
    with suppress(ParseError):
        assert parse(text).frames


def test_an_amount_that_is_not_meant_may_have_its_unit_beside_it() -> None:
    assert parse("turn it 5°, not 3°").paraphrase == parse("turn it 5 degrees").paraphrase
    with pytest.raises(ParseError):
        parse("do not a 3°")
