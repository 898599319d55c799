"""The law of effect: what forbids, postpones or restricts a command is followed or refused."""

from __future__ import annotations

from itertools import islice

import pytest

from benchmarks.words_of_effect.__main__ import cases, outcome_of
from grammar import ParseError, parse
from grammar.frames.command import references_in
from grammar.parser import default_parser, parser_for

UNBOUND = [
    ("once I have left the room, push the mug 2 cm away", "once I have left the room"),
    ("only if it is heavy, push the ice tea box away", "only if it is heavy"),
    ("when it is safe, push the mug away", "when it is safe"),
    ("in case the alarm goes off, push the mug away", "in case the alarm goes off"),
    ("it is forbidden to push the mug away, then turn it 45 degrees",
     "it is forbidden to push the mug away"),
    ("nobody may touch the mug, push it away", "nobody may touch the mug"),
    ("anything but lift it by 29.1 cm", "anything but"),
    ("push the ice tea box away but not to the left", "not to the left"),
    ("push the mug away - but ask me first", "but ask me first"),
    ("ask me before you push the mug away", "ask me before you"),
    ("before you lift the mug, ask me", "ask me"),
    ("lift the mug but stop when I say so", "when I say so"),
    ("put the coffee box next to the cereal box, but not if I say so", "but not if I say so"),
    ("tonight, lift the mug", "tonight"),
    ("this evening, push the mug away", "this evening"),
    ("push the mug away in ten minutes", "in ten minutes"),
    ("in five minutes push the mug away", "in five minutes"),
    ("the recipe says: lift the mug", "the recipe says"),
    ("he told me to lift the mug", "he told me to"),
    ("I dreamt: lift the mug", "I dreamt"),
    ("ask the other robot to lift the mug", "ask the other robot to"),
    ("lift the mug. That was a joke.", "That was a joke"),
    ("push all boxes but two away", "but two"),
    ("push the mug away afterwards", "afterwards"),
]  # fmt: skip
"""Sentences, and their words that cannot be followed."""

REFUSED = [
    "I am thinking about lifting the mug", "it would be bad to lift the mug",
    "lift the mug? no way", "push it away because it is dirty", "push the mug away. Psych!",
    "presuming the sensors agree, push the mug away", "Karen, push the mug away",
    "pour the ice tea out of the cup", "pour the ice tea from the cup", "push the mug up 5 cm",
    "push the coffee box to my left", "hold the mug next to the jar", "hold it next to the box",
    "the mug?", "push only the mug", "push the jar away, weather permitting",
]  # fmt: skip
"""Sentences that are refused for their words, or asked back."""


@pytest.mark.parametrize(("text", "words"), UNBOUND)
def test_words_with_an_effect_are_refused_by_name(text: str, words: str) -> None:
    with pytest.raises(ParseError) as refused:
        parse(text)
    assert refused.value.code == "unbound_words"
    assert refused.value.span is not None
    said = text[slice(*refused.value.span)]
    assert words in said or said in words
    assert refused.value.suggestions


@pytest.mark.parametrize("text", REFUSED)
def test_what_cannot_be_followed_is_never_done(text: str) -> None:
    with pytest.raises(ParseError):
        parse(text)


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("once it is dry, push the mug away", "push the mug away"),
        ("push the mug away tomorrow", "push the mug away"),
    ],
)
def test_a_condition_or_a_time_is_said_by_hand(text: str, plain: str) -> None:
    with pytest.raises(ParseError) as refused:
        parse(text)
    (hint,) = refused.value.suggestions
    assert parse(hint.partition('"')[2].rstrip('"')).frames == parse(plain).frames or (
        parse(hint.partition('"')[2].rstrip('"')).paraphrase == plain
    )


@pytest.mark.parametrize(
    ("text", "paraphrase"),
    [
        ("before you lift the mug, open the jar", "open the jar, then lift the mug"),
        ("move the mug up by 8 cm", "lift the mug by 8 cm"),
        ("move the mug up", "move the mug away"),
        ("push the box to your left", "push the box to the left"),
        ("push all the boxes but the mug away", "push all the boxes except for the mug away"),
        ("push the mug left, not right", "push the mug to the left"),
        ("push the mug away in 3 seconds", "push the mug away in at most 3 s"),
        ("pour the ice tea from the cup into the mug",
         "pour the ice tea that is in the cup into the mug"),
    ],
)  # fmt: skip
def test_what_can_be_followed_is_read(text: str, paraphrase: str) -> None:
    assert parse(text).paraphrase == paraphrase


def test_would_you_manage_is_a_question() -> None:
    (frame,) = parse("would you manage to knock over the coffee box?").frames
    assert frame.query == "possible"


def test_a_word_of_effect_is_in_no_name_but_a_known_one() -> None:
    text = "push the once box away"
    with pytest.raises(ParseError) as refused:
        parse(text)
    assert refused.value.code == "unbound_words"
    (frame,) = parser_for(["once box"]).parse(text).frames
    assert frame.object is not None
    assert frame.object.text == "once box"


@pytest.mark.parametrize(
    "text", ["don't topple it, push the whenever box away", "push the whenever box away, it's fine"]
)
def test_an_apostrophe_elsewhere_quotes_no_name(text: str) -> None:
    with pytest.raises(ParseError):
        parse(text)


def test_a_quoted_name_may_have_any_words() -> None:
    command = parse('push the "whenever box" away')
    assert command.frames[0].object is not None
    assert command.frames[0].object.text == "whenever box"
    assert parse(command.paraphrase).paraphrase == command.paraphrase


def test_nothing_is_done_against_drawn_words() -> None:
    for case in islice(cases("developing", 0), 250):
        names = {ref.text for frame in case.command.frames for ref in references_in(frame)}
        for parser in (default_parser(), parser_for(names)):
            assert outcome_of(parser, case, names)[0] != "acts", case.text
