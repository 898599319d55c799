"""The way of each word of a sentence: to the frame, and on to a push, an answer or a refusal.

What was planned is explained by the planner (`planner.plan_explanation`). Here stands
what else may become of a frame: a question its answer, with the push that was considered; a refused
frame the words that cannot be satisfied, with the reason; a frame that was not reached its parts
alone. In the end come the words that no part of a frame stands for.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from pydantic import BaseModel

from grammar.frames import command as g
from nlcontrol.errors import ErrorInfo, error
from nlcontrol.questions.answer import DOES, Answer, Considered, force_text
from nlcontrol.questions.push_prediction import CERTAIN
from nlcontrol.references.reference_resolution import parts_within
from nlcontrol.reports.plan_drawing import Sheet, line_height
from nlcontrol.text_format import aside_text, quantity
from planner.plan_explanation import (
    Clause,
    PartName,
    Row,
    Value,
    belief_values,
    explain_hand,
    explain_push,
    frame_clauses,
    quotation,
    row,
)
from planner.problem.directions import phrase
from planner.types.refusal import probability_text

if TYPE_CHECKING:
    from rich.table import Table

    from nlcontrol.results.result import Result, Step


NOT_PLANNED, NOT_ANSWERED = "not planned", "not answered"
NO_MEANING = "no meaning of their own"


def word_explanation(result: Result) -> tuple[Row, ...]:
    """The rows of a whole sentence, frame after frame."""
    if not result.frames:
        return ()
    steps = {step.frame: step for step in result.steps}
    rows: list[Row] = []
    # An undo has frames of its own making, which no word stands for.
    whole = () if any(map(_spans, result.frames)) else ((0, len(result.text)),)
    for index, frame in enumerate(result.frames):
        found = _of_frame(frame, steps.get(index), result)
        rows += [each.model_copy(update={"frame": index}) for each in found]
    if whole:
        said = {"spans": whole, "words": result.text}
        rows[0] = rows[0].model_copy(update=said)
    return (*rows, *_filler(result, rows))


def reading_explanation(command: g.Command) -> tuple[Row, ...]:
    """The rows of a sentence that was read and not yet planned: the parts that its words set."""
    rows = [
        row(clause, command.text, Value("", ""), frame=index)
        for index, frame in enumerate(command.frames)
        for clause in frame_clauses(frame, _head(frame))
    ]
    return (*rows, *_filler(command, rows))


def _of_frame(frame: g.Frame, step: Step | None, result: Result) -> tuple[Row, ...]:
    if step is not None and step.plan is not None and step.basis is not None:
        if not step.plan.pushes:
            return explain_hand(frame, step.plan, result.text, step.basis)
        return explain_push(frame, step.plan, result.text, step.basis)
    answer = step.answer if step else None
    if answer is None and len(result.frames) == 1:
        answer = result.answer
    if answer is not None:
        return tuple(_answer_rows(frame, answer, step, result.text))
    reason = step.error if step else None
    if not result.steps and result.error and _concerns(result.error, frame):
        reason = result.error
    rows = tuple(_unplanned_rows(frame, reason, result.text))
    if step is not None and step.plan is not None:  # read from JSON, which holds no object models
        rows = tuple(each.model_copy(update={"value": ""}) for each in rows)
    return rows


def _unplanned_rows(frame: g.Frame, reason: ErrorInfo | None, text: str) -> Iterator[Row]:
    """The parts of a frame without parameters; those that cannot be satisfied with the reason."""
    parts = list(frame_clauses(frame, _head(frame)))
    refused = _refusal_rows(parts, reason) if reason else []
    for clause in parts:
        stopped = NOT_PLANNED if clause.part == "controller" else NOT_ANSWERED
        value = Value("", stopped if clause is parts[0] else "")
        if reason is None or clause not in refused:
            yield row(clause, text, value)
            continue
        if clause is parts[0]:
            yield row(clause, text, value)
        verdict = "not supported" if reason.capability else "cannot be satisfied"
        told = reason.message if clause is refused[0] else "for the same reason"
        yield row(clause, text, Value(verdict, told), problem=True)


def _head(frame: g.Frame) -> PartName:
    if frame.query is not None:
        return "question"
    return "remark" if frame.dialogue is not None and frame.action is None else "controller"


def _refusal_rows(parts: list[Clause], reason: ErrorInfo) -> list[Clause]:
    """The parts that an error is about: its span goes from the first word of them to the last."""
    if reason.span is None:
        return parts[:1]
    start, end = reason.span
    ends = [p for p in parts if any(a == start or b == end for a, b in p.spans)]
    within = [p for p in parts if any(a < end and start < b for a, b in p.spans)]
    return ends or within or parts[:1]


def _concerns(error: ErrorInfo, frame: g.Frame) -> bool:
    if error.span is None:
        return True
    return any(a < error.span[1] and error.span[0] < b for a, b in _spans(frame))


def _answer_rows(frame: g.Frame, answer: Answer, step: Step | None, text: str) -> Iterator[Row]:
    """Rows of a question: the query with its answer, the object model, the push considered."""
    push = answer.push
    numbers = tuple(_numbers(answer))
    asked_of = isinstance(frame.goal, g.Parameters) and bool(frame.goal.spans)
    open_ones = dict(_considered_values(push)) if push else {}
    for clause in frame_clauses(frame, _head(frame)):
        if clause.said is frame.goal if asked_of else clause.part in ("question", "remark"):
            values: tuple[Value, ...] = numbers
        elif clause.part == "object model":
            values = belief_values(step.basis.target) if step and step.basis else ()
        else:
            decided = [name for name in _decides(clause.said) if name in open_ones]
            values = tuple(open_ones.pop(name) for name in decided)
        if not values and (clause.spans or clause.said is None):
            values = (Value("", ""),)
        for value in values:
            yield row(clause, text, value)
    rest = Clause("left open", "push considered", (), None)
    for value in open_ones.values():
        yield row(rest, text, value._replace(default=True))


def _decides(said: Any) -> tuple[str, ...]:
    """Which properties of the push a part of the question gives."""
    match said:
        case g.Displace() if said.direction or said.toward or said.heading is not None:
            return ("direction",)
        case g.Topple() | g.Tilt() if said.direction:
            return ("direction",)
        case g.ContactRegion():
            height = ("height",) if said.region or said.height else ()
            return ("face", *height) if said.face else height
        case g.Force() | g.MaxForce() | g.MinForce():
            return ("force",)
    return ()


def _considered_values(push: Considered) -> Iterator[tuple[str, Value]]:
    yield "face", Value("face", f"the {push.face} face")
    if push.height is not None:
        off = aside_text(push.lateral)
        aside = f", {off} of the middle" if off else ""
        yield "height", Value("contact height", f"{quantity(push.height, 'm')}{aside}")
    yield "direction", Value("direction", phrase(push.heading))
    if push.force is not None:
        yield "force", Value("force", force_text(push.force))


_UNITS = {"mass": " kg", "friction": ""}
"""Units of what is believed; all else is a length or an angle."""


def _numbers(answer: Answer) -> Iterator[Value]:
    """The numbers that answer a question, in words."""
    told = answer.numbers
    if answer.query in (None, "affordances"):
        yield Value("answer", answer.text)
        return
    if answer.yes is not None and answer.query in ("predict", "possible"):
        yield Value("answer", "yes" if answer.yes else "no")
    elif answer.query == "predict":
        yield Value("answer", _comes(told))
    if answer.reason is not None:
        yield Value("because", answer.text.removeprefix("No: "))
    if answer.query == "value":
        yield from _properties(told)
    elif answer.query == "where":
        ends = [quantity(told[key], "m") for key in ("lowest", "highest") if key in told]
        places = f"{' to '.join(ends)} above the table" if ends else "none that is sure"
        yield Value("places", places)
    elif "force" in told and answer.query == "how_hard":
        yield Value("force", force_text(told["force"], told.get("force_sd")))
        if sd := told.get("force_sd"):
            least, most = max(told["force"] - CERTAIN * sd, 0.0), told["force"] + CERTAIN * sd
            yield Value("with 95 %", f"between {force_text(least)} and {force_text(most)}")
    for name in ("slide", "topple"):
        if name in told and told[name] != told.get("force"):
            force = force_text(told[name], told.get(f"{name}_sd"))
            yield Value(f"{DOES[name]} from", f"{force} on")
    if "critical_height" in told:
        yield Value("topples if pushed above", quantity(told["critical_height"], "m"))
    if answer.probability is not None:
        yield Value("probability", probability_text(answer.probability))


def _comes(told: dict[str, float]) -> str:
    """Outcome of a push: none below the onset, else the one that needs the lesser force."""
    if "onset" not in told or told.get("given_force", told["onset"]) < told["onset"]:
        return "it stays where it is"
    first = min(("slide", "topple"), key=lambda name: told.get(name, float("inf")))
    return f"it {DOES[first]} first"


def _properties(told: dict[str, float]) -> Iterator[Value]:
    for name, value in told.items():
        if name.endswith("_sd"):
            continue
        sd = told.get("position_sd" if name in ("x", "y") else f"{name}_sd", 0.0)
        known = f"{_figure(name, value)} ± {_figure(name, sd)}" if sd else _figure(name, value)
        yield Value(name.replace("_", " "), known)


def _figure(name: str, value: float) -> str:
    if name in _UNITS:
        return f"{value:z.3f}{_UNITS[name]}"
    return quantity(value, "rad" if name == "yaw" else "m")


def _spans(part: BaseModel) -> tuple[g.Span, ...]:
    """Every span in a part of a frame."""
    return tuple(span for each in parts_within(part) for span in getattr(each, "spans", ()))


def _filler(result: Result | g.Command, rows: list[Row]) -> Iterator[Row]:
    """The words of the sentence that no part of a frame stands for, in one row."""
    covered = {i for frame in result.frames for a, b in _spans(frame) for i in range(a, b)}
    covered |= {i for each in rows for a, b in each.spans for i in range(a, b)}
    found = [m.span() for m in re.finditer(r"[\w'’]+(?:-[\w'’]+)*", result.text)]
    spans = tuple((a, b) for a, b in found if covered.isdisjoint(range(a, b)))
    if spans:
        told = ", ".join(
            dict.fromkeys(quotation(result.text, (span,)).casefold() for span in spans)
        )
        yield Row(
            words=told,
            field=NO_MEANING,
            parameter="",
            value="",
            spans=spans,
            frame=len(result.frames) - 1,
            part="filler",
        )


def part_at(rows: Sequence[Row], start: int, end: int) -> PartName | Literal["problem"]:
    """The part that a word became, the narrowest of several; `problem` if it stands in the way."""
    found: list[tuple[int, bool, PartName]] = [
        (b - a, not row.problem, row.part)
        for row in rows
        for a, b in row.spans
        if a < end and start < b
    ]
    _, fine, part = min(found, default=(0, True, "filler"))
    return part if fine else "problem"


NOT_SAID = "(not said)"
WIDTH = 110
"""Columns of the table when it is not printed to a terminal."""


@dataclass(frozen=True)
class Group:
    """Rows of one part of a frame; `words` is empty if the sentence did not say it."""

    part: PartName
    words: str
    field: str
    rows: tuple[Row, ...]


def groups(rows: Sequence[Row]) -> Iterator[Group]:
    """The rows of each part of a frame; what the table of defaults added to a part is with it."""
    said: list[Row] = []
    for each in rows:
        same = said and (each.part, each.field) == (said[0].part, said[0].field)
        words = next((r.words for r in said if r.words), "")
        if said and not (same and (not each.words or not words or each.words == words)):
            yield _group(said)
            said = []
        said.append(each)
    if said:
        yield _group(said)


def _group(rows: Sequence[Row]) -> Group:
    words = next((row.words for row in rows if row.words), "")
    return Group(rows[0].part, words, rows[0].field, tuple(rows))


def steps(rows: Sequence[Row]) -> Iterator[tuple[str, list[Row]]]:
    """The rows of each frame of the sentence, with a heading if there are several."""
    told = [row for row in rows if row.part != "filler"]
    several = len({row.frame for row in told}) > 1
    for frame, members in groupby(told, key=lambda row: row.frame):
        found = list(members)
        unplanned = any(row.value == NOT_PLANNED and not row.parameter for row in found)
        heading = f"Step {frame + 1}{', not planned' if unplanned else ''}" if several else ""
        yield heading, found


def filler(rows: Sequence[Row]) -> str | None:
    """The line about words that carry no meaning; None if there are none."""
    words = next((row.words for row in rows if row.part == "filler"), None)
    return None if words is None else f"{NO_MEANING}: {words}"


def table(rows: Sequence[Row], *, width: int = WIDTH) -> str:
    """The table as text, in at most so many columns."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    drawn = Table(box=box.SIMPLE_HEAD, title="From the words to the controller", title_style="")
    for heading in ("words", "frame", "parameter", "value"):
        drawn.add_column(heading, overflow="fold")
    for heading, members in steps(rows):
        if heading:
            drawn.add_row(f"{heading}:")
        for group in groups(members):
            _add(drawn, group)
        drawn.add_section()
    text = io.StringIO()
    console = Console(file=text, width=width)
    console.print(drawn)
    lines = [line.rstrip() for line in text.getvalue().rstrip().splitlines()]
    if (last := filler(rows)) is not None:
        lines.append(f"  {last}")
    return "\n".join(lines)


def _add(drawn: Table, group: Group) -> None:
    from rich.text import Text

    words, frame = [group.words or NOT_SAID], [group.field, f"({group.part})"]
    if len(group.rows) == 1:
        frame = ["\n".join(frame)]
    for said, field, each in zip_longest(words, frame, group.rows):
        parameter = f"✗ {each.parameter}" if each.problem else each.parameter
        style = "dim" if each.default else ""
        # As text, since the words of a sentence may look like marks of the console.
        drawn.add_row(
            Text(said or ""), Text(field or ""), Text(parameter, style), Text(each.value, style)
        )


# The way from the words to the controller, drawn: words, frames and parameters tied by lines.
#
# Above stands the sentence, each word in the colour of what it became. Below are three columns,
# as in Figure 2 of the paper "Prediction of action outcomes using an object model": the words,
# the part of the frame that they became with the paper's name for it, and the parameters with
# their values. What was not said is grey and dashed, what cannot be satisfied is red. Lengths are
# in inches.


# Okabe and Ito's colours, which people with colour blindness tell apart, dark enough for letters.
_BLUE, _ORANGE, _GREEN, _PURPLE = "#0064A0", "#C04E00", "#00805C", "#A8477F"
_GREY, _DARK, _RED = "#7A7A7A", "#222222", "#C1121F"
_COLOURS: dict[PartName | Literal["problem"], str] = {
    "push controller": _BLUE,
    "controller": _BLUE,
    "question": _BLUE,
    "remark": _BLUE,
    "object model": _ORANGE,
    "wanted outcome": _GREEN,
    "constraint": _PURPLE,
    "left open": _GREY,
    "filler": _GREY,
    "problem": _RED,
}
_TINTS = {
    _BLUE: "#E8F2F9",
    _ORANGE: "#FCEEE4",
    _GREEN: "#E6F4EF",
    _PURPLE: "#F8ECF3",
    _GREY: "#F4F4F4",
    _RED: "#FDECEC",
}

_WIDTH = 12.0
_EDGE = 0.35
_PAD = 0.09  # between a text and its box
_GAP, _GROUP_GAP = 0.06, 0.2
_TITLE, _HEADING, _BODY, _SMALL = 16.0, 11.0, 10.5, 9.0  # letters, in points


class _Column(NamedTuple):
    x: float
    width: float


_WORDS = _Column(_EDGE, 2.5)
_FRAME = _Column(3.55, 2.6)
_PARAMETER = _Column(6.95, _WIDTH - _EDGE - 6.95)
_NAME = 1.75  # of the last column: what its names take


def save_explanation(result: Result, path: Path) -> None:
    """Draws the explanation of a sentence that was understood; the suffix names the format.

    Raises:
        ControlError: `cannot_write` if the format is unknown.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    if path.suffix.lstrip(".").lower() not in FigureCanvasAgg.get_supported_filetypes():
        raise error(
            "cannot_write",
            f"cannot draw a '{path.suffix}' file",
            suggestions=("use .png, .svg or .pdf",),
        )
    rows, sheet = result.explanation_rows(), Sheet(_WIDTH)
    y = _sentence(sheet, result.text, rows, _EDGE + 0.1)
    became = "parameter of the controller" if result.plan else "what it became"
    for x, heading in ((_WORDS.x, "words"), (_FRAME.x, "frame"), (_PARAMETER.x, became)):
        sheet.write(x, y, heading, _HEADING, _GREY, fontweight="bold")
    y += 0.28
    for heading, members in steps(rows):
        if heading:
            y = _heading(sheet, heading, y + 0.15)
        for group in groups(members):
            y = _drawing_group(sheet, group, y) + _GROUP_GAP
    if (last := filler(rows)) is not None:
        for line in sheet.lines_of(last, _WIDTH - 2 * _EDGE, _BODY):
            sheet.write(_EDGE, y + 0.08, line, _BODY, _GREY, fontstyle="italic")
            y += line_height(_BODY)
    sheet.save(path, y + 0.22)


def _sentence(sheet: Sheet, text: str, rows: Sequence[Row], y: float) -> float:
    """The sentence in colours, in as many lines as it takes; returns where it ends."""
    ends = _WIDTH - _EDGE
    space = sheet.length("a a", _TITLE) - 2 * sheet.length("a", _TITLE)
    x, start = _EDGE, 0
    for word in text.split():
        start = text.index(word, start)
        colour = _COLOURS[part_at(rows, start, start + len(word))]
        bold = colour != _GREY
        for piece in sheet.lines_of(word, ends - _EDGE, _TITLE, bold=bold):
            length = sheet.length(piece, _TITLE, bold=bold)
            if x > _EDGE and x + length > ends:
                x, y = _EDGE, y + line_height(_TITLE)
            weight = "bold" if bold else "normal"
            sheet.write(x, y, piece, _TITLE, colour, fontweight=weight)
            x += length + space
        start += len(word)
    return y + 0.48


def _heading(sheet: Sheet, text: str, y: float) -> float:
    """The heading of one step of a sequence; returns where it ends."""
    sheet.write(_EDGE, y, text, _HEADING, _DARK, fontweight="bold")
    x = _EDGE + sheet.length(text, _HEADING, bold=True) + 0.15
    sheet.tie((x, y), (_WIDTH - _EDGE, y), "#CCCCCC", linewidth=0.8)
    return y + 0.3


class _Cell(NamedTuple):
    """A row's texts, broken into lines."""

    row: Row
    name: list[str]
    value: list[str]

    @property
    def height(self) -> float:
        return max(len(self.name), len(self.value)) * line_height(_BODY) + 2 * _PAD


def _cell(sheet: Sheet, row: Row) -> _Cell:
    name = f"✗ {row.parameter}" if row.problem else row.parameter
    room = _PARAMETER.width - 2 * _PAD
    lines = sheet.lines_of(name, _NAME - _PAD, _BODY) if name else []
    value = sheet.lines_of(row.value, room - (_NAME if name else 0.0), _BODY, bold=bool(name))
    return _Cell(row, lines, value)


def _drawing_group(sheet: Sheet, group: Group, top: float) -> float:
    """One part of a frame, from its words to its parameters; returns where it ends."""
    colour = _RED if any(row.problem for row in group.rows) else _COLOURS[group.part]
    cells = [_cell(sheet, row) for row in group.rows if row.parameter or row.value]
    words = sheet.lines_of(group.words or NOT_SAID, _WORDS.width - 2 * _PAD, _BODY, bold=True)
    detail = group.field.removeprefix(f"{group.part}: ")
    field = sheet.lines_of(detail, _FRAME.width - 2 * _PAD, _SMALL)
    word_height = len(words) * line_height(_BODY) + 2 * _PAD
    field_height = line_height(_BODY) + len(field) * line_height(_SMALL) + 2 * _PAD
    cells_height = sum(cell.height + _GAP for cell in cells) - _GAP
    height = max(word_height, field_height, cells_height)
    middle = top + 0.5 * height

    said = colour if group.words else _GREY
    style = {} if group.words else {"linestyle": (0, (4, 3))}
    word_width = max(sheet.length(line, _BODY, bold=True) for line in words) + 2 * _PAD
    sheet.box(_WORDS.x, middle - 0.5 * word_height, word_width, word_height, said, "white", **style)
    y = middle - 0.5 * word_height + _PAD
    _lines(sheet, words, _WORDS.x + _PAD, y, _BODY, said, fontweight="bold")

    y = middle - 0.5 * field_height
    sheet.box(_FRAME.x, y, _FRAME.width, field_height, colour, _TINTS[colour])
    y = _lines(sheet, [group.part], _FRAME.x + _PAD, y + _PAD, _BODY, colour, fontweight="bold")
    _lines(sheet, field, _FRAME.x + _PAD, y, _SMALL, _DARK)
    sheet.tie((_WORDS.x + word_width, middle), (_FRAME.x, middle), said, **style)

    y = middle - 0.5 * cells_height
    for cell in cells:
        _parameter(sheet, cell, y, colour, (_FRAME.x + _FRAME.width, middle))
        y += cell.height + _GAP
    return top + height


def _parameter(
    sheet: Sheet, cell: _Cell, top: float, colour: str, start: tuple[float, float]
) -> None:
    """A parameter with its value, tied to its frame."""
    row = cell.row
    open_ = row.default or not row.parameter
    if open_ or (colour == _RED and not row.problem):
        colour = _GREY
    style = {"linestyle": (0, (4, 3))} if open_ else {}
    letters = _RED if row.problem else _GREY if open_ else _DARK
    sheet.box(
        _PARAMETER.x,
        top,
        _PARAMETER.width,
        cell.height,
        colour,
        _TINTS[_RED] if row.problem else "white",
        **style,
    )
    x = _PARAMETER.x + _PAD
    _lines(sheet, cell.name, x, top + _PAD, _BODY, letters)
    weight = "bold" if cell.name else "normal"
    x += _NAME if cell.name else 0.0
    _lines(sheet, cell.value, x, top + _PAD, _BODY, letters, fontweight=weight)
    sheet.tie(start, (_PARAMETER.x, top + 0.5 * cell.height), colour, **style)


def _lines(
    sheet: Sheet, lines: Sequence[str], x: float, top: float, size: float, colour: str, **style: str
) -> float:
    """Lines of text from a height on; returns where they end."""
    for line in lines:
        sheet.write(x, top + 0.5 * line_height(size), line, size, colour, **style)
        top += line_height(size)
    return top
