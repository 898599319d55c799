"""`fit`: an object's parameters from a real robot's data files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from nlcontrol.cli.console_output import print_json, require_writable
from nlcontrol.cli.objects_command import registry_told
from nlcontrol.errors import OK
from nlcontrol.learning.model_store import kept, renamed

if TYPE_CHECKING:
    from objectmodels import ObjectModel, Registry

Function = TypeVar("Function", bound=Callable[..., Any])

_File = click.Path(dir_okay=False, path_type=Path)


class ParameterNames(click.ParamType[tuple[str, ...]]):
    """Names of parameters with commas between them."""

    name = "names"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, ...]:
        """Reads them; `centre_of_mass` stands for its three coordinates."""
        from objectmodels.geometry.mechanical import UNCERTAIN
        from objectmodels.name_suggestions import suggest

        if isinstance(value, tuple):
            return value
        names: list[str] = []
        for word in str(value).replace(" ", "").split(","):
            if word == "centre_of_mass":
                names += ["com_x", "com_y", "com_z"]
            elif word in UNCERTAIN:
                names.append(word)
            else:
                known = (*UNCERTAIN, "centre_of_mass")
                near = [f"did you mean {name!r}?" for name in suggest(word, known)[:1]]
                hint = near[0] if near else f"known: {', '.join(known)}"
                self.fail(f"{word!r} is no parameter; {hint}", param, ctx)
        return tuple(dict.fromkeys(names))


def keeping(function: Function) -> Function:
    """Options that keep a fitted model: `--save` and `--output`."""
    output = click.option("--output", type=_File, help="Write the fitted model to a file (.yaml).")
    save = click.option(
        "--save",
        "saved_as",
        is_flag=False,
        flag_value="",
        metavar="[NAME]",
        help="Keep the fitted model among your own, under its name or another: the robot goes by "
        "it.",
    )
    return save(output(function))


@click.command("fit")
@click.argument("name", metavar="OBJECT")
@click.argument("files", metavar="DATA.csv...", nargs=-1, required=True, type=_File)
@click.option(
    "--parameters",
    type=ParameterNames(),
    metavar="NAME,NAME",
    help="What to find: mass, friction, finger_friction, friction_radius, centre_of_mass (or "
    "com_x, com_y, com_z). By default all that the data tell.",
)
@keeping
@click.option("--json", "as_json", is_flag=True, help="Answer with one JSON document.")
def command(
    name: str,
    files: tuple[Path, ...],
    parameters: tuple[str, ...] | None,
    saved_as: str | None,
    output: Path | None,
    as_json: bool,
) -> int:
    """Find the parameters of OBJECT from data of a real robot.

    OBJECT is a model that the robot knows, or a model file: its shape and what is not found are
    taken from there. The columns of the data files are explained in docs/fitting.md.
    """
    from nlcontrol.learning.log_fitting import fit_files, report_lines
    from objectmodels.registry.model_files import save_model

    _require_sensible(files, saved_as, output)
    registry = registry_told()
    found = fit_files(_model(registry, name), files, parameters)
    model = found.model if not saved_as else renamed(found.model, saved_as)
    # Both are written only now that nothing can fail any more but the writing itself.
    path, instead = (None, None) if saved_as is None else kept(registry, model)
    if output is not None:
        save_model(model, output)
    written = {"saved": _told(path), "output": _told(output), "instead_of": instead}
    report = found.report.model_copy(update=written)
    if as_json:
        print_json(report.model_dump(mode="json"))
        return OK
    for line in report_lines(report):
        click.echo(line)
    return OK


def _require_sensible(files: tuple[Path, ...], saved_as: str | None, output: Path | None) -> None:
    """Refuses options that cannot be meant, before the fit."""
    if saved_as and (saved_as.endswith(".csv") or Path(saved_as).is_file()):
        message = f"--save takes a name, not the file {saved_as}: put --save last, or --save=NAME"
        raise click.UsageError(message)
    if len({file.resolve() for file in files}) < len(files):
        raise click.UsageError("a data file is given twice, and would count twice")
    if output is not None and output.suffix not in (".yaml", ".yml"):
        raise click.UsageError(f"{output}: the ending must be .yaml")
    require_writable(output)


def _model(registry: Registry, name: str) -> ObjectModel:
    """The model of a name, or of a model file."""
    from objectmodels.registry.model_files import load_model

    if name.endswith((".yaml", ".yml")):
        return load_model(Path(name), registry.kinds)
    return registry.called(name)


def _told(path: Path | None) -> str | None:
    return None if path is None else str(path)
