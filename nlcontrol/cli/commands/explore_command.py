"""`explore`: the robot finds the parameters of an object by touching it."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from nlcontrol.cli.console.command_options import (
    ParameterNames,
    Placed,
    Settings,
    keep_options,
    object_argument,
    open_controller,
    put_option,
    world_options,
)
from nlcontrol.cli.console.console_output import (
    FILE,
    Narrator,
    json_option,
    print_answer,
    require_writable,
)
from nlcontrol.cli.console.robot_stop import stop_on_signal
from nlcontrol.errors import ControlError, ErrorInfo
from nlcontrol.interruption import SIGNALS
from objectmodels.files.yaml_documents import replace_file
from sim.supervision import Monitor

if TYPE_CHECKING:
    from nlcontrol.learning.exploration_session import Exploration, ExplorationStopped
    from nlcontrol.session.controller import Controller
    from objectmodels import ObjectModel
    from sim.exploration.exploration_run import Touched


@click.command("explore")
@object_argument
@click.option(
    "--trials",
    default=10,
    show_default=True,
    type=click.IntRange(1, 1000),
    help="Number of repetitions of the experiments.",
)
@click.option(
    "--parameters",
    type=ParameterNames(),
    metavar="NAME,NAME",
    help="Parameters to identify: mass, friction, finger_friction, friction_radius, "
    "centre_of_mass (or com_x, com_y, com_z); default: all.",
)
@click.option(
    "--precision",
    type=click.FloatRange(0.0, 1.0, min_open=True),
    help="Repeat the most informative experiment until every parameter has this relative standard "
    "deviation, e.g. 0.02; of the centre of mass, as a share of the object's size.",
)
@click.option(
    "--guess",
    type=click.FloatRange(1.0, min_open=True),
    metavar="FACTOR",
    help="Treat the believed mass and friction as a guess that may be off by this factor.",
)
@world_options
@put_option
@click.option("--picture", type=FILE, help="Draw the force curves (PNG, SVG or PDF).")
@keep_options
@json_option
def command(
    name: str,
    trials: int,
    parameters: tuple[str, ...] | None,
    precision: float | None,
    guess: float | None,
    scene: str,
    seed: int,
    settings: Settings,
    put: tuple[Placed, ...],
    picture: Path | None,
    saved_as: str | None,
    output: Path | None,
    as_json: bool,
) -> int:
    """Identify the parameters of OBJECT by touching it, in simulation.

    The finger tilts, slides and rubs it again and again. The report has the estimates of each
    repetition, the joint estimate, and the true values of the scene. Control-C stops the hand and
    reports what the touches have shown so far; --save then saves nothing.
    """
    from nlcontrol.learning.exploration_session import ExplorationStopped, explore
    from nlcontrol.outcome_maps.face_experiment import object_on_table
    from nlcontrol.reports.exploration_report import report_lines, with_truth
    from objectmodels.geometry.pushed_body import UNCERTAIN
    from objectmodels.registry.model_registry import rename_model, save_model, store_model
    from sim.simulated_executor import simulation

    _require_sense(precision, output, picture)
    controller = open_controller(scene, seed, settings, put=put)
    item = object_on_table(name, controller.cell, controller.models, controller.registry)
    if saved_as is not None:
        _require_room(controller, item.name, saved_as)
    stopped = None
    with Narrator() as progress, stop_on_signal() as stop:
        try:
            found = explore(
                controller.executor,
                controller.models,
                item.name,
                parameters=parameters or UNCERTAIN,
                repetitions=trials,
                precision=precision,
                guess=guess,
                progress=Monitor(progress, stop),
                told=partial(_print_touch, progress),
            )
        except ExplorationStopped as raised:
            found, stopped = _findings(raised)
    files = {}
    if picture is not None:
        _save_curves(found, item.name, picture)
        files["picture"] = str(picture)
    model = found.model if not saved_as else rename_model(found.model, saved_as)
    if output is not None:
        save_model(model, output)
        files["model"] = str(output)
    truth = simulation(controller.executor).truth(item.name)
    report = with_truth(found.report, truth).model_copy(
        update={"files": files, "error": stopped, "ok": stopped is None}
    )
    if saved_as is not None and stopped is None:
        path, instead = store_model(controller.registry, model, replace=True)
        report = report.model_copy(update={"saved": str(path), "instead_of": instead})
    code = print_answer(report.model_dump(mode="json"), report_lines(report), as_json=as_json)
    return code if stopped is None else SIGNALS.exit_code


def _require_sense(precision: float | None, output: Path | None, picture: Path | None) -> None:
    if precision is not None and math.isnan(precision):
        raise click.UsageError("--precision: nan is no number")
    _require_file_ending(output, ".yaml", ".yml")
    _require_file_ending(picture, ".png", ".svg", ".pdf")


def _save_curves(found: Exploration, name: str, picture: Path) -> None:
    from nlcontrol.reports.plan_drawing import save_curves

    with replace_file(picture) as temporary:
        save_curves(found.touches, name, temporary)


def _require_room(controller: Controller, name: str, saved_as: str) -> None:
    """Requires that the registry can take what will be found, before anything is touched."""
    from objectmodels.registry.model_registry import place_model, rename_model

    believed = controller.models[name]
    named = rename_model(believed, saved_as) if saved_as else believed
    place_model(controller.registry.copy(), named, replace=True)


def _findings(stopped: ExplorationStopped) -> tuple[Exploration, ErrorInfo]:
    """Findings of an exploration until a signal stopped it, and how that is told.

    Raises:
        Stopped: nothing.
    """
    try:
        found = stopped.findings()
    except ControlError:
        raise stopped from None
    message = f"interrupted after {len(found.touches)} touches, whose findings these are"
    hint = "--output keeps them; nothing else does, so explore again for more"
    return found, ErrorInfo(code="interrupted", message=message, suggestions=(hint,))


def _require_file_ending(path: Path | None, *endings: str) -> None:
    """Refuse a file that could not be written, before minutes are spent on its contents."""
    if path is not None and path.suffix.lower() not in endings:
        raise click.UsageError(f"{path}: the ending must be {' or '.join(endings)}")
    require_writable(path)


def _print_touch(progress: Narrator, touched: Touched, model: ObjectModel) -> None:
    """Print a touch and what is believed after it, on standard error."""
    progress.line(
        f"{touched.repetition + 1:2}. {touched.experiment.name}: {touched.recording.detail}; "
        f"now believed: mass {model.mass:.3f} ± {model.mass_sd:.3f} kg, "
        f"friction {model.friction:.3f} ± {model.friction_sd:.3f}"
    )
