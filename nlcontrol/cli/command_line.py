"""The command line: `nlcontrol say "…"` and its siblings.

Standard output carries the answer (with `--json` exactly one JSON document, errors included),
standard error the progress and, without `--json`, the errors. Exit codes stand in
`nlcontrol.errors`. A command is loaded when it is called, and what it needs when it runs: `parse`
and `plan` never load the simulator.
"""

from __future__ import annotations

import contextlib
import errno
import gc
import importlib
import io
import os
import sys
from collections.abc import Sequence

import click

from nlcontrol import __version__
from nlcontrol.cli.console.console_output import print_error
from nlcontrol.errors import OK, USAGE, ErrorInfo, exception_info
from nlcontrol.interruption import SIGNALS, Terminated

_EXIT_CODES = (
    "Exit codes: 0 done, every clause held; 1 internal failure; 2 wrong usage; 3 not understood; "
    "4 refused with its numbers, or beyond what this robot can do; 5 executed, a clause did not "
    "hold; 6 executed, a clause can be neither confirmed nor denied; 130 interrupted by control-C, "
    "143 by SIGTERM, 129 by SIGHUP."
)


_COMMANDS = {
    "affordances": "predict_command:affordances",
    "batch": "batch_command:group",
    "defaults": "schema_commands:defaults",
    "doctor": "doctor_command:command",
    "explore": "explore_command:command",
    "fit": "fit_command:command",
    "map": "map_command:command",
    "mcp": "mcp_command:command",
    "objects": "objects_command:group",
    "parse": "say_command:parse",
    "plan": "say_command:plan",
    "predict": "predict_command:predict",
    "rerun": "rerun_command:command",
    "sample": "say_command:sample",
    "say": "say_command:say",
    "scenes": "scenes_command:group",
    "schema": "schema_commands:schema",
    "serve": "serve_command:command",
    "shell": "shell_command:command",
}
"""Where each command stands in `nlcontrol.cli.commands`."""


class _Commands(click.Group):
    """A group that loads a command when it is called; `--help` loads them all."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in _COMMANDS:
            return None
        module, _, name = _COMMANDS[cmd_name].partition(":")
        found = getattr(importlib.import_module(f"nlcontrol.cli.commands.{module}"), name)
        assert isinstance(found, click.Command)
        return found


_GREETING = """\
nlcontrol tells a robot arm what to do with an object.
Three things to try:

  nlcontrol plan "push the ice tea box away without toppling it"
      shows the plan and the reasons for it
  nlcontrol say "push the mug 3 cm to the left" --replay run.html
      carries it out, checks it, and writes a page with the replay
  nlcontrol shell
      takes one sentence after another

`nlcontrol --help` lists all commands, `nlcontrol scenes list` the tables."""


@click.group(
    cls=_Commands,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog=_EXIT_CODES,
)
@click.version_option(__version__, prog_name="nlcontrol")
@click.pass_context
def cli(ctx: click.Context) -> None:
    """Say what to do with an object: nlcontrol predicts it, carries it out and checks it."""
    if ctx.invoked_subcommand is None:
        click.echo(_GREETING)


def main(args: Sequence[str] | None = None) -> None:
    """Run the command line and end the process with its exit code."""
    # A start allocates much and frees little: looking for garbage seldom saves a tenth of it.
    gc.set_threshold(100_000)
    SIGNALS.hold()
    status = run(sys.argv[1:] if args is None else args)
    SIGNALS.ignore()
    sys.exit(status)


def run(args: Sequence[str]) -> int:
    """Run one command and return its exit code; no exception gets through."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # A terminal that lacks a sign gets a substitute rather than an error.
            stream.reconfigure(errors="replace")
    # Pictures are drawn without a window: which backend the environment names does not matter.
    os.environ.pop("MPLBACKEND", None)
    try:
        _require_output()
        return _run_command(args, as_json="--json" in args)
    except OSError as raised:
        # Tell on standard error that standard output takes nothing; a reader that has gone is none.
        if sys.stdout is not None:
            # Python would complain once more when it flushes at the end.
            with contextlib.suppress(OSError):
                os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        info = ErrorInfo(
            code="cannot_write",
            message=f"cannot write to standard output: {raised.strerror or raised}",
            suggestions=("let standard output go to a file with room, a pipe or a terminal",),
        )
        if isinstance(raised, BrokenPipeError):
            return OK
        with contextlib.suppress(OSError):
            print_error(info, as_json=False)
        return info.status.exit


def _run_command(args: Sequence[str], *, as_json: bool) -> int:
    """Run one command; only the loss of standard output gets through."""
    try:
        SIGNALS.release()
        status = cli.main(args=list(args), prog_name="nlcontrol", standalone_mode=False)
        return status if isinstance(status, int) else OK
    except click.UsageError as raised:
        if not as_json:
            raised.show()
            return USAGE
        command = raised.ctx.command_path if raised.ctx else "nlcontrol"
        hints = [f"`{command} --help` shows what it takes"]
        if "unexpected extra argument" in raised.format_message():
            hints.insert(0, "put what belongs together, like a sentence, in quotes")
        print_error(
            ErrorInfo(code="usage", message=raised.format_message(), suggestions=tuple(hints)),
            as_json=True,
        )
        return USAGE
    except (click.Abort, KeyboardInterrupt, Terminated):
        return _print_interruption(as_json)
    except SystemExit as raised:  # the way of click to tell that the reader has gone
        raise BrokenPipeError from raised
    except Exception as raised:
        if SIGNALS.received:  # what a signal raises, a library may have turned into something else
            return _print_interruption(as_json)
        if isinstance(raised, OSError):
            _require_output()
            is_of_file = raised.filename is not None or isinstance(raised, FileNotFoundError)
            if not (is_of_file or as_json):
                raise  # of a stream
        info = exception_info(raised)
        print_error(info, as_json=as_json)
        return info.status.exit


def _require_output() -> None:
    """Refuse to go on without standard output.

    Raises:
        OSError: it is closed, or what stands in its buffer cannot be written.
    """
    if sys.stdout is None:
        raise OSError(errno.EBADF, "it is closed")
    sys.stdout.flush()


def _print_interruption(as_json: bool) -> int:
    SIGNALS.ignore()
    print_error(
        ErrorInfo(
            code="interrupted",
            message="interrupted before it was done",
            suggestions=("run it again; a command that keeps a record goes on from there",),
        ),
        as_json=as_json,
    )
    return SIGNALS.exit_code
