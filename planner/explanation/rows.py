"""The parts of a frame and the rows that explain them: words, field, parameter, value.

A row goes from the words over the field of the frame to the parameter of the controller and its
value. The parts bear the names of Figure 2 of the paper "Prediction of action outcomes using an
object model". Values are SI inside; people read millimetres, degrees and newtons.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from pydantic import BaseModel, ConfigDict

from grammar.frames import command as g
from planner.types.probability_text import probability_text

if TYPE_CHECKING:
    from planner.types.plan import DefaultUsed, Plan

PartName = Literal[
    "push controller", "hand controller", "controller", "question", "remark", "object model",
    "wanted outcome", "constraint", "left open", "filler",
]  # fmt: skip


class Row(BaseModel):
    """The way of some words into the controller.

    Attributes:
        words: as they stand in the sentence; empty if it did not say so.
        field: of the frame that they set.
        parameter: of the controller that follows; empty if nothing does.
        value: with its unit.
        spans: where the words stand.
        frame: which frame of the sentence, from 0.
        part: of the way from words to a push, as the paper calls it.
        default: whether the value comes from what stands for words that were not said.
        problem: whether these words are why there is no plan.
    """

    model_config = ConfigDict(defer_build=True, frozen=True, extra="forbid")

    words: str
    field: str
    parameter: str
    value: str
    spans: g.Spans = ()
    frame: int = 0
    part: PartName = "left open"
    default: bool = False
    problem: bool = False


class Clause(NamedTuple):
    """A part of a frame: what the paper calls it, how it reads, where it stands, and itself."""

    part: PartName
    field: str
    spans: g.Spans
    said: Any


class Value(NamedTuple):
    """A parameter with its value.

    Attributes:
        parameter: of the controller, of the object model or of an answer.
        value: with its unit.
        default: whether the number comes from the table of defaults, or was chosen.
        said: whether words led to it; words may say "a little", and the table how much that is.
    """

    parameter: str
    value: str
    default: bool = False
    said: bool = True


def frame_clauses(frame: g.Frame, controller: PartName = "controller") -> Iterator[Clause]:
    """The parts of a frame: its head, its object, its goal, its constraints."""
    named_so = {key: getattr(frame, key) for key in ("query", "dialogue", "action", "event")}
    head = [f"{key}: {said}" for key, said in named_so.items() if said is not None]
    yield Clause(controller, ", ".join(head), frame.spans, None)
    if frame.object is not None:
        yield Clause(
            "object model", f"object: {object_name(frame.object)}", frame.object.spans, None
        )
    if frame.goal.kind != "none" or frame.goal.spans:
        yield Clause(
            "wanted outcome", f"goal: {clause_text(frame.goal)}", frame.goal.spans, frame.goal
        )
    for said in frame.constraints:
        yield Clause("constraint", f"constraint: {clause_text(said)}", said.spans, said)


def row(clause: Clause, text: str, value: Value, **more: Any) -> Row:
    """The row of a clause of the sentence `text` and a value of it, with `more` fields."""
    spans = clause.spans if value.said else ()
    return Row(
        words=quotation(text, spans), field=clause.field, spans=spans, part=clause.part,
        parameter=value.parameter, value=value.value, default=value.default, **more,
    )  # fmt: skip


def plan_rows(
    frame: g.Frame, text: str, controller: PartName, values: Callable[[Clause], Iterable[Value]]
) -> tuple[Row, ...]:
    """The rows of a planned frame: the values of each of its parts, and of what it left open."""
    left_open = Clause("left open", "controller", (), None)
    clauses = (*frame_clauses(frame, controller), left_open)
    return tuple(row(clause, text, value) for clause in clauses for value in values(clause))


def amount_value(name: str, told: str, used: DefaultUsed | None) -> Value:
    """A number, and whether it comes from the table of defaults."""
    if used is None:
        return Value(name, told)
    # Words may name an amount, but what number that is stands in the table.
    in_words = used.reason.startswith("“")
    why = f"{used.reason}, from the table of defaults" if in_words else "not said: by default"
    return Value(name, f"{told} ({why})", default=True, said=in_words)


def outcome_value(does: str, plan: Plan) -> Value:
    """The outcome of a plan, and how likely it is."""
    return Value("outcome", f"{does}, probability {probability_text(plan.probability)}")


def place_text(x: float, y: float) -> str:
    """A point of the table in words, from its coordinates in W [m]."""
    return f"x {si_text(x, 'm')}, y {si_text(y, 'm')}"


def quotation(text: str, spans: g.Spans) -> str:
    """The words that spans cover, in their order; a dash stands for other words between them."""
    told, last = "", 0
    for start, end in sorted(spans):
        if told and start > last:
            told += " … " if text[last:start].strip(" ,") else " "
        told += text[max(start, last) : max(end, last)]
        last = max(end, last)
    return told


_UNITS = {
    "distance": "m", "clearance": "m", "height": "m", "x": "m", "y": "m", "angle": "rad",
    "heading": "rad", "volume": "m³",
}  # fmt: skip
"""Units of fields; the class of a constraint knows that of its `value`."""


def clause_text(part: Any) -> str:
    """A goal or a constraint in words: its kind, and each field that was said."""
    told = part.kind
    for key, info in type(part).model_fields.items():
        value = getattr(part, key)
        if key in ("kind", "spans") or value == info.get_default():
            continue
        if key == "value":
            told += f", {si_text(value, part.words.unit)}"
        else:
            told += f", {key} {_field(value, key)}"
    return str(told)


def _field(value: Any, name: str) -> str:
    match value:
        case None:
            return "anything"
        case g.ObjectRef():
            return object_name(value)
        case g.RelativeLength():
            whose = value.of.text if value.of.pronoun else f"{object_name(value.of)}'s"
            return f"{value.value:g} × {whose} {value.side or 'width'}"
        case g.ContactHeight():
            bound = "" if value.bound == "exact" else f"{value.bound.replace('_', ' ')} "
            where = "above the table" if value.origin == "table" else "below the top"
            return f"{bound}{_field(value.value, 'height')} {where}"
        case g.Point():
            return place_text(value.x, value.y)
        case tuple():
            return " and ".join(_field(each, name) for each in value)
        case float():
            return si_text(value, _UNITS.get(name, ""))
    return str(value).replace("_", " ")


def object_name(ref: g.ObjectRef) -> str:
    """An object by its name in the scene; as it was said, if that is not known."""
    return ref.id or ref.text


def si_text(value: float, unit: str) -> str:
    """An SI value as people read it, in whole millimetres, millilitres and degrees."""
    if unit in ("m", "m/s"):
        return f"{round(1e3 * value) + 0.0:.0f} m{unit}"  # never −0
    if unit == "m³":
        return f"{1e6 * value:.0f} ml"
    if unit == "rad/s":
        return f"{math.degrees(value):.0f}°/s"
    return f"{math.degrees(value):.0f}°" if unit == "rad" else f"{value:g} {unit}".rstrip()
