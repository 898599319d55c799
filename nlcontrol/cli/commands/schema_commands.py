"""`defaults` and `schema`: the settings that commands take, and the form of their answers."""

from __future__ import annotations

import click

from nlcontrol.cli.console.command_options import (
    Settings,
    complete_defaults,
    scene_option,
    set_option,
)
from nlcontrol.cli.console.console_output import json_option, print_answer, print_json
from nlcontrol.errors import OK, known_errors_raised


@click.command("defaults")
@click.argument("names", metavar="[NAME]...", nargs=-1, shell_complete=complete_defaults)
@scene_option
@set_option
@json_option
def defaults(names: tuple[str, ...], scene: str, settings: Settings, as_json: bool) -> int:
    """List every default with its value.

    --set and `defaults` in a scene file take these names. NAME selects those that begin with it.
    """
    from dataclasses import asdict

    from planner.types.defaults import settings_beginning, with_settings
    from sim.truth.scene_file import load_scene

    with known_errors_raised():
        found = settings_beginning(
            names or ("",), with_settings(load_scene(scene).defaults, dict(settings))
        )
    lines = (f"{each.name:24} {each.value:>6g}  {each.meaning}" for each in found)
    return print_answer({"defaults": list(map(asdict, found))}, lines, as_json=as_json)


@click.command("schema")
def schema() -> int:
    """Print the JSON schema of all documents that `--json` prints."""
    from nlcontrol import json_schema

    print_json(json_schema.schema())
    return OK
