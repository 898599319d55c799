"""`predict` and `affordances`: what the object models say without a sentence."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from nlcontrol.cli.console_output import print_json
from nlcontrol.cli.objects_command import registry_told
from nlcontrol.cli.world_options import Settings, controller_of, world_options
from nlcontrol.errors import OK

if TYPE_CHECKING:
    from objectmodels import Face, ObjectModel

json_option = click.option("--json", "as_json", is_flag=True, help="Answer with one JSON document.")
face_option = click.option(
    "--face",
    default="front",
    show_default=True,
    help="The face that is touched, as the robot would call it.",
)
lying_option = click.option(
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


def looked_up(
    name: str, face: str, lying_on: str, file: Path | None = None
) -> tuple[ObjectModel, Face]:
    """The model of an object, lying on a face of it, and another face.

    Args:
        name: of the object.
        face: how the one is called.
        lying_on: how the other is called.
        file: with a model to take instead of the registry's.
    """
    from nlcontrol.references.face_names import face_of
    from objectmodels.registry.model_files import load_model

    registry = registry_told()
    model = load_model(file, registry.kinds) if file else registry.called(name)
    if lying_on != "bottom":
        model = model.standing(lying_on)
    return model, face_of(model, face)


@click.command()
@click.argument("name", metavar="OBJECT")
@face_option
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
@lying_option
@json_option
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
    from nlcontrol.questions.push_prediction import predict_push

    model, side = looked_up(name, face, lying_on)
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


@click.command()
@click.argument("name", metavar="OBJECT")
@world_options
@json_option
def affordances(name: str, scene: str, seed: int, settings: Settings, as_json: bool) -> int:
    """Tell what this robot can do with OBJECT, and if not, why not.

    An object that is not in the scene is taken as standing alone in the middle of the table.
    """
    from dataclasses import asdict

    from nlcontrol.questions.answer import affordance_lines

    found = controller_of(scene, seed, settings).affordances(name)
    if as_json:
        print_json({"object": name, "scene": scene, "affordances": [asdict(a) for a in found]})
        return OK
    for each in found:
        for line in affordance_lines(each):
            click.echo(line)
    return OK
