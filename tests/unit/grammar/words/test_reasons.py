"""Reasons are left out, and nothing of the command with them."""

from __future__ import annotations

from itertools import product

import pytest

from grammar import ParseError, parse

REASONS = (
    "because it is in the way", "because of the cat", "since my arm hurts", "as nobody needs it",
    "so that I can see the screen", "so we can play chess", "to make room", "to test you",
    "for safety", "before the guests come", "otherwise I can't see", "or it will fall off the edge",
    "while we wait", ", it smells", ", it is too close to the edge", ". My hands are full",
    ", the boss said so", ", that's what my wife wants", "it bothers me", "I need some space",
    "since I keep bumping into it", "it looks better that way", "it's blocking my view",
)  # fmt: skip
TAILS = (
    "without touching the jar", ", without touching the jar", "gently", ", but gently",
    "with one finger", ", with at most 5 N", "at 5 cm/s", "and do not topple it",
    ". Do not topple it", "until it touches the jar", ", then lift it 5 cm", "and topple the jar",
    ", no further than 5 cm", ", keep it upright", "10 cm",
)  # fmt: skip
"""What says how, how far, or what next."""


@pytest.mark.parametrize("reason", REASONS)
def test_a_reason_alone_changes_nothing(reason: str) -> None:
    assert parse(f"push the tin away {reason}").paraphrase == "push the tin away"


@pytest.mark.parametrize("reason", REASONS)
def test_what_stands_behind_a_reason_is_read_or_the_sentence_refused(reason: str) -> None:
    read = 0
    for tail in TAILS:
        try:
            command = parse(f"push the tin away {reason}{' ' * (tail[0].isalnum())}{tail}")
        except ParseError:
            continue
        read += 1
        plain = parse(f"push the tin away{' ' * (tail[0].isalnum())}{tail}")
        assert command.paraphrase == plain.paraphrase, tail
    assert read > len(TAILS) // 2


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("because it is ugly, push the tin away", "push the tin away"),
        ("since the guests arrive push the tin away", "push the tin away"),
        ("push the tin, my back hurts, to the left", "push the tin to the left"),
        ("push the tin away, I can't see, and topple the jar",
         "push the tin away and topple the jar"),
    ],
)  # fmt: skip
def test_a_reason_may_stand_anywhere(text: str, plain: str) -> None:
    assert parse(text).paraphrase == parse(plain).paraphrase


@pytest.mark.parametrize(
    "text",
    [
        "push the tin away as it must not fall",
        "push the tin away because the jar must not be touched",
        "push the tin away so that you do not touch the jar",
        "push the tin away, I want to push the jar too",
        "push the tin away as it was before",
        "push the tin because it leans to the left",
        "push the tin away because I am back in 5 minutes",
        "push the tin away if it bothers me",
        "push the tin away unless it is in my way",
        "push the tin away until it is blocking my view",
        "push the tin away after I have to clean",
    ],
)
def test_what_restricts_or_may_be_meant_is_no_reason(text: str) -> None:
    with pytest.raises(ParseError):
        parse(text)


def test_reasons_and_tails_in_a_row() -> None:
    for reason, tail in product(REASONS[:4], TAILS[:4]):
        how = tail.strip(", ")
        read = parse(f"push the tin away {reason}, {how}")
        assert read.paraphrase == parse(f"push the tin away, {how}").paraphrase
