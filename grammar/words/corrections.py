"""Words that are taken back: what follows a mark of correction replaces what it corrects.

"The tin, no wait, the jar" means the jar. A correction takes the place of the last group of words
of its own kind (a thing, a number, a direction, a verb); where none stands before it, nothing is
taken back. What stands between them and is not said anew is kept.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple, cast

from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.numerals import DIGITS
from grammar.words.phrase_places import WORD, Phrases
from grammar.words.repeats import Repeats

_ALONE = frozenset({"AMOUNT", "DIRECTION", "MANNER", "SENSE", "SEPARATOR", "VERB"})
"""Terminals that are a group of words by themselves."""

_LEAD = _ALONE | {"AT", "AVOID_DOING", "BETWEEN", "BY", "COMING_WITHIN", "FACE", "FROM_SIDE",
                  "IN", "INTO", "KEEP", "NEXT", "NOT", "REGION", "REGION_OF_TABLE", "RELATION",
                  "SO", "TOWARD", "UNTIL", "WITH", "WITHOUT"}  # fmt: skip
"""Terminals that begin a group; what follows belongs to it."""

_WHERE = frozenset({"DIRECTION", "INTO", "REGION_OF_TABLE", "RELATION", "TOWARD"})
"""Terminals of where something is brought, any of which corrects any other."""

_BEGIN = _LEAD | {"NUMBER", "THING", "IT"}
"""Kinds that begin a group where no other is open."""

_UNITS = frozenset({"ANGLE_UNIT", "FORCE_UNIT", "LENGTH_UNIT", "SPEED_UNIT", "TIME_UNIT"})
_MEASURES = _UNITS | {"TOOL"}
"""What tells groups with the same beginning apart: "with 5 N", "with one finger"."""

RESTATED = frozenset({"NUMBER", "SENSE", "THING", "WHERE"}) | _UNITS
"""Kinds of groups of which a second one behind a pause can only correct the first."""

RENAMED = RESTATED - {"WHERE"} | {"MANNER"}
"""Those of which a second one behind "that is" can only be another word for the first."""


class _Group(NamedTuple):
    """Words that say one thing, and the kinds of things that it may be."""

    start: int
    end: int
    kinds: frozenset[str]


class Corrections:
    """Finds what a correction takes back, by the words of a lexicon."""

    def __init__(self, lexicon: Lexicon, phrases: Phrases, repeats: Repeats) -> None:
        self._lexicon = lexicon
        self._phrases = phrases
        self._repeats = repeats
        self._ends_names = lexicon.ends_names - lexicon.adjectives.keys()

    def correction(
        self, said: Normalised, start: int, end: int, only: frozenset[str] = frozenset()
    ) -> Normalised | None:
        """The sentence with what follows a mark of correction in the place of what it corrects."""
        if self._goes_beyond(said.text, start, end):
            return None  # "left, no nearer than 5 cm"
        paused = said.text[start] in ",.;" or said.text[:end].endswith(",")
        start = len(said.text[:start].rstrip(" ,"))
        end = len(said.text) - len(said.text[end:].lstrip(" ,"))
        if (only or not paused) and not self.begins_a_group(said.text, end):
            return None  # "push it left no matter what"
        before, after = self._groups(said.text, 0, start), self._groups(said.text, end)
        if self._repeats.ends_open(said.text[:start]):
            verbs = [group for group in before if "VERB" in group.kinds]
            if not verbs or len(after) < 2 or "VERB" not in after[0].kinds:
                return None  # "in front of, hold on, the jar"; "the, er, bowl"
            return said.words_in((0, verbs[-1].start), (end, len(said.text)))
        if not before or not after or self._may_address(said.text, before):
            return None
        denies = len(before) == 1 or said.text.startswith("not ", before[-1].start)
        if denies and "NOT" in before[-1].kinds and "THING" in after[0].kinds:
            return None  # "not the mug, I meant the jar"
        inner = self._within(said.text, before[-1], after[0].kinds)
        if only and not only & after[0].kinds & (only if inner else before[-1].kinds):
            return None
        if inner and (len(after) == 1 or not _are_alike(after[1].kinds, before[-1].kinds)):
            return said.words_in((0, inner), after[0][:2], (after[0].end, len(said.text)))
        for i in reversed(range(len(before))):
            wrong, between = before[i], before[i + 1 :]
            if not _are_alike(wrong.kinds, after[0].kinds):
                continue
            rest = (after[0].end, len(said.text))
            if said.text[rest[0] :].startswith(" ,"):
                rest = (rest[0] + 2, rest[1])
            left = _not_restated(between, after[1:])
            commands = "VERB" in wrong.kinds and left
            if commands or any("VERB" in group.kinds for group in left):
                return None  # "push the mug 5 cm away, no, push the tin"
            kept = [group[:2] for group in left] if len(after) > 1 else [(wrong.end, start)]
            last = _last_restating(between, after)
            anew = [(after[0].start, after[last].end), *kept]
            return said.words_in((0, wrong.start), *anew, (max(rest[0], anew[0][1]), rest[1]))
        return None

    def _may_address(self, text: str, said: Sequence[_Group]) -> bool:
        """Check for all that was said being no thing: "Karen, no, …", "on my signal, no, …"."""
        if len(said) > 1:
            return False
        bare = said[0].kinds == {"THING"} and not self._phrases.phrases_at(text, said[0].start)
        return bare or not (_LEAD - _ALONE).isdisjoint(said[0].kinds)

    def _goes_beyond(self, text: str, start: int, end: int) -> bool:
        """Check for a mark of correction that is the beginning of a phrase."""
        mark = text[start:end].strip(" ,.;")
        start = text.index(mark, start)
        phrases = self._phrases.phrases_at(text, start)
        return any(phrase.rstrip(" ,.").startswith(f"{mark} ") for phrase, _ in phrases)

    def _within(self, text: str, group: _Group, kinds: frozenset[str]) -> int:
        """Place of a thing or a number within a group, as in "left of the tin"; 0 if none is."""
        if not kinds & {"THING", "NUMBER"} or not group.kinds & _LEAD:
            return 0
        first = next(WORD.finditer(text, group.start, group.end))
        places = WORD.finditer(text, self._phrase_at(text, first)[0], group.end)
        return next(
            (m.start() for m in places if _are_alike(self._phrase_at(text, m)[1], kinds)), 0
        )

    def begins_a_group(self, text: str, start: int) -> bool:
        """Check for a phrase of the language or a number, and not for any word."""
        number = self._lexicon.numbers.pattern.match(text, start) or DIGITS.match(text, start)
        return bool(number or self._phrases.phrases_at(text, start))

    def _groups(self, text: str, start: int, end: int | None = None) -> list[_Group]:
        """The groups of words of a part of a text."""
        text, groups = text[:end], list[_Group]()
        while match := WORD.search(text, start):
            start, kinds = self._phrase_at(text, match)
            own = _LEAD if groups and groups[-1].kinds & _LEAD - _ALONE else _BEGIN
            if groups and not kinds & own:
                measured = groups[-1].kinds | kinds & _MEASURES
                groups[-1] = groups[-1]._replace(end=start, kinds=measured)
            else:
                groups.append(_Group(match.start(), start, kinds))
        return groups

    def _phrase_at(self, text: str, match: re.Match[str]) -> tuple[int, frozenset[str]]:
        """End and kinds of the phrase that a word begins."""
        start, lexicon = match.start(), self._lexicon
        number = lexicon.numbers.pattern.match(text, start) or DIGITS.match(text, start)
        if number and number[0] not in ("a", "an"):
            units = self._phrases.phrases_at(text, number.end() + 1)
            kinds = frozenset(units[0][1]) if units else frozenset()
            return number.end(), (kinds & _MEASURES) | {"NUMBER"}
        found = self._phrases.phrases_at(text, start)
        kinds = frozenset(found[0][1]) if found else frozenset({"WORD"})
        measure = start + len(found[0][0]) + 1 if "BOUND" in kinds else len(text)
        if lexicon.numbers.pattern.match(text, measure) or DIGITS.match(text, measure):
            return self._phrase_at(text, cast("re.Match[str]", WORD.match(text, measure)))
        if not kinds & {"THE", "A", "THAT", "WORD"}:
            kinds |= {"WHERE"} if kinds & _WHERE else set()
            return start + len(found[0][0]), kinds - _UNITS  # "turn" is no angle here
        end = match.end()
        for word in WORD.finditer(text, end):
            phrase, leads = next(iter(self._phrases.phrases_at(text, word.start())), ("", ()))
            ends = self._ends_name(word) if "DIRECTION" in leads else word[0] in self._ends_names
            ends = ends or (" " in phrase and not _LEAD.isdisjoint(leads))  # "left of"
            if not word[0][0].isalpha() or (ends and end > match.end()):
                break
            end = word.end()
        return end, frozenset({"THING"})

    def _ends_name(self, word: re.Match[str]) -> bool:
        """Check for "left" of "the tin left", which is no part of a name as in "the left tin"."""
        after = WORD.match(word.string, word.end() + 1)
        return after is None or not after[0].isalpha() or after[0] in self._ends_names


def _are_alike(one: frozenset[str], other: frozenset[str]) -> bool:
    """Check for kinds of groups of which one can correct the other; not 2 cm and 5 N."""
    measures = one & _MEASURES, other & _MEASURES
    return bool(one & other - {"WORD"}) and (not all(measures) or measures[0] == measures[1])


def _not_restated(said: Sequence[_Group], anew: Sequence[_Group]) -> list[_Group]:
    """The groups, joints apart, that no group of what is said anew can stand for."""
    return [
        group
        for group in said
        if "SEPARATOR" not in group.kinds
        and not any(_are_alike(group.kinds, other.kinds) for other in anew)
    ]


def _last_restating(said: Sequence[_Group], anew: Sequence[_Group]) -> int:
    """Place of the last group, behind none that adds something, that says some of it anew."""
    adds = (
        i
        for i, group in enumerate(anew[1:])
        if not any(_are_alike(group.kinds, old.kinds) for old in said)
    )
    return next(adds, len(anew) - 1)
