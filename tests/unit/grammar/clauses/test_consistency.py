"""What a sentence says against itself: the refusal points at both places."""

from __future__ import annotations

import pytest

from grammar import ParseError, parse


def refusal(text: str) -> ParseError:
    with pytest.raises(ParseError) as caught:
        parse(text)
    return caught.value


def places(error: ParseError, text: str) -> list[str]:
    return [text[slice(*span)] for span in error.spans]


GOALS = [
    ("topple it without toppling it", "topple", "without toppling it"),
    ("topple it so that it does not fall", "topple", "so that it does not fall"),
    ("topple the mug, but keep it upright", "topple", "keep it upright"),
    ("topple the box without it falling over", "topple", "without it falling over"),
    ("tip the box over without tilting it", "tip", "without tilting it"),
    ("knock it over without tilting it more than 5 degrees",
     "knock", "without tilting it more than 5 degrees"),
    ("tilt it without tilting it", "tilt", "without tilting it"),
    ("tilt it by 30 degrees without tilting it more than 10 degrees",
     "by 30 degrees", "without tilting it more than 10 degrees"),
    ("turn it clockwise but keep it straight", "turn", "keep it straight"),
    ("turn it 90 degrees without turning it more than 30 degrees",
     "90 degrees", "without turning it more than 30 degrees"),
    ("lift it 5 cm but keep it on the table", "lift", "keep it on the table"),
    ("slide it away without sliding it", "away", "without sliding it"),
    ("move it without moving it", "move", "without moving it"),
    ("push it next to the mug without sliding it", "next to the mug", "without sliding it"),
    ("push it 20 cm without moving it more than 10 cm",
     "20 cm", "without moving it more than 10 cm"),
    ("push it 10 cm away, at most 5 cm", "10 cm", "at most 5 cm"),
    ("push it at least 10 cm, at most 5 cm", "at least 10 cm", "at most 5 cm"),
    ("push it against the mug without touching the mug",
     "against the mug", "without touching the mug"),
    ("put the box on the mug without touching the mug", "on the mug", "without touching the mug"),
    ("push the box without touching the box", "push", "without touching the box"),
    ("can you topple it without toppling it?", "topple", "without toppling it"),
    ("no, topple it without toppling it", "topple", "without toppling it"),
]  # fmt: skip

DIRECTIONS = [
    ("push it left and right", "left", "right"),
    ("push it away towards me", "away", "towards me"),
    ("push it to the left toward the mug", "to the left", "toward the mug"),
    ("push it toward the mug, heading 30 degrees", "toward the mug", "heading 30 degrees"),
    ("push it toward the mug away from the jar", "toward the mug", "away from the jar"),
]

MANNERS = [
    ("push it gently and hard", "gently", "hard"),
    ("push it hard and gently", "hard", "gently"),
    ("push it slowly but quickly", "slowly", "quickly"),
    ("again, gently and hard", "gently", "hard"),
    ("push it with 5 N and with at most 3 N", "with 5 N", "with at most 3 N"),
    ("push it with at most 3 N and with 5 N", "with at most 3 N", "with 5 N"),
    ("push it with 2 N and with at least 3 N", "with 2 N", "with at least 3 N"),
    ("push it with at least 5 N and with at most 3 N", "with at least 5 N", "with at most 3 N"),
    ("push it with 3 N and with 5 N", "with 3 N", "with 5 N"),
    ("push it at 5 cm/s and at most 3 cm/s", "at 5 cm/s", "at most 3 cm/s"),
    ("push it at 2 cm/s and at least 3 cm/s", "at 2 cm/s", "at least 3 cm/s"),
    ("push it at least 5 cm/s and at most 3 cm/s", "at least 5 cm/s", "at most 3 cm/s"),
    ("push it at 2 cm/s at 3 cm/s", "at 2 cm/s", "at 3 cm/s"),
    ("push it for 5 seconds in at most 3 seconds", "for 5 seconds", "in at most 3 seconds"),
    ("push it for 5 seconds for 3 seconds", "for 5 seconds", "for 3 seconds"),
    ("push it with one finger with two fingers", "with one finger", "with two fingers"),
]

STOPS = [
    ("push it until it moves until it tips", "until it moves", "until it tips"),
    ("push it until it tips without toppling it", "until it tips", "without toppling it"),
    ("push it without tilting it until it tips", "without tilting it", "until it tips"),
    ("push it until it almost tips without tilting it",
     "until it almost tips", "without tilting it"),
    ("push it until it touches the mug without touching the mug",
     "until it touches the mug", "without touching the mug"),
]  # fmt: skip

CONTACTS = [
    ("slide it at the top with no contact above 3 cm", "at the top", "with no contact above 3 cm"),
    ("push it with no contact above 3 cm at the top", "with no contact above 3 cm", "at the top"),
    ("push it at the bottom with no contact below 3 cm",
     "at the bottom", "with no contact below 3 cm"),
    ("push it at the top, at least 3 cm below the top",
     "at the top", "at least 3 cm below the top"),
    ("push it at the top at the bottom", "at the top", "at the bottom"),
    ("push it on the left side, from the right", "on the left side", "from the right"),
    ("push it at 3 cm above the table at 5 cm above the table",
     "at 3 cm above the table", "at 5 cm above the table"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "first", "second"), [*GOALS, *DIRECTIONS, *MANNERS, *STOPS, *CONTACTS]
)
def test_contradiction_points_at_both_places(text: str, first: str, second: str) -> None:
    error = refusal(text)
    assert error.code == "contradiction"
    assert places(error, text) == [first, second]
    assert error.span == error.spans[1]
    assert second in error.message
    assert error.suggestions


@pytest.mark.parametrize(
    "text",
    [
        "tilt it by 10 degrees without tilting it more than 30 degrees",
        "tilt it at most 30 degrees without tilting it more than 10 degrees",
        "tilt it 30 degrees without tilting it more than 30 degrees",
        "turn it 30 degrees without turning it more than 30 degrees",
        "turn it without tilting it",
        "topple it without lifting it",
        "lift it without tilting it",
        "move it away without sliding it",
        "push it 10 cm away, at most 10 cm",
        "push it at least 5 cm, at most 10 cm",
        "push it so lightly that it does not move",
        "push it next to the mug without touching the mug",
        "push it against the mug without touching the jar",
        "push it gently, slowly and carefully",
        "push it with 3 N and with at most 3 N",
        "push it with at least 3 N and with at most 5 N",
        "push it for 3 seconds in at most 5 seconds",
        "push it until it almost tips without toppling it",
        "push it until it touches the mug without touching the jar",
        "push it at the bottom with no contact above 3 cm",
        "push it at the top, at most 3 cm below the top",
        "push it at the top on the left side",
        "push it away and to the left",
        "push it to the left, then to the right",
        "topple the box, then push the mug without toppling it",
    ],
)
def test_what_goes_together_is_read(text: str) -> None:
    assert parse(text).frames


@pytest.mark.parametrize(
    ("text", "first", "second"),
    [
        ("push it 10 cm 20 cm", "10 cm", "20 cm"),
        ("push it a little 5 cm", "a little", "5 cm"),
        ("turn it 30 degrees 20 degrees", "30 degrees", "20 degrees"),
    ],
)
def test_what_is_said_twice_is_pointed_at_twice(text: str, first: str, second: str) -> None:
    error = refusal(text)
    assert error.code == "said_twice"
    assert places(error, text) == [first, second]


def test_other_object_is_pointed_at_with_the_first() -> None:
    text = "push the box without toppling the mug"
    error = refusal(text)
    assert error.code == "other_object"
    assert places(error, text) == ["box", "mug"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("push it with -3 N", "with -3 N"),
        ("push it with no more than -3 newtons", "with no more than -3 newtons"),
        ("push it ten kilometres", "ten kilometres"),
        ("push it ten kilometres away without toppling it", "ten kilometres"),
        ("push it 0 cm to the left", "0 cm"),
    ],
)
def test_impossible_quantity_is_pointed_at(text: str, said: str) -> None:
    error = refusal(text)
    assert error.code == "impossible_quantity"
    assert places(error, text) == [said]
