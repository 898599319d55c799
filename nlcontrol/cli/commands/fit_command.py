"""`fit`: an object's parameters from a real robot's data files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from nlcontrol.cli.console.command_options import (
    ParameterNames,
    keep_options,
    object_argument,
    open_registry,
)
from nlcontrol.cli.console.console_output import FILE, json_option, print_answer, require_writable

if TYPE_CHECKING:
    from objectmodels import ObjectModel, Registry


@click.command("fit")
@object_argument
@click.argument("files", metavar="DATA.csv...", nargs=-1, required=True, type=FILE)
@click.option(
    "--parameters",
    type=ParameterNames(),
    metavar="NAME,NAME",
    help="Parameters to identify: mass, friction, finger_friction, friction_radius, "
    "centre_of_mass (or com_x, com_y, com_z); default: all that the data determine.",
)
@keep_options
@json_option
def command(
    name: str,
    files: tuple[Path, ...],
    parameters: tuple[str, ...] | None,
    saved_as: str | None,
    output: Path | None,
    as_json: bool,
) -> int:
    """Identify the parameters of OBJECT from data of a real robot.

    OBJECT is a model that the robot knows, or a model file: its shape and what is not found are
    taken from there. The columns of the data files are explained in docs/fitting.md.
    """
    from nlcontrol.learning.log_fitting import fit_files, report_lines
    from objectmodels.registry.model_registry import rename_model, save_model, store_model

    # Refuse options that cannot be meant, before the fit.
    if saved_as and (saved_as.endswith(".csv") or Path(saved_as).is_file()):
        message = f"--save takes a name, not the file {saved_as}: put --save last, or --save=NAME"
        raise click.UsageError(message)
    if len({file.resolve() for file in files}) < len(files):
        raise click.UsageError("a data file is given twice, and would count twice")
    if output is not None and output.suffix not in (".yaml", ".yml"):
        raise click.UsageError(f"{output}: the ending must be .yaml")
    require_writable(output)
    registry = open_registry()
    model, report = fit_files(_find_model(registry, name), files, parameters)
    model = rename_model(model, saved_as) if saved_as else model
    # Both are written only now that nothing can fail any more but the writing itself.
    path, instead = (None, None) if saved_as is None else store_model(registry, model, replace=True)
    if output is not None:
        save_model(model, output)
    saved, written = (None if file is None else str(file) for file in (path, output))
    report = report.model_copy(update={"saved": saved, "output": written, "instead_of": instead})
    return print_answer(report.model_dump(mode="json"), report_lines(report), as_json=as_json)


def _find_model(registry: Registry, name: str) -> ObjectModel:
    """The model of a name, or of a model file."""
    from objectmodels.registry.model_registry import load_model

    if name.endswith((".yaml", ".yml")):
        return load_model(Path(name), registry.kinds)
    return registry.find_one(name)
