"""Keeping a fitted model among the user's own, so that the robot goes by it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from nlcontrol.errors import error

if TYPE_CHECKING:
    from objectmodels import ObjectModel, Registry


def rename_model(model: ObjectModel, name: str) -> ObjectModel:
    """The model under another name; its synonyms stay with the model that they belong to.

    Raises:
        ControlError: `usage` if it cannot be a name.
    """
    from pydantic import TypeAdapter, ValidationError

    from objectmodels.models.parameters import Word

    try:
        TypeAdapter(Word).validate_python(name, strict=True)
    except ValidationError as wrong:
        raise error("usage", f"{name!r} cannot be a name") from wrong
    return model.model_copy(update={"name": name, "synonyms": ()})


def storage_path(registry: Registry, model: ObjectModel) -> Path:
    """Puts a model into a registry, over the user's own one of that name, and names its file.

    Nothing is written: on a copy of the registry this tells beforehand whether it can be kept.

    Raises:
        ModelError: `duplicate_name` if it is called as another model's synonym.
        ControlError: `cannot_write` if the file is there and holds another model.
    """
    from objectmodels.registry.model_registry import user_file, user_folder

    path = user_file(model.name)
    own = Path(registry.place(model.name)) if model.name in registry else None
    if own is not None and own.parent == user_folder():
        path = own
    elif path.exists():
        raise error("cannot_write", f"cannot write {path}: it holds another model")
    registry.add(model, place=str(path), over=registry.names())
    return path


def store_model(registry: Registry, model: ObjectModel) -> tuple[Path, str | None]:
    """Writes a model into the user's folder, over the user's own one of that name.

    Returns:
        The file, and where the model comes from whose place it takes, if not the user's own.

    Raises:
        ModelError: as `placed`; `cannot_write`.
        ControlError: as `placed`.
    """
    from objectmodels.registry.model_files import save_model

    path = storage_path(registry, model)
    save_model(model, path)
    replaced = registry.replaced_place(model.name)
    return path, None if replaced == str(path) else replaced
