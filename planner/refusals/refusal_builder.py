"""From a code and its numbers to a refusal."""

from __future__ import annotations

import math
import string
from collections.abc import Callable, Iterator, Mapping
from math import isfinite
from typing import Any

from planner.refusals.refusal_marks import height_marks
from planner.refusals.sentences import SENTENCES
from planner.types.marks import Mark, obstacle_mark
from planner.types.probability_text import probability_text
from planner.types.refusal import NoPlanError, Refusal, RefusalReason

Spans = tuple[tuple[int, int], ...]


def _floor(value: float) -> int:
    """The largest whole number below, but for what comes of binary fractions."""
    return math.floor(value + 1e-6)


QUANTITIES: dict[str, Callable[[float], str]] = {
    "mm": lambda length: f"{1e3 * length:z.0f} mm",
    "mm_down": lambda length: f"{10 * _floor(100 * length)} mm",
    "deg": lambda angle: f"{math.degrees(abs(angle)):.0f}°",
    "deg1": lambda angle: f"{math.degrees(angle):z.1f}°",
    "deg_exact": lambda angle: f"{math.degrees(angle):z.1f}°".replace(".0°", "°"),
    "deg_floor": lambda angle: f"{math.floor(10.0 * math.degrees(angle)) / 10.0:g}°",
    "mm/s": lambda speed: f"{1e3 * speed:z.0f} mm/s",
    "mm/s_down": lambda speed: f"{_floor(1000 * speed)} mm/s",
    "N": lambda force: f"{force:z.1f} N",
    "N2": lambda force: f"{force:z.2f} N",
    "N_down": lambda force: f"{math.floor(10.0 * force) / 10.0:g} N",
    "N_up": lambda force: f"{math.ceil(2.0 * force) / 2.0:g} N",
    "Nm": lambda torque: f"{torque:.3f} N·m",
    "s": lambda time: f"{time:.1f} s",
    "s_up": lambda time: f"{math.ceil(2.0 * time) / 2.0:g} s",
    "kg": lambda mass: f"{mass:.2f} kg",
    "ml": lambda volume: f"{1e6 * volume:.0f} ml",
    "ml_down": lambda volume: f"{_floor(1e6 * volume)} ml",
    "chance": probability_text,
    "share": lambda share: f"{share:.2f}",
    "times": lambda factor: f"{factor:.1f} times",
    "count": lambda number: f"{number:.0f}",
}
"""How people read a number in SI units, by what stands behind the colon."""


class _Formatter(string.Formatter):
    def format_field(self, value: object, format_spec: str) -> str:
        """One number or word of a sentence."""
        if format_spec:
            assert isinstance(value, float | int), f"{value!r} is no number"
            if not isfinite(value):
                return "more than any" if value > 0.0 else "an unknown amount"
            return QUANTITIES[format_spec](value)
        return str(value)


def filled_in(text: str, values: Mapping[str, object]) -> str:
    """A sentence with its words and numbers."""
    return _Formatter().vformat(text, (), values)


def refusal(
    code: str,
    numbers: Mapping[str, float] | None = None,
    *,
    spans: Spans = (),
    reason: RefusalReason | None = None,
    instead: tuple[str, ...] = (),
    marks: tuple[Mark, ...] = (),
    **words: object,
) -> Refusal:
    """Refusal in the words of its code.

    Args:
        code: in `SENTENCES`.
        numbers: that decide, by name [SI].
        spans: the words that cannot be satisfied.
        reason: the kind of obstacle, where it is not that of the code.
        instead: what would be possible, where it is not that of the code.
        marks: of numbers that the other words do not place.
        words: other words and numbers of the sentence.
    """
    said, values = SENTENCES[code], {**(numbers or {}), **words}
    numbers = {name: each for name, each in (numbers or {}).items() if isfinite(each)}
    return Refusal(
        code=code,
        reason=reason or said.reason,
        message=filled_in(said.text, values),
        numbers=numbers,
        capability=said.capability and filled_in(said.capability, values),
        spans=spans,
        suggestions=instead or _suggestions(said.instead, values),
        marks=(*marks, *_marks(said.reason, numbers, values)),
    )


def _suggestions(instead: tuple[str, ...], values: Mapping[str, object]) -> tuple[str, ...]:
    """Phrases of what would be possible; what takes an amount that nobody has is not."""
    endless = {n for n, each in values.items() if isinstance(each, float) and not isfinite(each)}
    parsed = ((one, {name for _, name, _, _ in _Formatter().parse(one)}) for one in instead)
    return tuple(filled_in(one, values) for one, names in parsed if not names & endless)


def _marks(
    reason: RefusalReason, numbers: Mapping[str, float], words: Mapping[str, Any]
) -> Iterator[Mark]:
    """Heights on the object that a refusal is about, and what stands in the way."""
    if "object" in words:
        yield from height_marks(words["object"], numbers)
    other = words.get("blocker") or (words.get("other") if reason == "blocked" else None)
    if other is not None:
        yield obstacle_mark(other)


def not_capable(capability: str, message: str, spans: Spans, *instead: str) -> NoPlanError:
    """Dead end because this robot, or this version, lacks a capability."""
    words: dict[str, Any] = {"capability": capability, "message": message}
    return no_plan("not_capable", spans=spans, instead=instead, **words)


def unsupported_while(what: str, doing: str, spans: Spans) -> NoPlanError:
    """Dead end because no hand of this version does something meanwhile."""
    return no_plan("not_while", spans=spans, what=what, doing=doing)


def no_plan(
    code: str, numbers: Mapping[str, float] | None = None, *, spans: Spans = (), **words: Any
) -> NoPlanError:
    """Dead end in the words of its code; see `refusal`."""
    return NoPlanError(refusal(code, numbers, spans=spans, **words))
