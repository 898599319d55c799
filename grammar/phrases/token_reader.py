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
"""Children of a node of the parse tree: tokens, parts, and lists of parts."""


def tokens_in(children: Children, *terminals: str) -> list[Token]:
    """The tokens of some terminals among the children of a node."""
    return [c for c in children if isinstance(c, Token) and c.type in terminals]


def parts_in(children: Children) -> list[ph.Part]:
    """The parts among the children of a node."""
    return [child for child in children if isinstance(child, ph.Part)]


def things_in(children: Children) -> list[ph.Thing]:
    """The named objects among the children of a node."""
    return [child for child in children if isinstance(child, ph.Thing)]


class TokenReader:
    """The children of the nodes of a sentence, with their places in it and their values."""

    def __init__(self, lexicon: Lexicon, sentence: Normalised) -> None:
        self.lexicon = lexicon
        self.sentence = sentence

    def span_of(self, children: Children) -> Span:
        """From the first to the last of tokens and parts."""
        ends = [
            child.span
            if isinstance(child, ph.Part)
            else self.sentence.original_span(child.start_pos, child.end_pos)
            for child in children
        ]
        return min(start for start, _ in ends), max(end for _, end in ends)

    def does_not_apply_error(
        self, children: Children, message: str, hint: str, *more: str
    ) -> ParseError:
        """The error for words that do not apply where they stand."""
        span = self.span_of(children)
        return self.sentence.error_at(span, "does_not_apply", message, hint, *more)

    def value_of(self, children: Children, terminal: str, default: str = "") -> str:
        """Value of the token of a terminal; `default` if there is none."""
        tokens = tokens_in(children, terminal)
        return self.lexicon.value_of(terminal, str(tokens[0])) if tokens else default

    def bound_of(self, children: Children) -> Bound:
        """About so much, at least, at most; "or more" is said behind the quantity."""
        return cast(Bound, self.strict_bound_of(children).replace("exactly", "exact"))

    def strict_bound_of(self, children: Children) -> Bound:
        """The same of an amount, for which "exactly" is less than about so much."""
        before, behind = self.value_of(children, "BOUND"), self.value_of(children, "OR_MORE")
        if {before, behind} == {"exact", "exactly"}:
            return "exactly"
        if before and behind and before != behind:
            said = tokens_in(children, "OR_MORE")
            raise self.does_not_apply_error(said, "is a second bound", f'leave out "{said[0]}"')
        return cast(Bound, before or behind or "exact")

    def numbers_in(self, children: Children) -> list[Decimal]:
        """The numbers among the children; an article is a one."""
        found: list[Decimal] = []
        terminals = ("NUMBER", "NUMBER_WORD", "TWICE", "A", "AND_FRACTION")
        for token in tokens_in(children, *terminals):
            match token.type:
                case "NUMBER":
                    found.append(exact_decimal(str(token)))
                case "NUMBER_WORD":
                    found.append(self.lexicon.numbers.decimal_of(str(token)))
                case "A":
                    found.append(Decimal(1))
                case "TWICE":
                    found.append(Decimal(self.lexicon.value_of("TWICE", str(token))))
                case _:
                    fraction = Decimal(self.lexicon.value_of("AND_FRACTION", str(token)))
                    found[-1] = LENIENT.add(found[-1], fraction)
        return found

    def in_unit(self, children: Children, terminal: str) -> list[float]:
        """The numbers times their unit [SI]."""
        units = [self.lexicon.value_of(terminal, str(u)) for u in tokens_in(children, terminal)]
        numbers = self.numbers_in(children)
        units = units * len(numbers) if len(units) == 1 else units
        return [
            float(LENIENT.multiply(number, Decimal(unit)))
            for number, unit in zip(numbers, units, strict=True)
        ]

    def lengths_in(self, children: Children) -> list[float]:
        """The distances [m]."""
        range_ = f"a distance is more than 0 and at most {MAX_LENGTH_M:g} m"
        lengths = self.in_unit(children, "LENGTH_UNIT")
        return [self.require_possible(children, x, MAX_LENGTH_M, range_) for x in lengths]

    def angle_in(self, children: Children, *, signed: bool = False) -> float:
        """The angle [rad]; a heading may also be zero or negative."""
        number, unit = float(self.numbers_in(children)[0]), self.value_of(children, "ANGLE_UNIT")
        units = {"degree": math.radians(1.0), "right angle": math.tau / 4, "turn": math.tau}
        angle = units.get(unit, 1.0) * number
        if signed:
            range_ = "a heading is at most one turn"
            self.require_possible(children, abs(angle) or math.tau, math.tau, range_)
            return angle
        range_ = "an angle is more than 0 and at most ten turns"
        return self.require_possible(children, angle, MAX_ANGLE_RAD, range_)

    def require_possible(self, children: Children, value: float, most: float, range_: str) -> float:
        """The value, if it lies in (0, most]; `range_` says so in words."""
        if not 0.0 < value <= most:
            span, message = self.span_of(children), f"is out of range: {range_}"
            raise self.sentence.error_at(span, "impossible_quantity", message, range_)
        return value
