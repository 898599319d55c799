"""The parts of one clause, each of which is taken once and finds its place in the frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeVar, cast

from grammar.clauses.consistency import contradiction_error
from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.frames.command import Span
from grammar.phrases import phrase_parts as ph
from grammar.words.lexicon import Verb
from grammar.words.normalisation import Normalised

P = TypeVar("P", bound=ph.Part)
Parts = list[ph.Part]

ON_THE_TABLE = {"above": "behind", "below": "in_front_of"}
"""Relations as on a picture of the table, and what they are for one who stands before it."""

_OPPOSITES: tuple[set[g.Direction], ...] = ({"away", "toward"}, {"left", "right"})
_FORWARD = ('"forward"', '"forwards"')
_MEASURES = (ph.Length, ph.Angle)
_PAUSE = frozenset(",;:–—")
_HOW_MUCH = (ph.Amount, ph.Share, ph.Volume)


def unexpected_part(part: ph.Part, sentence: Normalised) -> ParseError:
    """Words that have no place where they stand."""
    suggestion = f'leave out "{sentence.words_as_written(part.span)}"'
    return sentence.error_at(part.span, "unexpected_words", "is not understood here", suggestion)


def several_objects(thing: ph.Thing, sentence: Normalised) -> ParseError:
    """A second object."""
    suggestion = "say one command for each object"
    return sentence.error_at(thing.span, "several_objects", "is a second object", suggestion)


def no_verb(sentence: Normalised, parts: Sequence[ph.Part] = ()) -> ParseError:
    """Nothing says what to do."""
    said = [part for part in parts if not isinstance(part, ph.Filler)] or parts
    span = said[0].span if said else sentence.original_span(0, len(sentence.text))
    message = "the sentence does not say what to do"
    return ParseError("no_verb", message, span, ('say, for example, "push the box away"',))


class Clause:
    """The parts of one clause; each is taken once."""

    def __init__(
        self, parts: Parts, verb: Verb, sentence: Normalised, verb_span: Span | None = None
    ) -> None:
        self._left = [part for part in parts if not isinstance(part, ph.Filler)]
        self._sentence = sentence
        self.verb = verb
        self.verb_span = verb_span
        self.spans: list[Span] = []

    def has_part(self, *kinds: type[ph.Part]) -> bool:
        """Check for a part of these kinds that is left; an implied direction does not count."""
        return any(
            isinstance(part, kinds) and not (isinstance(part, ph.Direction) and part.implied)
            for part in self._left
        )

    def first_part(self, kind: type[P]) -> P | None:
        """The first part of a kind, which stays to be taken."""
        return next((part for part in self._left if isinstance(part, kind)), None)

    def replace_part(self, instead_of: ph.Part, part: ph.Part) -> None:
        """Takes a part for another one."""
        self._left = [part if each is instead_of else each for each in self._left]

    def how_much(self) -> Parts:
        """Everything that says how much of a liquid, in the order of the sentence; not taken."""
        return [part for part in self._left if isinstance(part, _HOW_MUCH)]

    def take_all(self, kind: type[P]) -> list[P]:
        """Takes all parts of a kind; their words become the goal's."""
        taken = [part for part in self._left if isinstance(part, kind)]
        if not taken:
            return []
        self._left = [part for part in self._left if not isinstance(part, kind)]
        self.spans += [part.span for part in taken]
        return taken

    def take_only(self, kind: type[P]) -> P | None:
        """Takes the only part of a kind."""
        taken = self.take_all(kind)
        if len(taken) > 1:
            raise self.said_twice_error(taken[0], taken[1])
        return taken[0] if taken else None

    def take_place(self) -> ph.Place | None:
        """Takes where to; of two places it is not clear which one is meant."""
        taken = self.take_all(ph.Place)
        if len(taken) < 2:
            return taken[0] if taken else None
        first, second = self.quote(taken[0]), self.quote(taken[1])
        message = f"{first} and {second} are two places; only one can be where it should go"
        spans = (taken[0].span, taken[1].span)
        suggestions = (f"leave out {second}", f"leave out {first}")
        raise ParseError("said_twice", message, taken[1].span, suggestions, spans=spans)

    def no_place_error(self, what: str, *hints: str) -> ParseError:
        """The sentence does not say where."""
        message = f"the sentence does not say {what}"
        return ParseError("no_place", message, self.verb_span, hints)

    def said_twice_error(self, first: ph.Part, second: ph.Part) -> ParseError:
        """Two parts say the same thing."""
        both = f"{self.quote(first)} and {self.quote(second)}"
        message, spans = f"{both} say the same thing twice", (first.span, second.span)
        suggestion = f"leave out one of {both}"
        return ParseError("said_twice", message, second.span, (suggestion,), spans=spans)

    def contradiction_error(self, first: ph.Part, second: ph.Part) -> ParseError:
        """Two parts contradict each other."""
        return contradiction_error((first.span,), (second.span,), self._sentence)

    def does_not_apply_error(
        self, part: ph.Part, message: str, hint: str, *more: str
    ) -> ParseError:
        """A part that does not apply."""
        return self._sentence.error_at(part.span, "does_not_apply", message, hint, *more)

    def quote(self, part: ph.Part) -> str:
        """The words of a part, in quotation marks."""
        return f'"{self._sentence.words_as_written(part.span)}"'

    def take_directions(self) -> tuple[g.Direction, ...]:
        """Takes what is said of the direction: none, one, or two across each other."""
        parts = self.take_all(ph.Direction)
        if any(not part.implied for part in parts):
            self.spans = [s for s in self.spans if s not in {p.span for p in parts if p.implied}]
            parts = [part for part in parts if not part.implied]
        if self.verb.direction == "toward":  # "bring it forward", to who says so
            forward = [part for part in parts if self.quote(part).casefold() in _FORWARD]
            parts = [replace(p, value="toward") if p in forward else p for p in parts]
        for i, part in enumerate(parts):
            for other in parts[:i]:
                if {part.value, other.value} in _OPPOSITES:
                    raise self.contradiction_error(other, part)
        said = {part.value for part in parts}
        diagonal = self.take_only(ph.Diagonal)
        if diagonal is not None and len(said) < 2:
            message = "needs two directions"
            raise self.does_not_apply_error(
                diagonal, message, "away and to the left", "back and to the right"
            )
        return tuple(sorted(said, key=("away", "toward", "left", "right").index))

    def drop_implied(self) -> None:
        """Forgets the direction that a side implies, where another says where to go."""
        self._left = [p for p in self._left if not (isinstance(p, ph.Direction) and p.implied)]

    def take_direction(self) -> g.Direction | None:
        """Takes what is said of the direction, where only a single one makes sense."""
        last = next((p for p in reversed(self._left) if isinstance(p, ph.Direction)), None)
        directions = self.take_directions()
        if last is not None and len(directions) > 1:
            message = "is a second direction; a single one is possible here"
            raise self.does_not_apply_error(last, message, *directions)
        return directions[0] if directions else None

    def take_measure(self, kind: type[ph.Angle | ph.Length]) -> tuple[Any, g.Bound]:
        """Takes an angle or a length, None if none is said, and its bound."""
        part = self.take_only(kind)
        return (None, "exact") if part is None else (part.value, part.bound)

    def take_value(self, kind: type[ph.Part]) -> Any:
        """Takes the value of the only part of a kind; None if there is no part."""
        return getattr(self.take_only(kind), "value", None)

    def take_amount(self) -> g.Amount | None:
        """Takes "a little"; it is no more than a remark where a quantity says how far.

        Raises:
            ParseError: `said_twice`, unless the quantity says the same more exactly, behind a
                pause, or the amount is denied: "not so far".
        """
        measure = next((part for part in self._left if isinstance(part, _MEASURES)), None)
        parts = self.take_all(ph.Amount)
        if not parts:
            return None
        part = parts[0]
        for other in filter(None, [*parts[1:], measure]):
            if not self._is_denied(part) and not self._is_finer(other, part):
                raise self.said_twice_error(part, other)
        return None if measure is not None else cast(g.Amount, part.value)

    def _is_finer(self, part: ph.Part, amount: ph.Amount) -> bool:
        """Check for "a little, say 3 cm", which says the same behind a pause."""
        between = self._sentence.original[amount.span[1] : part.span[0]]
        alike = not isinstance(part, ph.Amount) or part.value == "little"
        return alike and amount.value == "little" and not _PAUSE.isdisjoint(between)

    def _is_denied(self, part: ph.Part) -> bool:
        return self.quote(part).casefold().startswith('"not ')

    def require_all_taken(self, verb: str) -> None:
        """Refuses parts that were not taken."""
        for part in self._left:
            message = f"does not go with {verb!r}" if verb else "says nothing here"
            raise self.does_not_apply_error(part, message, f"leave out {self.quote(part)}")

    @property
    def all_spans(self) -> tuple[Span, ...]:
        """The words of the goal, in the order of the sentence."""
        return tuple(sorted(set(self.spans)))
