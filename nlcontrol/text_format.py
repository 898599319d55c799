"""Pieces of text that every answer is made of: values with units, quoted words, frames, errors.

Values are SI inside; people read millimetres, degrees and newtons.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from decimal import Decimal
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from grammar.frames.command import Frame
    from nlcontrol.errors import ErrorInfo

_SCALES: dict[str, tuple[float, str, int]] = {
    "m": (1e3, " mm", 0),
    "rad": (180.0 / math.pi, "°", 1),
    "N": (1.0, " N", 1),
    "m/s": (1e3, " mm/s", 0),
    "s": (1.0, " s", 1),
    "m³": (1e6, " ml", 0),
    "rad/s": (180.0 / math.pi, "°/s", 0),
    "N·m": (1e3, " N·mm", 0),
    "": (1.0, "", 3),
}


REFUSALS = frozenset(
    {"impossible", "out_of_reach", "blocked", "too_uncertain", "out_of_time", "too_small"}
)
"""Codes of errors that are refusals of the planner."""


def quantity(value: float, unit: str) -> str:
    """An SI value as people read it: 0.119 m becomes "119 mm"."""
    scale, sign, digits = _SCALES.get(unit, (1.0, f" {unit}", 3))
    text = f"{value * scale:.{digits}f}"
    return (text.lstrip("-") if float(text) == 0.0 else text) + sign


def place_text(x: float, y: float) -> str:
    """Place on the table in W [m]: "x 450 mm, y 0 mm"."""
    return f"x {quantity(x, 'm')}, y {quantity(y, 'm')}"


def aside_text(lateral: float) -> str:
    """Place to the right of a face's middle [m]: "12 mm to the right"; empty in the middle."""
    if abs(lateral) < 5e-4:
        return ""
    return f"{quantity(abs(lateral), 'm')} to the {'right' if lateral > 0.0 else 'left'}"


def with_sd_text(value: float, sd: float, unit: str = "") -> str:
    """A value with its standard deviation, to three decimals; without it if it is certain."""
    # As decimals: 0.0375 lies half-way as it stands in a model, but below that as a float.
    text, spread = (f"{Decimal(repr(float(x))):.3f}{unit}" for x in (value, sd))
    return f"{text} ± {spread}" if sd else text


def join_words(names: Sequence[str], word: str = "and") -> str:
    """Names as one reads them: "a, b and c"."""
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} {word} {names[-1]}"


def words(text: str, spans: Sequence[tuple[int, int]]) -> str:
    """The words of a sentence that spans cover, with a dash for what lies between."""
    return " … ".join(text[start:end] for start, end in spans)


def encodable_text(text: str) -> str:
    """The text with each half of a surrogate pair replaced, since it could not be printed again.

    A shell hands over bytes that are not UTF-8 as such halves.
    """
    return re.sub("[\ud800-\udfff]", "\N{REPLACEMENT CHARACTER}", text)


def frame_lines(frame: Frame, text: str) -> Iterator[str]:
    """A frame in a few lines: each part with its fields and its words."""
    for key in ("dialogue", "query", "action"):
        if getattr(frame, key) is not None:
            yield f"  {key}: {getattr(frame, key)}{_quoted_words(text, frame.spans)}"
    if frame.object is not None:
        yield f"  object: {frame.object.text}{_quoted_words(text, frame.object.spans)}"
    if frame.goal.kind != "none":
        yield f"  goal: {_fields(frame.goal, text)}"
    if frame.event is not None:
        yield f"  asked about: {frame.event.replace('_', ' ')}"
    for clause in frame.constraints:
        yield f"  constraint: {_fields(clause, text)}"


def _fields(part: Any, text: str) -> str:
    values = part.model_dump(mode="json", exclude={"kind", "spans"}, exclude_defaults=True)
    told = "".join(f" {key}={_value(value)}" for key, value in values.items())
    return f"{part.kind}{told}{_quoted_words(text, part.spans)}"


def _value(value: Any) -> str:
    """A field's value without spans; an object is told by its name."""
    if isinstance(value, dict):
        bare = {k: v for k, v in value.items() if k not in ("spans", "id", "qualities", "noun")}
        if "text" in value:
            told = f"“{bare.pop('text')}”"
            more = "".join(f" {k} {_value(v)}" for k, v in bare.items() if k != "pronoun")
            return told + more
        return " ".join(f"{k} {_value(v)}" for k, v in bare.items())
    if isinstance(value, list):
        return " and ".join(map(_value, value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _quoted_words(text: str, spans: Sequence[tuple[int, int]]) -> str:
    return f"  “{words(text, spans)}”" if spans else ""


def error_lines(error: ErrorInfo, text: str | None = None) -> Iterator[str]:
    """An error: its message, the words it is about, and what would be possible."""
    titles = {
        "clause_not_held": "Not held",
        "not_finished": "Not finished",
        "clause_unknown": "Undecided",
        "unsupported": "Unsupported",
        "internal": "Internal",
    }
    refused = error.code in REFUSALS
    title = titles.get(error.code, "Refused" if refused else "Error")
    path = f"{error.path}: " if error.path else ""
    code = "" if title.casefold() == error.code else f" ({error.code})"
    yield f"{title}{code}: {path}{error.message}"
    if text and error.span and len(text) <= 100 and text.isprintable():
        yield f"  {text}"
        spans = error.spans or (error.span,)
        marks = [" "] * max(end + 1 for _, end in spans)
        for start, end in spans:
            length = max(1, end - start)
            marks[start : start + length] = "^" * length
        yield f"  {''.join(marks).rstrip()}"
    if error.capability:
        yield f"  missing capability: {error.capability}"
    yield from (f"  → {suggestion}" for suggestion in error.suggestions)
