"""`schema`: what the JSON documents look like."""

from __future__ import annotations

import click

from nlcontrol.errors import OK


@click.command("schema")
def command() -> int:
    """Print the JSON schema of what `parse`, `plan` and `say` answer with --json."""
    from nlcontrol.results.json_schema import schema_json

    click.echo(schema_json())
    return OK
