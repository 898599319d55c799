"""Words said twice are read once, unless they are meant twice."""

from __future__ import annotations

import pytest

from grammar import parse


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("push the tin... push the tin 3 cm to the left", "push the tin 3 cm to the left"),
        ("push the tin to uh push the tin to the right", "push the tin to the right"),
        ("push the tin left of the jar I mean the jar", "push the tin left of the jar"),
        ("push the tin away with at most 5 most 5 N", "push the tin away with at most 5 N"),
        ("push the tea box away box away", "push the tea box away"),
        ("push the tea tea box away", "push the tea box away"),
        ("push the tin without toppling it it", "push the tin without toppling it"),
    ],
)
def test_words_said_anew_are_read_once(text: str, plain: str) -> None:
    assert parse(text).paraphrase == parse(plain).paraphrase


@pytest.mark.parametrize(
    ("text", "frames"),
    [
        ("push the tin 5 cm, push the tin 5 cm", 2),
        ("push the tin away, push the tin away, then lift it", 3),
    ],
)
def test_a_whole_command_said_twice_is_two(text: str, frames: int) -> None:
    assert len(parse(text).frames) == frames


def test_a_name_that_says_a_word_twice_stays() -> None:
    (frame,) = parse("push the yo yo away").frames
    assert frame.object is not None
    assert frame.object.text == "yo yo"


def test_a_name_is_written_without_what_stands_within_it() -> None:
    (frame,) = parse("push the ice, uh, tea box away").frames
    assert frame.object is not None
    assert frame.object.text == "ice tea box"


def test_a_name_of_the_same_letters_stays() -> None:
    (frame,) = parse("push the aaa battery away").frames
    assert frame.object is not None
    assert frame.object.text == "aaa battery"


def test_a_name_that_is_read_as_stammered_is_said_in_quotation_marks() -> None:
    said = parse('push the "aa aa" away').paraphrase
    assert said == 'push "aa aa" away'
    assert parse(said).paraphrase == said
