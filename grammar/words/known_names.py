"""Names of known objects as people say them without a verb or an article: "coffee box again".

What follows is tried only on a sentence that is not read as it stands: "the" before a bare name;
"the coffee one" as "the coffee"; and a name that is all there is, "the mug", as "no, the mug", or
with a question mark as "and the mug?". Words that are in no name never become one, so that prose
stays refused.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace

from grammar.frames.command import Frame, references_in
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.phrase_places import WORD

_ONE = re.compile(r" ones?(?= |$)")
_GOES = "to|toward|towards|left|right|away|back|closer|behind|next|in front|a (?:bit|little)"
_SIDE = re.compile(r" (?:on|at|in|to) the (?:far )?(?:left|right|middle|centre|center|back|front)$")
_GROUP = re.compile(r"(?:the )?both(?: of (?:them|these|those))?(?= |$)")
_AGAIN = frozenset({"again", "too", "also", "as", "well", "please"})


class KnownNames:
    """Finds the names of some objects in sentences in plain form.

    Attributes:
        words: the words of these names.
    """

    def __init__(self, names: Iterable[str], lexicon: Lexicon) -> None:
        plain = {" ".join(name.casefold().replace("-", " ").split()) for name in names}
        own = sorted(plain - lexicon.first_words - lexicon.verb_words["VERB"].keys(), key=len)
        either = "|".join(map(re.escape, reversed(own))) or "(?!)"
        told = lexicon.adjectives.keys() | lexicon.numbers.ordinals.keys()
        one = rf"(?:{'|'.join(sorted(told))}) ones?"
        self._name = re.compile(rf"(?<![^ ])(?:{either}|{one})(?= |$)")
        self.words = {word for name in own for word in name.split()}
        numbers = lexicon.numbers.pattern.pattern
        self._told_where = re.compile(rf"(the (?:{either})) (?={_GOES}(?: |$)|\d|{numbers})")
        determining = (
            w for kind in ("THE", "A", "THAT", "QUANTIFIER") for w in lexicon.terminals[kind]
        )
        self._before_name = {*(w.split()[-1] for w in determining), *told, *self.words}
        self._told = {"the", "other", *told, *self.words, "one", "ones"}
        self._borne = self._told | set(lexicon.nobodies) | {"it", "them", "they", "that", "this"}
        self._silent = lexicon.silent_words - {"the"}

    def are_borne(self, frames: Iterable[Frame]) -> bool:
        """Check for frames in whose names each word is of some object, or tells objects apart."""
        names = (
            ref.noun if ref.qualities else ref.text
            for frame in frames
            for ref in references_in(frame)
        )
        return all(self._borne.issuperset(name.split()) for name in names)

    def readings(self, said: Normalised) -> Iterator[Normalised]:
        """Yield the sentence in the ways in which it may be meant, the likelier first."""
        named = self._with_articles(self._without_one(said))
        if named is not said:
            yield named
        if self._told_where.match(named.text):
            yield _with_words(named, 0, 0, "now ")
        if remark := self._as_remark(named):
            yield remark

    def _without_one(self, said: Normalised) -> Normalised:
        """The sentence with "the coffee" in the place of "the coffee one"."""
        for one in _ONE.finditer(said.text):
            if said.text[: one.start()].rpartition(" ")[2] in self.words:
                return _with_words(said, one.start(), one.end(), "")
        return said

    def _with_articles(self, said: Normalised) -> Normalised:
        """The sentence with "the" before each name that has no article."""
        for name in reversed(list(self._name.finditer(said.text))):
            if said.text[: name.start()].rstrip().rpartition(" ")[2] not in self._before_name:
                said = _with_words(said, name.start(), name.start(), "the ")
        return said

    def _as_remark(self, said: Normalised) -> Normalised | None:
        """A name that is all there is, as a remark; None if there is more, or no name."""
        words = list(WORD.finditer(said.text))
        while words and words[0][0] in self._silent:
            words.pop(0)
        if words and words[-1][0] in ("next", "then"):
            said = _with_words(said, words.pop().start() - 1, len(said.text), "")
        again = bool(words) and words[-1][0] in _AGAIN
        while words and words[-1][0] in _AGAIN:
            words.pop()
        if not words:
            return None
        start, end = words[0].start(), words[-1].end()
        side = _SIDE.search(said.text, start, end)
        if side is not None:
            words = [word for word in words if word.end() <= side.start()]
        group = _GROUP.fullmatch(said.text, start, end)
        named = len(words) > 1 and self._told.issuperset(match[0] for match in words)
        if not (group or (named and words[0][0] == "the")):
            return None
        return _with_words(said, start, start, "and " if again or said.question else "no ")


def _with_words(said: Normalised, start: int, end: int, words: str) -> Normalised:
    """The sentence with other words in the place of some of it."""
    at = said.columns[min(start, len(said.columns) - 1)]
    columns = (*said.columns[:start], *((at[0], at[0]),) * len(words), *said.columns[end:])
    return replace(said, text=said.text[:start] + words + said.text[end:], columns=columns)
