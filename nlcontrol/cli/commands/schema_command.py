"""`schema`: what the JSON documents look like."""

from __future__ import annotations

import click

from nlcontrol.cli.console.console_output import print_json
from nlcontrol.errors import OK


@click.command("schema")
def command() -> int:
    """Print the JSON schema of what the commands answer with --json."""
    from nlcontrol.results.json_schema import schema

    print_json(schema())
    return OK
