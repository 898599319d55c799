"""What a clause is about: the object that it names, or those of a list, or "it"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from grammar.clauses.clause_errors import no_object, several, unexpected
from grammar.clauses.constraint_builder import require_same
from grammar.frames import command as g
from grammar.phrases.phrase_parts import (
    AskPart,
    AvoidPart,
    ConstraintPart,
    Part,
    RemarkPart,
    ThingPart,
    VerbPart,
)
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised

NOBODY = ThingPart((0, 0), g.ObjectRef(text="it", pronoun=True))
"""What a remark is about that names nothing."""


def subjects(
    parts: Sequence[Part],
    ask: Sequence[AskPart],
    remarks: Sequence[RemarkPart],
    lexicon: Lexicon,
    sentence: Normalised,
) -> list[ThingPart]:
    """What a clause with a verb is about: one object, or several of a list.

    Raises:
        ParseError: `no_object`, `several_objects`, `other_object`, `unexpected_words`.
    """
    named = [part.thing for part in ask if part.thing is not None]
    things = [part for part in parts if isinstance(part, ThingPart)]
    if named and len(things) > 1:
        raise several(things[1], sentence)
    if named and named[0].ref.pronoun and things:
        return things
    if named and things and not things[0].ref.pronoun:
        require_same(named[0], things[0], ask[0], sentence)
    if named:
        spans = named[0].ref.spans + tuple(s for t in things for s in t.ref.spans)
        return [replace(named[0], ref=named[0].ref.model_copy(update={"spans": spans}))]
    if not things and (remarks or any(part.query == "why" for part in ask)):
        return [NOBODY]
    verb = next(part for part in parts if isinstance(part, VerbPart))
    if not things:
        raise no_object(verb, parts)
    if not (verb.passive or remarks or ask) and things[0].span < verb.span:
        raise unexpected(things[0], sentence)
    if any(thing.ref.text.casefold() == "them" for thing in things):
        raise several(things[0], sentence)
    if things[0].ref.pronoun and (earlier := _restricted_before(things[0], parts)):
        return [earlier]
    if len(things) > 1 and not _listed(things, lexicon, sentence):
        raise several(things[1], sentence)
    return things


def _restricted_before(thing: ThingPart, parts: Sequence[Part]) -> ThingPart | None:
    """What "it" stands for after "be careful not to topple the jar when you push it"."""
    named = [part.thing for part in parts if isinstance(part, AvoidPart)]
    named += [part.subject for part in parts if isinstance(part, ConstraintPart)]
    for other in named:
        if other is not None and not other.ref.pronoun and other.span < thing.span:
            spans = other.ref.spans + thing.ref.spans
            return replace(other, ref=other.ref.model_copy(update={"spans": spans}))
    return None


def _listed(things: Sequence[ThingPart], lexicon: Lexicon, sentence: Normalised) -> bool:
    """Whether things stand side by side, joined by "and"."""
    for one, other in pairwise(things):
        between = sentence.original[one.span[1] : other.span[0]].casefold()
        words = between.replace(",", " , ").split()
        joined = set(words) <= {",", "and", "&", *lexicon.terminals["THE"], "a", "an"}
        if not joined or not {",", "and"} & set(words):
            return False
    return True
