"""From lark's tree to parts with spans: what each phrase says, with quantities in SI units."""

from __future__ import annotations

import math
from decimal import Context, Decimal
from typing import Any, Literal, cast

from lark import Token, Transformer, Tree

from grammar.errors import ParseError
from grammar.frames import (
    Bound,
    ContactHeight,
    ContactRegion,
    Direction,
    Effector,
    Fast,
    Force,
    Gentle,
    Hard,
    MaxForce,
    MinForce,
    NoTouch,
    ObjectRef,
    Slow,
    Span,
)
from grammar.lexicon import Lexicon
from grammar.normalise import Normalised
from grammar.parts import (
    AmountPart,
    AnglePart,
    AvoidPart,
    ConstraintPart,
    DirectionPart,
    IntoPart,
    LengthPart,
    ObjectPart,
    Part,
    ParticlePart,
    SensePart,
    TowardPart,
    VerbPart,
)

MAX_LENGTH_M = 10.0
"""Longest distance that is taken seriously [m]."""

MAX_FORCE_N = 1000.0
"""Largest force that is taken seriously [N]."""

MAX_ANGLE_RAD = 20 * math.pi
"""Largest angle that is taken seriously [rad]."""

_FORCES: dict[str, type[Force | MinForce | MaxForce]] = {
    "exact": Force,
    "at_least": MinForce,
    "at_most": MaxForce,
}
_MANNERS: dict[str, type[Gentle | Hard | Slow | Fast]] = {
    "gentle": Gentle,
    "hard": Hard,
    "slow": Slow,
    "fast": Fast,
}
_BEFORE_FACE: dict[str, Direction] = {
    "front": "away",
    "back": "toward",
    "left": "right",
    "right": "left",
}

# Numbers beyond all bounds become infinite or NaN, which no range admits, and raise nothing.
_LENIENT = Context(prec=60, traps=[])

Children = list[Any]


class Parts(Transformer[Token, list[Part]]):
    """Turns the tree of one sentence into its parts, in the order of the sentence."""

    def __init__(self, lexicon: Lexicon, sentence: Normalised) -> None:
        super().__init__(visit_tokens=False)
        self._lexicon = lexicon
        self._sentence = sentence

    # --- words and numbers -------------------------------------------------------------------

    def _span(self, children: Children) -> Span:
        """From the first to the last of tokens and parts."""
        starts = [self._ends(child)[0] for child in children]
        ends = [self._ends(child)[1] for child in children]
        return min(starts), max(ends)

    def _ends(self, child: Token | Part) -> Span:
        if isinstance(child, Part):
            return child.span
        if child.start_pos is None or child.end_pos is None:
            raise AssertionError(f"token {child!r} without position")
        return self._sentence.span(child.start_pos, child.end_pos)

    def _value(self, children: Children, terminal: str, default: str = "") -> str:
        for child in children:
            if isinstance(child, Token) and child.type == terminal:
                return self._lexicon.value(terminal, str(child))
        return default

    def _bound(self, children: Children) -> Bound:
        return cast(Bound, self._value(children, "BOUND", "exact"))

    def _number(self, children: Children) -> Decimal:
        """The number among the children. Decimals keep "7 cm" at 0.07, not 0.07000000000000001."""
        number = next(c for c in children if isinstance(c, Token) and c.type.startswith("NUMBER"))
        word = number.type == "NUMBER_WORD"
        written = self._lexicon.value("NUMBER_WORD", str(number)) if word else str(number)
        return _LENIENT.create_decimal(written)

    def _times_unit(self, children: Children, terminal: str) -> float:
        factor = Decimal(self._value(children, terminal))
        return float(_LENIENT.multiply(self._number(children), factor))

    def _possible(self, children: Children, value: float, most: float, range_: str) -> float:
        """The value, if it lies in (0, most]; `range_` says so in words."""
        if not 0.0 < value <= most:
            span = self._span(children)
            raise ParseError(
                "impossible_quantity",
                f'"{self._sentence.written(span)}" is out of range: {range_}',
                span,
            )
        return value

    def _length(self, children: Children) -> float:
        metres = self._times_unit(children, "LENGTH_UNIT")
        range_ = f"a distance is more than 0 and at most {MAX_LENGTH_M:g} m"
        return self._possible(children, metres, MAX_LENGTH_M, range_)

    # --- the verb and what it is done to ------------------------------------------------------

    def number(self, children: Children) -> Token:
        """A number, in digits or as a word."""
        return cast(Token, children[0])

    def verb(self, children: Children) -> VerbPart:
        """The verb."""
        return VerbPart(self._span(children), str(children[0]))

    def particle(self, children: Children) -> ParticlePart:
        """Over, up, down."""
        return ParticlePart(self._span(children), str(children[0]))

    def object(self, children: Children) -> ObjectPart:
        """A name, without its article; quotation marks are no part of it."""
        words = [c for c in children if c.type in ("WORD", "QUOTED", "IT")]
        span = self._span(words)
        if words[0].type == "QUOTED":
            span = span[0] + 1, span[1] - 1
            inner = self._sentence.original[span[0] : span[1]]
            span = span[0] + len(inner) - len(inner.lstrip()), span[0] + len(inner.rstrip())
        ref = ObjectRef(text=self._sentence.written(span), spans=(span,))
        return ObjectPart(span, ref, contents=any(c.type == "CONTENTS" for c in children))

    # --- what should become of it -------------------------------------------------------------

    def direction(self, children: Children) -> list[Part]:
        """Away, over to the left."""
        span = self._span(children)
        direction = DirectionPart(span, cast(Direction, self._value(children, "DIRECTION")))
        if str(children[0]).startswith("over "):
            return [ParticlePart((span[0], span[0] + 4), "over", optional=True), direction]
        return [direction]

    def sense(self, children: Children) -> SensePart:
        """Clockwise."""
        return SensePart(self._span(children), self._value(children, "SENSE"))

    def amount(self, children: Children) -> AmountPart:
        """A little."""
        return AmountPart(self._span(children), self._value(children, "AMOUNT"))

    def toward(self, children: Children) -> TowardPart:
        """Towards the mug."""
        return TowardPart(self._span(children), children[1])

    def into(self, children: Children) -> IntoPart:
        """Into the mug."""
        return IntoPart(self._span(children), children[1])

    def length(self, children: Children) -> LengthPart:
        """By at least 10 cm."""
        return LengthPart(self._span(children), self._length(children), self._bound(children))

    def angle(self, children: Children) -> AnglePart:
        """By 30 degrees."""
        angle = float(self._number(children))
        if self._value(children, "ANGLE_UNIT") == "degree":
            angle = math.radians(angle)
        range_ = "an angle is more than 0 and at most ten turns"
        angle = self._possible(children, angle, MAX_ANGLE_RAD, range_)
        return AnglePart(self._span(children), angle, self._bound(children))

    # --- how ----------------------------------------------------------------------------------

    def manner(self, children: Children) -> ConstraintPart:
        """Gently."""
        span = self._span(children)
        return ConstraintPart(span, _MANNERS[self._value(children, "MANNER")](spans=(span,)))

    def force(self, children: Children) -> ConstraintPart:
        """With at most 5 N."""
        span = self._span(children)
        newtons = self._times_unit(children, "FORCE_UNIT")
        range_ = f"a force is more than 0 and at most {MAX_FORCE_N:g} N"
        value = self._possible(children, newtons, MAX_FORCE_N, range_)
        return ConstraintPart(span, _FORCES[self._bound(children)](value=value, spans=(span,)))

    def effector(self, children: Children) -> ConstraintPart:
        """With two fingers, with your left hand."""
        span = self._span(children)
        numbers = [c for c in children if c.type.startswith("NUMBER")]
        count = float(self._number(children)) if numbers else None
        if count is not None and count not in range(1, 11):
            raise ParseError(
                "impossible_quantity",
                f'"{self._sentence.written(span)}" is out of range: one to ten can be used',
                span,
            )
        if self._bound(children) != "exact":
            raise ParseError(
                "unexpected_words",
                f'"{self._sentence.written(span)}" leaves open how many to use',
                span,
                ("with one finger", "with two fingers"),
            )
        effector = Effector(
            tool=cast(Literal["finger", "hand", "arm"], self._value(children, "TOOL")),
            count=None if count is None else int(count),
            side=cast(Literal["left", "right"] | None, self._value(children, "SIDE") or None),
            spans=(span,),
        )
        return ConstraintPart(span, effector)

    def region(self, children: Children) -> ConstraintPart:
        """At the top."""
        region = cast(Literal["top", "middle", "bottom"], self._value(children, "REGION"))
        span = self._span(children)
        return ConstraintPart(span, ContactRegion(region=region, spans=(span,)))

    def face(self, children: Children) -> ConstraintPart:
        """On the left side."""
        face = cast(Literal["front", "back", "left", "right"], self._value(children, "FACE"))
        span = self._span(children)
        return ConstraintPart(span, ContactRegion(face=face, spans=(span,)))

    def from_side(self, children: Children) -> list[Part]:
        """From the left: the left face is touched and, if nothing else is said, pushed right."""
        face = cast(Literal["front", "back", "left", "right"], self._value(children, "FROM_SIDE"))
        span = self._span(children)
        return [
            ConstraintPart(span, ContactRegion(face=face, spans=(span,))),
            DirectionPart(span, _BEFORE_FACE[face], implied=True),
        ]

    def height(self, children: Children) -> ConstraintPart:
        """At 3 cm above the table."""
        span = self._span(children)
        origin = cast(Literal["table", "top"], self._value(children, "HEIGHT_REFERENCE", "table"))
        height = ContactHeight(value=self._length(children), origin=origin)
        return ConstraintPart(span, ContactRegion(height=height, spans=(span,)))

    # --- what must not happen -----------------------------------------------------------------

    def avoid(self, children: Children) -> AvoidPart:
        """Without toppling it."""
        word = next(c for c in children if isinstance(c, Token) and c.type in _AVOIDED)
        thing = next((c for c in children if isinstance(c, ObjectPart)), None)
        kind = self._lexicon.value(word.type, str(word))
        return AvoidPart(self._span(children), kind, str(word), thing)

    def further(self, children: Children) -> AvoidPart:
        """… or turning it."""
        part = self.avoid(children)
        return AvoidPart(part.span, part.kind, part.word, part.thing, further=True)

    def no_touch(self, children: Children) -> ConstraintPart:
        """Without touching the mug."""
        span = self._span(children)
        return ConstraintPart(span, NoTouch(object=children[-1].ref, spans=(span,)))

    # --- the whole ----------------------------------------------------------------------------

    def clause(self, children: Children) -> list[Part]:
        """The parts of the clause."""
        return self.start(children)

    def start(self, children: Children) -> list[Part]:
        """The parts of the sentence; tokens that are left carry no meaning (please, and)."""
        parts: list[Part] = []
        for child in children:
            if isinstance(child, list):
                parts += child
            elif isinstance(child, Part):
                parts.append(child)
        return parts


_AVOIDED = ("AVOIDING", "AVOID", "UPRIGHT")


def parts_of(tree: Tree[Token], lexicon: Lexicon, sentence: Normalised) -> list[Part]:
    """The parts of a parsed sentence.

    Raises:
        ParseError: `impossible_quantity` or `unexpected_words`.
    """
    return Parts(lexicon, sentence).transform(tree)
