"""No word is lost: each phrase of a sentence that is read makes a difference to its frames.

A phrase is left out of the sentence; then other frames are read, or none. What may be left out
stands on two lists, besides the words that say nothing (`SILENT`): words that govern a phrase which
is understood without them, and phrases that say again what the sentence, or its verb, says anyway.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import chain
from random import Random

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from benchmarks.sentences import understood
from grammar import Command, ParseError, parse
from grammar.parser import default_parser
from grammar.phrases.lalr_parser import LalrParser, UnexpectedTokenError, parse_table
from grammar.words.asides import Asides
from grammar.words.normalisation import Normalised, normalise
from grammar.words.phrase_lexer import PhraseLexer, Token
from tests.property.test_grammar_properties import (
    LEXICON,
    SEEDS,
    SILENT,
    damaged_sentence,
    meaning,
    read,
)
from tests.property.test_grammar_properties import PHRASES as ANY_PHRASE
from tests.sizes import examples

GOVERNING = {
    "AT": "at 2 cm/s",
    "BY": "by 10 cm",
    "ENSURE": "make sure it does not tip",
    "FROM": "from 2 to 4 cm",
    "HOW_MUCH_OF": "how much of it will spill?",
    "IN": "in ten seconds, which is the most as well",
    "IT": "without toppling it, the object itself",
    "ITS": "half its width, the object's own",
    "I_MEANT": "no, I meant the mug",
    "MUST": "it must stay upright",
    "NO": "no, I meant the mug",
    "OF": "the top of the mug",
    "ON_IT": "the box with number 5 on it",
    "PART_OF": "100 ml of milk",
    "SO": "so that it does not tip",
    "TELL": "tell me how heavy it is, where 'how heavy it is?' is asked as well",
    "TIMES": "three times its width",
    "TO_BE": "I'd like it to be pushed",
    "UPON": "press on the mug",
    "UNTIL": "until it is level with the jar",
    "WHAT_IS": "what is its weight?, where 'its weight?' is asked as well",
    "WILL": "will it topple?, where 'it topples?' is asked as well",
    "WISH": "I'd like it to be pushed",
    "WITH": "with 5 N",
    "WITHOUT": "without toppling it, further things to avoid may follow without it",
    "Y": "to x 0.6 y 0.1",
}
"""Terminals that open a phrase, each with an example."""

SAID_AGAIN = {
    "AMOUNT": "nudge it a little",
    "ANGLE_UNIT turn": "turn it a quarter turn",
    "BOUND": "about 10 cm is 10 cm; in at most 5 s is in 5 s",
    "DO": "go ahead, push it",
    "DIRECTION": "hand it to me; down towards me",
    "FILLED": "filled is filled to the brim",
    "FROM_TABLE": "all stands on the table",
    "HEIGHT_REFERENCE": "lifted by 10 cm is lifted 10 cm above the table",
    "LENGTH_UNIT": "to x 0.5 y 0.1 metres",
    "LET_GO": "a push lets go",
    "ME": "things are handed to me",
    "MORE": "again, a bit more",
    "NOT not": "all of them, but not the red one",
    "OR_MORE": "at most 5 N at most",
    "ON_TABLE": "put down is put on the table",
    "PARTICLE": "tipping over; turn up",
    "RELATION from": "pour from the jug",
    "REPEAT": "stand it up again; no, push it again",
    "SETTLES": "what is tilted falls back",
    "SOME_OF": "pour some water, roughly 80 ml",
    "STOP": "stop, no, push it to the left: what is said next stops it as well",
    "THINK": "do you think it will topple?",
    "UNDO": "revert that, undo it",
    "VERB": "push it left, then push it right",
    "WAY": "all the way to the edge",
    "WORD": "tipping the tall mug over, where it says which mug already",
}
"""Terminals, or phrases of them, that may say what is said already, each with an example."""

_PARSER = LalrParser(parse_table(), PhraseLexer(LEXICON))
_ASIDES = Asides(LEXICON, PhraseLexer(LEXICON).phrases)


def without_effect(command: Command) -> Iterator[Token]:
    """Yield each phrase without which the same frames are read."""
    sentence = _as_it_is_read(command)
    mark = "?" if sentence.question else ""
    twice = _columns_of_joined(command)
    for token in _PARSER.parse(sentence.text).leaves() if sentence.text else ():
        start, _ = sentence.original_span(token.start_pos, token.end_pos)
        if token.type in SILENT or start in twice:
            continue
        words = f"{sentence.text[: token.start_pos]} {sentence.text[token.end_pos :]}".split()
        try:
            rest = parse(" ".join(words) + mark)
        except ParseError:
            continue
        if meaning(rest.frames) == meaning(command.frames):
            yield token


def _as_it_is_read(command: Command) -> Normalised:
    """The plain form of a command that the grammar reads, which may be put in other words."""
    whole = normalise(command.text, LEXICON.contractions)
    sentence = _ASIDES.left_out(whole)
    if not sentence.text or command.frames[0].dialogue == "thank":
        return replace(sentence, text="")
    for said in chain([sentence], default_parser()._other_readings(sentence, whole, None)):
        with suppress(UnexpectedTokenError):
            _PARSER.parse(said.text)
            if all(_lies_in(span, command.asides) for span in said.asides):
                return said
    raise AssertionError(command.text)


def _lies_in(span: tuple[int, int], spans: Iterable[tuple[int, int]]) -> bool:
    return any(start <= span[0] and span[1] <= end for start, end in spans)


def _columns_of_joined(command: Command) -> set[int]:
    """Columns of constraints that are said in several places: "gently … carefully"."""
    clauses = [clause for frame in command.frames for clause in frame.constraints]
    spans = [span for clause in clauses if len(clause.spans) > 1 for span in clause.spans]
    return {column for span in spans for column in range(*span)}


def lost(command: Command) -> list[str]:
    """The phrases of a sentence that neither make a difference nor stand on a list."""
    known = GOVERNING.keys() | SAID_AGAIN.keys()
    tokens = [(t.type, f"{t.type} {t}") for t in without_effect(command)]
    return [said for kind, said in tokens if known.isdisjoint((kind, said))]


@pytest.mark.parametrize("start", range(8))
def test_no_phrase_of_the_test_set_is_lost(start: int) -> None:
    found = {text: lost(parse(text)) for text in understood()[start::8]}
    assert not {text: words for text, words in found.items() if words}


@settings(max_examples=examples(400), deadline=None)
@given(SEEDS, st.integers(0, 9), ANY_PHRASE)
@example(0, 7, "even more")
def test_no_phrase_of_a_damaged_sentence_is_lost(seed: int, damage: int, phrase: str) -> None:
    command = read(damaged_sentence(Random(seed), damage, phrase))
    assert command is None or not lost(command)


def test_a_second_place_of_an_object_is_that_of_the_first_ones_reference() -> None:
    (frame,) = parse("push the mug near the box that is behind the jar to the left").frames
    assert frame.object is not None
    (box,) = frame.object.reference
    assert (frame.object.relation, box.relation) == ("next_to", "behind")
    assert [jar.text for jar in box.reference] == ["jar"]
