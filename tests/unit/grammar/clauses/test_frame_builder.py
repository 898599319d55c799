"""No word of a clause is dropped: what goes together, and what is refused instead."""

from __future__ import annotations

import pytest

from grammar import Frame, ParseError, parse


def read(text: str) -> Frame:
    (frame,) = parse(text).frames
    return frame


def said(text: str) -> list[str]:
    """The words of the action, the query and the dialogue."""
    return sorted(text[slice(*span)] for span in read(text).spans)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("how hard must I push it to make it slide?", ["how hard must I", "push",
                                                       "to make it slide"]),
        ("how hard can I push it until it tips?", ["how hard can I", "push", "until it tips"]),
        ("how hard can I push it before it tips?", ["before it tips", "how hard can I", "push"]),
        ("will it topple if you push it?", ["push", "will it topple"]),
        ("stand it up again", ["again", "stand", "up"]),
        ("push it again", ["again", "push"]),
        ("no, weigh it", ["no", "weigh"]),
        ("push the box, not the mug", ["not the mug", "push"]),
    ],
)  # fmt: skip
def test_words_of_questions_and_remarks_are_kept(text: str, words: list[str]) -> None:
    assert said(text) == words


def test_closer_to_make_it_tip_is_a_direction_and_a_purpose() -> None:
    frame = read("how hard must I pull the bottle closer to make it lean?")
    assert frame.goal.model_dump()["direction"] == "toward"
    assert frame.event == "tilts"
    assert read("pull it closer to the mug").goal.model_dump()["toward"]["text"] == "mug"


@pytest.mark.parametrize("text", ["push again", "no, slide", "why did you push?"])
def test_what_is_not_named_is_it(text: str) -> None:
    frame = read(text)
    assert frame.object is not None
    assert frame.object.pronoun


def test_pronoun_may_be_told_apart() -> None:
    command = parse("push that one on the left")
    assert command.paraphrase == "push that one on the left"
    (frame,) = command.frames
    assert frame.object is not None
    assert (frame.object.qualities, frame.object.noun) == (("left",), "")


@pytest.mark.parametrize(
    "text", ["push it so lightly that it does not move", "push it without moving it"]
)
def test_touch_without_motion_has_no_goal(text: str) -> None:
    command = parse(text)
    assert command.frames[0].goal.kind == "none"
    assert parse(command.paraphrase).frames[0].goal.kind == "none"


@pytest.mark.parametrize(
    ("name", "said_as"),
    [("robot", '"robot"'), ("rest", '"rest"'), ("front", '"front"'), ("table leg", '"table leg"'),
     ("left box", "the left box"), ("back", '"back"')],
)  # fmt: skip
def test_names_that_end_phrases_are_quoted(name: str, said_as: str) -> None:
    command = parse(
        f'push it against "{name}"' if '"' in said_as else f"push it against the {name}"
    )
    assert command.paraphrase == f"push it against {said_as}"


@pytest.mark.parametrize(
    ("text", "at"),
    [
        ("can you push it again?", "again"),
        ("stop, why did you not?", "stop"),
        ("what if I tilt it, actually", "actually"),
        ("pull what is the size of it?", "pull"),
        ("will it topple if you push it the box", "box"),
        ("this again", "this"),
        ("the mug again", "mug"),
        ("topple the box that is at the edge", "that is"),
        ("push the box standing away from the mug", "standing"),
        ("the other way round even more", "even more"),
        ("do it more", "more"),
        ("push it away with at most 5 N or more", "or more"),
        ("reverse that in the opposite direction", "in the opposite direction"),
    ],
)
def test_what_says_nothing_is_refused_and_never_dropped(text: str, at: str) -> None:
    with pytest.raises(ParseError) as caught:
        parse(text)
    assert caught.value.span is not None
    assert text[slice(*caught.value.span)] == at


@pytest.mark.parametrize(
    ("words", "code"),
    [("is supposed to be", "unbound_words"), ("definitely should really be", "unexpected_words")],
)
def test_a_state_that_nothing_tells_is_refused_behind_a_command(words: str, code: str) -> None:
    with pytest.raises(ParseError) as refused:
        parse(f"push the box {words}")
    assert refused.value.code == code
