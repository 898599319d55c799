"""Which words became which parameters, as a table for the terminal."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from planner.explain import Row

NOT_SAID = "(not said)"
WIDTH = 110
"""Columns of the table when it is not printed to a terminal."""


def table(rows: Sequence[Row], *, width: int = WIDTH) -> str:
    """The table as text.

    Args:
        rows: each the way of some words into the controller.
        width: largest number of columns.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Table

    drawn = Table(box=box.SIMPLE_HEAD, title="From the words to the controller", title_style="")
    for heading in ("words", "frame", "parameter", "value"):
        drawn.add_column(heading, overflow="fold")
    previous = None
    for row in rows:
        words = row.words or NOT_SAID
        drawn.add_row("" if words == previous else words, row.field, row.parameter, row.value)
        previous = words
    text = io.StringIO()
    Console(file=text, width=width).print(drawn)
    return "\n".join(line.rstrip() for line in text.getvalue().rstrip().splitlines())
