"""Command lines made of functions: their arguments are the options, their texts the help."""

from __future__ import annotations

import argparse
import inspect
from collections.abc import Callable
from typing import Any, get_args, get_type_hints

Command = Callable[..., int | None]


def run_command(*commands: Command) -> int | None:
    """Calls the command that was asked for; what it returns is the exit code.

    What has no default is given by its place; a tuple is a choice of some of its words.
    """
    if len(commands) == 1:
        parser = argparse.ArgumentParser(description=inspect.getdoc(commands[0]))
        _add_options(parser, commands[0])
    else:
        parser = argparse.ArgumentParser()
        names = parser.add_subparsers(required=True)
        for command in commands:
            text = inspect.getdoc(command) or ""
            name = command.__name__.replace("_", "-")
            head, _, _ = text.partition("\n")
            options = names.add_parser(name, help=head.replace("%", "%%"), description=text)
            _add_options(options, command)
    given = vars(parser.parse_args())
    chosen: Command = given.pop("command")
    return chosen(**given)


def _add_options(parser: argparse.ArgumentParser, command: Command) -> None:
    parser.set_defaults(command=command)
    kinds = get_type_hints(command)
    for name, parameter in inspect.signature(command).parameters.items():
        flag, default = f"--{name.replace('_', '-')}", parameter.default
        kind: Any = next((part for part in get_args(kinds[name]) if part is not None), kinds[name])
        if default is inspect.Parameter.empty:
            parser.add_argument(name, type=kind)
        elif isinstance(default, tuple):
            parser.add_argument(flag, nargs="+", choices=default, default=default)
        else:
            parser.add_argument(flag, type=kind, default=default)
