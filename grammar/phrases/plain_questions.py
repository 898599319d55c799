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
    "idle": r"(?<![^ ])(?<!, )(?:{0})(?: ,)?(?= |$)",
}
"""Where the words of each kind stand."""

_SUPPOSED = re.compile(
    "(?:(?:and|but|now|so|then|ok|okay|well) (?:, )?)*"
    "(?:(?:suppose|supposing|imagine|assume|assuming|"
    "let us (?:say|suppose|assume|imagine)|say|what if|if) (?:that )?(?:i|we|you|somebody|someone) "
    "(?:now |just )?(?:ask|asked|tell|told|had|were|was|want|wanted)|what (?:happens|would happen))"
)
"""How a question begins what would come of something, which is not to be done for it."""

_CONFIRMED = re.compile(
    "(?:(?:and|but|so|or|well|ok|okay|now|then|no|oh|hey|wait) (?:, )?)*(?:it|that|this|they) "
    "(?:will|would|could|can|may|might|is|does) (?:not )?[^.;!?]*?"
    "(?:will|would|could|can|may|might|is|does) (?:not )?(?:it|they|that)(?: [.;!?])?$"
)
"""A question whether something will happen, which forbids nothing: "it won't fall, will it"."""

_IF_NEEDED = re.compile(
    "(?:(?:and|but|so|or|well|really|ok|okay|now|then|no|oh|hey|wait) (?:[,.?!] )?)*(?:could|can|"
    "would) you [^.;!?]*? (?:if you (?:had to|really had to|wanted to|needed to|must)|, "
    "(?:i mean , |that is , )?(?:are you (?:able to|capable of it)|is (?:it|that) possible))"
    "(?: [.;!?])?$"
)
"""A question for what is possible: "could you lift it, if you had to", "…, are you able to"."""

_MOST = 4
"""Openers, and tags, that are left out one after another."""

_BE = "is|are|was|were|would|will|can|could|did|does|do|has|have|had|might|may|should"
_BE_NOT_CAN = _BE.replace("can|", "")
_COULD = "(?<!the )(?<!that )(?<!this )(?<!soup )can"
"""The verb, which no name of a thing ends before: "the can is heavy"."""

_ASKS = re.compile(
    rf"(?:(?:and|but|so|or|well|ok|okay|now|then|no|oh|hey|wait) (?:, )?)*(?:how|what|which|who|"
    rf"whose|where|when|why|whether|if|any|anything|{_BE}) "
)
_TOLD = re.compile(
    rf"(?P<who>[^,.;!?]+?) (?P<be>{_BE_NOT_CAN}|{_COULD})(?: not)?(?: (?P<rest>[^.;!?]+))?"
)
_WHETHER = re.compile(rf"(?:whether|if) {_TOLD.pattern}")
_SUBJECTS = "the|an?|my|your|our|his|her|its?|that|this|these|those|you|they|we|i|s?he|all|both"
_THAT = re.compile("that (?=(?:the|a|an|it|you|my|your|this|that|they|i|we) )")
_ASKED_FOR = rf"(?: (?!(?:{_BE}) )[a-z]+)?"
"""What "how" and "which" stand before: "how heavy", "which side"."""

_EMBEDDED = re.compile(
    rf"(?P<how>(?:and )?(?:how{_ASKED_FOR}|where|why|wh(?:at|ich){_ASKED_FOR})) "
    rf"(?!(?:{_BE}) )(?=(?:{_SUBJECTS}) ){_TOLD.pattern}"
)
_DEED = re.compile("(?:you|it|they|that|everything|nothing|something|anything) ")
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
        asks = _ASKS.match(said.text) or (opened and _ASKS.match(plain.text))
        if not (said.question or asks):
            return
        plain = self._without_idle(plain)
        if not plain.text or plain.text in ("it", "that", "this"):
            return
        asked = _put_as_question(plain, told=tagged or said.question)
        if asked is not None:
            yield replace(asked, question=True, asks=True).with_gaps_aside()
        if plain.text != said.text:
            yield replace(plain, question=True, asks=True).with_gaps_aside()

    def only_supposes(self, said: Normalised) -> bool:
        """Check for a question what would come of something: "suppose I asked you to push it"."""
        asked = any(each.match(said.text) for each in (_SUPPOSED, _CONFIRMED, _IF_NEEDED))
        return said.question and asked

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


def _put_as_question(said: Normalised, *, told: bool) -> Normalised | None:
    """The question of what is told, its verb first: "whether it is shut" → "is it shut".

    Args:
        said: a question without words that ask nothing.
        told: whether something that is told may be meant as one: "it did not move, did it?".
    """
    if that := _THAT.match(said.text):
        said = said.words_in((that.end(), len(said.text)))
    names: tuple[str, ...] = ("be", "who", "rest")
    found = _WHETHER.fullmatch(said.text)
    if found is None and (found := _EMBEDDED.fullmatch(said.text)):
        names = ("how", *names)
    if found is None and told and not _INVERTED.match(said.text):
        found = _TOLD.fullmatch(said.text)
        if found is None and _DEED.match(said.text):
            columns = (said.columns[0],) * len("did ") + said.columns
            return replace(said, text=f"did {said.text}", columns=columns)
    if found is None:
        return None
    return said.words_in(*(span for span in map(found.span, names) if span[0] >= 0))
