"""Output of the commands: documents, errors, files and progress."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal, Self

import click

from nlcontrol.cli.console.terminal_text import print_lines
from nlcontrol.errors import OK, ErrorInfo, error
from nlcontrol.interruption import SIGNALS
from nlcontrol.json_document import document_text

FILE = click.Path(dir_okay=False, path_type=Path)
"""The type of an option that names a file."""

json_option = click.option("--json", "as_json", is_flag=True, help="Answer with one JSON document.")


def print_json(content: Mapping[str, Any]) -> None:
    """Print the one JSON document of a command; from then on no signal adds another."""
    SIGNALS.ignore()
    click.echo(document_text(content))


def print_answer(document: Mapping[str, Any], lines: Iterable[str], *, as_json: bool) -> int:
    """Print a command's answer as its document or as lines; the exit code says that all is well."""
    if as_json:
        print_json(document)
        return OK
    print_lines(lines)
    return OK


def print_skipped(problems: Iterable[object]) -> None:
    """Print on standard error which plug-ins and model files were skipped."""
    for problem in problems:
        click.echo(f"skipped: {problem}", err=True)


def print_skipped_with_words(problems: Iterable[object] = ()) -> None:
    """Print the same, and besides which plug-ins of the lexicon were skipped."""
    from grammar.words.lexicon_plugins import installed_lexicon

    _, words = installed_lexicon()
    print_skipped((*problems, *words))


def print_error(info: ErrorInfo, *, as_json: bool, text: str | None = None) -> None:
    """Print an error: as the document on standard output, or as text on standard error."""
    if as_json:
        said = {} if text is None else {"text": text}
        print_json({**said, "ok": False, "error": info.model_dump(mode="json")})
        return
    from nlcontrol.text_format import error_lines

    print_lines(error_lines(info, text), err=True)


def require_writable(path: Path | None) -> None:
    """Refuse a file that could not be written, before minutes are spent on its contents.

    Raises:
        ControlError: `cannot_write`.
    """
    if path is None:
        return
    folder, reason = path.absolute().parent, ""
    try:
        if not folder.is_dir():
            reason = f"there is no folder {folder}"
        elif path.is_dir():
            reason = "it is a folder"
        elif not os.access(folder, os.W_OK):
            reason = "nothing can be written in its folder"
    except (OSError, ValueError) as raised:  # no name of a file, as one that is too long
        reason = getattr(raised, "strerror", None) or str(raised)
    if reason:
        raise error(
            "cannot_write",
            f"cannot write {path}: {reason}",
            suggestions=("choose a file in a folder of yours",),
        )


Detail = Literal["quiet", "full"]
"""Less, or more, than is usually told of a sentence on its way."""


class Narrator:
    """Print on standard error what the simulation does.

    On a terminal one line that changes, else a line for each phase; with full detail, on both a
    line for each phase.
    """

    def __init__(self, detail: Detail | None = None) -> None:
        self._detail = detail
        self._phase = ""
        self._status: Any = None
        self._began = time.monotonic()

    def __enter__(self) -> Self:
        if sys.stderr.isatty() and self._detail != "quiet":
            from rich.console import Console

            self._status = Console(stderr=True).status("")
            self._status.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._status is not None:
            self._status.stop()

    def __call__(self, phase: str, time_: float, text: str) -> None:
        """Take one report of the simulation: phase, its own time [s], and what happens."""
        wall = time.monotonic() - self._began
        line = f"{phase}: {text}" if text else phase
        line = f"simulated {time_:5.1f} s, wall {wall:5.1f} s  {line}"
        if phase != self._phase and (self._status is None or self._detail == "full"):
            self.line(line)
        if self._status is not None:
            self._status.update(line[: self._status.console.width - 2])  # beside the spinner
        self._phase = phase

    def line(self, text: str) -> None:
        """Print a line that stays."""
        if self._detail != "quiet":
            with self.pause():
                print_lines([text], err=True)

    @contextmanager
    def pause(self) -> Iterator[None]:
        """Context in which the line that changes is not there, so that others can be printed."""
        if self._status is not None:
            self._status.stop()
        try:
            yield
        finally:
            if self._status is not None:
                self._status.start()


class Progress:
    """A bar on a terminal, elsewhere one plain line for each tenth.

    Args:
        what: is done, in the plural.
    """

    def __init__(self, what: str) -> None:
        self._what = what
        self._bar: Any = None
        self._tenths = 0

    def __enter__(self) -> Progress:
        if sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
            from rich.progress import Progress as Bar

            columns = (
                TextColumn("{task.description}"),
                BarColumn(),
                MofNCompleteColumn(),
                TimeRemainingColumn(),
            )
            self._bar = Bar(*columns, console=Console(stderr=True))
            self._task = self._bar.add_task(self._what, total=None)
            self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def __call__(self, done: int, total: int | None, note: str = "") -> None:
        """Take one report: how many of how many are done, and what else is worth to know."""
        if self._bar is not None:
            told = f"{self._what}, {note}" if note else self._what
            self._bar.update(self._task, completed=done, total=total, description=told)
            return
        # Where nobody knows how many there are, a line for each thousand.
        tenths = done // 1000 if total is None else 10 * done // total
        if tenths > self._tenths:
            self._tenths = tenths
            told = " ".join(filter(None, (f"{done} of {total or '?'} {self._what}", note)))
            click.echo(told, err=True)
