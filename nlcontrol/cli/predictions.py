"""`predict`, `map` and `affordances`: what the object models say without a sentence."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from nlcontrol.cli.objects import registry_told
from nlcontrol.cli.output import print_json, require_writable, written_whole
from nlcontrol.errors import OK

if TYPE_CHECKING:
    from objectmodels import Face, ObjectModel

_json = click.option("--json", "as_json", is_flag=True, help="Answer with one JSON document.")
_face = click.option(
    "--face",
    default="front",
    show_default=True,
    help="The face that is touched, as the robot would call it.",
)
_lying = click.option(
    "--lying-on", default="bottom", help="The face that the object lies on, e.g. left for a box."
)


class Numbers(click.ParamType[tuple[float, ...]]):
    """So many numbers with commas between them."""

    name = "numbers"

    def __init__(self, count: int) -> None:
        self.count = count

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        """Reads them."""
        if isinstance(value, tuple):
            return value
        try:
            numbers = tuple(float(part) for part in str(value).split(","))
        except ValueError:
            numbers = ()
        if len(numbers) != self.count or not all(abs(x) <= 1e6 for x in numbers):
            self.fail(f"{value!r} is not {self.count} numbers with commas between them", param, ctx)
        return numbers


def _looked_up(name: str, face: str, lying_on: str) -> tuple[ObjectModel, Face]:
    from nlcontrol.faces import face_of

    model = registry_told().called(name)
    if lying_on != "bottom":
        model = model.standing(lying_on)
    return model, face_of(model, face)


@click.command()
@click.argument("name", metavar="OBJECT")
@_face
@click.option(
    "--at",
    type=Numbers(2),
    required=True,
    metavar="LATERAL,HEIGHT",
    help="Where: along the face from its middle, rightwards for who looks at it, and up [m].",
)
@click.option(
    "--direction", type=Numbers(3), metavar="X,Y,Z", help="Of the force; straight in by default."
)
@click.option("--force", type=click.FloatRange(min=0.0), help="Its size [N].")
@click.option(
    "--friction",
    type=click.Choice(["static", "kinetic"]),
    default="static",
    show_default=True,
    help="Which coefficient at the table decides.",
)
@_lying
@_json
def predict(
    name: str,
    face: str,
    at: tuple[float, float],
    direction: tuple[float, float, float] | None,
    force: float | None,
    friction: Literal["static", "kinetic"],
    lying_on: str,
    as_json: bool,
) -> int:
    """Say what one push does to OBJECT.

    Directions are the robot's: x away from it, y to its left, z up.
    """
    from nlcontrol.predictions import predict_push

    model, side = _looked_up(name, face, lying_on)
    found = predict_push(
        model,
        face,
        side,
        lateral=at[0],
        height=at[1],
        direction=direction,
        force=force,
        friction=friction,
    )
    if as_json:
        print_json(found.model_dump(mode="json"))
    else:
        click.echo(found.text)
    return OK


@click.command("map")
@click.argument("name", metavar="OBJECT")
@_face
@click.option(
    "--direction", type=Numbers(3), metavar="X,Y,Z", help="Of the pushes; straight in by default."
)
@click.option("--spacing", default=10.0, show_default=True, help="Between contacts [mm].")
@click.option(
    "--band", default=5.0, show_default=True, help="Undecided: thresholds so close together [%]."
)
@click.option(
    "--level",
    type=click.FloatRange(0.5, 1.0),
    help="Undecided: where no outcome has this probability, instead of the band.",
)
@click.option("--straight", is_flag=True, help="The object cannot turn, as in the paper.")
@click.option("--shade", is_flag=True, help="Paler circles where the outcome is less probable.")
@click.option("--3d", "solid", is_flag=True, help="In three dimensions, the force as height.")
@click.option(
    "--output",
    "outputs",
    multiple=True,
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write it as PNG, SVG, PDF, CSV or JSON, by the ending; may be repeated.",
)
@_lying
@_json
def map_(
    name: str,
    face: str,
    direction: tuple[float, float, float] | None,
    spacing: float,
    band: float,
    level: float | None,
    straight: bool,
    shade: bool,
    solid: bool,
    outputs: tuple[Path, ...],
    lying_on: str,
    as_json: bool,
) -> int:
    """Show what pushes all over a face of OBJECT do, and what force they need."""
    from nlcontrol import maps
    from objectmodels.outcomemap import outcome_map

    for output in outputs:
        require_writable(output)
        if output.suffix not in (".png", ".svg", ".pdf", ".csv", ".json"):
            raise click.UsageError(f"{output}: the ending must be .png, .svg, .pdf, .csv or .json")
    model, side = _looked_up(name, face, lying_on)
    chart = outcome_map(
        model,
        side,
        direction=direction,
        spacing=1e-3 * spacing,
        band=1e-2 * band,
        level=level,
        turning=not straight,
    )
    for output in outputs:
        with written_whole(output) as temporary:
            _write(chart, face, temporary, solid=solid, shaded=shade)
    if as_json:
        print_json(maps.document(chart, face))
        return OK
    for line in maps.text(chart, face):
        click.echo(line)
    for output in outputs:
        click.echo(f"Map: {output}")
    return OK


def _write(chart: Any, face: str, path: Path, *, solid: bool, shaded: bool) -> None:
    import json

    from nlcontrol import maps

    if path.suffix == ".csv":
        maps.save_table(chart, face, path)
    elif path.suffix == ".json":
        document = maps.document(chart, face)
        path.write_text(json.dumps(document, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    else:
        maps.save_map(chart, face, path, solid=solid, shaded=shaded)


@click.command()
@click.argument("name", metavar="OBJECT")
@click.option(
    "--scene", default="kitchen", show_default=True, help="A built-in scene, or a scene file."
)
@click.option(
    "--seed", default=0, show_default=True, type=click.IntRange(0), help="Of everything random."
)
@_json
def affordances(name: str, scene: str, seed: int, as_json: bool) -> int:
    """Tell what this robot can do with OBJECT, and if not, why not.

    An object that is not in the scene is taken as standing alone in the middle of the table.
    """
    from dataclasses import asdict

    from nlcontrol.answers import affordance_lines
    from nlcontrol.controller import Controller

    found = Controller(scene, seed=seed).affordances(name)
    if as_json:
        print_json({"object": name, "scene": scene, "affordances": [asdict(a) for a in found]})
        return OK
    for each in found:
        for line in affordance_lines(each):
            click.echo(line)
    return OK
