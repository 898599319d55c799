"""From the parts of a sentence to its frame: which goal takes which parts, and what is left over.

Every part must find its place; a part that its verb has no use for is an error, never dropped.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar, cast

from grammar.errors import ParseError
from grammar.frames import (
    Action,
    Amount,
    Close,
    Direction,
    Displace,
    Frame,
    Goal,
    Lift,
    Open,
    Parameters,
    Pour,
    Rotate,
    Sense,
    Span,
    Tilt,
    Topple,
)
from grammar.lexicon import Lexicon, Verb
from grammar.normalise import Normalised
from grammar.parts import (
    AmountPart,
    AnglePart,
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
from grammar.restrictions import constraints_of

P = TypeVar("P", bound=Part)

_OPPOSITES: tuple[set[Direction], ...] = ({"away", "toward"}, {"left", "right"})
_UP_AND_DOWN: dict[str, Direction] = {"up": "away", "down": "toward"}
_FORBIDDING = {
    "topple": ("no_topple", "no_tilt"),
    "tilt": ("no_tilt",),
    "turn": ("no_turn",),
    "slide": ("no_slide",),
    "lift": ("no_lift",),
}
"""Constraints that contradict an action."""

_PUSHED = frozenset({"displace", "topple", "tilt"})
"""Goals of which "from the left" says that they go to the right, unless by pulling."""

_SENSES: dict[Direction, Sense] = {"left": "ccw", "right": "cw"}


class _Clause:
    """The parts of one clause; each is taken once."""

    def __init__(self, parts: Sequence[Part], verb: Verb, sentence: Normalised) -> None:
        self._left = list(parts)
        self._sentence = sentence
        self.verb = verb
        self.spans: list[Span] = []

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
            raise ParseError(
                "said_twice",
                f"{self.quote(taken[0])} and {self.quote(taken[1])} say the same thing twice",
                taken[1].span,
                (f"leave out one of {self.quote(taken[0])} and {self.quote(taken[1])}",),
            )
        return taken[0] if taken else None

    def quote(self, part: Part) -> str:
        """The words of a part, in quotation marks."""
        return f'"{self._sentence.written(part.span)}"'

    def directions(self) -> tuple[Direction, ...]:
        """Takes what is said of the direction: none, one, or two across each other."""
        parts = self.take_all(DirectionPart)
        if any(not part.implied for part in parts):
            self.spans = [s for s in self.spans if s not in {p.span for p in parts if p.implied}]
            parts = [part for part in parts if not part.implied]
        said = {part.value for part in parts}
        if any(pair <= said for pair in _OPPOSITES):
            raise ParseError(
                "contradiction",
                " and ".join(self.quote(part) for part in parts) + " contradict each other",
                parts[-1].span,
                tuple(f"say only {self.quote(part)}" for part in parts),
            )
        return tuple(sorted(said, key=("away", "toward", "left", "right").index))

    def direction(self) -> Direction | None:
        """Takes what is said of the direction, where only a single one makes sense."""
        last = next((p for p in reversed(self._left) if isinstance(p, DirectionPart)), None)
        directions = self.directions()
        if last is not None and len(directions) > 1:
            raise ParseError(
                "does_not_apply",
                f"{self.quote(last)} is a second direction; a single one is possible here",
                last.span,
                directions,
            )
        return directions[0] if directions else None

    def exactly(self, part: P) -> P:
        """Refuses a bound where there is no place for one."""
        if isinstance(part, LengthPart | AnglePart) and part.bound != "exact":
            raise ParseError(
                "does_not_apply",
                f"{self.quote(part)} is a bound; a plain quantity is possible here",
                part.span,
            )
        return part

    def finish(self, verb: str) -> None:
        """Refuses parts that were not taken."""
        for part in self._left:
            raise ParseError(
                "does_not_apply", f'{self.quote(part)} does not go with "{verb}"', part.span
            )


def _displace(clause: _Clause) -> Displace:
    directions = clause.directions()
    toward = clause.take(TowardPart)
    distance = clause.take(LengthPart)
    amount = clause.take(AmountPart)
    if distance is not None and amount is not None:
        raise ParseError(
            "said_twice",
            f"{clause.quote(amount)} and {clause.quote(distance)} both say how far",
            amount.span,
            (f"leave out {clause.quote(amount)}",),
        )
    if toward is not None and directions:
        raise ParseError(
            "contradiction", f"{clause.quote(toward)} is already a direction", toward.span
        )
    implied = None if distance else clause.verb.amount
    return Displace(
        direction=cast(Any, directions if len(directions) > 1 else next(iter(directions), None)),
        toward=None if toward is None else toward.target.ref,
        distance=None if distance is None else distance.value,
        bound="exact" if distance is None else distance.bound,
        amount=cast(Amount | None, implied if amount is None else amount.value),
        spans=tuple(sorted(clause.spans)),
    )


def _rotate(clause: _Clause) -> Rotate:
    sense, direction, angle = clause.take(SensePart), clause.direction(), clause.take(AnglePart)
    turned = _SENSES.get(direction) if direction else None
    if (direction and turned is None) or (sense and turned):
        raise ParseError(
            "does_not_apply",
            f'an object turns to the left or to the right, not "{direction}"'
            if turned is None
            else "the sense of turning is said twice",
            clause.spans[-1],
            ("to the left", "to the right", "clockwise", "counterclockwise"),
        )
    return Rotate(
        angle=None if angle is None else clause.exactly(angle).value,
        sense=turned if sense is None else cast(Sense, sense.value),
        spans=tuple(sorted(clause.spans)),
    )


def _tilt(clause: _Clause) -> Tilt:
    direction, angle = clause.direction(), clause.take(AnglePart)
    value = None if angle is None else clause.exactly(angle).value
    return Tilt(angle=value, direction=direction, spans=tuple(sorted(clause.spans)))


def _topple(clause: _Clause) -> Topple:
    return Topple(direction=clause.direction(), spans=tuple(sorted(clause.spans)))


def _lift(clause: _Clause) -> Lift:
    height = clause.take(LengthPart)
    return Lift(
        height=None if height is None else clause.exactly(height).value, spans=tuple(clause.spans)
    )


def _pour(clause: _Clause) -> Pour:
    into, amount = clause.take(IntoPart), clause.take(AmountPart)
    return Pour(
        into=None if into is None else into.target.ref,
        amount=None if amount is None else cast(Amount, amount.value),
        spans=tuple(sorted(clause.spans)),
    )


_GOALS: dict[str, Callable[[_Clause], Goal]] = {
    "displace": _displace,
    "rotate": _rotate,
    "tilt": _tilt,
    "topple": _topple,
    "lift": _lift,
    "open": lambda _: Open(),
    "close": lambda _: Close(),
    "pour": _pour,
    "parameters": lambda _: Parameters(),
}


def frame_of(parts: Sequence[Part], lexicon: Lexicon, sentence: Normalised) -> Frame:
    """Puts the parts of a sentence together.

    Raises:
        ParseError: `unexpected_words`, `unknown_verb`, `said_twice`, `contradiction`,
            `does_not_apply`, `other_object`.
    """
    verb_part = next(part for part in parts if isinstance(part, VerbPart))
    thing = next(part for part in parts if isinstance(part, ObjectPart))
    rest = [part for part in parts if part is not verb_part and part is not thing]
    rest, constraints = constraints_of(rest, thing, lexicon, sentence)
    verb, name, verb_spans, rest = _verb(verb_part, rest, lexicon, sentence)
    if thing.contents and verb.goal != "pour":
        raise ParseError(
            "does_not_apply", f'the contents of a thing do not go with "{name}"', thing.span
        )
    if verb.goal not in _PUSHED or verb.action == "pull":
        rest = [p for p in rest if not (isinstance(p, DirectionPart) and p.implied)]
    clause = _Clause(rest, verb, sentence)
    goal = _GOALS[verb.goal](clause)
    clause.finish(name)
    for constraint in constraints:
        if constraint.kind in _FORBIDDING.get(verb.action, ()):
            raise ParseError(
                "contradiction",
                f'"{sentence.written(constraint.spans[0])}" forbids what "{name}" asks',
                constraint.spans[0],
            )
    return Frame(
        action=cast(Action, verb.action),
        object=thing.ref,
        goal=goal,
        constraints=constraints,
        spans=verb_spans,
    )


def _verb(
    part: VerbPart, rest: list[Part], lexicon: Lexicon, sentence: Normalised
) -> tuple[Verb, str, tuple[Span, ...], list[Part]]:
    """Finds the verb with or without its particle; returns what it leaves of the rest."""
    particle = next((p for p in rest if isinstance(p, ParticlePart)), None)
    alone = lexicon.verb(part.word)
    if particle is not None and particle.optional and alone and alone.goal == "displace":
        rest, particle = [p for p in rest if p is not particle], None
    if particle is not None:
        verb = lexicon.verb(part.word, particle.word)
        if verb is not None:
            left = [p for p in rest if p is not particle]
            spans = _joined([part.span, particle.span], sentence)
            return verb, f"{part.word} {particle.word}", spans, left
    verb = alone
    if verb is None:
        whole = tuple(sorted(v for v in lexicon.verbs if v.startswith(f"{part.word} ")))
        raise ParseError(
            "unknown_verb",
            f'"{part.word}" alone is no action; it needs its particle',
            part.span,
            tuple(f"did you mean '{phrase}'?" for phrase in whole),
        )
    if particle is not None and verb.goal == "displace" and particle.word in _UP_AND_DOWN:
        direction = DirectionPart(particle.span, _UP_AND_DOWN[particle.word])
        rest = [direction if p is particle else p for p in rest]
    return verb, part.word, (part.span,), rest


def _joined(spans: list[Span], sentence: Normalised) -> tuple[Span, ...]:
    """One span if only space lies between."""
    (start, middle), (again, end) = sorted(spans)
    between = sentence.original[middle:again]
    return ((start, end),) if not between.strip() else ((start, middle), (again, end))
