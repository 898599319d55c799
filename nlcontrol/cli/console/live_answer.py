"""What is told of a sentence: while it is carried out, and at its end.

At a terminal the understanding and each plan appear as soon as they are there, then the phases,
then what came of it. Elsewhere the answer is printed at its end, in one piece.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any, TypeVar

import click

from nlcontrol.cli.console.console_output import Detail, Narrator
from nlcontrol.cli.console.terminal_text import print_lines

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from nlcontrol.session.events import Event

Command = TypeVar("Command", bound=Callable[..., Any])


def detail_options(command: Command) -> Command:
    """Add -v and -q, as `detail`."""
    verbose = click.option(
        "-v", "--verbose", "detail", flag_value="full", help="Tell every phase and every new plan."
    )
    quiet = click.option(
        "-q", "--quiet", "detail", flag_value="quiet", help="Tell only what came of it."
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
