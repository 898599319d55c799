"""Options of the commands that need a world: its scene, its seed, and what words mean in it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from nlcontrol.session.controller import Controller

Command = TypeVar("Command", bound=Callable[..., Any])
Settings = tuple[tuple[str, float], ...]


class Assignment(click.ParamType[tuple[str, float]]):
    """A name and a number with an equals sign between them."""

    name = "name=value"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, float]:
        """Read the name and the number."""
        if isinstance(value, tuple):
            return value
        name, _, number = str(value).partition("=")
        try:
            return name.strip(), float(number)
        except ValueError:
            self.fail(f"{value!r} is not a name and a number, like distance_m=0.15", param, ctx)


scene_option = click.option(
    "--scene", default="kitchen", show_default=True, help="A built-in scene, or a scene file."
)
seed_option = click.option(
    "--seed", default=0, show_default=True, type=click.IntRange(0), help="Of everything random."
)
set_option = click.option(
    "--set",
    "settings",
    type=Assignment(),
    multiple=True,
    metavar="NAME=VALUE",
    help="Set a default, e.g. distance_m=0.15; may be repeated. `nlcontrol defaults` lists them.",
)


def world_options(command: Command) -> Command:
    """Add --scene, --seed and --set, as `scene`, `seed` and `settings`."""
    for option in (set_option, seed_option, scene_option):
        command = option(command)
    return command


def open_controller(scene: str, seed: int, settings: Settings) -> Controller:
    """The controller that the options ask for.

    Args:
        scene: name or file.
        seed: of everything random.
        settings: defaults to be set, on top of the scene's.

    Raises:
        ControlError: the scene cannot be read, or a default is none.
    """
    from nlcontrol.errors import translated
    from nlcontrol.session.controller import Controller
    from planner.types.default_settings import changed
    from sim.truth.scene_file import load_scene

    with translated():
        loaded = load_scene(scene)
        defaults = changed(loaded.defaults, dict(settings))
    return Controller(loaded, seed=seed, defaults=defaults)
