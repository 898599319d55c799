"""What a refusal tells: suggestions, and errors that are about the whole sentence."""

from __future__ import annotations

import pytest

from grammar import ParseError, parse
from grammar.words.normalisation import MAX_LENGTH


def refusal(text: str) -> ParseError:
    with pytest.raises(ParseError) as caught:
        parse(text)
    return caught.value


@pytest.mark.parametrize(
    ("text", "verb"),
    [("psuh the box", "push"), ("toppel the box", "topple"), ("sldie the box", "slide")],
)
def test_misspelt_verb_is_asked_back(text: str, verb: str) -> None:
    assert refusal(text).suggestions == (f"did you mean '{verb}'?",)


def test_near_ties_are_all_named() -> None:
    # Likeness: "tit" is 6/7 like "tilt" and 2/3 like "tip"; "pul" is 6/7 like "pull" and 4/7 like
    # "push"; but "lilt" is 3/4 like "lift" and "tilt" alike.
    assert refusal("tit the box").suggestions == ("did you mean 'tilt'?",)
    assert refusal("pul the box").suggestions == ("did you mean 'pull'?",)
    assert refusal("lilt the box").suggestions == ("did you mean 'lift' or 'tilt'?",)


@pytest.mark.parametrize(
    ("text", "instead"),
    [
        ("throw the mug away", ["push the mug away"]),
        ("drop it in the box", ["put it in the box"]),
        ("flip the box", ["turn the box", "topple the box"]),
        ("push the jar away, then roll the can to the left",
         ["push the jar away, then push the can to the left"]),
    ],
)  # fmt: skip
def test_a_verb_that_is_not_known_yet_has_the_sentence_with_one_that_is(
    text: str, instead: list[str]
) -> None:
    assert refusal(text).suggestions == tuple(f'this would do: "{said}"' for said in instead)
    assert all(parse(said).frames for said in instead)


def test_misspelt_direction_is_asked_back() -> None:
    assert refusal("push the box gently awya").suggestions[0] == "did you mean 'away'?"


def test_words_where_anything_could_stand_are_to_be_left_out() -> None:
    assert refusal("push the box away bananas").suggestions[0] == 'leave out "bananas"'


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("push the box without bananas", '"toppling"'),
        ("push the box away, at least", "a number"),
        ("push the box with your", '"finger", "hand" or "arm"'),
        ("push the box until it", "what happens"),
    ],
)
def test_errors_within_a_phrase_say_what_could_stand_there(text: str, expected: str) -> None:
    could = refusal(text).suggestions[0]
    assert could.startswith("could stand here: ")
    assert expected in could
    assert "__ANON" not in could


def test_a_part_to_hold_it_by_is_named_as_a_whole() -> None:
    error = refusal("lift the mug by its handle")
    assert "where to take hold is up to the robot" in error.message
    assert error.suggestions[0] == 'leave out "by its handle"'


def test_missing_unit_suggests_units() -> None:
    error = refusal("push the box 10")
    assert error.message == '"10" lacks its unit'
    assert error.suggestions[:3] == ("10 cm", "10 N", "10 cm/s")  # and no angle
    assert refusal("push the box with 5").suggestions[:2] == ("5 N", "5 cm/s")
    assert refusal("push the box 10 away").suggestions[0] == "10 cm"


def test_verb_without_its_particle_suggests_it() -> None:
    assert refusal("knock the box").suggestions == (
        "did you mean 'knock down'?",
        "did you mean 'knock on its side'?",
        "did you mean 'knock over'?",
        "did you mean 'knock over on its side'?",
    )


def test_long_text_is_cut_off_before_it_is_read() -> None:
    error = refusal("push the box away " * 600)
    assert error.code == "too_long"
    assert error.span == (MAX_LENGTH, 10_800)


def test_longest_text_is_read() -> None:
    assert parse("push the box away".ljust(MAX_LENGTH)).frames
    assert refusal("push the box away".ljust(MAX_LENGTH + 1)).code == "too_long"


@pytest.mark.parametrize("char", ["\x00", "\x1b", "\x7f", "\u200b", "\u202e", "\ud800", "\ue000"])
def test_control_characters_are_named_by_number(char: str) -> None:
    error = refusal(f"push the{char} box")
    assert error.code == "control_character"
    assert error.span == (8, 9)
    assert f"U+{ord(char):04X}" in error.message
    # A message may be printed where a lone surrogate cannot be.
    assert char not in error.message


def test_error_carries_no_other_error() -> None:
    error = refusal("push the box 0 cm")
    assert error.__cause__ is None
    assert error.__suppress_context__ or error.__context__ is None
