"""`objects`: the models that the robot knows."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from nlcontrol.cli.console.command_options import complete_objects, open_registry
from nlcontrol.cli.console.console_output import (
    FILE,
    json_option,
    print_answer,
    print_json,
    print_lines,
)
from nlcontrol.errors import CODES, OK, ErrorInfo, error, exception_info
from nlcontrol.text_format import error_lines, join_words

if TYPE_CHECKING:
    from objectmodels import ModelError, ObjectModel, Registry
    from objectmodels.descriptions.description_reading import Format

_name_argument = click.argument("name", shell_complete=complete_objects)


@click.group("objects")
def group() -> None:
    """List, show, add and check the object models that the robot knows."""


@group.command("list")
@json_option
def list_models(as_json: bool) -> int:
    """List the models of the registry with their sources."""
    registry = open_registry()
    document = {"objects": [_document(registry, model) for model in registry]}
    lines = (
        f"{model.name:16} {_size_text(model):20} {model.mass:.3f} kg  μ {model.friction:.3f}  "
        f"{_origin_text(registry, model.name)}"
        for model in registry
    )
    return print_answer(document, lines, as_json=as_json)


@group.command("show")
@_name_argument
@json_option
def show_model(name: str, as_json: bool) -> int:
    """Show what is believed about the object NAME, with the source of each figure."""
    registry = open_registry()
    model = registry.find_one(name)
    lines = _model_lines(model, _origin_text(registry, model.name))
    return print_answer(_document(registry, model), lines, as_json=as_json)


@group.command("validate")
@click.argument("files", nargs=-1, required=True, type=FILE)
@json_option
def validate_files(files: tuple[Path, ...], as_json: bool) -> int:
    """Check model FILES without adding them."""
    from objectmodels import ModelError
    from objectmodels.registry.model_registry import load_model

    registry = open_registry()
    verdicts = []
    for file in files:
        try:
            model = load_model(file, registry.kinds)
        except ModelError as problem:
            verdicts.append({"file": str(file), "ok": False, "error": str(problem)})
        else:
            verdicts.append({"file": str(file), "ok": True, "name": model.name})
    ok = all(verdict["ok"] for verdict in verdicts)
    if as_json:
        fault = {} if ok else {"error": _fault(len(verdicts)).model_dump(mode="json")}
        print_json({"ok": ok, "files": verdicts, **fault})
    else:
        for verdict in verdicts:
            mark = f"{verdict['file']}: a good model of {verdict.get('name')!r}"
            line = mark if verdict["ok"] else str(verdict["error"])
            print_lines([line], err=not verdict["ok"])
    return OK if ok else CODES["bad_model_file"].exit


@group.command("check")
@click.argument("entry")
@json_option
def check_plugin(entry: str, as_json: bool) -> int:
    """Test the models of a plug-in: do its predictions fit an object on a table?

    ENTRY is the name of an entry point or an installed package, or the object itself in the form
    of an entry point: my_shapes:CartonModel.
    """
    from objectmodels import Registry
    from objectmodels.registry.model_checks import model_faults

    sys.path.append(str(Path.cwd()))  # where a module is that is not installed yet
    registry = Registry.of_plugin(entry)
    told: list[tuple[str, str, ModelError | None]]
    told = [(entry, "loads", problem) for problem in registry.problems]
    told += [(m.name, check, f) for m in registry for check, f in model_faults(m).items()]
    if not told:
        raise error(
            "no_models",
            f"{entry} brings no model that could be tested",
            suggestions=("let it bring a model file of its kind too",),
        )
    rows = [(name, check, exception_info(f) if f else None) for name, check, f in told]
    faults = [info for *_, info in rows if info]
    if as_json:
        checks = [
            {
                "object": name,
                "check": check,
                "error": info.model_dump(mode="json") if info else None,
            }
            for name, check, info in rows
        ]
        fault = {"error": faults[0].model_dump(mode="json")} if faults else {}
        print_json({"ok": not faults, "checks": checks, **fault})
    else:
        for name, check, info in rows:
            below = (f"    {line}" for line in error_lines(info)) if info else ()
            print_lines([f"{'✗' if info else '✓'} {name}: {check}", *below])
    return faults[0].status.exit if faults else OK


@group.command("add")
@click.argument("file", type=FILE)
@click.option(
    "--name", help="Name of the object in a URDF, SDF or MJCF file; default: the file's own."
)
@click.option("--mass", type=float, help="Mass [kg], if the file has none.")
@click.option("--friction", type=float, help="Friction coefficient at the table, if known.")
@json_option
def add_model(
    file: Path, name: str | None, mass: float | None, friction: float | None, as_json: bool
) -> int:
    """Add the model FILE to your own models.

    FILE is a model file, or a URDF, SDF or MJCF file with one rigid object.
    """
    from objectmodels.descriptions.description_import import import_description
    from objectmodels.descriptions.description_reading import FILE_ENDINGS
    from objectmodels.registry.model_registry import load_model

    registry = open_registry()
    if file.suffix.lower() in FILE_ENDINGS:
        model = import_description(file, name=name, mass=mass, friction=friction)
        return _keep_model(registry, model, as_json)
    if (name, mass, friction) != (None, None, None):
        raise click.UsageError("a model file states name, mass and friction itself")
    return _keep_model(registry, load_model(file, registry.kinds), as_json)


@group.command("import")
@click.argument("mesh", type=FILE)
@click.option("--name", required=True, help="Name of the object.")
@click.option("--mass", type=float, help="Mass [kg].")
@click.option("--density", type=float, help="Mean density [kg/m³], instead of the mass.")
@click.option("--friction", type=float, help="Friction coefficient at the table, if known.")
@click.option("--synonym", "synonyms", multiple=True, help="Another name for it. May be repeated.")
@click.option(
    "--unit",
    default="m",
    show_default=True,
    type=click.Choice(["m", "cm", "mm", "in"]),
    help="Length unit of the mesh.",
)
@click.option(
    "--up",
    default="+z",
    show_default=True,
    type=click.Choice(["+x", "-x", "+y", "-y", "+z", "-z"]),
    help="Axis of the mesh that points upwards.",
)
@click.option(
    "--hull", is_flag=True, help="Use the convex hull even if a box, cylinder or prism fits."
)
@click.option("--output", type=FILE, help="Write the model file here instead of your own models.")
@json_option
def import_mesh_file(
    mesh: Path,
    name: str,
    mass: float | None,
    density: float | None,
    friction: float | None,
    synonyms: tuple[str, ...],
    unit: str,
    up: str,
    hull: bool,
    output: Path | None,
    as_json: bool,
) -> int:
    """Make a model from a MESH file: find its shape, base, volume and centre of mass.

    STL, OBJ, PLY and others; needs the extra `mesh`. Asks for the mass if neither mass nor density
    is given.
    """
    from objectmodels.descriptions.mesh_import import import_mesh
    from objectmodels.registry.model_registry import save_model

    if mass is None and density is None:
        if as_json or not sys.stdin.isatty():
            raise click.UsageError("state --mass or --density")
        mass = click.prompt("Mass of the object [kg]", type=float)
    model = import_mesh(
        mesh,
        name=name,
        mass=mass,
        density=density,
        friction=friction,
        synonyms=synonyms,
        unit=unit,
        up=up,
        hull=hull,
    )
    registry = open_registry()
    if output is None:
        return _keep_model(registry, model, as_json)
    save_model(model, output)
    return _print_written(model, output, as_json)


@group.command("export")
@_name_argument
@click.option(
    "--format",
    "form",
    required=True,
    type=click.Choice(["mjcf", "sdf", "urdf"]),
    help="Format of the file.",
)
@click.option(
    "--output",
    type=click.Path(path_type=Path, file_okay=False),
    default=".",
    help="Folder for the file, and for a mesh if the shape needs one.",
)
@json_option
def export_model(name: str, form: Format, output: Path, as_json: bool) -> int:
    """Export the object NAME for another simulator: inertia, feet and friction."""
    from objectmodels.descriptions.description_reading import write_description

    model = open_registry().find_one(name)
    files = [str(path) for path in write_description(model, form, output)]
    document = {"ok": True, "name": model.name, "files": files}
    return print_answer(document, [f"wrote {file}" for file in files], as_json=as_json)


@group.command("remove")
@_name_argument
@json_option
def remove_model(name: str, as_json: bool) -> int:
    """Remove the object NAME from your own models."""
    from objectmodels.registry.model_registry import remove_model as remove_own_model

    removed, place = remove_own_model(name)
    document = {"ok": True, "removed": removed, "file": str(place)}
    return print_answer(document, [f"removed {removed}: {place}"], as_json=as_json)


def _fault(count: int) -> ErrorInfo:
    """The error of files that were checked, of which one or more are no good."""
    return ErrorInfo(
        code="bad_model_file",
        message=f"not all of {count} files are good models" if count > 1 else "no good model",
        suggestions=("`files` says what is wrong with each of them",),
    )


def _keep_model(registry: Registry, model: ObjectModel, as_json: bool) -> int:
    """Write a model into the user's folder, unless its names are taken."""
    from objectmodels.registry.model_registry import store_model

    path, _ = store_model(registry, model)
    # A command that pushes an object of the user's own, on a table with room for it.
    from sim.truth.scene_file import free_place, load_scene

    place = free_place(load_scene("kitchen"), model)
    put = "NAME@X,Y" if place is None else f"{model.name}@{place.x_m:g},{place.y_m:g}"
    return _print_written(
        model, path, as_json, f'nlcontrol say "push the {model.name} away" --put "{put}"'
    )


def _document(registry: Registry, model: ObjectModel) -> dict[str, Any]:
    """A model with where it comes from and whose place it took, for JSON."""
    origin = {
        "place": registry.place(model.name),
        "instead_of": registry.replaced_place(model.name),
    }
    return {**model.model_dump(mode="json"), **origin}


def _origin_text(registry: Registry, name: str) -> str:
    replaced = registry.replaced_place(name)
    return registry.place(name) + (f", instead of: {replaced}" if replaced else "")


def _print_written(
    model: ObjectModel, path: Path, as_json: bool, next_command: str | None = None
) -> int:
    document = {"ok": True, "name": model.name, "file": str(path), "next": next_command}
    lines = [f"wrote {path}", *_model_lines(model, str(path))]
    if next_command:
        lines.append(f"next: {next_command}")
    return print_answer(document, lines, as_json=as_json)


def _model_lines(model: ObjectModel, place: str) -> list[str]:
    from objectmodels.registry.model_registry import kind_of

    places = zip(model.com, model.com_sd, strict=True)
    centre = [f"{1e3 * c:z.0f} ± {1e3 * sd:.0f}" for c, sd in places]
    radius, radius_sd = 1e3 * model.friction_radius, 1e3 * model.friction_radius_sd
    rows = [
        ("kind", f"{kind_of(model)}, stands on {_base_text(model)}"),
        ("size", _size_text(model)),
        ("mass", f"{model.mass:.4f} ± {model.mass_sd:.4f} kg"),
        ("friction, table", f"{model.friction:.4f} ± {model.friction_sd:.4f}"),
        ("friction, finger", f"{model.finger_friction:.3f} ± {model.finger_friction_sd:.3f}"),
        ("centre of mass", f"{', '.join(centre)} mm from the middle of the base"),
        ("friction radius", f"{radius:.1f} ± {radius_sd:.1f} mm"),
        ("also called", ", ".join(model.synonyms) or "–"),
        ("from", place),
        ("source", model.provenance.source),
        ("method", " ".join(model.provenance.method.split())),
    ]
    if model.friction_kinetic is not None:
        rows.insert(4, ("friction, sliding", f"{model.friction_kinetic:.4f}"))
    # Above which height a level push in the middle of each face topples it.
    from nlcontrol.references.object_names import face_names

    found: dict[str, list[str]] = {}
    for name, face in face_names(model).items():
        points, normals = face.points_at([0.0], [0.5 * (face.bottom + face.top)])
        height = float(model.cone_thresholds(points, normals).critical_height[0])
        verdict = f"topples above {1e3 * height:.0f} mm" if height < face.top else "never topples"
        found.setdefault(verdict, []).append(name)
    rows += [
        ("pushed level", f"{verdict}, in the middle of {join_words(names)}")
        for verdict, names in found.items()
    ]
    return [model.name, *(f"  {key:24} {value}" for key, value in rows)]


def _size_text(model: ObjectModel) -> str:
    return " × ".join(f"{1e3 * side:.0f}" for side in model.extents) + " mm"


def _base_text(model: ObjectModel) -> str:
    if not isinstance(model.support, str):
        return f"{len(model.support)} points"
    how = {"uniform": "evenly pressed", "corners": "on its corners"}[model.support]

    if model.base.is_round:
        return f"a round base, {'on its rim' if model.support == 'corners' else how}"
    return f"{len(model.base.corners)} edges, {how}"
