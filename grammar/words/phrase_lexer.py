"""From the plain form of a sentence to tokens: the longest phrase that can stand where it stands.

A word means different things in different places ("left" in "the left box", "to the left"), so the
lexer asks the parser what it could go on with, and takes the longest of those phrases. After an
article any word may begin a name; a name ends where a word of the language begins.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from grammar.words.lexer_lookahead import Lookahead
from grammar.words.lexicon import Lexicon
from grammar.words.numerals import DIGITS
from grammar.words.phrase_places import WORD, Phrases, stands_at

_QUOTED = re.compile(r'"[^"]*[^" ][^"]*"(?= |$)')
_DETERMINERS = frozenset({"THE", "A", "THAT", "VERB", "QUANTIFIER", "WHICH"})
_UNITS = ("LENGTH_UNIT", "ANGLE_UNIT", "FORCE_UNIT", "SPEED_UNIT", "TIME_UNIT", "VOLUME_UNIT",
          "CUPS", "PERCENT", "SIDE_OF_OBJECT")  # fmt: skip


Accepts = Callable[[str], bool]
"""Check for a terminal with which the parser could go on."""


class Token(str):
    """A phrase of the text as a terminal.

    Attributes:
        type: the terminal.
        start_pos: where it starts in the plain form.
        end_pos: where it ends.
    """

    __slots__ = ("end_pos", "start_pos", "type")

    type: str
    start_pos: int
    end_pos: int

    def __new__(cls, type_: str, text: str, start_pos: int, end_pos: int) -> Token:
        """Make the token of a terminal."""
        token = super().__new__(cls, text)
        token.type, token.start_pos, token.end_pos = type_, start_pos, end_pos
        return token


class PhraseLexer:
    """Finds the terminals of a lexicon.

    Attributes:
        phrases: the lexicon's, by where they stand in a text.
    """

    def __init__(self, lexicon: Lexicon) -> None:
        self.phrases = self._phrases = Phrases(lexicon)
        self._ahead = Lookahead(lexicon, self._phrases)
        self._units = [phrase for unit in _UNITS for phrase in lexicon.phrases_of(unit)]
        self._numbers = lexicon.numbers
        self._names = lexicon.names
        self._adjectives = lexicon.adjectives
        self._first_in_names = lexicon.adjectives.keys() | lexicon.numbers.ordinals.keys()
        self._reserved = lexicon.reserved_words
        self._ends_names = lexicon.ends_names
        self._nobodies = lexicon.nobodies
        self._later = lexicon.later_words | lexicon.later_verbs.keys()
        self._openers = lexicon.openers

    def tokens(self, text: str, acceptance: Callable[[], Accepts]) -> Iterator[Token]:
        """Yield the tokens of a text in plain form.

        One that the parser cannot take stands where the language ends. `acceptance` gives what the
        parser could go on with after the last token that was yielded.
        """
        position, name = 0, _Name()
        while position < len(text):
            if text[position] == " ":
                position += 1
                continue
            kind, end = self._next_token(text, position, acceptance(), name)
            token = Token(kind, text[position:end], position, end)
            name.note_token(kind, text[position:end] in self._first_in_names)
            yield token
            position = end

    def _next_token(self, text: str, start: int, accepts: Accepts, name: _Name) -> tuple[str, int]:
        """Terminal and end of the token that starts here."""
        match = WORD.match(text, start)
        assert match is not None
        word, end = match.group(), match.end()
        if accepts("QUOTED") and word.startswith('"') and (quoted := _QUOTED.match(text, start)):
            return "QUOTED", quoted.end()
        may_name = accepts("WORD") and word[0].isalnum()
        named = "WORD" if may_name else "KNOWN"
        if self._names and accepts(named) and (known := self._known_name_end(text, start)):
            return named, known
        if may_name and self._is_name_word(text, word, end, accepts, name):
            return "WORD", end
        number = self._numbers.pattern.match(text, start)
        counted = number.end() if number and accepts("NUMBER_WORD") else start
        fallback = None
        for phrase, kinds in self._phrases.phrases_at(text, start):
            after = start + len(phrase)
            if counted > after:
                break
            for kind in kinds:
                if accepts(kind) and self._ahead.can_be(kind, phrase, text, after, name.last):
                    if kind == "VERB" and name.words and may_name:
                        return "WORD", end
                    return kind, after
            # "Go" of "go home" is no filler, but an unknown verb, and "through" goes before no
            # number; the "first" of "what did you move first" does not go on to something else.
            unknown = phrase in self._later and kinds[0] in ("BY", "FILLER", "PARTICLE")
            unknown = unknown or name.last == "WHAT_DID"
            fallback = fallback or ("UNKNOWN" if unknown else kinds[0], after)
        digits = DIGITS.match(text, start) if accepts("NUMBER") else None
        if digits and self._ends_number(text, digits.end()):
            return "NUMBER", digits.end()
        if counted > start:
            return "NUMBER_WORD", counted
        free = word not in self._reserved and not self._is_number(text, start)
        if may_name and (free or (word == "of" and name.words)):
            return "WORD", end
        return fallback or ("UNKNOWN", end)

    def _known_name_end(self, text: str, start: int) -> int | None:
        """End of a name of the lexicon that stands here, but not of "block 5" before "cm"."""
        for phrase, kinds in self._phrases.phrases_at(text, start):
            end = start + len(phrase)
            measured = phrase[-1].isdigit() and self._has_unit_at(text, end + 1)
            if "WORD" in kinds and not measured:
                return end
        return None

    def _has_unit_at(self, text: str, start: int) -> bool:
        """Check for a unit; "in" is a preposition here: "put block 5 in the box"."""
        return any(stands_at(unit, text, start) for unit in self._units if unit != "in")

    def _is_name_word(self, text: str, word: str, end: int, accepts: Accepts, name: _Name) -> bool:
        """Check for a word that belongs to a name, although it means something elsewhere."""
        if name.determined == "THE":
            return True
        if name.determined == "A":
            units = [unit for unit in _UNITS if accepts(unit)]
            return not any(self._stands_as(unit, text, end - len(word), name) for unit in units)
        if name.determined == "VERB" and self._begins_a_way(text, end - len(word), name):
            return False  # "topple right up to me"
        if name.adjectival and word in self._adjectives:
            follower = WORD.match(text, end + 1)
            return follower is not None and follower.group() not in self._ends_names
        if name.adjectival and word in self._nobodies:
            start = end - len(word)
            kinds = ("PORTION",) if name.words else ("PORTION", "QUANTIFIER")
            return not any(self._stands_as(kind, text, start, name) for kind in kinds)
        return (
            (name.words > 0 or name.determined == "VERB")
            and word in self._openers
            and not self._begins_a_phrase(text, end - len(word), name)
        )

    def _stands_as(self, unit: str, text: str, start: int, name: _Name) -> bool:
        """Check for a phrase of a unit, or of a share, that stands here."""
        return any(
            unit in kinds and self._ahead.can_be(unit, phrase, text, start + len(phrase), name.last)
            for phrase, kinds in self._phrases.phrases_at(text, start)
        )

    def _begins_a_way(self, text: str, start: int, name: _Name) -> bool:
        """Check for a direction of several words that stands here."""
        return any(
            " " in phrase
            and "DIRECTION" in kinds
            and self._ahead.can_be("DIRECTION", phrase, text, start + len(phrase), name.last)
            for phrase, kinds in self._phrases.phrases_at(text, start)
        )

    def _begins_a_phrase(self, text: str, start: int, name: _Name) -> bool:
        """Check for a phrase of several words that stands here."""
        return any(
            " " in phrase and self._ahead.can_be(kind, phrase, text, start + len(phrase), name.last)
            for phrase, kinds in self._phrases.phrases_at(text, start)
            for kind in kinds
        )

    def _ends_number(self, text: str, end: int) -> bool:
        """Check for the end of a number: a space, or a unit that is glued to it."""
        if end == len(text) or text[end] == " ":
            return True
        return any(stands_at(unit, text, end) for unit in self._units)

    def _is_number(self, text: str, start: int) -> bool:
        number = DIGITS.match(text, start)
        return number is not None and self._ends_number(text, number.end())


class _Name:
    """State of a name: just after its article, or within it."""

    def __init__(self) -> None:
        self.last = ""
        self.determined = ""
        self.words = 0
        self.adjectival = False

    def note_token(self, kind: str, adjective: bool) -> None:
        """Takes note of one more token."""
        self.last = kind
        if kind == "WORD":
            self.adjectival = self.adjectival and adjective
            self.words += 1
            self.determined = ""
            return
        self.determined = kind if kind in _DETERMINERS else ""
        self.words, self.adjectival = 0, kind in _DETERMINERS
