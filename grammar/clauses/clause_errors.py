"""Refusals that several steps of reading share."""

from __future__ import annotations

from collections.abc import Sequence

from grammar.errors import ParseError
from grammar.phrases import phrase_parts as ph
from grammar.words.normalisation import Normalised


def unexpected_part(part: ph.Part, sentence: Normalised) -> ParseError:
    """Words that have no place where they stand."""
    written = sentence.words_as_written(part.span)
    message = f'"{written}" is not understood here'
    return ParseError("unexpected_words", message, part.span, (f'leave out "{written}"',))


def several_objects(thing: ph.Thing, sentence: Normalised) -> ParseError:
    """A second object."""
    return ParseError(
        "several_objects",
        f'"{sentence.words_as_written(thing.span)}" is a second object',
        thing.span,
        ("say one command for each object",),
    )


def no_object(verb: ph.Verb, parts: Sequence[ph.Part]) -> ParseError:
    """A verb without what it is done to."""
    after = [part for part in parts if part.span[0] >= verb.span[1]]
    return ParseError(
        "no_object",
        "the name of an object is missing",
        after[0].span if after else verb.span,
        (f'say what to {verb.word}: "{verb.word} the box"',),
    )


def no_verb(sentence: Normalised, parts: Sequence[ph.Part] = ()) -> ParseError:
    """Nothing says what to do."""
    said = [part for part in parts if not isinstance(part, ph.Filler)] or parts
    span = said[0].span if said else sentence.original_span(0, len(sentence.text))
    message = "the sentence does not say what to do"
    return ParseError("no_verb", message, span, ('say, for example, "push the box away"',))
