"""Sentences without a word that has an effect: "test one", "that went well", "you know the drill".

Such a text is made of words of courtesy, of the occasion, of praise and of mood, which a lexicon
lists; or it says something of somebody or something that is not named. It holds no verb of an
action, no place, amount or manner, no event or limit, and no name of an object: with one of them
it is not idle, whatever else it says.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from functools import cached_property

from grammar.words.lexicon import Lexicon
from grammar.words.numerals import DIGITS
from grammar.words.phrase_places import Phrases
from grammar.words.phrase_templates import template_pattern

_NEUTRAL = frozenset({"A", "CAN", "CAN_YOU", "FILLER", "IS", "IT", "ME", "MUST", "NEXT", "OF",
                      "SEPARATOR", "THAT", "THE", "THERE", "THINK", "VOCATIVE", "YOU"})  # fmt: skip
"""Terminals that have an effect only beside others."""

_EFFECTIVE = frozenset({"ANGLE_UNIT", "AVOID", "DIRECTION", "EVENT_INFINITIVE", "MANNER", "NO",
                        "NOT", "STOP", "VERB", "WISH"})  # fmt: skip
"""Terminals with an effect, which no word of courtesy takes from them."""

_ARTICLES = frozenset({"A", "THE"})
_BEFORE_ANY = frozenset({"be", "for", "how", "is", "of", "so", "such", "to", "was", "what"})
"""Words behind which an unknown one can only tell: "no need to apologise", "how exciting"."""

_CONDITIONS = frozenset({"if", "once", "unless", "until", "when", "whenever", "while"})

_MANNER = re.compile(r"[a-z]{3,}(?:ly|er)")
"""An unknown word that may say how: "airily", "calmer"."""


class IdleWords:
    """Finds texts without an effect, by the words of a lexicon."""

    def __init__(self, lexicon: Lexicon, phrases: Phrases, names: Collection[str] = ()) -> None:
        self._lexicon = lexicon
        self._phrases = phrases
        self._names = frozenset(names)

    def with_names(self, names: Collection[str]) -> IdleWords:
        """The same, where some words are those of the names of objects."""
        return IdleWords(self._lexicon, self._phrases, names)

    def are_all(self, text: str) -> bool:
        """Check for a text in plain form, without its last mark, that has no effect."""
        if self._label.fullmatch(text):
            return True
        if text.partition(" ")[0] in _CONDITIONS:
            return False
        subject = self._subject.match(text)
        if subject and self._denied.search(text):
            return False
        open_name, idle, last = False, False, ""
        words = list(self._phrases.longest_in(text))
        for i, (start, word, kinds) in enumerate(words):
            acts = "VERB" in kinds or word in self._lexicon.later_verbs
            noun = word in self._nouns and (open_name or not acts or last in self._idle)
            said = noun or word in self._idle or word in self._joining
            said = said or (word in self._courtesy and _EFFECTIVE.isdisjoint(kinds))
            tells = subject is not None and start >= subject.end()
            follows = words[i + 1][1] if i + 1 < len(words) else ""
            if word in self._names and (open_name or not said):
                return False
            if not said and not (kinds and _NEUTRAL.issuperset(kinds)):
                free = tells or follows in self._nouns or (last in _BEFORE_ANY and not open_name)
                unknown = not kinds and word.isalpha() and not self._lexicon.numbers.is_number(word)
                if not (unknown and free) or (_MANNER.fullmatch(word) and not tells):
                    return False
            idle = idle or noun or tells or (said and word not in self._weak)
            open_name = not noun and not tells and (open_name or not _ARTICLES.isdisjoint(kinds))
            last = word
        return idle and not open_name

    @cached_property
    def _nouns(self) -> frozenset[str]:
        return frozenset(self._lexicon.courtesy["occasions"].split())

    @cached_property
    def _idle(self) -> frozenset[str]:
        return frozenset(self._lexicon.courtesy["idle"].split())

    @cached_property
    def _courtesy(self) -> frozenset[str]:
        said = self._lexicon.courtesy
        return frozenset(f"{said['both']} {said['after']} {said['beside_thanks']}".split())

    @cached_property
    def _joining(self) -> frozenset[str]:
        return frozenset(self._lexicon.courtesy["joining"].split())

    @cached_property
    def _weak(self) -> frozenset[str]:
        """Words of which a text is not idle that has no others."""
        return self._joining | frozenset(self._lexicon.courtesy["pointing"].split())

    @cached_property
    def _denied(self) -> re.Pattern[str]:
        """Words with which somebody says what must be done, or what is meant."""
        said = "|".join(map(template_pattern, self._lexicon.statements["denied"]))
        return re.compile(rf"(?<![^ ])(?:{said})(?= |$)")

    @cached_property
    def _subject(self) -> re.Pattern[str]:
        """A subject that names no object, and a verb that is said of it."""
        return re.compile(template_pattern(self._lexicon.courtesy["telling"]) + " ")

    @cached_property
    def _label(self) -> re.Pattern[str]:
        """The label of a part of a series: "test two", "step 3 of 5", "task b"."""
        number = rf"(?:{DIGITS.pattern}|{self._lexicon.numbers.pattern.pattern}|[a-h])"
        before = template_pattern(self._lexicon.courtesy["before_label"])
        kind = self._lexicon.courtesy["labels"].replace(" ", "|")
        return re.compile(
            rf"(?:(?:{before}) )?(?:(?:{kind})(?: number)?|number) {number}(?: of {number})?"
            r"(?: (?:now|begins|starts|please))?"
        )
