"""The way from the words to the controller, drawn: words, frames and parameters tied by lines.

Three columns. At the left the words in the order of the sentence, in the middle the part of the
frame that they became, at the right the parameters of the controller with their values. What was
not said and came from the table of defaults is grey.
"""

from __future__ import annotations

import textwrap
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from nlcontrol.explanation import NOT_SAID

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from nlcontrol.result import Result
    from planner.explain import Row

# Okabe and Ito's colours, which people with colour blindness tell apart.
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_GREY = "#888888"
_X_WORDS, _X_FRAME, _X_PARAMETER = 0.02, 0.30, 0.58
_PAD = 0.0065  # from a text to the edge of the box around it
_COLUMN_CHARACTERS = {_X_WORDS: 24, _X_FRAME: 24, _X_PARAMETER: 46}


def save_explanation(result: Result, path: Path) -> None:
    """Draws the explanation of a planned result.

    Args:
        result: with a plan.
        path: file to write; its suffix names the format.

    Raises:
        ControlError: `cannot_write` if the format is unknown.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from nlcontrol.errors import error

    rows = result.explained()
    formats = FigureCanvasAgg.get_supported_filetypes()
    if path.suffix.lstrip(".").lower() not in formats:
        raise error(
            "cannot_write",
            f"cannot draw a '{path.suffix}' file",
            suggestions=("use .png, .svg or .pdf",),
        )
    lines = sum(_height(row) for row in rows)
    title = textwrap.wrap(f"“{result.text}”", 90)
    body, head = 0.36 * (lines + 1.5), 0.3 * len(title) + 0.25  # heights in inches
    figure = Figure(figsize=(10.5, body + head), dpi=150)
    FigureCanvasAgg(figure)
    figure.text(
        0.5,
        1.0 - 0.5 * head / (body + head),
        "\n".join(title),
        fontsize=14,
        ha="center",
        va="center",
    )
    # Fixed axes: the ties start where a text's box ends, which a later layout would move.
    axes = figure.add_axes((0.0, 0.0, 1.0, body / (body + head)))
    axes.set_axis_off()
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(lines + 0.3, -1.2)
    for x, heading in (
        (_X_WORDS, "words"),
        (_X_FRAME, "frame"),
        (_X_PARAMETER, "parameter of the controller"),
    ):
        axes.text(x, -0.8, heading, fontsize=11, fontweight="bold", va="center", color="#333333")
    _draw_groups(axes, rows)
    figure.savefig(path)


def _height(row: Row) -> float:
    """Lines that a row takes, its longest cell wrapped, with some air."""
    return 0.55 * max(1, len(_wrapped(_right(row), _X_PARAMETER))) + 0.6


def _right(row: Row) -> str:
    return f"{row.parameter} = {row.value}" if row.parameter else row.value


def _wrapped(text: str, column: float) -> list[str]:
    return textwrap.wrap(text, _COLUMN_CHARACTERS[column]) or [""]


def _draw_groups(axes: Axes, rows: Sequence[Row]) -> None:
    top = 0.0
    said = 0
    for words, group in groupby(rows, key=lambda row: row.words or NOT_SAID):
        members = list(group)
        colour = _GREY if words == NOT_SAID else _COLOURS[said % len(_COLOURS)]
        said += words != NOT_SAID
        bottom = top + sum(map(_height, members))
        _draw_group(axes, words, members, top, bottom, colour)
        top = bottom


def _draw_group(
    axes: Axes, words: str, rows: Sequence[Row], top: float, bottom: float, colour: str
) -> None:
    middle = 0.5 * (top + bottom)
    word_end = _cell(axes, _X_WORDS, middle, words, colour, strong=True)
    y = top
    for field, members in groupby(rows, key=lambda row: row.field):
        same = list(members)
        heights = [_height(row) for row in same]
        y_field = y + 0.5 * sum(heights)
        field_end = _cell(axes, _X_FRAME, y_field, field, colour)
        _tie(axes, (word_end, middle), (_X_FRAME, y_field), colour)
        for row, height in zip(same, heights, strict=True):
            _cell(axes, _X_PARAMETER, y + 0.5 * height, _right(row), colour)
            _tie(axes, (field_end, y_field), (_X_PARAMETER, y + 0.5 * height), colour)
            y += height


def _cell(axes: Axes, x: float, y: float, text: str, colour: str, *, strong: bool = False) -> float:
    """Writes a boxed text; returns the x at which the text ends."""
    drawn = axes.text(
        x,
        y,
        "\n".join(_wrapped(text, x)),
        fontsize=10.5,
        fontweight="bold" if strong else "normal",
        va="center",
        bbox={"boxstyle": "round,pad=0.3", "facecolor": "white", "edgecolor": colour},
    )
    box = drawn.get_window_extent().transformed(axes.transData.inverted())
    return float(box.x1)


def _tie(axes: Axes, start: tuple[float, float], end: tuple[float, float], colour: str) -> None:
    """A curve from one cell to the next, level at both ends."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Curve

    (x0, y0), (x1, y1) = (start[0] + _PAD, start[1]), (end[0] - _PAD, end[1])
    bend = 0.5 * (x0 + x1)
    points = [(x0, y0), (bend, y0), (bend, y1), (x1, y1)]
    curve = Curve(points, [Curve.MOVETO, Curve.CURVE4, Curve.CURVE4, Curve.CURVE4])
    axes.add_patch(PathPatch(curve, facecolor="none", edgecolor=colour, linewidth=1.4, zorder=0))
