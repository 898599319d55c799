"""Which goal takes which parts of a clause.

Every part must find its place; a part that its verb has no use for is an error, never dropped.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar, cast

from grammar import frames as g
from grammar.errors import ParseError
from grammar.frames import Span
from grammar.lexicon import Verb
from grammar.normalise import Normalised
from grammar.parts import (
    AmountPart,
    AnglePart,
    AwayFromPart,
    DiagonalPart,
    DirectionPart,
    FillerPart,
    HeadingPart,
    IntoPart,
    LengthPart,
    MePart,
    Part,
    PlacePart,
    ResultPart,
    SensePart,
    SharePart,
    TowardPart,
)

P = TypeVar("P", bound=Part)

_OPPOSITES: tuple[set[g.Direction], ...] = ({"away", "toward"}, {"left", "right"})
_SENSES: dict[g.Direction, g.Sense] = {"left": "ccw", "right": "cw"}
_MEASURES = (LengthPart, AnglePart)


class Clause:
    """The parts of one clause; each is taken once."""

    def __init__(
        self,
        parts: Sequence[Part],
        verb: Verb,
        sentence: Normalised,
        verb_span: Span | None = None,
    ) -> None:
        self._left = [part for part in parts if not isinstance(part, FillerPart)]
        self._sentence = sentence
        self.verb = verb
        self.verb_span = verb_span
        self.spans: list[Span] = []

    def has(self, *kinds: type[Part]) -> bool:
        """Whether a part of these kinds is left; a direction that is implied does not count."""
        return any(
            isinstance(part, kinds) and not (isinstance(part, DirectionPart) and part.implied)
            for part in self._left
        )

    def first(self, kind: type[P]) -> P | None:
        """The first part of a kind, which stays to be taken."""
        return next((part for part in self._left if isinstance(part, kind)), None)

    def take_all(self, kind: type[P]) -> list[P]:
        """Takes all parts of a kind; their words become the goal's."""
        taken = [part for part in self._left if isinstance(part, kind)]
        self._left = [part for part in self._left if not isinstance(part, kind)]
        self.spans += [part.span for part in taken]
        return taken

    def take(self, kind: type[P]) -> P | None:
        """Takes the only part of a kind."""
        taken = self.take_all(kind)
        if len(taken) > 1:
            raise self.twice(taken[0], taken[1])
        return taken[0] if taken else None

    def twice(self, first: Part, second: Part) -> ParseError:
        """Two parts say the same thing."""
        quotes = self.quote(first), self.quote(second)
        return ParseError(
            "said_twice",
            f"{quotes[0]} and {quotes[1]} say the same thing twice",
            second.span,
            (f"leave out one of {quotes[0]} and {quotes[1]}",),
            spans=(first.span, second.span),
        )

    def against(self, first: Part, second: Part) -> ParseError:
        """Two parts contradict each other."""
        quotes = self.quote(first), self.quote(second)
        return ParseError(
            "contradiction",
            f"{quotes[0]} and {quotes[1]} contradict each other",
            second.span,
            tuple(f"say only {quote}" for quote in quotes),
            spans=(first.span, second.span),
        )

    def refused(self, part: Part, message: str, *suggestions: str) -> ParseError:
        """A part that does not apply."""
        text = f"{self.quote(part)} {message}"
        return ParseError("does_not_apply", text, part.span, suggestions)

    def quote(self, part: Part) -> str:
        """The words of a part, in quotation marks."""
        return f'"{self._sentence.written(part.span)}"'

    def directions(self) -> tuple[g.Direction, ...]:
        """Takes what is said of the direction: none, one, or two across each other."""
        parts = self.take_all(DirectionPart)
        if any(not part.implied for part in parts):
            self.spans = [s for s in self.spans if s not in {p.span for p in parts if p.implied}]
            parts = [part for part in parts if not part.implied]
        for i, part in enumerate(parts):
            for other in parts[:i]:
                if {part.value, other.value} in _OPPOSITES:
                    raise self.against(other, part)
        said = {part.value for part in parts}
        diagonal = self.take(DiagonalPart)
        if diagonal is not None and len(said) < 2:
            message = "needs two directions"
            raise self.refused(diagonal, message, "away and to the left", "back and to the right")
        return tuple(sorted(said, key=("away", "toward", "left", "right").index))

    def drop_implied(self) -> None:
        """Forgets the direction that a side implies, where another says where to go."""
        self._left = [p for p in self._left if not (isinstance(p, DirectionPart) and p.implied)]

    def direction(self) -> g.Direction | None:
        """Takes what is said of the direction, where only a single one makes sense."""
        last = next((p for p in reversed(self._left) if isinstance(p, DirectionPart)), None)
        directions = self.directions()
        if last is not None and len(directions) > 1:
            message = "is a second direction; a single one is possible here"
            raise self.refused(last, message, *directions)
        return directions[0] if directions else None

    def angle(self) -> tuple[float | None, g.Bound]:
        """Takes an angle and its bound."""
        part = self.take(AnglePart)
        return (None, "exact") if part is None else (part.value, part.bound)

    def amount(self) -> g.Amount | None:
        """Takes "a little", unless a quantity says how much."""
        measure = next((part for part in self._left if isinstance(part, _MEASURES)), None)
        part = self.take(AmountPart)
        if part is not None and measure is not None:
            raise self.twice(part, measure)
        return None if part is None else cast(g.Amount, part.value)

    def finish(self, verb: str) -> None:
        """Refuses parts that were not taken."""
        for part in self._left:
            message = f"does not go with {verb!r}" if verb else "says nothing here"
            raise self.refused(part, message, f"leave out {self.quote(part)}")

    @property
    def all_spans(self) -> tuple[Span, ...]:
        """The words of the goal, in the order of the sentence."""
        return tuple(sorted(set(self.spans)))


def _displace(clause: Clause) -> g.Displace | g.Place:
    place = next((p for p in clause.take_all(PlacePart)), None)
    if place is not None and place.relation not in ("away_from", "to"):
        return _place_at(clause, place)
    share = clause.take(SharePart)
    if place is not None and place.relation == "to" and share is None:
        return _place_at(clause, place)
    heading, toward, me = clause.take(HeadingPart), clause.take(TowardPart), clause.take(MePart)
    off = clause.take(AwayFromPart)
    said = [part for part in (heading, toward, place, me, off) if part is not None]
    if said:
        clause.drop_implied()
    if len(said) > 1 or (said and clause.has(DirectionPart)):
        other = said[1] if len(said) > 1 else clause.take_all(DirectionPart)[0]
        raise clause.against(*sorted((said[0], other), key=lambda part: part.span))
    directions = clause.directions()
    if me is not None or (clause.verb.direction and not said and not directions):
        directions = (cast(g.Direction, clause.verb.direction or "toward"),)
    target = None if toward is None else toward.target
    away_from: g.ObjectRef | g.TableRegion | None = None if off is None else off.region
    if place is not None:
        assert isinstance(place.reference, tuple)
        if place.relation == "to":
            target = place.reference[0]
        else:
            away_from = place.reference[0]
    if share is not None and (not share.of_way or target is None):
        if not share.of_way:
            raise clause.refused(share, "is no single object", "say it for each object")
        raise clause.refused(share, "needs to say where to", "halfway to the mug")
    amount = clause.amount()
    length = clause.take(LengthPart)
    if share is not None and length is not None:
        raise clause.twice(share, length)
    if amount is None and length is None and share is None:
        amount = cast(g.Amount | None, clause.verb.amount)
    return g.Displace(
        direction=cast(Any, directions if len(directions) > 1 else next(iter(directions), None)),
        heading=None if heading is None else heading.value,
        toward=target,
        away_from=away_from,
        distance=None if length is None else length.value,
        bound="exact" if length is None else length.bound,
        fraction=None if share is None else share.value,
        amount=amount,
        spans=clause.all_spans,
    )


def _place(clause: Clause) -> g.Place:
    place = clause.take(PlacePart)
    if place is None:
        raise ParseError(
            "no_place",
            "the sentence does not say where to put it",
            clause.verb_span,
            ("next to the mug", "to the middle of the table", "to x 0.6 y -0.1"),
        )
    return _place_at(clause, place)


def _place_at(clause: Clause, place: PlacePart) -> g.Place:
    relation = "next_to" if place.relation in ("from", "away_from", "to") else place.relation
    length, share = clause.take(LengthPart), clause.take(SharePart)
    if place.relation == "from" and length is None:
        raise clause.refused(place, "needs a distance", "10 cm from the mug")
    objects = isinstance(place.reference, tuple)
    apart = relation not in ("touching", "on", "between", "at")
    if length is not None and (not apart or length.bound != "exact" or length.most):
        raise clause.refused(length, "does not go with this place", "10 cm from the mug")
    if share is not None and (objects or not share.of_way):
        raise clause.refused(share, "does not go with this place", "halfway to the left edge")
    clause.drop_implied()
    return g.Place(
        relation=cast(g.Relation, relation),
        reference=place.reference,
        distance=None if length is None else length.value,
        fraction=None if share is None or share.value == 1.0 else share.value,
        spans=clause.all_spans,
    )


def _rotate(clause: Clause) -> g.Rotate:
    sense = clause.take(SensePart)
    aside = clause.first(DirectionPart)
    direction = clause.direction()
    turned = _SENSES.get(direction) if direction else None
    if aside is not None and not aside.implied and (turned is None or sense is not None):
        message = "says the sense of turning twice" if sense else "is no way to turn"
        raise clause.refused(aside, message, "to the left", "to the right", "clockwise")
    amount = clause.amount()
    angle, bound = clause.angle()
    if angle is None and clause.verb.turns is not None:
        angle = math.tau * clause.verb.turns
    return g.Rotate(
        angle=angle,
        sense=turned if sense is None else cast(g.Sense, sense.value),
        bound=bound,
        amount=amount,
        spans=clause.all_spans,
    )


def _tilt(clause: Clause) -> g.Tilt:
    direction, amount = clause.direction(), clause.amount()
    angle, bound = clause.angle()
    return g.Tilt(
        angle=angle, direction=direction, bound=bound, amount=amount, spans=clause.all_spans
    )


def _topple(clause: Clause) -> g.Topple:
    return g.Topple(direction=clause.direction(), spans=clause.all_spans)


def _lift(clause: Clause) -> g.Lift:
    amount, height = clause.amount(), clause.take(LengthPart)
    return g.Lift(
        height=None if height is None else height.value,
        bound="exact" if height is None else height.bound,
        amount=amount,
        spans=clause.all_spans,
    )


def _pour(clause: Clause) -> g.Pour:
    into, amount, share = clause.take(IntoPart), clause.amount(), clause.take(SharePart)
    if share is not None and share.of_way:
        raise clause.refused(share, "is no part of a liquid", "half of the water")
    return g.Pour(
        into=None if into is None else into.target,
        amount=amount,
        fraction=None if share is None else share.value,
        spans=clause.all_spans,
    )


def _hand_over(clause: Clause) -> g.HandOver:
    clause.take(MePart)
    if clause.has(DirectionPart) and clause.direction() != "toward":
        raise ParseError(
            "does_not_apply",
            "things are handed to the one who speaks",
            clause.spans[-1],
            ("to me",),
        )
    return g.HandOver(spans=clause.all_spans)


def _contact(clause: Clause) -> g.Displace | g.Place | g.NoGoal:
    moves = (DirectionPart, HeadingPart, TowardPart, AwayFromPart, PlacePart, LengthPart,
             AmountPart, SharePart)  # fmt: skip
    if clause.has(*moves, MePart):
        return _displace(clause)
    # The side that is touched says where to push, but a touch need not move anything.
    clause.take_all(DirectionPart)
    return g.NoGoal()


def _parameters(clause: Clause) -> g.Parameters:
    return g.Parameters(which=(clause.verb.which,) if clause.verb.which else ())


GOALS: dict[str, Callable[[Clause], g.Goal]] = {
    "displace": _displace,
    "contact": _contact,
    "place": _place,
    "rotate": _rotate,
    "tilt": _tilt,
    "topple": _topple,
    "upright": lambda _: g.Upright(),
    "lift": _lift,
    "open": lambda _: g.Open(),
    "close": lambda _: g.Close(),
    "pour": _pour,
    "hand_over": _hand_over,
    "parameters": _parameters,
}

_OUTCOMES = {
    "moves": "displace",
    "slides": "displace",
    "tips": "topple",
    "tilts": "tilt",
    "turns": "rotate",
    "ends_up": "displace",
}


def intended(verb: Verb, result: ResultPart | None, clause: Clause) -> Callable[[Clause], g.Goal]:
    """The goal that takes the parts of a clause: the verb's, or that of "so that it falls".

    Raises:
        ParseError: `does_not_apply` if the verb cannot have that outcome.
    """
    if result is None:
        return GOALS[verb.goal]
    goal = _OUTCOMES.get(result.event)
    allowed = verb.goal in ("displace", "contact") or goal == verb.goal
    if goal is None or not allowed:
        raise clause.refused(
            result, "is no outcome of this", "so that it moves", "so that it falls"
        )
    return GOALS[goal]
