"""Options that commands share: of the world and its defaults, of object models and faces."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.shell_completion import CompletionItem

from nlcontrol.cli.console.console_output import FILE, Command, print_skipped
from nlcontrol.errors import known_errors_raised

if TYPE_CHECKING:
    from nlcontrol.session.controller import Controller
    from objectmodels import Face, ObjectModel, Registry
    from sim.truth.scene_file import Scene


# What a shell offers at the tab key: names of scenes, objects, faces and defaults.


def complete_scenes(
    _ctx: click.Context, _param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """The built-in scenes that begin so; files, if there is none."""
    from sim.truth.scene_file import built_in_scenes

    return _beginning(built_in_scenes(), incomplete) or [CompletionItem(incomplete, type="file")]


def complete_objects(
    _ctx: click.Context, _param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """The models of the registry that begin so."""
    from objectmodels import Registry

    return _beginning((model.name for model in Registry.default()), incomplete)


def complete_faces(
    ctx: click.Context, _param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """The faces that begin so, of the object that was named before."""
    from nlcontrol.references.object_names import face_names
    from objectmodels import ModelError, Registry

    # An option whose value is being typed is not read whole, nor then is the argument before it.
    name = ctx.params.get("name") or next(iter(ctx.args), "")
    try:
        faces = face_names(Registry.default().find_one(name))
    except ModelError:
        return []
    return _beginning(faces, incomplete)


def complete_defaults(
    _ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """The names of defaults that begin so; of an option that sets them, with an equals sign."""
    from planner.types.defaults import settings

    sign = "=" if isinstance(param, click.Option) else ""
    return _beginning((each.name + sign for each in settings()), incomplete)


def _beginning(names: Iterable[str], incomplete: str) -> list[CompletionItem]:
    # Bash alone takes a word as it is: other shells put marks around one with spaces themselves.
    in_bash = os.environ.get("_NLCONTROL_COMPLETE", "").startswith("bash")
    begun = incomplete.casefold()
    found = [name for name in names if name.casefold().startswith(begun)]
    return [CompletionItem(shlex.quote(name) if in_bash else name) for name in found]


Settings = tuple[tuple[str, float], ...]
Placed = tuple[str, float, float, float]


class Assignment(click.ParamType[tuple[str, float]]):
    """A name and a number, or a word for one, with an equals sign between them."""

    name = "name=value"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, float]:
        """Read the name and the number."""
        from planner.types.defaults import CLEARED

        if isinstance(value, tuple):
            return value
        name, _, number = str(value).partition("=")
        if number in CLEARED:
            return name.strip(), float(CLEARED.index(number))
        try:
            return name.strip(), float(number)
        except ValueError:
            self.fail(f"{value!r} is not a name and a number, like distance_m=0.15", param, ctx)


class Placement(click.ParamType["Placed"]):
    """A name and a place on the table with an at sign between them."""

    name = "name@x,y"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> Placed:
        """Read the name, x and y [m] and the heading [degrees], 0 if not given."""
        if isinstance(value, tuple):
            return value
        name, _, place = str(value).rpartition("@")
        numbers = place if place.count(",") == 2 else f"{place},0"
        try:
            x, y, yaw = map(float, numbers.split(","))
        except ValueError:
            self.fail(f"{value!r} is no name and place, like crate@0.5,0.1", param, ctx)
        if not (abs(x) <= 10.0 and abs(y) <= 10.0 and abs(yaw) <= 360.0):
            self.fail(f"{value!r} is in metres and degrees, like crate@0.5,0.1,45", param, ctx)
        return name.strip(), x, y, yaw


scene_option = click.option(
    "--scene",
    default="kitchen",
    show_default=True,
    shell_complete=complete_scenes,
    help="A built-in scene, or a scene file.",
)
seed_option = click.option(
    "--seed", default=0, show_default=True, type=click.IntRange(0), help="Seed of all randomness."
)
set_option = click.option(
    "--set",
    "settings",
    type=Assignment(),
    multiple=True,
    metavar="NAME=VALUE",
    shell_complete=complete_defaults,
    help="Set a default, e.g. distance_m=0.15 (see `nlcontrol defaults`). May be repeated.",
)


put_option = click.option(
    "--put",
    type=Placement(),
    multiple=True,
    metavar="NAME@X,Y",
    help="Add an object, true to its model, at x, y [m]; a third number is its heading [degrees]. "
    "May be repeated.",
)


motion_option = click.option(
    "--motion",
    type=click.Choice(["never", "simulate"]),
    help="never: nothing moves, as with --plan-only. simulate: questions may touch objects too, "
    "for better answers.",
)


time_limit_option = click.option(
    "--time-limit",
    type=click.FloatRange(0.0, min_open=True),
    metavar="SECONDS",
    help="Stop planning after this many seconds (wall clock).",
)


def world_options(command: Command) -> Command:
    """Add --scene, --seed and --set, as `scene`, `seed` and `settings`."""
    for option in (set_option, seed_option, scene_option):
        command = option(command)
    return command


def open_controller(
    scene: str,
    seed: int,
    settings: Settings,
    time_limit: float | None = None,
    put: Sequence[Placed] = (),
) -> Controller:
    """The controller that the options ask for; the settings go on top of the scene's defaults.

    Raises:
        ControlError: the scene cannot be read, a default is none, or there is no room for what is
            to be put there.
    """
    from nlcontrol.session.controller import Controller
    from planner.types.defaults import with_settings
    from sim.truth.scene_file import load_scene

    with known_errors_raised():
        loaded = load_scene(scene)
        defaults = with_settings(loaded.defaults, dict(settings))
        if put:
            loaded = scene_with_objects(loaded, put)
    return Controller(loaded, seed=seed, defaults=defaults, time_limit=time_limit)


def scene_with_objects(scene: Scene, put: Sequence[Placed]) -> Scene:
    """The scene with objects of the registry put there.

    Raises:
        ModelError: there is no such model.
        SceneError: there is no room for one.
    """
    from objectmodels import Registry
    from sim.truth.scene_file import Pose, scene_with_object

    registry = Registry.default()
    for path in scene.models:
        registry.load(path)
    for name, x, y, yaw in put:
        pose = Pose(x_m=x, y_m=y, yaw_deg=yaw)
        scene = scene_with_object(scene, registry.find_one(name), pose)
    return scene


object_argument = click.argument("name", metavar="OBJECT", shell_complete=complete_objects)
face_option = click.option(
    "--face",
    default="front",
    show_default=True,
    shell_complete=complete_faces,
    help="Face that is pushed, as seen from the robot.",
)
lying_option = click.option(
    "--lying-on",
    default="bottom",
    shell_complete=complete_faces,
    help="Face that the object lies on, e.g. left for a box.",
)


class Numbers(click.ParamType[tuple[float, ...]]):
    """So many numbers with commas between them."""

    name = "numbers"

    def __init__(self, count: int) -> None:
        self.count = count

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        """Read the numbers."""
        if isinstance(value, tuple):
            return value
        try:
            numbers = tuple(float(part) for part in str(value).split(","))
        except ValueError:
            numbers = ()
        if len(numbers) != self.count or not all(abs(x) <= 1e6 for x in numbers):
            self.fail(f"{value!r} is not {self.count} numbers with commas between them", param, ctx)
        return numbers


class ParameterNames(click.ParamType[tuple[str, ...]]):
    """Names of parameters with commas between them."""

    name = "names"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, ...]:
        """Read the names; `centre_of_mass` stands for its three coordinates."""
        from objectmodels.errors import suggest
        from objectmodels.geometry.pushed_body import UNCERTAIN

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


def keep_options(command: Command) -> Command:
    """Add the options that keep a fitted model: `--save` and `--output`."""
    output = click.option("--output", type=FILE, help="Write the fitted model to a file (.yaml).")
    save = click.option(
        "--save",
        "saved_as",
        is_flag=False,
        flag_value="",
        metavar="[NAME]",
        help="Save the fitted model among your own, under its name or another; the robot then "
        "uses it.",
    )
    return save(output(command))


def open_registry() -> Registry:
    """The default registry; what it had to skip is printed on standard error."""
    from objectmodels import Registry

    registry = Registry.default()
    print_skipped(registry.problems)
    return registry


def find_model_and_face(
    name: str, face: str, lying_on: str, file: Path | None = None
) -> tuple[ObjectModel, Face]:
    """The model of an object, lying on a face of it, and the face of another name.

    A model file takes the place of the registry's model.
    """
    from nlcontrol.references.object_names import face_of

    model = find_model(name, lying_on, file)
    return model, face_of(model, face)


def find_model(name: str, lying_on: str, file: Path | None = None) -> ObjectModel:
    """The model of an object, lying on a face of it; that of a file in place of the registry's."""
    from objectmodels.registry.model_registry import load_model

    registry = open_registry()
    model = load_model(file, registry.kinds) if file else registry.find_one(name)
    return model if lying_on == "bottom" else model.model_on_face(lying_on)
