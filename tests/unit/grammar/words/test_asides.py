"""What is left out of a sentence before it is read, and what stays."""

from __future__ import annotations

import pytest

from grammar import ParseError, parse
from grammar.parser import parser_for


@pytest.mark.parametrize(
    ("text", "asides"),
    [
        ("push the mug away", []),
        ("uh, push the mug away, thanks", ["uh", "thanks"]),
        ("push the mug, no wait, the jar away", ["the mug, no wait"]),
        ("push the mug away, no, the jar", ["the mug", "no"]),
        ("push the the jar", ["the"]),
    ],
)
def test_asides_are_kept_with_their_places(text: str, asides: list[str]) -> None:
    assert [text[start:end] for start, end in parse(text).asides] == asides


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("push the jar until it, er, touches the mug", "push the jar until it touches the mug"),
        ("push the jar until it touches... the mug", "push the jar until it touches the mug"),
        ("slide it 2, how should I say, inches away", "slide it 2 inches away"),
        ("push it with at most 3, I guess, N", "push it with at most 3 N"),
        ("push it to the left of the, er, bowl", "push it to the left of the bowl"),
        ("lift it 15 cm, correction, 8 cm", "lift it 8 cm"),
        ("push the jar, but it must not touch the mug", "push the jar without touching the mug"),
        ("turn it by half a right angle", "turn it by 45 degrees"),
        ("pull the tea mm box 2 inches to the left", "pull the tea box 2 inches to the left"),
        ("turn the blue okay mug 45 degrees", "turn the blue mug 45 degrees"),
        ("push well the jar to the left", "push the jar to the left"),
        (
            "let the jar have a turn 45 degrees counterclockwise",
            "give the jar a turn 45 degrees counterclockwise",
        ),
    ],
)
def test_pauses_within_a_phrase_change_nothing(text: str, plain: str) -> None:
    assert parse(text).paraphrase == parse(plain).paraphrase


@pytest.mark.parametrize("text", ["no, the jar", "no, to the left", "actually, push the jar"])
def test_where_nothing_stands_before_it_a_correction_stays_a_remark(text: str) -> None:
    command = parse(text)
    assert command.frames[0].dialogue == "correct"
    assert not command.asides


@pytest.mark.parametrize(
    "text", ["push the mug, no, gently", "push the mug 5 cm away, no, lift it"]
)
def test_what_has_no_counterpart_is_refused_at_its_mark(text: str) -> None:
    with pytest.raises(ParseError) as raised:
        parse(text)
    assert raised.value.code == "unexpected_words"
    assert raised.value.span == (text.index("no"), text.index("no") + 2)


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("turn the jar 30 degrees left at the top - no, turn the jar 30 degrees left at the bottom",
         "turn the jar 30 degrees left at the bottom"),
        ("push the jar left, no, right", "push the jar right"),
        ("push the jar 5 cm to the right. No, the tin", "push the tin 5 cm to the right"),
        ("push the jar 5 cm left slowly, no, 3 cm right", "push the jar 3 cm right slowly"),
        ("push the jar to the middle of the table, sorry, the tin",
         "push the tin to the middle of the table"),
        ("push the jar behind the tin with at most 5 N, just a moment, with one finger",
         "push the jar behind the tin with at most 5 N with one finger"),
        ("pull the jar left with at most 9 N, er, with at most 5 N",
         "pull the jar left with at most 5 N"),
        ("push the jar actually 5 cm away", "push the jar 5 cm away"),
    ],
)  # fmt: skip
def test_a_correction_takes_back_no_more_than_is_said_anew(text: str, plain: str) -> None:
    assert parse(text).paraphrase == parse(plain).paraphrase


def test_words_of_names_and_quotations_are_no_fillers() -> None:
    assert parse('push the "um, er" away').frames[0].object.text == "um, er"  # type: ignore[union-attr]
    command = parser_for(["um box"]).parse("push the um box away")
    assert command.frames[0].object is not None
    assert command.frames[0].object.text == "um box"


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("slide the jar to to the left", "slide the jar to the left"),
        ("push the jar next next to the tin", "push the jar next to the tin"),
        ("pull the jar a a little away with with at most 5 N",
         "pull the jar a little away with at most 5 N"),
    ],
)  # fmt: skip
def test_the_first_word_of_a_phrase_said_twice_is_stammered(text: str, plain: str) -> None:
    assert parse(text).paraphrase == parse(plain).paraphrase


def test_what_is_not_to_be_knocked_over_is_pushed_to_its_place() -> None:
    (frame,) = parse("push the mug next to the tin without knocking it over").frames
    assert frame.goal.kind == "place"
    assert [clause.kind for clause in frame.constraints] == ["no_topple"]


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("the jar needs pushing away", "push the jar away"),
        ("the jar could do with a push to the left", "push the jar to the left"),
        ("make sure the jar is pushed away", "push the jar away"),
        ("can the jar please be gently pushed away?", "gently push the jar away"),
        ("how about pushing the jar away?", "push the jar away"),
        ("the jar, please push it away", "push the jar away"),
        ("push the mug, er, the jar away", "push the jar away"),
        ("push the mug, wait a second, the jar away", "push the jar away"),
        ("push the jar away, will you?", "push the jar away"),
        ("push the jar away, OK?", "push the jar away"),
        ("push the jar to the right now", "push the jar to the right"),
        ("push the jar without exceeding 5 N", "push the jar with at most 5 N"),
    ],
)
def test_other_ways_of_asking_mean_the_same(text: str, plain: str) -> None:
    assert parse(text).paraphrase == parse(plain).paraphrase


@pytest.mark.parametrize(
    "text", ["could the jar be pushed away?", "would you be able to push the jar away?"]
)
def test_without_a_plea_it_stays_a_question(text: str) -> None:
    assert parse(text).frames[0].query == "possible"


def test_praise_alone_is_thanked_for() -> None:
    assert parse("well done, that was great").frames[0].dialogue == "thank"


def test_as_soon_as_gives_no_reason() -> None:
    (frame,) = parse("push the jar away as soon as it gets about to tip over").frames
    assert [clause.kind for clause in frame.constraints] == ["until"]


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("push the tin left of the lamp, no, right of the lamp", "push the tin right of the lamp"),
        ("push the tin left of the lamp, no, the bowl", "push the tin left of the bowl"),
        ("push the tin left of the lamp, no, the jar to the right", "push the jar to the right"),
        ("push the tin next to the jar, no, to the left", "push the tin to the left"),
        ("push the tin 2 cm away at 5 cm/s, no, 8 cm/s", "push the tin 2 cm away at 8 cm/s"),
        ("push the tin away with 5 N, sorry, 8 N", "push the tin away with 8 N"),
    ],
)
def test_a_correction_takes_the_place_of_what_is_like_it(text: str, plain: str) -> None:
    assert parse(text).paraphrase == parse(plain).paraphrase


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("push the, mate, tea, uhhh, box a, robot, little away", "push the tea box a little away"),
        ("push the tin away, sorry about that, 5 cm", "push the tin 5 cm away"),
        ("push the tin away dear robot", "push the tin away"),
    ],
)
def test_courtesy_may_stand_anywhere(text: str, plain: str) -> None:
    assert parse(text).paraphrase == parse(plain).paraphrase


def test_what_may_be_the_name_of_a_thing_is_no_courtesy() -> None:
    assert parse("the computer, push it away").paraphrase == "push the computer away"
    assert "friend" in parse("push the tin to the right of my friend").paraphrase
    for text in (
        "push the tin away, and the computer",
        "push the tin, please, the jar and the cup",
    ):
        with pytest.raises(ParseError):
            parse(text)


def test_a_question_about_what_was_asked_for_is_no_request() -> None:
    with pytest.raises(ParseError):
        parse("did I ask you to push the tin away")


@pytest.mark.parametrize("text", ["open the cup, the jar, I mean", "open the cup, the jar I meant"])
def test_what_is_meant_may_stand_before_the_mark_of_it(text: str) -> None:
    assert parse(text).paraphrase == "open the jar"
