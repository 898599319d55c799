"""Names of known objects without a verb or an article, and prose that never becomes a name."""

from __future__ import annotations

import pytest

from grammar.errors import ParseError
from grammar.parser import default_parser, parser_for
from tests.patience import hang_ended

PARSER = parser_for(["coffee box", "cereal box", "mug", "ice tea cup"])


@pytest.mark.parametrize(
    ("text", "dialogue", "name"),
    [
        ("the coffee box", "correct", "coffee box"),
        ("hang on, the mug", "correct", "mug"),
        ("no mug", "correct", "mug"),
        ("coffee box again", "repeat", "coffee box"),
        ("now cereal box", "same", "cereal box"),
        ("the coffee box next", "correct", "coffee box"),
        ("the coffee one", "correct", "coffee"),
        ("the mug?", "repeat", "mug"),
        ("both of them", "correct", "both of them"),
    ],
)
def test_a_name_alone_is_a_remark(text: str, dialogue: str, name: str) -> None:
    (frame,) = PARSER.parse(text).frames
    assert frame.object is not None
    assert (frame.dialogue, frame.object.text) == (dialogue, name)


def test_an_article_may_be_left_out() -> None:
    asked = PARSER.parse("is mug lighter than coffee box").frames
    assert [f.query for f in asked] == ["compare"]
    said = PARSER.parse("push lighter one right 3 cm").frames
    assert [f.object and f.object.text for f in said] == ["lighter one"]


@pytest.mark.parametrize(
    ("text", "means"),
    [
        ("cereal behind the mug", "move the cereal behind the mug"),
        ("cup and coffee 5 cm closer",
         "move the cup toward the robot by 5 cm, then move the coffee toward the robot by 5 cm"),
        ("red box further back", "move the red box away"),
        ("mug back on its feet", "stand the mug upright"),
        ("brown one, a quarter turn", "turn the brown one by 90 degrees"),
        ("everything back please", "put everything back to where it was"),
        ("which is heavier, cereal or coffee?", "is the cereal heavier than the coffee?"),
        ("all three to the front", "move all three toward the robot"),
    ],
)  # fmt: skip
def test_a_thing_and_where_it_goes_is_a_command(text: str, means: str) -> None:
    assert PARSER.parse(text).paraphrase == means


@pytest.mark.parametrize("text", ["the cereal on the left", "the coffee in the middle"])
def test_a_place_that_may_tell_things_apart_moves_none(text: str) -> None:
    (frame,) = PARSER.parse(text).frames
    assert (frame.dialogue, frame.action) == ("correct", None)


def test_many_names_are_read_in_one_way() -> None:
    with hang_ended(), pytest.raises(ParseError):
        PARSER.parse("the mug and " * 40 + "x")


@pytest.mark.parametrize(
    "text",
    ["the mug was pushed", "the weather", "sorry, my mistake", "the box of tricks", "mug off"],
)
def test_prose_is_no_name(text: str) -> None:
    with pytest.raises(ParseError):
        PARSER.parse(text)


def test_without_names_no_name_is_known() -> None:
    with pytest.raises(ParseError) as raised:
        default_parser().parse("the coffee box")
    assert raised.value.code == "no_verb"
