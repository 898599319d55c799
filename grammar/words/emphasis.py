"""What a command is about and what it stresses, put plainly.

"As for the jar, push it" is "the jar, push it", and "what the jar needs is a push" is "the jar
needs a push". The words that go stand in a closed list.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import replace

from grammar.frames.command import Span
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.phrase_places import WORD, Phrases
from grammar.words.phrase_templates import template_pattern

_THING = frozenset({"THE", "THAT", "IT"})
_ABOUT_IT = ("IS_IT", "HOW", "HOW_MUCH_DOES", "WHERE_IS", "CAN_YOU")
_IS_TO_GO = re.compile(r"(?:it|that|they|those) (?:should|must|ought to) (?:go|be) ")
_BEHIND_TOPIC = re.compile(r" ([,.;?!]|and)(?: (?:and|then|please|now|(?:could|would) you))* ")
_NEW_THING = re.compile(r"(?:there|here) is an? ")
_BEHIND_NEW_THING = re.compile(
    r"(?: (?:on the table|in front of (?:you|me|us|the robot)|over there|there|here))?"
    + _BEHIND_TOPIC.pattern
)
"""What stands on the table need not be said so: "there is a jar on the table. Push it"."""

_EMPHASIS = re.compile(
    r"it is ((?:the|my|your|our) [^,.;]+?) (?:that|which) "
    r"|what ((?:the|my|your|our) [^,.;]+? needs) is "
)
"""What is said with emphasis: "it is the jar that should go", "what the jar needs is a push"."""

_SAYS = frozenset({"AMOUNT", "DIRECTION", "FACE", "FROM_SIDE", "MANNER", "REGION",
                   "REGION_OF_TABLE", "SENSE", "SIDE_QUALITY", "WAY", "LENGTH_UNIT",
                   "ANGLE_UNIT", "FORCE_UNIT", "SPEED_UNIT", "TOOL"})  # fmt: skip

_LONGEST_END = 8
"""Words of the end of a command that are looked at."""


class Emphasis:
    """Puts topics and emphasis plainly, by the words of a lexicon."""

    def __init__(self, lexicon: Lexicon, phrases: Phrases) -> None:
        self._phrases = phrases
        topics = "|".join(map(template_pattern, lexicon.asides["topics"]))
        self._topics = re.compile(rf"(?:{topics}) ")

    def put_plainly(self, said: Normalised) -> Normalised:
        """The sentence that begins with its thing, without emphasis."""
        return self._without_emphasis(self._without_topic(said))

    def begins_command(self, text: str) -> bool:
        """Check for words with which a command begins: "then", "push"."""
        return self._has_kind({"NEXT", "VERB"}, text, 0)

    def _without_topic(self, said: Normalised) -> Normalised:
        """The sentence that begins with its thing: "as for the jar, push it" is "the jar, …"."""
        topic = self._topics.match(said.text)
        new = _NEW_THING.match(said.text)
        if topic is None or not (new or self._has_kind(_THING, said.text, topic.end())):
            return said
        start = new.end() if new else topic.end()
        behind = _BEHIND_NEW_THING if new else _BEHIND_TOPIC
        for pause in behind.finditer(said.text, start):
            told = topic[0] == "now " and _IS_TO_GO.match(said.text, pause.end())
            if told or self._has_kind({"VERB", *_ABOUT_IT}, said.text, pause.end()):
                text = f"{said.text[: pause.start()]} , {said.text[pause.end() :]}"
                columns = said.columns[: pause.start()], said.columns[pause.end() :]
                comma = said.columns[pause.start(1)][0], said.columns[pause.end(1) - 1][1]
                whole = replace(said, text=text, columns=(*columns[0], *[comma] * 3, *columns[1]))
                asked = said.question and "you" not in pause[0].split()
                return replace(_begun_with("the " * bool(new), whole, start), question=asked)
        return said

    def _without_emphasis(self, said: Normalised) -> Normalised:
        """The sentence that plainly says what it says with emphasis."""
        found = _EMPHASIS.match(said.text)
        kinds = ("TO_BE",) if found and found[1] else ("STROKE",)
        if found is None or not self._has_kind(kinds, said.text, found.end()):
            return said
        return said.words_in(found.span(found.lastindex or 0), (found.end(), len(said.text)))

    def _has_kind(self, kinds: Collection[str], text: str, start: int) -> bool:
        return any(self._phrases.has_terminal_at(kind, text, start) for kind in kinds)

    def is_said(self, text: str) -> bool:
        """Check for a text that ends in a whole phrase about where, how or how far."""
        starts = [m.start() for m in WORD.finditer(text)][-_LONGEST_END:]
        return any(
            start + len(phrase) == len(text) and not _SAYS.isdisjoint(kinds)
            for start in starts
            for phrase, kinds in self._phrases.phrases_at(text, start)
        )


def _begun_with(words: str, said: Normalised, start: int) -> Normalised:
    """A sentence from a place on, with other words before that."""
    over: Span = (said.columns[0][0], said.columns[start - 1][1])
    return replace(
        said,
        text=words + said.text[start:],
        columns=(*((over,) * len(words)), *said.columns[start:]),
        question=said.question
        and not words
        and {"you", "we"}.isdisjoint(said.text[:start].split()),
    )
