"""How far a reason goes, and whether it is one.

"Push the tin away because it is ugly without touching the jar" gives its reason in four words; how
it is done stands behind it. A reason ends where the next thing that a command can say begins. One
that itself restricts what may be done ("as it must not fall"), or of which it is not clear where it
ends, is none, so that the sentence is refused where it stands.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

from grammar.words.lexicon import Lexicon
from grammar.words.numerals import DIGITS
from grammar.words.phrase_places import WORD, Phrases

_HOW = frozenset({"AVOID_DOING", "COMING_WITHIN", "COMPARED", "KEEPS", "LETTING", "MANNER",
                  "REPEAT", "UNTIL", "WITHOUT"})  # fmt: skip
_WHERE = frozenset({"AWAY_FROM_REGION", "BETWEEN", "DIRECTION", "FACE", "FROM_SIDE", "INTO",
                    "MUTUAL", "REGION", "REGION_OF_TABLE", "RELATION", "SENSE", "TOWARD",
                    "TOWARD_REGION"})  # fmt: skip
_MEASURES = frozenset({"ANGLE_UNIT", "FORCE_UNIT", "LENGTH_UNIT", "SPEED_UNIT", "TOOL"})
_BEFORE_MEASURES = frozenset({"A", "AT", "BOUND", "BY", "NUMBER", "SIDE", "THE", "WITH"})
_UNCLEAR = frozenset({"FACE", "FROM_SIDE", "KEEP", "REGION", "STAYS", "TIME_UNIT"})
_NOTS = frozenset({"DOES_NOT", "NOT"})
_NOBODY = frozenset({"nobody", "nothing"})
_FORBIDDEN = frozenset({"AVOID", "AVOIDING", "EVENT", "EVENT_INFINITIVE", "TOUCH", "TOUCHES",
                        "TOUCHING"})  # fmt: skip
_FORBIDDING = frozenset({"before", "may not", "must not", "shall not", "should not"})
"""Phrases that restrict by themselves, or point back: "as it was before"."""

_UNWANTED = re.compile("(?:not (?:want|wish|like)|hate)$")
"""How a wish begins what is to be avoided: "I do not want it to fall"."""

_FINITE = frozenset({"am", "are", "been", "can", "did", "do", "does", "had", "has", "have", "i",
                     "is", "it", "know", "they", "was", "we", "were", "will", "you"})  # fmt: skip
"""Words of which a clause with a verb has one."""

_DAMAGED = frozenset({"broken", "crushed", "damaged", "dented", "hurt", "knocked", "scratched",
                      "smashed", "spilled", "spilling", "spilt", "squashed", "tipped", "toppled",
                      "wasted"})  # fmt: skip
"""What nobody wants a thing to be."""

_JOINED = _HOW | _NOTS | {"BOUND", "DIRECTION", "ENSURE", "KEEP", "NUMBER", "RELATION", "VERB",
                          "WITH"}  # fmt: skip
_PAUSES = frozenset(",.;!?")
_TELLING = frozenset({"am", "are", "be", "been", "being", "is", "looks", "more", "so", "too",
                      "very", "was", "were"})  # fmt: skip
"""Words behind which a manner is that of the reason: "because it is too slow"."""

_DOING = frozenset({"can", "could", "he", "i", "may", "might", "must", "not", "or", "should",
                    "she", "they", "to", "we", "will", "would", "you"})  # fmt: skip
"""Words behind which a verb says what somebody does, and is no command."""


class _Said(NamedTuple):
    """A phrase or a word, and the terminals that it may be."""

    start: int
    words: str
    kinds: frozenset[str]


class Reasons:
    """Finds the ends of reasons, by the words of a lexicon."""

    def __init__(self, lexicon: Lexicon, phrases: Phrases) -> None:
        self._numbers = lexicon.numbers.pattern
        self._phrases = phrases

    def end_of(self, text: str, start: int, opened: int) -> int | None:
        """End of the reason whose opening words stand in a span; None if it is none."""
        if start == 0:
            return self._end_of_first(text, opened)
        goes_somewhere = self.goes_somewhere(text[:start])
        opening = self._said(text[:opened], start)
        if not goes_somewhere and any("MUTUAL" in said.kinds for said in opening):
            return None  # "push it so that it is out of the way"
        measure: int | None = None
        negated = _UNWANTED.search(text[start:opened]) is not None
        telling, last = False, text[:opened].rpartition(" ")[2]
        for said in self._said(text, opened):
            kinds = said.kinds
            if said.words in _PAUSES or self._goes_on(text, said):
                return said.start
            doing = last == "to" and said.start > opened + 1  # "it is too heavy to lift it"
            if text[start] in _PAUSES and not doing and self._is_done_to_a_thing(text, said):
                return None
            negated = negated or bool(kinds & _NOTS) or said.words in _NOBODY
            forbidden = negated and (kinds & _FORBIDDEN or said.words in _DAMAGED)
            if kinds & _UNCLEAR or said.words in _FORBIDDING or forbidden:
                return None
            if not goes_somewhere and kinds & _WHERE:
                return None
            if kinds & _HOW and not (last in _TELLING and "MANNER" in kinds):
                return None if last.endswith(("ed", "s")) and "MANNER" in kinds else said.start
            if measure is not None and kinds & _MEASURES:
                return None if telling else measure
            if not kinds & _BEFORE_MEASURES:
                measure = None
            elif measure is None and kinds & _BEFORE_MEASURES - {"THE", "SIDE"}:
                measure, telling = said.start, last in _TELLING or last.endswith("s")
            last = said.words.rpartition(" ")[2]
        return len(text)

    def goes_somewhere(self, text: str) -> bool:
        """Check for words that say where something is to go."""
        return any(said.kinds & _WHERE for said in self._said(text, 0))

    def _end_of_first(self, text: str, opened: int) -> int | None:
        """End of a reason with which the sentence begins: a pause, or the verb of a command."""
        last = text[:opened].rpartition(" ")[2]
        needs_verb = text.startswith("now that ")  # "now that red box, push it" gives none
        for said in self._said(text, opened):
            if said.words in _PAUSES:
                told = text[opened : said.start].split()
                return None if needs_verb and _FINITE.isdisjoint(told) else said.start
            if last not in _DOING and self._is_done_to_a_thing(text, said):
                return said.start
            if said.words in _FORBIDDING:
                return None
            last = said.words.rpartition(" ")[2]
        return None

    def _said(self, text: str, start: int) -> Iterator[_Said]:
        """The phrases and words of a text from a place on, the longest at each place."""
        while match := WORD.search(text, start):
            start = match.start()
            number = self._numbers.match(text, start) or DIGITS.match(text, start)
            found = self._phrases.phrases_at(text, start)
            said = _Said(start, match[0], frozenset())
            if number and number[0] not in ("a", "an"):
                said = _Said(start, number[0], frozenset({"NUMBER"}))
            elif found:
                said = _Said(start, found[0][0], frozenset(found[0][1]))
            yield said
            start += len(said.words)

    def _goes_on(self, text: str, joint: _Said) -> bool:
        """Check for a joint behind which the command goes on: "and do not …", "then …"."""
        if "NEXT" in joint.kinds and joint.words.split()[-1] in ("afterwards", "that", "then"):
            return True
        if "SEPARATOR" not in joint.kinds:
            return False
        after = next(self._said(text, joint.start + len(joint.words)), None)
        return after is not None and (bool(after.kinds & _JOINED) or after.words == "let")

    def _is_done_to_a_thing(self, text: str, said: _Said) -> bool:
        """Check for a verb behind which a thing stands."""
        if "VERB" not in said.kinds:
            return False
        after = next(self._said(text, said.start + len(said.words)), None)
        return after is not None and bool(after.kinds & {"IT", "THAT", "THE"})
