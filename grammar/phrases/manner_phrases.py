"""Parts from phrases of manner, force, speed, time, tool and contact."""

from __future__ import annotations

from typing import Any, Literal, cast

from grammar.frames import command as g
from grammar.frames.constraints import new_constraint
from grammar.phrases import phrase_parts as ph
from grammar.phrases import token_reader as q
from grammar.phrases.token_reader import Children

_BOUNDED = {"exact": "", "at_least": "min_", "at_most": "max_"}
"""Bound of a quantity → what its constraint's kind begins with."""

_BEFORE_FACE: dict[str, g.Direction] = {
    "front": "away", "back": "toward", "left": "right", "right": "left",
}  # fmt: skip

_LATER = 60.0
"""Time from which on "in" says when to begin, as no push takes so long [s]."""

Origin = Literal["table", "top"]
Face = Literal["front", "back", "left", "right", "top"]


class Manners(q.TokenReader):
    """Builders of parts for how an action is done, and where the object is touched."""

    # --- how ----------------------------------------------------------------------------------

    def manner_part(self, children: Children) -> ph.Constraint:
        """Gently."""
        span = self.span_of(children)
        kind = self.value_of(children, "MANNER")
        return ph.Constraint(span, new_constraint(kind, spans=(span,)))

    def compared_part(self, children: Children) -> list[ph.Part]:
        """More gently, higher: as the last time, but so."""
        span, said = self.span_of(children), self.value_of(children, "COMPARED")
        more = ph.Remark(span, "more")
        if said in ("top", "bottom"):
            return [more, self._contact_part(children, region=said)]
        return [more, ph.Constraint(span, new_constraint(said, spans=(span,)))]

    def force_part(self, children: Children) -> ph.Constraint:
        """With at most 5 N."""
        value = self._measure(children, "force", q.MAX_FORCE_N, "N")
        return self._bounded_part(children, "force", value)

    def speed_part(self, children: Children) -> ph.Constraint:
        """At 2 cm/s."""
        value = self._measure(children, "speed", q.MAX_SPEED, "m/s")
        return self._bounded_part(children, "speed", value)

    def duration_part(self, children: Children) -> ph.Constraint:
        """In under four seconds; for three seconds."""
        span, value = self.span_of(children), self._measure(children, "time", q.MAX_TIME_S, "s")
        bound = self.bound_of(children)
        later = value >= _LATER or bool(q.tokens_in(children, "A"))
        if (
            children[0].type == "IN"
            and not self.value_of(children, "IN")
            and (bound == "exact" and later)
        ):
            message, hint = "says when to begin; nothing is done later", "within one minute"
            raise self.sentence.error_at(span, "unbound_words", message, hint)
        if bound == "at_least":
            raise self.does_not_apply_error(
                children, "leaves open how long it takes",
                "for three seconds", "in at most three seconds",
            )  # fmt: skip
        lasts = children[0].type == "BY" and bound == "exact"
        kind = g.Duration if lasts else g.MaxDuration
        return ph.Constraint(span, kind(value=value, spans=(span,)))

    def _measure(self, children: Children, name: str, most: float, unit: str) -> float:
        """A quantity with its unit [SI], if it is taken seriously."""
        value = self.in_unit(children, f"{name.upper()}_UNIT")[0]
        range_ = f"a {name} is more than 0 and at most {most:g} {unit}"
        return self.require_possible(children, value, most, range_)

    def _bounded_part(self, children: Children, name: str, value: float) -> ph.Constraint:
        span, kind = self.span_of(children), f"{_BOUNDED[self.bound_of(children)]}{name}"
        return ph.Constraint(span, new_constraint(kind, value=value, spans=(span,)))

    def effector_part(self, children: Children) -> ph.Constraint:
        """With two fingers, with your left hand."""
        span, numbers = self.span_of(children), self.numbers_in(children)
        count = float(numbers[0]) if numbers else None
        if count is not None and count not in range(1, 11):
            message = "is out of range: one to ten can be used"
            raise self.sentence.error_at(span, "impossible_quantity", message, "with one finger")
        if self.bound_of(children) != "exact":
            raise self.sentence.error_at(
                span, "unexpected_words", "leaves open how many to use",
                "with one finger", "with two fingers",
            )  # fmt: skip
        effector = g.Effector(
            tool=cast(Literal["finger", "hand", "arm"], self.value_of(children, "TOOL")),
            count=None if count is None else int(count),
            side=cast(Literal["left", "right"] | None, self.value_of(children, "SIDE") or None),
            spans=(span,),
        )
        return ph.Constraint(span, effector)

    # --- where it is touched ------------------------------------------------------------------

    def region_part(self, children: Children) -> list[ph.Part]:
        """At the top; at the top of the box."""
        region = cast(Literal["top", "middle", "bottom"], self.value_of(children, "REGION"))
        return [self._contact_part(children[:1], region=region), *q.parts_in(children)]

    def face_part(self, children: Children) -> ph.Constraint:
        """On the left side."""
        return self._contact_part(children, face=cast(Face, self.value_of(children, "FACE")))

    def from_side_part(self, children: Children) -> list[ph.Part]:
        """From the left: the left face is touched and, if nothing else is said, pushed right."""
        face = cast(Face, self.value_of(children, "FROM_SIDE"))
        implied = ph.Direction(self.span_of(children), _BEFORE_FACE[face], implied=True)
        return [self._contact_part(children, face=face), implied]

    def height_part(self, children: Children) -> ph.Constraint:
        """At 3 cm above the table; no higher than 3 cm."""
        value, bound = self.lengths_in(children)[0], self.bound_of(children)
        limit = self.value_of(children, "HEIGHT_BOUND", bound)
        if limit != bound and self.value_of(children, "HEIGHT_REFERENCE") == "top":
            # No higher than 3 cm below the top: at least so far below it.
            limit = "at_least" if limit == "at_most" else "at_most"
        return self._height_part(children, value, cast(g.Bound, limit))

    def relative_height_part(self, children: Children) -> ph.Constraint:
        """At half its height."""
        return self._height_part(children, children[1].value, children[1].bound)

    def _height_part(
        self, children: Children, value: float | g.RelativeLength, bound: g.Bound
    ) -> ph.Constraint:
        origin = cast(Origin, self.value_of(children, "HEIGHT_REFERENCE", "table"))
        height = g.ContactHeight(value=value, origin=origin, bound=bound)
        return self._contact_part(children, height=height)

    def _contact_part(self, children: Children, **said: Any) -> ph.Constraint:
        span = self.span_of(children)
        return ph.Constraint(span, g.ContactRegion(**said, spans=(span,)))
