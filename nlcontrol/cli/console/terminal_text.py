"""Lines as a terminal shows them: wrapped to its width, verdicts in colour.

What goes to a file or a pipe stays as it is, line by line. Colours are the terminal's own green and
red, which its dark and its light theme choose so that they can be read; marks and words say the
same without them. The environment variable NO_COLOR turns them off.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
import textwrap
from collections.abc import Iterable
from itertools import chain
from typing import Any

import click

_STYLES: tuple[tuple[re.Pattern[str], dict[str, Any]], ...] = tuple(
    (re.compile(pattern), style)
    for pattern, style in (
        (r" *✓", {"fg": "green"}),
        (r" *✗", {"fg": "red"}),
        (r"Done: .*", {"fg": "green", "bold": True}),
        (r"(Refused|Not held|Unsupported|Error|Internal)( \(\w+\))?:",
         {"fg": "red", "bold": True}),
        (r"(I understood|Plan|Step \d+[^:]*|What (happened|\w+ taught)[^:]*):", {"bold": True}),
    )
)  # fmt: skip
"""Beginnings of lines that are shown in a style; the first that fits counts."""

_LEAST = 20  # columns of a text, however narrow the terminal is


def columns_of(*, err: bool = False) -> int | None:
    """Columns of the terminal that a standard stream goes to; None if it goes to none."""
    stream = sys.stderr if err else sys.stdout
    if stream is None or not stream.isatty():
        return None
    if "COLUMNS" in os.environ:
        return shutil.get_terminal_size().columns
    return os.get_terminal_size(stream.fileno()).columns or 80


def print_lines(lines: Iterable[str], *, err: bool = False) -> None:
    """Print lines on a standard stream, as its reader wants them."""
    columns = columns_of(err=err)
    if columns is None:
        for line in lines:
            click.echo(line, err=err)
        return
    before = ""
    for line in chain.from_iterable(text.splitlines() or [""] for text in lines):
        # Carets below words that do not fit into one line would point at others.
        if not (_CARETS.fullmatch(line) and len(before) > columns):
            click.echo(with_style(lines_within(line, columns)), err=err)
        before = line


_CARETS = re.compile(r" +\^[ ^]*")


def lines_within(line: str, columns: int) -> str:
    """The line in as many lines as it takes; those after the first stand below its last column."""
    if len(line) <= columns:
        return line
    filled = textwrap.fill(
        _UNIT.sub(_KEPT, line),
        max(columns, _LEAST),
        subsequent_indent=" " * _hanging(line, columns),
        break_on_hyphens=False,
    )
    return filled.replace(_KEPT, " ")


_KEPT = "\N{NO-BREAK SPACE}"
_UNIT = re.compile(r"(?<=\d) (?=(mm|m|N|s|kg|ml|%)(\W|$))|(?<=±) ")  # a number stays with its unit


def _hanging(line: str, columns: int) -> int:
    """Indentation below a line: of the last column of a table, else two more than its own."""
    indent = len(line) - len(line.lstrip())
    gaps = [gap.end() for gap in re.finditer(r"(?<=\S) {2,}", line) if gap.end() <= columns / 2]
    return max(gaps, default=indent + 2)


def with_style(text: str) -> str:
    """The text with its beginning in the style of what it tells."""
    if "NO_COLOR" in os.environ or os.environ.get("TERM") == "dumb":
        return text
    for pattern, style in _STYLES:
        if found := pattern.match(text):
            return click.style(found[0], **style) + text[found.end() :]
    return text
