"""`batch`: many rows of sentence, scene and seed, and the summary of their results."""

from __future__ import annotations

import sys
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Literal

import click

from nlcontrol.cli.console.command_options import open_registry
from nlcontrol.cli.console.console_output import (
    FILE,
    Progress,
    json_option,
    print_error,
    print_json,
    print_skipped_with_words,
    require_writable,
)
from nlcontrol.errors import OK
from objectmodels.files.yaml_documents import error_of_system, replace_file

if TYPE_CHECKING:
    from nlcontrol.batches.batch import BatchProgress, BatchSummary


class _BatchGroup(click.Group):
    """A group in which `run` may be left out."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the arguments, with the name of the command that is meant."""
        if args and args[0] not in (*self.commands, *ctx.help_option_names):
            args = ["run", *args]
        return super().parse_args(ctx, args)


@click.group("batch", cls=_BatchGroup)
def group() -> None:
    """Carry out many rows of sentence, scene and seed.

    `batch FILE` is `batch run FILE`.
    """


_picture = click.option("--picture", type=FILE, help="Draw the summary (PNG, SVG or PDF).")


@group.command("run")
@click.argument("file", type=click.Path(path_type=Path, allow_dash=True))
@click.option(
    "--output", type=FILE, help="Append the results to this file instead of printing them."
)
@click.option("--resume", is_flag=True, help="Continue after the results in --output.")
@click.option(
    "--workers", type=click.IntRange(1), help="Number of processes; default: one per processor."
)
@click.option("--dask", metavar="ADDRESS", help="Run on the Dask cluster of this scheduler.")
@click.option("--plan-only", is_flag=True, help="Plan only, whatever the rows say.")
@click.option("--brief", is_flag=True, help="Write digests and codes instead of whole results.")
@click.option(
    "--on-error",
    type=click.Choice(["skip", "stop"]),
    default="skip",
    show_default=True,
    help="Skip a row without a result, or stop the batch.",
)
@click.option("--events", is_flag=True, help="Write the progress to standard error as JSON lines.")
@_picture
@json_option
def run(
    file: Path,
    output: Path | None,
    resume: bool,
    workers: int | None,
    dask: str | None,
    plan_only: bool,
    brief: bool,
    on_error: Literal["skip", "stop"],
    events: bool,
    picture: Path | None,
    as_json: bool,
) -> int:
    """Carry out the rows of FILE, JSON lines (docs/batch.md); - is standard input.

    A summary follows at the end; with --json it is one document.
    """
    from nlcontrol.batches.batch import (
        Tally,
        batch,
        dask_executor,
        read_outcomes,
        summarise,
    )
    from nlcontrol.batches.row_orders import rows_in_file

    if output is None and (resume or as_json):
        raise click.UsageError(f"{'--resume' if resume else '--json'} needs --output")
    for path in (output, picture):
        require_writable(path)
    print_skipped_with_words()
    from_input, tally = str(file) == "-", Tally()
    with ExitStack() as opened:
        executor = None
        if dask is not None:
            executor, threads = opened.enter_context(dask_executor(dask))
            workers = workers or threads
        bar = None if events else opened.enter_context(Progress("rows"))
        results = batch(
            rows_in_file(opened.enter_context(_opened_rows(file))),
            executor=executor,
            workers=workers,
            registry=open_registry(),
            folder=Path() if from_input else file.parent,
            plan_only=plan_only,
            brief=brief,
            output=output,
            resume=resume,
            on_error=on_error,
            on_event=partial(_tell, bar),
            total=None if from_input else _row_count(file),
        )
        for result in opened.enter_context(closing(results)):
            if output is None:
                tally.add(result)
                click.echo(result.model_dump_json())
    summary = tally.summary() if output is None else summarise(read_outcomes(output))
    return _answer_summary(summary, picture, as_json=as_json, err=output is None)


def _opened_rows(file: Path) -> BinaryIO:
    if str(file) == "-":
        return sys.stdin.buffer
    try:
        return file.open("rb")
    except OSError as raised:
        raise error_of_system("unreadable_file", "cannot be read", file, raised) from raised


def _row_count(file: Path) -> int:
    from nlcontrol.batches.row_orders import rows_in_file

    with _opened_rows(file) as lines:
        return sum(bool(line.strip()) for line in rows_in_file(lines))


def _tell(bar: Progress | None, event: BatchProgress) -> None:
    """Report the progress of a batch: on its bar, or as a line of JSON where there is none."""
    if bar is None:
        click.echo(event.model_dump_json(), err=True)
        return
    left = "" if event.left is None else f", {event.left:.0f} s left"
    without = f", {event.without_result} without result" if event.without_result else ""
    bar(event.done, event.total, f"{event.rate:.3g} a second{left}{without}")


@group.command("summary")
@click.argument("results", type=FILE)
@_picture
@json_option
def summary(results: Path, picture: Path | None, as_json: bool) -> int:
    """Summarise RESULTS, a file written by `batch --output`."""
    from nlcontrol.batches.batch import read_outcomes, summarise

    require_writable(picture)
    found = summarise(read_outcomes(results))
    _answer_summary(found, picture, as_json=as_json)
    return OK


def _answer_summary(
    found: BatchSummary, picture: Path | None, *, as_json: bool, err: bool = False
) -> int:
    from nlcontrol.batches.batch import save_summary_picture, summary_lines

    if picture is not None:
        with replace_file(picture) as path:
            save_summary_picture(found, path)
    if as_json:
        print_json(found.model_dump(mode="json"))
    else:
        for line in summary_lines(found):
            click.echo(line, err=err)
        if found.error is not None:
            print_error(found.error, as_json=False)
    return OK if found.error is None else found.error.status.exit
