"""Numbers with units in SI, and what is taken seriously."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import Any, cast

from grammar.errors import ParseError
from grammar.frames.command import Bound, Span
from grammar.phrases import phrase_parts as ph
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.numerals import LENIENT, exact_decimal
from grammar.words.phrase_lexer import Token

MAX_LENGTH_M = 10.0
"""Longest distance that is taken seriously [m]."""

MAX_FORCE_N = 1000.0
"""Largest force that is taken seriously [N]."""

MAX_ANGLE_RAD = 20 * math.pi
"""Largest angle that is taken seriously [rad]."""

MAX_SPEED = 10.0
"""Largest speed that is taken seriously [m/s]."""

MAX_VOLUME = 0.1
"""Largest volume that is taken seriously [m³]."""

MAX_TIME_S = 3600.0
"""Longest time that is taken seriously [s]."""

Children = list[Any]


class TokenReader:
    """The tokens of a sentence, with their places in it and their values."""

    def __init__(self, lexicon: Lexicon, sentence: Normalised) -> None:
        self.lexicon = lexicon
        self.sentence = sentence

    def span_of(self, children: Children) -> Span:
        """From the first to the last of tokens and parts."""
        ends = [self._span_of_child(child) for child in children]
        return min(start for start, _ in ends), max(end for _, end in ends)

    def _span_of_child(self, child: Token | ph.Part) -> Span:
        if isinstance(child, ph.Part):
            return child.span
        return self.sentence.original_span(child.start_pos, child.end_pos)

    def value_of(self, children: Children, terminal: str, default: str = "") -> str:
        """Value of the token of a terminal; `default` if there is none."""
        for child in children:
            if isinstance(child, Token) and child.type == terminal:
                return self.lexicon.value_of(terminal, str(child))
        return default

    def bound_of(self, children: Children) -> Bound:
        """Exactly, at least, at most; "or more" is said behind the quantity."""
        said = self.value_of(children, "BOUND") or self.value_of(children, "OR_MORE", "exact")
        return cast(Bound, said)

    def numbers_in(self, children: Children) -> list[Decimal]:
        """The numbers among the children; an article is a one."""
        found: list[Decimal] = []
        for child in children:
            if not isinstance(child, Token):
                continue
            if child.type == "NUMBER":
                found.append(exact_decimal(str(child)))
            elif child.type == "NUMBER_WORD":
                found.append(self.lexicon.numbers.decimal_of(str(child)))
            elif child.type == "TWICE":
                found.append(Decimal(self.lexicon.value_of("TWICE", str(child))))
            elif child.type == "A":
                found.append(Decimal(1))
            elif child.type == "AND_FRACTION":
                fraction = Decimal(self.lexicon.value_of("AND_FRACTION", str(child)))
                found[-1] = LENIENT.add(found[-1], fraction)
        return found

    def in_unit(self, children: Children, terminal: str) -> list[float]:
        """The numbers times their unit [SI]."""
        factor = Decimal(self.value_of(children, terminal))
        return [float(LENIENT.multiply(number, factor)) for number in self.numbers_in(children)]

    def lengths_in(self, children: Children) -> list[float]:
        """The distances [m]."""
        factors = [
            Decimal(self.lexicon.value_of("LENGTH_UNIT", str(child)))
            for child in children
            if isinstance(child, Token) and child.type == "LENGTH_UNIT"
        ]
        numbers = self.numbers_in(children)
        factors = factors * len(numbers) if len(factors) == 1 else factors
        return [
            self.require_possible(
                children, float(LENIENT.multiply(number, factor)), MAX_LENGTH_M,
                f"a distance is more than 0 and at most {MAX_LENGTH_M:g} m",
            )
            for number, factor in zip(numbers, factors, strict=True)
        ]  # fmt: skip

    def angle_in(self, children: Children, *, signed: bool = False) -> float:
        """The angle [rad]; a heading may also be zero or negative."""
        number, unit = float(self.numbers_in(children)[0]), self.value_of(children, "ANGLE_UNIT")
        angle = {"degree": math.radians(number), "turn": math.tau * number}.get(unit, number)
        if signed:
            range_ = "a heading is at most one turn"
            self.require_possible(children, abs(angle) or math.tau, math.tau, range_)
            return angle
        range_ = "an angle is more than 0 and at most ten turns"
        return self.require_possible(children, angle, MAX_ANGLE_RAD, range_)

    def require_possible(self, children: Children, value: float, most: float, range_: str) -> float:
        """The value, if it lies in (0, most]; `range_` says so in words."""
        if not 0.0 < value <= most:
            span = self.span_of(children)
            raise ParseError(
                "impossible_quantity",
                f'"{self.sentence.words_as_written(span)}" is out of range: {range_}',
                span,
                (range_,),
            )
        return value
