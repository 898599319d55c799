"""The command line: `nlcontrol say "…"` and its siblings.

Standard output carries the answer (with `--json` exactly one JSON document, errors included),
standard error the progress and, without `--json`, the errors. Exit codes stand in
`nlcontrol.errors`. Commands load what they need when they run: `parse` and `plan` never load the
simulator.
"""

from __future__ import annotations

import contextlib
import io
import os
import sys
from collections.abc import Sequence

import click

from nlcontrol import __version__
from nlcontrol.cli import (
    defaults_command as defaults,
)
from nlcontrol.cli import (
    doctor_command as doctor,
)
from nlcontrol.cli import (
    explore_command as exploring,
)
from nlcontrol.cli import (
    fit_command as fitting,
)
from nlcontrol.cli import (
    map_command as maps,
)
from nlcontrol.cli import (
    objects_command as objects,
)
from nlcontrol.cli import (
    predict_command as predictions,
)
from nlcontrol.cli import (
    say_command as sentences,
)
from nlcontrol.cli import (
    shell_command as shell,
)
from nlcontrol.cli.console_output import print_error
from nlcontrol.errors import INTERNAL, OK, USAGE, ErrorInfo, described

INTERRUPTED = 130  # what shells expect after control-C


_EXIT_CODES = (
    "Exit codes: 0 done and every clause held, 1 internal failure, 2 usage, 3 not understood, "
    "4 no plan (refused with its numbers) or a capability that this robot lacks, "
    "5 executed, but a clause did not hold."
)


@click.group(
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog=_EXIT_CODES,
)
@click.version_option(__version__, prog_name="nlcontrol")
def cli() -> None:
    """Say what should become of an object; it is predicted, carried out and checked."""


@cli.command()
def schema() -> int:
    """Print the JSON schema of what `parse`, `plan` and `say` answer with --json."""
    from nlcontrol.results.json_schema import schema_json

    click.echo(schema_json())
    return OK


for command in (
    sentences.say,
    sentences.plan,
    sentences.parse,
    sentences.sample,
    predictions.predict,
    maps.command,
    predictions.affordances,
    exploring.command,
    fitting.command,
    objects.group,
    shell.command,
    defaults.command,
    doctor.command,
):
    cli.add_command(command)


def main(args: Sequence[str] | None = None) -> None:
    """Runs the command line and ends the process with its exit code."""
    sys.exit(run(sys.argv[1:] if args is None else args))


def run(args: Sequence[str]) -> int:
    """Runs one command; returns the exit code and lets no exception through."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # A terminal that lacks a sign gets a substitute rather than an error.
            stream.reconfigure(errors="replace")
    as_json = "--json" in args
    try:
        status = cli.main(args=list(args), prog_name="nlcontrol", standalone_mode=False)
        return status if isinstance(status, int) else OK
    except click.UsageError as raised:
        return _usage(raised, as_json)
    except click.Abort:
        click.echo("interrupted", err=True)
        return INTERRUPTED
    except BrokenPipeError:
        # The reader has gone, and Python would complain once more when it flushes at the end.
        with contextlib.suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return INTERNAL
    except Exception as raised:
        return _failure(raised, as_json)


def _usage(raised: click.UsageError, as_json: bool) -> int:
    if not as_json:
        raised.show()
        return USAGE
    print_error(ErrorInfo(code="usage", message=raised.format_message()), as_json=True)
    return USAGE


def _failure(raised: Exception, as_json: bool) -> int:
    """The last resort: a known error, or a defect with the place where it arose."""
    info = described(raised)
    print_error(info, as_json=as_json)
    return info.status.exit
