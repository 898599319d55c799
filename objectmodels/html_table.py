"""Tables as notebooks show them: HTML that loads nothing from elsewhere."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from itertools import islice

MOST_ROWS = 12
"""Rows that are shown; of what has more, the last row is an ellipsis."""


def html_table(caption: str, header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of texts below a caption, with the units in its header."""
    shown = list(islice(rows, MOST_ROWS + 1))
    if len(shown) > MOST_ROWS:
        shown[-1] = ["…"] * len(header)
    lines = [_row("td", cells) for cells in shown]
    return "\n".join(
        ["<table>", f"<caption>{escape(caption)}</caption>", _row("th", header), *lines, "</table>"]
    )


def _row(tag: str, cells: Sequence[str]) -> str:
    return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"
