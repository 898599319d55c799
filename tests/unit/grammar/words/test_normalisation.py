"""The plain form of a sentence, and the way back to its columns."""

from __future__ import annotations

import pytest

from grammar import parse
from grammar.words.lexicon import default_lexicon
from grammar.words.normalisation import normalise

CONTRACTIONS = default_lexicon().contractions


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("  Push\tthe \n BOX ", "push the box"),
        ("push the box!!", "push the box"),
        ("push the box, gently", "push the box , gently"),
        ("the ice-tea box", "the ice tea box"),
        ("10-cm", "10 cm"),
        ("−5 cm", "-5 cm"),
        ("1.5 m.", "1.5 m"),
        (".5 m", ".5 m"),
        ("box. push", "box . push"),
        ("１０ cm", "10 cm"),
        ("٣ cm", "3 cm"),
        ("don’t", "do not"),
        ("“red mug”", '"red mug"'),
        ("'red mug'", '"red mug"'),
        ("the dog's bowl", "the dog's bowl"),
        ("Straße", "strasse"),
        ("box — now", "box , now"),
    ],
)
def test_plain_form(text: str, plain: str) -> None:
    assert normalise(text, CONTRACTIONS).text == plain


@pytest.mark.parametrize(
    ("text", "plain", "original"),
    [
        ("  Push   the BOX", "box", "BOX"),
        ("please don’t topple", "do not", "don’t"),
        ("große STRASSE", "grosse", "große"),
        ("a １０ cm", "10", "１０"),
        ("ice-tea box", "ice tea", "ice-tea"),
    ],
)
def test_columns_lead_back(text: str, plain: str, original: str) -> None:
    sentence = normalise(text, CONTRACTIONS)
    start = sentence.text.index(plain)
    span = sentence.original_span(start, start + len(plain))
    assert text[slice(*span)] == original


def test_letters_without_a_name_are_letters() -> None:
    # Python knows no single names for the letters of some scripts.
    assert normalise("push the \U00017000", CONTRACTIONS).text == "push the \U00017000"


def test_question_mark_is_seen() -> None:
    assert normalise("could you push it ?", CONTRACTIONS).question
    assert not normalise("push it", CONTRACTIONS).question


def test_spans_of_the_first_sentence() -> None:
    text = "Please push  the Ice-Tea box 10cm away, without toppling it."
    (frame,) = parse(text).frames

    def words(spans: tuple[tuple[int, int], ...]) -> list[str]:
        return [text[slice(*span)] for span in spans]

    assert frame.object is not None
    assert words(frame.spans) == ["push"]
    assert words(frame.object.spans) == ["Ice-Tea box"]
    assert words(frame.goal.spans) == ["10cm", "away"]
    assert words(frame.constraints[0].spans) == ["without toppling it"]


def test_split_verb_has_two_spans() -> None:
    assert parse("knock the box over").frames[0].spans == ((0, 5), (14, 18))
    assert parse("knock over the box").frames[0].spans == ((0, 10),)


def test_from_the_left_gives_contact_and_direction_the_same_words() -> None:
    (frame,) = parse("push the box from the left").frames
    assert frame.goal.spans == frame.constraints[0].spans == ((13, 26),)
    (frame,) = parse("push the box from the left away").frames
    assert frame.goal.spans == ((27, 31),)


def test_words_in_another_order_have_a_span_of_the_sentence() -> None:
    said = normalise("the jar", {})
    turned = said.words_in((4, 7), (0, 3))
    assert turned.text == "jar the"
    assert turned.original_span(0, len(turned.text)) == (0, 7)
