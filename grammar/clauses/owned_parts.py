"""A part of an object and the object itself: "the lid of the cup", "the cup's lid"."""

from __future__ import annotations

import re

from grammar.frames import command as g
from grammar.phrases import phrase_parts as ph
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised

QUOTES = ('"', "'", "“", "‘", "„", "«")
_OF = re.compile(
    r"(?P<part>.+?)\s+(?P<of>of)\s+(?:(?:the|an?|my|your|our)\s+)?(?P<whole>.+)",
    re.IGNORECASE | re.DOTALL,
)


_COMPOUND = re.compile(r"(?P<whole>.+?)(?:['’]s)?\s+(?P<part>\w+)(?P<of>)", re.DOTALL)


def part_and_owner(
    thing: ph.Thing, lexicon: Lexicon, sentence: Normalised
) -> tuple[str, g.Span, ph.Thing] | None:
    """Split "the lid of the cup" into the part, its span, and the whole."""
    start, end = thing.span
    name, quoted = sentence.original[start:end], sentence.original[:start].endswith(QUOTES)
    match = _OF.fullmatch(name) or _compound(name, lexicon)
    if match is None or quoted:
        return None
    span = start + match.start("whole"), start + match.end("whole")
    text = sentence.words_as_written(span)
    update: dict[str, object] = {"text": text, "spans": (span, *thing.ref.spans[1:])}
    first, _, counted = text.partition(" ")
    if ordinal := counted and lexicon.numbers.ordinals.get(first.casefold()):
        text = counted
        update |= {"text": text, "noun": text.casefold(), "ordinal": ordinal}
    if thing.ref.qualities:
        words = text.casefold().replace("-", " ").split()
        of_part = match["part"].casefold().split()
        own = sum(word in lexicon.adjectives for word in of_part)
        nouns = [w for w in words if w not in lexicon.adjectives and w not in lexicon.nobodies]
        update["qualities"] = thing.ref.qualities[own:]
        update["noun"] = " ".join(nouns) if update["qualities"] else ""
    ref = thing.ref.model_copy(update=update)
    part = " ".join(match["part"].casefold().split())
    words_of_part = start + match.start("part"), start + match.end("of")
    return part, words_of_part, ph.Thing(span, ref, thing.contents)


def _compound(name: str, lexicon: Lexicon) -> re.Match[str] | None:
    """A lid named behind what it belongs to: "the jar lid", "the jar's lid"; no "red lid"."""
    match = _COMPOUND.fullmatch(name)
    if match is None or match["part"].casefold() not in lexicon.lids:
        return None
    told = match["whole"].casefold().split()
    return None if all(word in lexicon.adjectives for word in told) else match
