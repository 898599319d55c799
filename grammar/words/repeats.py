"""Words said twice: stammered, or said anew after a restart.

"Push the the tin", "push the tin... push the tin away" and "to the, I mean, to the left" say the
same words twice, one directly behind the other; the first of them are left out. Two whole commands
that are the same are two ("push it 5 cm, push it 5 cm"), and so are words that say more the second
time ("at the top at the top face").
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from grammar.frames.command import Span
from grammar.words.lexicon import Lexicon
from grammar.words.numerals import DIGITS
from grammar.words.phrase_places import WORD, Phrases

_OPEN = frozenset({"A", "AND_WITH", "AT", "BETWEEN", "BY", "EXCHANGED_WITH", "FILLED_WITH", "FROM",
                   "GAP", "IN", "INTO", "NEXT", "OF", "PART_OF", "RANGE", "RELATION", "THE",
                   "TOUCH", "TOUCHES", "TOUCHING", "TO_DO", "TO_LEVEL", "TOWARD", "UNTIL", "WITH",
                   "WITHOUT"})  # fmt: skip
"""Terminals that say nothing by themselves, so that one said twice is stammered."""

_UNITS = ("ANGLE_UNIT", "FORCE_UNIT", "LENGTH_UNIT", "SPEED_UNIT", "TIME_UNIT")

_LONGEST_OPEN = 4
"""Words of the longest of them that are looked at: "on the left of"."""

_LONGEST = 10
"""Words of the longest repeat that is looked for, so that no text takes long."""

_PAUSES = frozenset(",.;!?")
_JOINTS = _PAUSES | {"and", "then"}


class Repeats:
    """Finds words that are said twice, by the words of a lexicon."""

    def __init__(self, lexicon: Lexicon, phrases: Phrases) -> None:
        self._phrases = phrases
        self._doubles = frozenset(lexicon.asides["doubles"])
        self._numbers = lexicon.numbers.pattern
        self._pronouns = lexicon.terminals["IT"].keys()

    def repeat_in(self, text: str, marks: re.Pattern[str] | None) -> Span | None:
        """The first words that are said again, up to where they are; None if there are none.

        Args:
            text: a sentence in plain form.
            marks: of a correction, which may stand between them; None if there are none.
        """
        places = list(WORD.finditer(text))
        words = [place[0] for place in places]
        marked = self._marked(text, places, marks) if marks else {}
        for i, end, again in _repeats(words, marked):
            start, second = places[i].start(), places[again].start()
            if not self._says_more(text, (start, places[end - 1].end()), second):
                return start, second
        return None

    def _marked(
        self, text: str, places: list[re.Match[str]], marks: re.Pattern[str]
    ) -> dict[int, int]:
        """For each word, behind which marks are all that stands before it, the place of those."""
        ends = {place.start(): i for i, place in enumerate(places)}
        found = (m for place in places if (m := marks.match(text, place.start())))
        return {ends[m.end() + 1]: ends[m.start()] for m in found if m.end() + 1 in ends}

    def ends_open(self, text: str) -> bool:
        """Check for a text that ends in the beginning of a phrase: "in front of"."""
        words = text.rsplit(" ", _LONGEST_OPEN)[-_LONGEST_OPEN:]
        return any(self._is_open(" ".join(words[i:])) for i in range(len(words)))

    def pauses_within(self, text: str, start: int, end: int) -> bool:
        """Check for a pause within a phrase: "until it touches, the jar", "3, inches"."""
        last, after = text[:start].rpartition(" ")[2], end + 1
        counted = DIGITS.fullmatch(last) or self._numbers.fullmatch(last)
        measured = counted and self._phrases.has_any_at(_UNITS, text, after)
        told = self._phrases.has_terminal_at("TOUCHES", text, after)
        return bool(measured) or told or self.ends_open(text[:start])

    def _is_open(self, words: str) -> bool:
        """Check for the beginning of a phrase, which says nothing by itself."""
        found = self._phrases.phrases_at(words, 0) if words else []
        kinds = [kinds for phrase, kinds in found if phrase == words]
        return bool(kinds) and all(map(_OPEN.issuperset, kinds))

    def _says_more(self, text: str, said: Span, second: int) -> bool:
        """Check for words that are meant both times: two commands, or a longer phrase."""
        words, phrases = text[slice(*said)], self._phrases.phrases_at
        after = text[second + len(words) + 1 :].partition(" ")[0]
        lacks = words in self._pronouns and after  # "push it it away" may lack a word
        if words in self._doubles or lacks:
            return True
        if (
            " " in words
            and self._phrases.has_terminal_at("VERB", words, 0)
            and (not after or after in _JOINTS)
        ):
            return True
        if self._is_open(words) and not self._phrases.has_terminal_at("BOUND", text, second):
            return False
        for word in WORD.finditer(text, said[0], said[1]):
            longest = next((phrase for phrase, _ in phrases(text, word.start())), "")
            if word.start() + len(longest) > said[1]:
                return True
        if self._phrases.has_terminal_at("VERB", text, second) and self._ends_phrase(text, said):
            return True
        found = phrases(text, second)
        if found and _OPEN.issuperset(found[0][1]):
            return False  # "in front in front of"
        again = [phrase for phrase, _ in found]
        more = self._phrases.has_terminal_at("BOUND", text, second + len(words) + 1)
        return more or (words in again and words != again[0])

    def _ends_phrase(self, text: str, said: Span) -> bool:
        """Check for words that end a phrase the first time: "with a gentle hand hand it over"."""
        starts = (word.start() for word in WORD.finditer(text, 0, said[0]))
        return any(
            start + len(phrase) == said[1]
            for start in starts
            for phrase, _ in self._phrases.phrases_at(text, start)
        )


def _repeats(words: list[str], marked: dict[int, int]) -> Iterator[tuple[int, int, int]]:
    """Beginning and end of words that are said again, and where; the longest of them first."""
    found = []
    for again in range(1, len(words)):
        end = marked.get(again, again)
        while end > 1 and words[end - 1] in _PAUSES:
            end -= 1
        for i in range(max(end - _LONGEST, 0), end):
            n = end - i
            if words[i] == words[again] and words[i:end] == words[again : again + n]:
                found.append((-n, i, end, again))
    for _, i, end, again in sorted(found):
        yield i, end, again
