"""Which words became which parameters, as a table for the terminal."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, zip_longest
from typing import TYPE_CHECKING

from nlcontrol.reports.word_explanation import NO_MEANING, NOT_PLANNED

if TYPE_CHECKING:
    from rich.table import Table

    from planner.explanation.rows import PartName, Row

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
    for row in rows:
        same = said and (row.part, row.field) == (said[0].part, said[0].field)
        words = next((r.words for r in said if r.words), "")
        if said and not (same and (not row.words or not words or row.words == words)):
            yield _group(said)
            said = []
        said.append(row)
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
    for said, field, row in zip_longest(words, frame, group.rows):
        parameter = f"✗ {row.parameter}" if row.problem else row.parameter
        style = "dim" if row.default else ""
        # As text, since the words of a sentence may look like marks of the console.
        drawn.add_row(
            Text(said or ""), Text(field or ""), Text(parameter, style), Text(row.value, style)
        )
