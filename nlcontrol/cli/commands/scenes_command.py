"""`scenes`: the tables that the robot can be put at."""

from __future__ import annotations

import os
import shlex
from typing import TYPE_CHECKING, Any

import click

from nlcontrol.cli.console.command_options import (
    Placed,
    complete_scenes,
    put_option,
    scene_with_objects,
)
from nlcontrol.cli.console.console_output import (
    FILE,
    json_option,
    print_answer,
    require_writable,
)
from nlcontrol.errors import error, known_errors_raised
from objectmodels.files.yaml_documents import replace_file

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from sim.truth.scene_file import Scene, SceneObject


@click.group("scenes")
def group() -> None:
    """List, show and write the scenes in which the robot can work."""


@group.command("list")
@json_option
def list_scenes(as_json: bool) -> int:
    """List the built-in scenes with their objects."""
    from sim.truth.scene_file import built_in_scenes, load_scene

    scenes = [load_scene(name) for name in built_in_scenes()]
    document = {"scenes": [_document(scene) for scene in scenes]}
    lines = (f"{scene.name:10} {', '.join(scene.cell.names)}" for scene in scenes)
    return print_answer(document, lines, as_json=as_json)


@group.command("show")
@click.argument("scene", default="kitchen", shell_complete=complete_scenes)
@json_option
def show_scene(scene: str, as_json: bool) -> int:
    """Show the objects of SCENE (built-in or a file) and their poses."""
    from sim.truth.scene_file import load_scene

    with known_errors_raised():
        found = load_scene(scene)
    extent = found.table.extent
    lines = [
        f"{found.name}: a table from x {1e3 * extent.x_min:z.0f} to {1e3 * extent.x_max:z.0f} mm, "
        f"y {1e3 * extent.y_min:z.0f} to {1e3 * extent.y_max:z.0f} mm",
        *map(_object_line, found.objects),
    ]
    return print_answer(_document(found), lines, as_json=as_json)


@group.command("new")
@click.argument("file", type=FILE)
@click.option(
    "--extends",
    shell_complete=complete_scenes,
    help="Built-in scene or scene file to inherit everything else from.",
)
@put_option
@json_option
def write_scene(file: Path, extends: str | None, put: tuple[Placed, ...], as_json: bool) -> int:
    """Write a scene FILE of your own, to edit by hand."""
    from sim.truth.scene_file import built_in_scenes, parse_scene

    if file.suffix not in {".yaml", ".yml"}:
        raise click.UsageError(f"name it {file.stem}.yaml: a scene is a YAML file")
    require_writable(file)
    if file.exists():
        hints = ("choose another name, or remove it",)
        raise error("cannot_write", f"{file} is there already", suggestions=hints)
    if extends and extends not in built_in_scenes():
        extends = os.path.relpath(extends, file.parent)
    with known_errors_raised():
        base = parse_scene(
            _text(file, extends, ()), source=str(file), folder=file.absolute().parent
        )
        scene = scene_with_objects(base, put or (() if extends else _FIRST))
    added = scene.objects[len(base.objects) :]
    with replace_file(file) as temporary:
        temporary.write_text(_text(file, extends, added), encoding="utf-8")
    name = scene.objects[-1].name if scene.objects else "mug"
    command = f"nlcontrol plan push the {name} away --scene {shlex.quote(str(file))}"
    lines = [f"wrote {file}; now", f"  {command}"]
    return print_answer({"file": str(file), **_document(scene)}, lines, as_json=as_json)


_FIRST: tuple[Placed, ...] = (("ice tea box", 0.45, 0.0, 0.0),)

_HEAD = """\
# A scene of your own: `nlcontrol say … --scene {file}`.
# An object that states no `truth` really is as its model says; docs/scenes.md tells every key.
"""


def _text(file: Path, extends: str | None, added: Sequence[SceneObject]) -> str:
    """The text of a scene file with objects, beside those of a scene that it extends."""
    import yaml

    document: dict[str, Any] = {"version": 1, "name": file.stem}
    if extends:
        document["extends"] = extends
    document["objects"] = [
        {
            "name": item.name,
            "model": item.model,
            "pose": item.pose.model_dump(exclude_defaults=True),
        }
        for item in added
    ]
    return _HEAD.format(file=file.name) + yaml.safe_dump(
        document, sort_keys=False, allow_unicode=True, default_flow_style=None
    )


def _document(scene: Scene) -> dict[str, Any]:
    told = {item.name: item.model_dump(mode="json") for item in scene.cell.objects}
    places = {item.name: item.pose.model_dump(mode="json") for item in scene.objects}
    objects = [{**told[name], "pose": places[name]} for name in told]
    return {"name": scene.name, "objects": objects}


def _object_line(item: SceneObject) -> str:
    pose = item.pose
    marks = [mark for mark in ("fragile", "fixed") if getattr(item, mark)]
    of_model = [] if item.model == item.name else [f"a {item.model}"]
    notes = f"  ({', '.join(of_model + marks)})" if of_model or marks else ""
    place = (
        f"x {1e3 * pose.x_m:z5.0f}  y {1e3 * pose.y_m:z5.0f} mm  turned by {pose.yaw_deg:z6.1f}°"
    )
    return f"  {item.name:16} {place}{notes}"
