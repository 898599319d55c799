"""Numbers in words and in digits: "two and a half", "a quarter of a", "one hundred and fifty".

Numbers are decimals, so that "7 cm" is 0.07 and not 0.07000000000000001.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Context, Decimal
from functools import cached_property
from typing import Any

LENIENT = Context(prec=60, traps=[])
"""Numbers beyond all bounds become infinite or NaN, which no range admits, and raise nothing."""

_DECIMAL = r"(?:\d+(?:\.\d*)?|\.\d+)(?:e[-+]?\d+)?"
DIGITS = re.compile(rf"[-+]?(?:\d+ \d+/\d+|\d+/\d+|{_DECIMAL})")
"""A number in digits: "10", "-0.5", "1e-3", "3/4", "2 1/2"."""


def exact_decimal(text: str) -> Decimal:
    """The number that digits mean, fractions included ("2 1/2", "1/3")."""
    whole, _, fraction = text.rpartition(" ")
    over, _, under = fraction.partition("/")
    value = LENIENT.create_decimal(over)
    if under:
        value = LENIENT.divide(value, LENIENT.create_decimal(under))
    sign = -1 if whole.startswith("-") else 1
    return LENIENT.add(LENIENT.create_decimal(whole or 0), LENIENT.multiply(Decimal(sign), value))


@dataclass(frozen=True)
class NumberWords:
    """The words that numbers are made of.

    Attributes:
        ones: "one" to "nine", and "zero".
        teens: "ten" to "nineteen".
        tens: "twenty", "thirty" to "ninety".
        ordinals: "first" to "tenth".
        phrases: other ways to say a number ("half a") → the number in digits.
    """

    ones: Mapping[str, int]
    teens: Mapping[str, int]
    tens: Mapping[str, int]
    ordinals: Mapping[str, int]
    phrases: Mapping[str, str]

    @classmethod
    def from_data(cls, data: Mapping[str, Any], phrases: Mapping[str, str]) -> NumberWords:
        """Builds them from the mapping in the lexicon's file, its phrases spelled out."""
        return cls(data["ones"], data["teens"], data["tens"], data["ordinals"], phrases)

    @cached_property
    def first_words(self) -> frozenset[str]:
        """Words that a number may begin with."""
        starts = {phrase.split()[0] for phrase in self.phrases}
        return frozenset(starts | self.ones.keys() | self.teens.keys() | self.tens.keys())

    @cached_property
    def pattern(self) -> re.Pattern[str]:
        """A number in words, from the start of a word to the end of one."""
        ones, teens, tens = ("|".join(sorted(w)) for w in (self.ones, self.teens, self.tens))
        small = rf"(?:(?:{tens})(?: (?:{ones}))?|{teens}|{ones})"
        cardinal = rf"(?:(?:(?:{ones}|a) hundred|thousand)(?: (?:and )?{small})?|{small})"
        point = rf"(?: point(?: (?:{ones}))+)?"
        said = sorted(self.phrases, key=lambda phrase: -len(phrase))
        phrases = "|".join(phrase for phrase in said if " " in phrase)
        words = "|".join(phrase for phrase in said if " " not in phrase)
        return re.compile(rf"(?:{phrases}|{cardinal}{point}|{words})(?= |$)")

    def decimal_of(self, words: str) -> Decimal:
        """The number that words mean, or digits that stand for them."""
        if words in self.phrases:
            return exact_decimal(self.phrases[words])
        whole, _, after = words.partition(" point ")
        total = 0
        for word in whole.split():
            if word == "hundred":
                total = max(total, 1) * 100
            elif word == "thousand":
                total = max(total, 1) * 1000
            elif word not in ("and", "a"):
                total += {**self.ones, **self.teens, **self.tens}[word]
        digits = "".join(str(self.ones[word]) for word in after.split())
        return Decimal(f"{total}.{digits}" if digits else total)
