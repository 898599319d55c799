"""`map`: what pushes all over a face do, as predicted, and beside it as carried out."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from nlcontrol.cli.console.command_options import (
    Numbers,
    face_option,
    find_model_and_face,
    lying_option,
    object_argument,
    open_registry,
    scene_option,
    seed_option,
)
from nlcontrol.cli.console.console_output import (
    FILE,
    Progress,
    json_option,
    print_answer,
    require_writable,
)
from nlcontrol.json_document import document_text
from objectmodels.files.yaml_documents import replace_file

if TYPE_CHECKING:
    from nlcontrol.outcome_maps.face_experiment import Comparison
    from objectmodels.mechanics.outcome_map import OutcomeMap
    from sim.face_experiment import Way

_PICTURES = (".png", ".svg", ".pdf")


@click.command("map")
@object_argument
@face_option
@click.option(
    "--direction",
    type=Numbers(3),
    metavar="X,Y,Z",
    help="Direction of the pushes; default: straight in.",
)
@click.option("--spacing", default=10.0, show_default=True, help="Distance between contacts [mm].")
@click.option(
    "--band",
    default=5.0,
    show_default=True,
    help="Undecided if both thresholds are this close [%].",
)
@click.option(
    "--level",
    type=click.FloatRange(0.5, 1.0),
    help="Undecided if no outcome has this probability; replaces the band.",
)
@click.option("--straight", is_flag=True, help="Keep the object from turning, as in the paper.")
@click.option("--shade", is_flag=True, help="Draw less probable outcomes paler.")
@click.option("--3d", "solid", is_flag=True, help="Draw it in 3-D, with the force as height.")
@click.option(
    "--output",
    "outputs",
    multiple=True,
    type=FILE,
    help="Write the map as PNG, SVG, PDF, CSV or JSON, by the ending. May be repeated.",
)
@click.option("--model", "model_file", type=FILE, help="Model file to predict with.")
@click.option(
    "--experiment",
    is_flag=True,
    help="Also simulate the pushes and compare: experiment left, prediction right.",
)
@click.option(
    "--by",
    type=click.Choice(["force", "robot", "both"]),
    default="force",
    show_default=True,
    help="Pusher in the experiment: a force applied directly, the robot within its reach, or one "
    "after the other.",
)
@scene_option
@seed_option
@click.option(
    "--workers", type=click.IntRange(1), help="Number of processes; default: one per processor."
)
@click.option(
    "--record",
    type=FILE,
    help="Record of the experiment, to continue from; default: beside the output.",
)
@lying_option
@json_option
@click.pass_context
def command(
    ctx: click.Context,
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
    model_file: Path | None,
    experiment: bool,
    by: Way | Literal["both"],
    scene: str,
    seed: int,
    workers: int | None,
    record: Path | None,
    lying_on: str,
    as_json: bool,
) -> int:
    """Map the outcomes of pushes all over a face of OBJECT.

    The map also shows the force of each push. --experiment simulates the pushes on the true object
    of the scene.
    """
    # Refuse options that say nothing, with the experiment or without it.
    apart = ("straight", "solid", "lying_on")
    belong = ("by", "scene", "seed", "workers", "record")
    for param in ctx.command.params:
        given = ctx.get_parameter_source(param.name or "") is click.core.ParameterSource.COMMANDLINE
        if given and experiment and param.name in apart:
            raise click.UsageError(
                f"{param.opts[0]} does not go with --experiment: there the object stands in its "
                "scene and may turn"
            )
        if given and not experiment and param.name in belong:
            raise click.UsageError(f"{param.opts[0]} belongs to --experiment")
    for output in outputs:
        require_writable(output)
        if output.suffix not in (*_PICTURES, ".csv", ".json"):
            raise click.UsageError(f"{output}: the ending must be .png, .svg, .pdf, .csv or .json")
    wanted: dict[str, Any] = {
        "direction": direction,
        "spacing": 1e-3 * spacing,
        "band": 1e-2 * band,
        "level": level,
    }
    if experiment:
        record = record or (outputs[0].with_suffix(".touches.jsonl") if outputs else None)
        require_writable(record)
        ways: tuple[Way, ...] = ("force", "robot") if by == "both" else (by,)
        found = _run_experiments(name, face, model_file, wanted, scene, ways, seed, workers, record)
        return _answer_comparison(found, outputs, shaded=shade, as_json=as_json)
    from objectmodels.mechanics.outcome_map import outcome_map

    model, side = find_model_and_face(name, face, lying_on, model_file)
    chart = outcome_map(model, side, turning=not straight, **wanted)
    return _answer_map(chart, face, outputs, solid=solid, shaded=shade, as_json=as_json)


def _answer_map(
    chart: OutcomeMap,
    face: str,
    outputs: tuple[Path, ...],
    *,
    solid: bool,
    shaded: bool,
    as_json: bool,
) -> int:
    from nlcontrol.outcome_maps import outcome_map_table as maps
    from nlcontrol.outcome_maps.outcome_map_drawing import save_map

    return _write_and_print(
        maps.map_document(chart, face),
        maps.map_lines(chart, face),
        outputs,
        partial(save_map, chart, face, solid=solid, shaded=shaded),
        partial(maps.save_table, chart, face),
        as_json,
    )


def _answer_comparison(
    found: tuple[Comparison, ...], outputs: tuple[Path, ...], *, shaded: bool, as_json: bool
) -> int:
    from nlcontrol.outcome_maps import face_experiment as comparison
    from nlcontrol.outcome_maps.outcome_map_drawing import save_comparison

    return _write_and_print(
        comparison.comparison_document(found),
        comparison.comparison_lines(found),
        outputs,
        partial(save_comparison, found, shaded=shaded),
        partial(comparison.save_table, found),
        as_json,
    )


def _write_and_print(
    document: dict[str, Any],
    lines: list[str],
    outputs: tuple[Path, ...],
    draw: Callable[[Path], None],
    tabulate: Callable[[Path], None],
    as_json: bool,
) -> int:
    """Write the files and print the answer."""
    for output in outputs:
        with replace_file(output) as path:
            if output.suffix in _PICTURES:
                draw(path)
            elif output.suffix == ".csv":
                tabulate(path)
            else:
                text = document_text(document, indent=1)
                path.write_text(text + "\n", encoding="utf-8")
    lines += [f"Map: {output}" for output in outputs]
    return print_answer(document, lines, as_json=as_json)


def _run_experiments(
    name: str,
    face: str,
    model_file: Path | None,
    wanted: dict[str, Any],
    scene: str,
    ways: tuple[Way, ...],
    seed: int,
    workers: int | None,
    record: Path | None,
) -> tuple[Comparison, ...]:
    """The experiment each way, carried out as far as it was not yet, and the prediction."""
    from nlcontrol.outcome_maps.face_experiment import (
        Comparison,
        FaceExperiment,
        Record,
        contacts_of,
        object_on_table,
    )
    from nlcontrol.references.object_names import face_of
    from nlcontrol.session.controller import Controller
    from objectmodels.mechanics.outcome_map import outcome_map
    from objectmodels.registry.model_registry import load_model
    from sim.simulated_executor import simulation

    controller = Controller(scene, registry=open_registry(), seed=seed)
    item = object_on_table(name, controller.cell, controller.models, controller.registry)
    model = controller.models[item.name]
    if model_file is not None:
        model = load_model(model_file, controller.registry.kinds)
    chart = outcome_map(model, face_of(model, face), **wanted)
    contacts = contacts_of(chart, item.name, face)
    kept = Record(record) if record else None
    found = []
    for by in ways:
        experiment = FaceExperiment(
            simulation(controller.executor).scene,
            contacts,
            by=by,
            believed=controller.models,
            seed=seed,
            record=kept,
        )
        if known := len(contacts) - len(experiment.missing):
            click.echo(f"{known} of {len(contacts)} results are in {record} already", err=True)
        with Progress("pushes" if by == "force" else "pushes by the robot") as progress:
            results = experiment.run(workers=workers, report=progress)
        scene_name = controller.cell.name
        found.append(Comparison(chart, results, item.name, face, scene_name, by, seed))
    return tuple(found)
