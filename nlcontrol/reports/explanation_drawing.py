"""The way from the words to the controller, drawn: words, frames and parameters tied by lines.

Above stands the sentence, each word in the colour of what it became. Below are three columns, as in
Figure 2 of the paper "Prediction of action outcomes using an object model": the words, the part of
the frame that they became with the paper's name for it, and the parameters with their values. What
was not said is grey and dashed, what cannot be satisfied is red. Lengths are in inches.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

from nlcontrol.reports.drawing_canvas import Sheet, line_height
from nlcontrol.reports.word_explanation import NOT_SAID, Group, filler, groups, part_at, steps

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nlcontrol.results.result import Result
    from planner.plan_explanation import PartName, Row

# Okabe and Ito's colours, which people with colour blindness tell apart, dark enough for letters.
_BLUE, _ORANGE, _GREEN, _PURPLE = "#0064A0", "#C04E00", "#00805C", "#A8477F"
_GREY, _DARK, _RED = "#7A7A7A", "#222222", "#C1121F"
_COLOURS: dict[PartName | Literal["problem"], str] = {
    "push controller": _BLUE, "controller": _BLUE, "question": _BLUE, "remark": _BLUE,
    "object model": _ORANGE, "wanted outcome": _GREEN, "constraint": _PURPLE,
    "left open": _GREY, "filler": _GREY, "problem": _RED,
}  # fmt: skip
_TINTS = {
    _BLUE: "#E8F2F9", _ORANGE: "#FCEEE4", _GREEN: "#E6F4EF", _PURPLE: "#F8ECF3",
    _GREY: "#F4F4F4", _RED: "#FDECEC",
}  # fmt: skip

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

    from nlcontrol.errors import error

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
            y = _group(sheet, group, y) + _GROUP_GAP
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


def _group(sheet: Sheet, group: Group, top: float) -> float:
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
        _PARAMETER.x, top, _PARAMETER.width, cell.height, colour,
        _TINTS[_RED] if row.problem else "white", **style,
    )  # fmt: skip
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
