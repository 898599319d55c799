"""Quantities in SI, with pint as the oracle of units and an own speller as that of number words."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import pint
import pytest

from grammar import ParseError, parse
from grammar.words.lexicon import default_lexicon
from grammar.words.numerals import exact_decimal

UNITS: Any = pint.UnitRegistry()
UNITS.define("right_angle = 0.25 * turn")
LEXICON = default_lexicon()

# A few units in the last place: pint and the grammar multiply in different orders.
CLOSE = 1e-14


def goal(text: str) -> dict[str, Any]:
    (frame,) = parse(text).frames
    return frame.goal.model_dump()


def distance(said: str) -> float:
    found = goal(f"push the box {said} away")
    assert (found["kind"], found["bound"]) == ("displace", "exact")
    return float(found["distance"])


def angle(said: str) -> float:
    return float(goal(f"turn the box {said}")["angle"])


def constraint(text: str) -> tuple[str, Any]:
    (frame,) = parse(f"push the box away {text}").frames
    (found,) = frame.constraints
    return found.kind, getattr(found, "value", None)


def si(number: float, unit: str, base: str) -> float:
    return float(UNITS.Quantity(number, unit).to(base).magnitude)


# --- units ------------------------------------------------------------------------------------

# What pint calls a unit, and all ways of the lexicon to say it.
LENGTHS = {
    "millimetre": ("mm", "millimetre", "millimeter", "millimetres", "millimeters"),
    "centimetre": ("cm", "cms", "centimetre", "centimeter", "centimetres", "centimeters"),
    "decimetre": ("dm", "decimetre", "decimeter", "decimetres", "decimeters"),
    "metre": ("m", "metre", "meter", "metres", "meters"),
    "kilometre": ("km", "kilometre", "kilometer", "kilometres", "kilometers"),
    "inch": ("in", "inch", "inches"),
    "foot": ("ft", "foot", "feet"),
    "yard": ("yd", "yard", "yards"),
}
ANGLES = {
    "degree": (
        "degrees", "°", "deg", "degs", "degree", "angular degrees", "degree of arc",
        "degrees of arc", "degree of angle", "degrees of angle", "degree of rotation",
        "degrees of rotation",
    ),
    "radian": ("radians", "rad", "radian"),
    "right_angle": ("right angle", "right angles"),
    "turn": (
        "turns", "turn", "of a turn", "of a full turn", "rotation", "rotations", "revolution",
        "revolutions", "full turn", "full turns", "complete turn", "complete turns", "whole turn",
        "whole turns", "full rotation", "full rotations", "full circle",
    ),
}  # fmt: skip
FORCES = {
    "newton": ("n", "newton", "newtons", "n of force", "newton of force", "newtons of force"),
    "kilonewton": ("kn", "kilonewton", "kilonewtons"),
    "kilogram_force": (
        "kgf", "kilopond", "kilogram of force", "kilograms of force", "kilo of force",
        "kilos of force", "kg of force",
    ),
    "gram * standard_gravity": ("gf", "pond", "gram of force", "grams of force", "g of force"),
    "pound_force": ("lbf", "pound of force", "pounds of force"),
}  # fmt: skip
TIMES = {
    "second": ("s", "sec", "secs", "second", "seconds"),
    "millisecond": ("ms", "millisecond", "milliseconds"),
    "minute": ("min", "minute", "minutes"),
}
SPEEDS = {
    f"{unit} / second": tuple(
        f"{word}{per}"
        for word in LENGTHS[unit]
        for per in (("/s", " / s", " per second") if len(word) == 2 or word == "m" else
                    (" per second", " a second", " each second"))
        if word not in ("in", "cms")
    )
    for unit in ("millimetre", "centimetre", "metre")
} | {"inch / second": ("in/s", "inches per second", "inch per second")}  # fmt: skip

Case = tuple[str, str]


def ways(units: dict[str, tuple[str, ...]]) -> list[Case]:
    return [(unit, word) for unit, words in units.items() for word in words]


PALMS = {
    f"{part}{said}"
    for part in ("hand", "finger")
    for said in (" width", " widths", " breadth", " breadths", "'s width", "'s breadth")
}


def test_widths_of_hand_and_finger_are_lengths_and_no_objects() -> None:
    assert {distance(f"two {said}") for said in PALMS if "hand" in said} == {0.16}
    assert {distance(f"two {said}") for said in PALMS if "finger" in said} == {0.04}


WHOLE = {f"whole {unit}" for unit in (
    "centimetre", "centimeter", "centimetres", "centimeters", "millimetres", "millimeters",
    "degrees",
)}  # fmt: skip


def test_whole_centimetres_are_centimetres() -> None:
    assert distance("two whole centimetres") == distance("twenty whole millimeters") == 0.02


def test_no_unit_of_the_lexicon_is_left_out() -> None:
    tables = {"LENGTH": LENGTHS, "ANGLE": ANGLES, "FORCE": FORCES, "TIME": TIMES, "SPEED": SPEEDS}
    for name, units in tables.items():
        known = set(LEXICON.phrases_of(f"{name}_UNIT")) - PALMS - WHOLE
        assert {word for _, word in ways(units)} == known


@pytest.mark.parametrize(("unit", "word"), ways(LENGTHS))
def test_lengths(unit: str, word: str) -> None:
    assert distance(f"0.0043 {word}") == pytest.approx(si(0.0043, unit, "metre"), rel=CLOSE)


@pytest.mark.parametrize(("unit", "word"), ways(ANGLES))
def test_angles(unit: str, word: str) -> None:
    assert angle(f"0.3 {word}") == pytest.approx(si(0.3, unit, "radian"), rel=CLOSE)


@pytest.mark.parametrize(("unit", "word"), ways(FORCES))
def test_forces(unit: str, word: str) -> None:
    newtons = pytest.approx(si(0.7, unit, "newton"), rel=CLOSE)
    assert constraint(f"with 0.7 {word}") == ("force", newtons)


@pytest.mark.parametrize(("unit", "word"), ways(TIMES))
def test_times(unit: str, word: str) -> None:
    seconds = pytest.approx(si(7, unit, "second"), rel=CLOSE)
    assert constraint(f"for 7 {word}") == ("duration", seconds)
    assert constraint(f"within 7 {word}") == ("max_duration", seconds)


@pytest.mark.parametrize(("unit", "word"), ways(SPEEDS))
def test_speeds(unit: str, word: str) -> None:
    speed = pytest.approx(si(0.3, unit, "metre / second"), rel=CLOSE)
    assert constraint(f"at 0.3 {word}") == ("speed", speed)


def test_units_may_be_glued_to_their_number() -> None:
    assert distance("10cm") == distance("10-cm") == distance("10 cm") == 0.1
    assert angle("30°") == angle("30 °") == math.radians(30)
    assert constraint("with 5N") == ("force", 5.0)
    assert constraint("at 2cm/s") == ("speed", 0.02)


# --- digits -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("said", "value"),
    [
        ("3", "3"), ("0.5", "0.5"), (".5", "0.5"), ("+3", "3"), ("007", "7"),
        ("1e-2", "0.01"), ("2.5e0", "2.5"), ("1/2", "1/2"), ("3/4", "3/4"), ("1/3", "1/3"),
        ("2 1/2", "5/2"), ("½", "1/2"), ("¾", "3/4"), ("⅓", "1/3"), ("⅞", "7/8"), ("2½", "5/2"),
        ("2 ½", "5/2"), ("٣", "3"), ("１.５", "1.5"),
    ],
)  # fmt: skip
def test_digits(said: str, value: str) -> None:
    assert distance(f"{said} m") == float(Fraction(value))


@pytest.mark.parametrize("number", ["0.1", "0.7", "1.1", "2.3", "7", "29", "57", "113"])
def test_distances_are_the_decimals_that_were_said(number: str) -> None:
    # In binary 7 * 0.01 is 0.07000000000000001; the nearest number to 7/100 is meant.
    assert distance(f"{number} cm") == float(Fraction(number) / 100)


@pytest.mark.parametrize(
    ("said", "value"), [("-2", -2), ("-1/2", -0.5), ("-2 1/2", -2.5), ("2 1/2", 2.5)]
)
def test_signs(said: str, value: float) -> None:
    assert float(exact_decimal(said)) == value


# --- words ------------------------------------------------------------------------------------

SMALL = [
    "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
    "eleven", "twelve", "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen",
    "nineteen",
]  # fmt: skip
TENS = ["twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety"]


def spelt(number: int, joint: str) -> str:
    """A number below a thousand in English."""
    if number >= 100:
        rest = f"{joint}{spelt(number % 100, joint)}" if number % 100 else ""
        return f"{SMALL[number // 100]} hundred{rest}"
    if number < 20:
        return SMALL[number]
    ones = f" {SMALL[number % 10]}" if number % 10 else ""
    return TENS[number // 10 - 2] + ones


@pytest.mark.parametrize("joint", [" ", " and "])
def test_numbers_in_words(joint: str) -> None:
    for number in range(1000):
        said = spelt(number, joint)
        match = LEXICON.numbers.pattern.match(f"{said} cm")
        assert match is not None
        assert match.group() == said
        assert LEXICON.numbers.decimal_of(said) == number


@pytest.mark.parametrize("number", [1, 9, 12, 20, 21, 99, 100, 101, 110, 342, 999])
def test_numbers_in_words_within_a_sentence(number: int) -> None:
    for joint in (" ", " and "):
        said = spelt(number, joint)
        assert distance(f"{said} millimetres") == number / 1000
        assert distance(f"{said.replace('y ', 'y-')} millimetres") == number / 1000


@pytest.mark.parametrize(
    ("said", "metres"),
    [
        ("a metre", 1), ("an inch", 0.0254), ("half a metre", 0.5), ("half an inch", 0.0127),
        ("a half metre", 0.5), ("one half metre", 0.5), ("a quarter of a metre", 0.25),
        ("one quarter of a metre", 0.25), ("three quarters of a metre", 0.75),
        ("three quarters of an inch", 0.01905), ("one and a half metres", 1.5),
        ("two and a half centimetres", 0.025), ("two and a quarter metres", 2.25),
        ("two and three quarters metres", 2.75), ("a metre and a half", 1.5),
        ("two metres and a half", 2.5), ("a metre and three quarters", 1.75),
        ("a couple of centimetres", 0.02), ("a dozen centimetres", 0.12),
        ("zero point five metres", 0.5), ("one point two five metres", 1.25),
        ("a hundred millimetres", 0.1), ("a hundred and five millimetres", 0.105),
        ("thousand millimetres", 1.0), ("a third of a metre", 1 / 3),
        ("two thirds of a metre", 2 / 3),
    ],
)  # fmt: skip
def test_fractions_and_articles(said: str, metres: float) -> None:
    assert distance(said) == metres


@pytest.mark.parametrize(
    ("said", "turns"),
    [
        ("a quarter turn", 0.25), ("a quarter of a turn", 0.25), ("half a turn", 0.5),
        ("a half turn", 0.5), ("three quarters of a turn", 0.75), ("a full turn", 1.0),
        ("one turn", 1.0), ("one and a half turns", 1.5), ("a turn and a half", 1.5),
        ("two turns", 2.0), ("around", 0.5),
    ],
)  # fmt: skip
def test_turns(said: str, turns: float) -> None:
    assert angle(said) == pytest.approx(si(turns, "turn", "radian"), rel=CLOSE)


# --- bounds and ranges ------------------------------------------------------------------------

BOUNDS = [
    *((phrase, "at_least") for phrase in ("at least", "no less than", "more than")),
    *((phrase, "at_most") for phrase in ("at most", "no more than", "up to", "less than")),
    *((phrase, "exact") for phrase in ("about", "roughly", "approximately")),
    ("exactly", "exactly"),
]


@pytest.mark.parametrize(("phrase", "bound"), BOUNDS)
def test_bounds(phrase: str, bound: str) -> None:
    assert goal(f"push the box {phrase} 5 cm away")["bound"] == bound
    assert goal(f"push the box away by {phrase} 5 cm")["bound"] == bound
    assert goal(f"turn the box {phrase} 30 degrees")["bound"] == bound
    assert goal(f"lift the box {phrase} 5 cm")["bound"] == bound
    kinds = {"exact": "{}", "exactly": "{}", "at_least": "min_{}", "at_most": "max_{}"}
    assert constraint(f"with {phrase} 3 N") == (kinds[bound].format("force"), 3.0)
    assert constraint(f"at {phrase} 2 cm/s") == (kinds[bound].format("speed"), 0.02)


@pytest.mark.parametrize("said", LEXICON.phrases_of("BOUND"))
def test_every_bound_leaves_the_number(said: str) -> None:
    found = goal(f"push the box {said} 5 cm")
    bound = LEXICON.value_of("BOUND", said) or "exact"
    assert (found["distance"], found["bound"]) == (0.05, bound)


@pytest.mark.parametrize(
    "said",
    [
        "5 to 10 cm", "5-10 cm", "5 cm to 10 cm", "50 mm to 10 cm", "between 5 and 10 cm",
        "from 5 to 10 cm", "five to ten centimetres", "at least 5 cm and at most 10 cm",
        "at least 5 cm, at most 10 cm", "at least 5 cm but no more than 10 cm",
    ],
)  # fmt: skip
def test_ranges(said: str) -> None:
    (frame,) = parse(f"push the box {said}").frames
    assert frame.goal.model_dump()["distance"] == 0.05
    assert frame.goal.model_dump()["bound"] == "at_least"
    assert [(c.kind, getattr(c, "value", None)) for c in frame.constraints] == [
        ("max_distance", 0.1)
    ]


@pytest.mark.parametrize(
    ("said", "times", "of", "side"),
    [
        ("its width", 1, "its", "width"), ("its own width", 1, "its", "width"),
        ("twice its width", 2, "its", "width"), ("three times its length", 3, "its", "length"),
        ("half its height", 0.5, "its", "height"), ("two and a half times its width", 2.5, "its",
                                                    "width"),
        ("half a box width", 0.5, "box", "width"), ("two box widths", 2, "box", "width"),
        ("the width of the mug", 1, "mug", "width"),
        ("twice the height of the mug", 2, "mug", "height"),
    ],
)  # fmt: skip
def test_lengths_of_objects(said: str, times: float, of: str, side: str) -> None:
    found = goal(f"push the box {said} away")["distance"]
    assert (found["value"], found["of"]["text"], found["side"]) == (times, of, side)


# --- what is not taken seriously --------------------------------------------------------------


@pytest.mark.parametrize(
    "said",
    [
        "10 m", "1000 cm", "1/2 m", "0.001 mm", "with 1000 N", "with 1 kN", "at 10 m/s",
        "for 60 minutes",
    ],
)  # fmt: skip
def test_quantities_up_to_their_bound_are_read(said: str) -> None:
    assert parse(f"push the box {said}").frames


@pytest.mark.parametrize(
    "said",
    [
        "10.001 m", "ten kilometres", "-5 cm", "−5 cm", "0 cm", "zero metres", "0/5 m",
        "with -3 N", "with 1001 N", "with 300 pounds of force", "with no more than -1 N",
        "at 11 m/s", "at -1 m/s", "for 61 minutes", "for 0 s", "in -2 seconds", "1/0 m", "0/0 m",
        "1e400 m", "101 times its width", "10 to 5 cm", "5 to 5 cm", "between 10 and 5 cm",
        "5 to 20000 cm",
    ],
)  # fmt: skip
def test_impossible_quantities_are_refused(said: str) -> None:
    with pytest.raises(ParseError) as caught:
        parse(f"push the box {said}")
    assert caught.value.code == "impossible_quantity"


@pytest.mark.parametrize("said", ["11 turns", "3601 degrees", "63 radians", "-30 degrees", "0°"])
def test_impossible_angles_are_refused(said: str) -> None:
    with pytest.raises(ParseError) as caught:
        parse(f"turn the box {said}")
    assert caught.value.code == "impossible_quantity"


def test_minus_is_no_part_of_a_name() -> None:
    text = "push the box minus 5 cm"
    with pytest.raises(ParseError) as caught:
        parse(text)
    assert caught.value.span is not None
    assert text[slice(*caught.value.span)] == "minus"


def test_refusal_names_the_quantity_and_its_bounds() -> None:
    text = "push the box with at most -3 N away"
    with pytest.raises(ParseError) as caught:
        parse(text)
    assert caught.value.span is not None
    assert text[slice(*caught.value.span)] == "with at most -3 N"
    assert caught.value.suggestions == ("a force is more than 0 and at most 1000 N",)
