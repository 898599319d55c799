"""What a shell offers at the tab key: names of scenes, objects, faces and defaults."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable

import click
from click.shell_completion import CompletionItem


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
