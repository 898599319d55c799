"""Questions and remarks that leave out what was said before."""

from __future__ import annotations

import pytest

from grammar import parse
from grammar.errors import ParseError


@pytest.mark.parametrize(
    ("text", "query", "dialogue"),
    [
        ("and if you push it at the top?", "predict", None),
        ("why to the left?", "why", None),
        ("why not the coffee box?", "why", None),
        ("and than the mug?", "compare", "repeat"),
        ("which of the boxes is the heaviest?", "compare", None),
        ("which of the two is taller?", "compare", None),
        ("could it be moved?", "possible", None),
        ("and what about the jar, is it heavy?", "value", None),
        ("go on then", None, "do"),
        ("leave it where it is", None, "stop"),
        ("which boxes can you tip over?", "capable", None),
        ("push them away by 3 cm", None, None),
        ("the mug, 5 cm away", None, "same"),
        ("away from you, not toward you", None, "correct"),
        ("please, could the mug be pushed to the left?", None, None),
        ("push that one away then, at the bottom", None, None),
    ],
)
def test_it_is_read_as_it_is_meant(text: str, query: str | None, dialogue: str | None) -> None:
    (frame,) = parse(text).frames
    assert (frame.query, frame.dialogue) == (query, dialogue)


@pytest.mark.parametrize(
    "text",
    ["what would be pushing it?", "push it to the left, not left", "leave the mug where it is"],
)
def test_what_may_mean_something_else_is_refused(text: str) -> None:
    with pytest.raises(ParseError):
        parse(text)
