"""Rows in the order in which their things are named, and pairs that are to be so far apart."""

from __future__ import annotations

import pytest

from grammar.parser import parser_for
from grammar.phrases.ordered_rows import row_in_order
from tests.patience import hang_ended

PARSER = parser_for(["coffee box", "cereal box", "mug", "ice tea cup", "tea tin"])


@pytest.mark.parametrize(
    ("text", "means"),
    [
        ("put the mug, the cup and the tin in a row in that order",
         "put the mug left of the cup, then put the tin right of the cup"),
        ("line up the cup, the mug and the coffee box from right to left, 5 cm apart",
         "put the cup 5 cm right of the mug, then put the coffee box 5 cm left of the mug"),
        ("set the mug and the cup 10 cm apart", "put the mug 10 cm next to the cup"),
        ("move the mug and the cup further apart", "move the mug away from the cup"),
    ],
)  # fmt: skip
def test_each_stands_beside_the_one_before(text: str, means: str) -> None:
    assert PARSER.parse(text).paraphrase == means


@pytest.mark.parametrize("text", ["push the mug left to right", "put the mug and the cup in a row"])
def test_without_an_order_there_is_none(text: str) -> None:
    assert row_in_order(text) is None


@pytest.mark.parametrize("repeated", ["a , ", "the mug and ", "left , and then "])
def test_no_repetition_takes_long(repeated: str) -> None:
    with hang_ended():
        row_in_order((repeated * 300)[:1000] + "left")
