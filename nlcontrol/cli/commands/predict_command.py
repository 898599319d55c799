"""`predict` and `affordances`: what the object models say without a sentence."""

from __future__ import annotations

from typing import Literal

import click
from click.core import ParameterSource

from nlcontrol.cli.console.command_options import (
    Numbers,
    Settings,
    face_option,
    find_model,
    find_model_and_face,
    lying_option,
    object_argument,
    open_controller,
    world_options,
)
from nlcontrol.cli.console.console_output import json_option, print_answer


@click.command()
@object_argument
@face_option
@click.option(
    "--at",
    type=Numbers(2),
    required=True,
    metavar="LATERAL,HEIGHT",
    help="Contact: distance from the middle of the face, positive to the viewer's right, and "
    "height [m]; on the top face x and y.",
)
@click.option(
    "--direction",
    type=Numbers(3),
    metavar="X,Y,Z",
    help="Direction of the force; default: straight in.",
)
@click.option("--force", type=click.FloatRange(0.0, 1e6), help="Magnitude of the force [N].")
@click.option(
    "--press",
    type=click.FloatRange(0.0, 1e6, min_open=True),
    help="Drag from above instead, pressing with this force [N].",
)
@click.option(
    "--friction",
    type=click.Choice(["static", "kinetic"]),
    default="static",
    show_default=True,
    help="Coefficient of friction at the table to use.",
)
@lying_option
@json_option
def predict(
    name: str,
    face: str,
    at: tuple[float, float],
    direction: tuple[float, float, float] | None,
    force: float | None,
    press: float | None,
    friction: Literal["static", "kinetic"],
    lying_on: str,
    as_json: bool,
) -> int:
    """Predict the outcome of one push on OBJECT.

    Directions are the robot's: x away from it, y to its left, z up.
    """
    if press is not None:
        given = click.get_current_context().get_parameter_source("face")
        if force is not None or (face != "top" and given is not ParameterSource.DEFAULT):
            raise click.UsageError("--press draws along from the top: leave out --force and --face")
        from nlcontrol.questions.drag_prediction import predict_drag

        model = find_model(name, lying_on)
        drag = predict_drag(model, at, press=press, direction=direction, friction=friction)
        return print_answer(drag.model_dump(mode="json"), [drag.text], as_json=as_json)
    from nlcontrol.questions.push_prediction import predict_push

    model, side = find_model_and_face(name, face, lying_on)
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
    return print_answer(found.model_dump(mode="json"), [found.text], as_json=as_json)


@click.command()
@object_argument
@world_options
@json_option
def affordances(name: str, scene: str, seed: int, settings: Settings, as_json: bool) -> int:
    """List what this robot can do with OBJECT, and for the rest, why not.

    An object outside the scene is taken to stand alone in the middle of the table.
    """
    from nlcontrol.questions.answer import affordance_lines
    from nlcontrol.service.documents import Affordances

    found = open_controller(scene, seed, settings).affordances(name)
    document = Affordances.of(name, scene, found).model_dump(mode="json")
    return print_answer(document, affordance_lines(found), as_json=as_json)
