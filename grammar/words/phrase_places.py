"""The phrases of a lexicon, by where they stand in a text, with the terminals that they may be."""

from __future__ import annotations

import re
from collections.abc import Iterable

from grammar.words.lexicon import NAME_TERMINALS, Lexicon

WORD = re.compile(r"[^ ]+")
"""A word of the plain form."""

_CLAUSE_END = re.compile(" , | [.;] |$")

BEFORE_NUMBERS = frozenset({"BY", "BOUND", "RANGE", "FROM", "IS_AT"})
"""Terminals that stand before quantities only."""

_OF_CONTENTS = ("FILLED", "FILLED_WITH", "TO_LEVEL", "SOME_OF", "PART_OF")
"""Terminals that say how much is poured or filled in; their words mean other things elsewhere."""

_TRIED_FIRST = {
    *_OF_CONTENTS,
    *BEFORE_NUMBERS,
    "AND_WITH",
    "TO_DO",
    "OR",
    "EXCEPT",
    "RIGHTS",
    "UPON",
    "USING",
}
"""Terminals whose rules tell them from others with the same words."""


_REMEMBERED = 4096
"""Places of texts whose phrases are kept, since each text is gone through many times."""


def stands_at(phrase: str, text: str, start: int) -> bool:
    """Check for a phrase in a text, from here to the end of a word."""
    end = start + len(phrase)
    return text.startswith(phrase, start) and (end == len(text) or text[end] == " ")


def _word_end(text: str, start: int) -> int:
    end = text.find(" ", start)
    return len(text) if end < 0 else end


class Phrases:
    """The phrases of a lexicon, each with the terminals that it may be.

    Attributes:
        verbs: infinitive or gerund → its verb.
    """

    def __init__(self, lexicon: Lexicon) -> None:
        names = [*lexicon.terminals, *NAME_TERMINALS]
        # "Up to 5 cm" is a bound before it is a place.
        names.sort(key=lambda name: name not in _TRIED_FIRST)
        self._kinds: dict[str, tuple[str, ...]] = dict.fromkeys(lexicon.names, ("WORD",))
        for name in names:
            words = lexicon.words_of(name)
            known = {phrase: self._kinds[phrase] for phrase in self._kinds.keys() & words.keys()}
            self._kinds |= dict.fromkeys(words, (name,))
            self._kinds |= {phrase: (*kinds, name) for phrase, kinds in known.items()}
        forms = (lexicon.verb_words[kind] for kind in ("VERB", "VERB_ING"))
        self.verbs = {form: verb for words in forms for form, verb in words.items()}
        self._goals = {verb: asks.goal for verb, asks in lexicon.verbs.items()}
        self._found: dict[tuple[str, int], list[tuple[str, tuple[str, ...]]]] = {}
        self._most: dict[str, int] = {}
        for phrase in self._kinds:
            first, count = phrase.partition(" ")[0], phrase.count(" ") + 1
            if count > self._most.get(first, 0):
                self._most[first] = count

    def phrases_at(self, text: str, start: int) -> list[tuple[str, tuple[str, ...]]]:
        """The phrases that stand in a text from the start of a word, longest first."""
        if (known := self._found.get((text, start))) is not None:
            return known
        found = self._phrases_at(text, start)
        if len(self._found) >= _REMEMBERED:
            self._found.clear()
        self._found[text, start] = found
        return found

    def _phrases_at(self, text: str, start: int) -> list[tuple[str, tuple[str, ...]]]:
        found = []
        end = _word_end(text, start)
        for _ in range(self._most.get(text[start:end], 0)):
            if (phrase := text[start:end]) in self._kinds:
                found.append((phrase, self._kinds[phrase]))
            if end == len(text):
                break
            end = _word_end(text, end + 1)
        return found[::-1]

    def has_terminal_at(self, kind: str, text: str, start: int) -> bool:
        """Check for a phrase of a terminal that stands here."""
        return any(kind in kinds for _, kinds in self.phrases_at(text, start))

    def has_any_at(self, wanted: Iterable[str], text: str, start: int) -> bool:
        """Check for a phrase of one of some terminals that stands here."""
        asked = frozenset(wanted)
        return any(not asked.isdisjoint(kinds) for _, kinds in self.phrases_at(text, start))

    def is_remark(self, text: str) -> bool:
        """Check for a text that is "do it" and nothing else, in any of its words: "go on then"."""
        found = self.phrases_at(text, 0)
        return bool(found) and found[0][0] == text and "DO" in found[0][1]

    def has_any_in_clause(self, wanted: Iterable[str], text: str, start: int) -> bool:
        """Check for a phrase of one of some terminals from here to the end of a clause."""
        rest = _CLAUSE_END.search(text, start)
        words = WORD.finditer(text, start, rest.start() if rest else len(text))
        return any(self.has_any_at(wanted, text, word.start()) for word in words)

    def last_goal(self, text: str, end: int) -> str | None:
        """Goal of the last verb before a place in the text."""
        words = reversed(text[:end].replace("fill level", "").split())
        verb = next((self.verbs[word] for word in words if word in self.verbs), None)
        return None if verb is None else self._goals.get(verb)
