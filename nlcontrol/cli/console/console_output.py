"""Output of the commands: documents, errors, files and progress."""

from __future__ import annotations

import os
import re
import shutil
import sys
import textwrap
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self, TypeVar

import click

from nlcontrol.errors import OK, ErrorInfo, error
from nlcontrol.interruption import SIGNALS
from nlcontrol.json_document import document_text

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from nlcontrol.session.events import Event


# Lines as a terminal shows them: wrapped to its width, verdicts in colour.
#
# What goes to a file or a pipe stays as it is, line by line. Colours are the terminal's own green
# and red, which its dark and its light theme choose so that they can be read; marks and words say
# the same without them. The environment variable NO_COLOR turns them off.


_STYLES: tuple[tuple[re.Pattern[str], dict[str, Any]], ...] = tuple(
    (re.compile(pattern), style)
    for pattern, style in (
        (r" *✓", {"fg": "green"}),
        (r" *✗", {"fg": "red"}),
        (r"Done: .*", {"fg": "green", "bold": True}),
        (r"(Refused|Not held|Unsupported|Error|Internal)( \(\w+\))?:", {"fg": "red", "bold": True}),
        (r"(I understood|Plan|Step \d+[^:]*|What (happened|\w+ taught)[^:]*):", {"bold": True}),
    )
)
"""Beginnings of lines that are shown in a style; the first that fits counts."""


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
    indent = len(line) - len(line.lstrip())
    gaps = [gap.end() for gap in re.finditer(r"(?<=\S) {2,}", line) if gap.end() <= columns / 2]
    # A text has 20 columns, however narrow the terminal is.
    filled = textwrap.fill(
        _UNIT.sub(_KEPT, line),
        max(columns, 20),
        subsequent_indent=" " * max(gaps, default=indent + 2),
        break_on_hyphens=False,
    )
    return filled.replace(_KEPT, " ")


_KEPT = "\N{NO-BREAK SPACE}"
_UNIT = re.compile(r"(?<=\d) (?=(mm|m|N|s|kg|ml|%)(\W|$))|(?<=±) ")  # a number stays with its unit


def with_style(text: str) -> str:
    """The text with its beginning in the style of what it tells."""
    if "NO_COLOR" in os.environ or os.environ.get("TERM") == "dumb":
        return text
    for pattern, style in _STYLES:
        if found := pattern.match(text):
            return click.style(found[0], **style) + text[found.end() :]
    return text


FILE = click.Path(dir_okay=False, path_type=Path)
"""The type of an option that names a file."""

json_option = click.option("--json", "as_json", is_flag=True, help="Print one JSON document.")


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


# What is told of a sentence: while it is carried out, and at its end.
#
# At a terminal the understanding and each plan appear as soon as they are there, then the phases,
# then what came of it. Elsewhere the answer is printed at its end, in one piece.


Command = TypeVar("Command", bound=Callable[..., Any])


def detail_options(command: Command) -> Command:
    """Add -v and -q, as `detail`."""
    verbose = click.option(
        "-v", "--verbose", "detail", flag_value="full", help="Print every phase and every new plan."
    )
    quiet = click.option(
        "-q", "--quiet", "detail", flag_value="quiet", help="Print the result alone."
    )
    return quiet(verbose(command))


class LiveAnswer(Narrator):
    """The answer to one sentence, told as it comes.

    Args:
        detail: how much is told; neither much nor little if not given.
        as_json: whether standard output is for documents alone.
    """

    def __init__(self, detail: Detail | None, *, as_json: bool) -> None:
        super().__init__(detail)
        self._live = not as_json and detail != "quiet" and sys.stdout.isatty()
        self._understood = False
        self._defaults: list[str] = []

    def take(self, event: Event) -> None:
        """Take one event of the sentence."""
        if self._live and (lines := list(self._lines_of(event))):
            with self.pause():
                print_lines(lines)

    def _lines_of(self, event: Event) -> Iterator[str]:
        from nlcontrol.plan_text import plan_lines
        from nlcontrol.reports.result_report import default_line, understanding_lines

        if event.kind == "understood":
            self._understood = True
            yield from understanding_lines(event.text, event.left_out or ())
        elif event.kind == "planned" and event.plan is not None:
            if event.frame:
                yield from ("", f"Step {event.frame + 1}:")
            told = dict.fromkeys(map(default_line, event.plan.defaults))
            yield from (line for line in told if line not in self._defaults)
            self._defaults += told
            yield from ("", *plan_lines(event.plan))
        elif self._detail == "full" and event.kind == "replanned" and event.plan is not None:
            yield from ("", *plan_lines(event.plan))
        elif self._detail == "full" and event.kind in ("contact", "lesson"):
            yield f"  {event.text}"

    def conclude(self, result: Result) -> None:
        """Print what is still to be told of the result."""
        from nlcontrol.reports.result_report import conclusion_lines, later_lines, report_lines

        lines: Iterable[str]
        if self._detail == "quiet":
            lines = conclusion_lines(result)
        else:
            lines = later_lines(result) if self._understood else report_lines(result)
        print_lines(lines, err=result.paraphrase is None and result.error is not None)
