"""`scenes`: the tables that the robot can be put at."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from nlcontrol.cli.console.console_output import json_option, print_answer
from nlcontrol.errors import known_errors_raised

if TYPE_CHECKING:
    from sim.truth.scene_file import Scene, SceneObject


@click.group("scenes")
def group() -> None:
    """The tables that the robot can be put at."""


@group.command("list")
@json_option
def list_scenes(as_json: bool) -> int:
    """List the built-in scenes and what stands there."""
    from sim.truth.scene_file import built_in_scenes, load_scene

    scenes = [load_scene(name) for name in built_in_scenes()]
    document = {"scenes": [_document(scene) for scene in scenes]}
    lines = (f"{scene.name:10} {', '.join(scene.cell.names)}" for scene in scenes)
    return print_answer(document, lines, as_json=as_json)


@group.command("show")
@click.argument("scene", default="kitchen")
@json_option
def show_scene(scene: str, as_json: bool) -> int:
    """Show where things stand in SCENE, a built-in one or a scene file."""
    from sim.truth.scene_file import load_scene

    with known_errors_raised():
        found = load_scene(scene)
    extent = found.table.extent
    lines = [
        f"{found.name}: a table from x {extent.x_min:g} to {extent.x_max:g} m, "
        f"y {extent.y_min:g} to {extent.y_max:g} m",
        *map(_object_line, found.objects),
    ]
    return print_answer(_document(found), lines, as_json=as_json)


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
    place = f"x {pose.x_m:z6.3f}  y {pose.y_m:z6.3f} m  turned by {pose.yaw_deg:z6.1f}°"
    return f"  {item.name:16} {place}{notes}"
