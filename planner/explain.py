"""Which words became which parameters of the controller: the way of a sentence as a table.

The rows go from the words over the field of the frame to the parameter and its value, as in
Figures 2 and 3 of the paper "Prediction of action outcomes using an object model". What the
sentence did not say has no words.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict

from planner.directions import phrase

if TYPE_CHECKING:
    from grammar.frames import Frame, Spans
    from planner.plan import Plan


class Row(BaseModel):
    """The way of some words into the controller.

    Attributes:
        words: as they stand in the sentence; empty if it did not say so.
        field: of the frame that they set.
        parameter: of the controller that follows.
        value: with its unit.
        spans: where the words stand.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    words: str
    field: str
    parameter: str
    value: str
    spans: tuple[tuple[int, int], ...] = ()


def explain(frame: Frame, plan: Plan, text: str) -> tuple[Row, ...]:
    """The rows of a planned frame, in the order of the sentence's parts.

    Args:
        frame: what was asked.
        plan: what came of it.
        text: the sentence.
    """
    rows: list[Row] = []

    def add(spans: Spans, field: str, parameters: Iterator[tuple[str, str]]) -> None:
        words = " … ".join(text[start:end] for start, end in spans)
        rows.extend(
            Row(words=words, field=field, parameter=name, value=value, spans=spans)
            for name, value in parameters
        )

    said = {default.name for default in plan.defaults}
    add(frame.spans, f"action: {frame.action}", _controller(plan))
    if frame.object is not None:
        add(frame.object.spans, f"object: {frame.object.id}", _object(plan))
    add(frame.goal.spans, f"goal: {frame.goal.kind}", _goal(plan, said))
    for clause in frame.constraints:
        add(clause.spans, f"constraint: {clause.kind}", _constraint(clause, plan))
    for default in plan.defaults:
        shown = iter([(default.name, f"{_shown(default.value, default.unit)} ({default.reason})")])
        add((), "default", shown)
    add((), "controller", _rest(plan))
    return tuple(rows)


def _controller(plan: Plan) -> Iterator[tuple[str, str]]:
    fingers = "one finger" if plan.push.fingers == 1 else "two fingers"
    until = "after the stroke" if plan.push.ends_on == "stroke" else "when it falls by itself"
    yield "controller", f"push with {fingers}, ends {until}"


def _object(plan: Plan) -> Iterator[tuple[str, str]]:
    p = plan.prediction
    yield "onset force", f"{p.onset:.1f} N"
    if p.critical_height is not None:
        yield "height where it tips", _shown(p.critical_height, "m")
    yield "angle of no return", f"{math.degrees(p.stay_on_base_angle):.0f}°"


def _goal(plan: Plan, said: set[str]) -> Iterator[tuple[str, str]]:
    x, y, _ = plan.push.direction_W
    yield "outcome", plan.prediction.outcome
    yield "movement direction", phrase(math.atan2(y, x))
    if plan.push.ends_on == "stroke" and "distance" not in said:
        yield "stroke", _shown(plan.push.stroke, "m")


def _constraint(clause: Any, plan: Plan) -> Iterator[tuple[str, str]]:
    push, margins = plan.push, plan.margins
    height = _shown(push.p_BC[2], "m")
    if clause.kind in {"no_topple", "no_tilt"}:
        yield "contact height", f"{height}, {_shown(margins.height, 'm')} from where it may tip"
    elif clause.kind == "no_turn":
        yield "fingers", f"{push.fingers}, through the middle of the {push.face} face"
    elif clause.kind == "contact":
        yield "contact", f"{push.face} face, {height} above the table"
    elif clause.kind == "max_force":
        yield "force limit", f"{push.force_limit:.1f} N"
    elif clause.kind in {"gentle", "slow", "max_speed"}:
        yield "largest speed", _shown(push.speed, "m/s")
        if clause.kind == "gentle":
            yield "force limit", f"{push.force_limit:.1f} N"
    elif clause.kind == "effector":
        yield "fingers", str(push.fingers)
    elif clause.kind == "max_distance":
        yield "stroke", _shown(push.stroke, "m")
    else:
        yield "guard", clause.kind.replace("_", " ")


def _rest(plan: Plan) -> Iterator[tuple[str, str]]:
    push = plan.push
    yield "contact", f"{push.face} face, {_shown(push.p_BC[2], 'm')} above the table"
    yield "force limit", f"{push.force_limit:.1f} N"
    if push.ends_on == "toppled":
        yield "longest stroke", _shown(push.stroke, "m")


def _shown(value: float, unit: str) -> str:
    if unit == "m":
        return f"{1e3 * value:.0f} mm"
    if unit == "m/s":
        return f"{1e3 * value:.0f} mm/s"
    return f"{math.degrees(value):.0f}°" if unit == "rad" else f"{value:g} {unit}"
