"""The command line: `nlcontrol say "…"` and its siblings.

`command_line` runs it, `commands` holds a file per command, `console` what they share.
"""

from nlcontrol.cli.command_line import cli, main, run

__all__ = ["cli", "main", "run"]
