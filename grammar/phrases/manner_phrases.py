"""Parts from phrases of manner, force, speed, time, tool and contact."""

from __future__ import annotations

from typing import Any, Literal, cast

from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.frames.constraints import new_constraint
from grammar.phrases import phrase_parts as ph
from grammar.phrases import token_reader as q
from grammar.phrases.outcome_phrases import Phrases

_BOUNDED = {"exact": "", "at_least": "min_", "at_most": "max_"}
"""Bound of a quantity → what its constraint's kind begins with."""

_BEFORE_FACE: dict[str, g.Direction] = {
    "front": "away",
    "back": "toward",
    "left": "right",
    "right": "left",
}

Children = list[Any]
Face = Literal["front", "back", "left", "right", "top"]


class Manners(Phrases):
    """Builders of parts for how an action is done, and where the object is touched."""

    # --- how ----------------------------------------------------------------------------------

    def manner_part(self, children: Children) -> ph.Constraint:
        """Gently."""
        span = self._w.span_of(children)
        kind = self._w.value_of(children, "MANNER")
        return ph.Constraint(span, new_constraint(kind, spans=(span,)))

    def compared_part(self, children: Children) -> list[ph.Part]:
        """More gently: as the last time, but so."""
        span = self._w.span_of(children)
        manner = new_constraint(self._w.value_of(children, "COMPARED"), spans=(span,))
        return [ph.Remark(span, "more"), ph.Constraint(span, manner)]

    def force_part(self, children: Children) -> ph.Constraint:
        """With at most 5 N."""
        span = self._w.span_of(children)
        range_ = f"a force is more than 0 and at most {q.MAX_FORCE_N:g} N"
        newtons = self._w.in_unit(children, "FORCE_UNIT")[0]
        value = self._w.require_possible(children, newtons, q.MAX_FORCE_N, range_)
        kind = f"{_BOUNDED[self._w.bound_of(children)]}force"
        return ph.Constraint(span, new_constraint(kind, value=value, spans=(span,)))

    def speed_part(self, children: Children) -> ph.Constraint:
        """At 2 cm/s."""
        span = self._w.span_of(children)
        range_ = f"a speed is more than 0 and at most {q.MAX_SPEED:g} m/s"
        speed = self._w.in_unit(children, "SPEED_UNIT")[0]
        value = self._w.require_possible(children, speed, q.MAX_SPEED, range_)
        kind = f"{_BOUNDED[self._w.bound_of(children)]}speed"
        return ph.Constraint(span, new_constraint(kind, value=value, spans=(span,)))

    def duration_part(self, children: Children) -> ph.Constraint:
        """In under four seconds; for three seconds."""
        span = self._w.span_of(children)
        range_ = f"a time is more than 0 and at most {q.MAX_TIME_S:g} s"
        seconds = self._w.in_unit(children, "TIME_UNIT")[0]
        value = self._w.require_possible(children, seconds, q.MAX_TIME_S, range_)
        bound = self._w.bound_of(children)
        if bound == "at_least":
            raise ParseError(
                "does_not_apply",
                f'"{self._w.sentence.words_as_written(span)}" leaves open how long it takes',
                span,
                ("for three seconds", "in at most three seconds"),
            )
        lasts = children[0].type == "BY" and bound == "exact"
        kind = g.Duration if lasts else g.MaxDuration
        return ph.Constraint(span, kind(value=value, spans=(span,)))

    def effector_part(self, children: Children) -> ph.Constraint:
        """With two fingers, with your left hand."""
        span = self._w.span_of(children)
        written = self._w.sentence.words_as_written(span)
        numbers = self._w.numbers_in(children)
        count = float(numbers[0]) if numbers else None
        if count is not None and count not in range(1, 11):
            message = f'"{written}" is out of range: one to ten can be used'
            raise ParseError("impossible_quantity", message, span, ("with one finger",))
        if self._w.bound_of(children) != "exact":
            message = f'"{written}" leaves open how many to use'
            suggestions = ("with one finger", "with two fingers")
            raise ParseError("unexpected_words", message, span, suggestions)
        effector = g.Effector(
            tool=cast(Literal["finger", "hand", "arm"], self._w.value_of(children, "TOOL")),
            count=None if count is None else int(count),
            side=cast(Literal["left", "right"] | None, self._w.value_of(children, "SIDE") or None),
            spans=(span,),
        )
        return ph.Constraint(span, effector)

    # --- where it is touched ------------------------------------------------------------------

    def region_part(self, children: Children) -> list[ph.Part]:
        """At the top; at the top of the box."""
        region = cast(Literal["top", "middle", "bottom"], self._w.value_of(children, "REGION"))
        things = [child for child in children if isinstance(child, ph.Part)]
        return [self._contact_part(children[:1], region=region), *things]

    def face_part(self, children: Children) -> ph.Constraint:
        """On the left side."""
        return self._contact_part(children, face=cast(Face, self._w.value_of(children, "FACE")))

    def from_side_part(self, children: Children) -> list[ph.Part]:
        """From the left: the left face is touched and, if nothing else is said, pushed right."""
        face = cast(Face, self._w.value_of(children, "FROM_SIDE"))
        implied = ph.Direction(self._w.span_of(children), _BEFORE_FACE[face], implied=True)
        return [self._contact_part(children, face=face), implied]

    def height_part(self, children: Children) -> ph.Constraint:
        """At 3 cm above the table; no higher than 3 cm."""
        value, bound = self._w.lengths_in(children)[0], self._w.bound_of(children)
        limit = self._w.value_of(children, "HEIGHT_BOUND", bound)
        if limit != bound and self._w.value_of(children, "HEIGHT_REFERENCE") == "top":
            # No higher than 3 cm below the top: at least so far below it.
            limit = "at_least" if limit == "at_most" else "at_most"
        bound = cast(g.Bound, limit)
        return self._contact_part(children, height=self._contact_height(children, value, bound))

    def relative_height_part(self, children: Children) -> ph.Constraint:
        """At half its height."""
        length = children[1]
        return self._contact_part(
            children, height=self._contact_height(children, length.value, length.bound)
        )

    def _contact_height(
        self, children: Children, value: float | g.RelativeLength, bound: g.Bound
    ) -> g.ContactHeight:
        origin = self._w.value_of(children, "HEIGHT_REFERENCE", "table")
        return g.ContactHeight(
            value=value, origin=cast(Literal["table", "top"], origin), bound=bound
        )

    def _contact_part(self, children: Children, **said: Any) -> ph.Constraint:
        span = self._w.span_of(children)
        return ph.Constraint(span, g.ContactRegion(**said, spans=(span,)))
