"""Questions as they are asked of a robot: "may I ask whether the jar is shut, do you think?".

What a question is opened with, what asks for assent and words that ask nothing are left out, and
what is told with "whether" or "…, isn't it?" is put as a question. What is left is only read as a
question, so that "you won't topple it, will you?" never becomes a command.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property

from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.phrase_templates import template_pattern

_SHAPES = {
    "openers": "(?:{0})(?: ,)? ",
    "tags": r" [,.] (?:{0})(?= [.;!?,]*$|$)",
    "endings": r"(?: [,.])? (?:{0})(?= [.;!?,]*$|$)",
    "idle": r"(?<![^ ])(?:{0})(?: ,)?(?= |$)",
}
"""Where the words of each kind stand."""

_MOST = 4
"""Openers, and tags, that are left out one after another."""

_BE = "is|are|was|were|would|will|can|could|did|does|do|has|have|had|might|may|should"
_BE_NOT_CAN = _BE.replace("can|", "")
_COULD = "(?<!the )(?<!that )(?<!this )(?<!soup )can"
"""The verb, which no name of a thing ends before: "the can is heavy"."""

_ASKS = re.compile(
    rf"(?:(?:and|but|so|or|well|ok|okay|now|then|no|oh|hey|wait) (?:, )?)*(?:how|what|which|who|"
    rf"whose|where|when|why|whether|any|anything|{_BE}) "
)
_TOLD = re.compile(
    rf"(?P<who>[^,.;!?]+?) (?P<be>{_BE_NOT_CAN}|{_COULD})(?: not)?(?: (?P<rest>[^.;!?]+))?"
)
_WHETHER = re.compile(rf"(?:whether|if) {_TOLD.pattern}")
_EMBEDDED = re.compile(
    rf"(?P<how>(?:and )?(?:how(?: (?!(?:{_BE}) )[a-z]+)?|where|why|wh(?:at|ich)(?: (?!(?:{_BE}) )[a-z]+)?)"
    rf") (?!(?:{_BE}) ){_TOLD.pattern}"
)
_INVERTED = re.compile(rf"(?:and |so |or )?(?:{_BE}|how|what|which|why|where|who) ")


class PlainQuestions:
    """Puts questions plainly, by a lexicon."""

    def __init__(self, lexicon: Lexicon) -> None:
        self._said = lexicon.asking

    @cached_property
    def _patterns(self) -> dict[str, re.Pattern[str]]:
        """The patterns of the words of each kind, made for the first question that needs them."""
        said = {kind: "|".join(map(template_pattern, each)) for kind, each in self._said.items()}
        return {kind: re.compile(shape.format(said[kind])) for kind, shape in _SHAPES.items()}

    def readings(self, said: Normalised) -> Iterator[Normalised]:
        """Yield a question in plain words, where it is one and can be put so.

        Args:
            said: a sentence that is not read as it stands.
        """
        plain, opened = self._without_openers(said)
        plain, tagged = self._without_tags(plain)
        if not (said.question or opened or _ASKS.match(said.text)):
            return
        plain = self._without_idle(plain)
        if not plain.text or plain.text in ("it", "that", "this"):
            return
        asked = _put_as_question(plain, opened=opened, tagged=tagged)
        if asked is not None:
            yield replace(asked, question=True, asks=True)
        if plain.text != said.text:
            yield replace(plain, question=True, asks=True)

    def is_opened(self, said: Normalised) -> bool:
        """Check for a question that is opened with words that ask nothing."""
        return said.question and self._patterns["openers"].match(said.text) is not None

    def _without_openers(self, said: Normalised) -> tuple[Normalised, bool]:
        start = 0
        for _ in range(_MOST):
            opener = self._patterns["openers"].match(said.text, start)
            if opener is None:
                break
            start = opener.end()
        return (said.words_in((start, len(said.text))), True) if start else (said, False)

    def _without_tags(self, said: Normalised) -> tuple[Normalised, bool]:
        end = len(said.text)
        for _ in range(_MOST):
            ends = (self._patterns[kind].search(said.text[:end]) for kind in ("tags", "endings"))
            tag = next(filter(None, ends), None)
            if tag is None or said.text.find(" ", 0, tag.start()) < 0:
                break
            end = tag.start()
        return (said.words_in((0, end)), True) if end < len(said.text) else (said, False)

    def _without_idle(self, said: Normalised) -> Normalised:
        """The question without words that ask nothing, and without pauses at its ends."""
        kept, start = list[tuple[int, int]](), 0
        for idle in self._patterns["idle"].finditer(said.text):
            kept.append((start, idle.start()))
            start = idle.end()
        plain = said.words_in(*kept, (start, len(said.text))) if kept else said
        text = plain.text
        left, right = len(text) - len(text.lstrip(" ,.;!?")), len(text.rstrip(" ,.;!?"))
        return plain.words_in((left, right)) if right - left < len(text) else plain


def _put_as_question(said: Normalised, *, opened: bool, tagged: bool) -> Normalised | None:
    """What is told, with its verb first: "whether the jar is shut" → "is the jar shut"."""
    told = _WHETHER.fullmatch(said.text)
    if told is None and opened and (embedded := _EMBEDDED.fullmatch(said.text)):
        groups = [embedded.span(name) for name in ("how", "be", "who", "rest")]
        return said.words_in(*(span for span in groups if span[0] >= 0))
    if told is None and (tagged or opened) and not _INVERTED.match(said.text):
        told = _TOLD.fullmatch(said.text)
    if told is None:
        return None
    groups = [told.span(name) for name in ("be", "who", "rest")]
    return said.words_in(*(span for span in groups if span[0] >= 0))
