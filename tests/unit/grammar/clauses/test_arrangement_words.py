"""Words for stacking, standing up, laying down and changing places."""

from __future__ import annotations

import pytest

from grammar import ParseError, parse
from grammar.frames import command as g


def only_frame(text: str) -> g.Frame:
    (frame,) = parse(text).frames
    return frame


@pytest.mark.parametrize("text", [
    "put the box back on its feet", "get the box on its feet", "turn the box right side up",
    "set the box the right way up", "put the box on its base", "tip the box upright",
])  # fmt: skip
def test_what_fell_is_stood_up(text: str) -> None:
    assert isinstance(only_frame(text).goal, g.Upright)


@pytest.mark.parametrize(
    "text", ["lay the box down", "lay down the box", "lay the box on its side"]
)
def test_what_is_laid_down_comes_to_lie(text: str) -> None:
    assert isinstance(only_frame(text).goal, g.Topple)


@pytest.mark.parametrize("text", ["stack the mug on the book", "pile the mug onto the book"])
def test_what_is_stacked_is_put_on(text: str) -> None:
    goal = only_frame(text).goal
    assert isinstance(goal, g.Place)
    assert isinstance(goal.reference, tuple)
    assert (goal.relation, [ref.text for ref in goal.reference]) == ("on", ["book"])


@pytest.mark.parametrize("text", [
    "stack the mug and the book", "put the mug and the book on top of each other",
    "pile up the mug and the book", "can you stack the mug and the book?",
])  # fmt: skip
def test_things_are_stacked_without_saying_which_is_lowest(text: str) -> None:
    command = parse(text)
    assert [frame.object and frame.object.text for frame in command.frames] == ["mug", "book"]
    for frame in command.frames:
        assert isinstance(frame.goal, g.Place)
        assert (frame.goal.relation, frame.goal.reference) == ("stacked", ())
    assert parse(command.paraphrase).paraphrase == command.paraphrase


@pytest.mark.parametrize(
    "text",
    ["swap the mug with the box", "exchange the mug for the box", "swap the mug and the box"],
)
def test_each_of_two_goes_where_the_other_is(text: str) -> None:
    frames = parse(f"{text} without touching the jar").frames
    assert [frame.object and frame.object.text for frame in frames] == ["mug", "box"]
    for frame in frames:
        assert isinstance(frame.goal, g.Place)
        assert frame.goal.relation == "place_of"
        assert [clause.kind for clause in frame.constraints] == ["no_touch"]


def test_nothing_but_a_swap_is_done_with_another_thing() -> None:
    with pytest.raises(ParseError):
        parse("push the mug with the box")
    assert len(parse("swap the mug and the box with one finger").frames) == 2


@pytest.mark.parametrize("text", ["tell me what is on the book", "what stands on the book?"])
def test_what_stands_on_it_is_asked(text: str) -> None:
    frame = only_frame(text)
    assert frame.query == "value"
    assert isinstance(frame.goal, g.Parameters)
    assert frame.goal.which == ("load",)


@pytest.mark.parametrize(
    ("text", "understood"),
    [
        ("swap the mug and the box", "put the mug and the box in each other's place"),
        (
            "put the mug, the tin and the box in a row without touching the jar",
            "put the mug, the tin and the box in a row without touching the jar",
        ),
    ],
)
def test_what_stands_to_each_other_is_said_at_once(text: str, understood: str) -> None:
    said = parse(text)
    assert said.paraphrase == understood
    again = parse(said.paraphrase).frames
    assert [f.object and f.object.text for f in again] == [
        f.object and f.object.text for f in said.frames
    ]
    assert [f.goal.kind for f in again] == [f.goal.kind for f in said.frames]


@pytest.mark.parametrize("text", ["what is in the bin?", "tell me what is inside the bin"])
def test_what_stands_in_it_is_asked(text: str) -> None:
    frame = only_frame(text)
    assert frame.query == "value"
    assert isinstance(frame.goal, g.Parameters)
    assert frame.goal.which == ("fill",)


def test_what_is_in_it_is_poured() -> None:
    goal = only_frame("pour what is in the jar into the mug").goal
    assert isinstance(goal, g.Pour)
