"""The user's own models: how one is put among them, and taken away again.

Every change is made under a lock of the folder, on what stands in it then, so that of several
processes none undoes what another one did.
"""

from __future__ import annotations

from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from objectmodels.errors import ModelError
from objectmodels.files.file_writing import lock_folder, remove_file
from objectmodels.files.validation_faults import short_text
from objectmodels.files.value_types import Name
from objectmodels.models.object_model import ObjectModel
from objectmodels.registry.model_files import save_model
from objectmodels.registry.model_registry import Registry
from objectmodels.registry.user_folder import free_file, user_folder


def place_model(registry: Registry, model: ObjectModel, *, replace: bool = False) -> Path:
    """Puts a model into a registry as one of the user's own, and names the file for it.

    Nothing is written: on a copy of a registry this tells beforehand whether it can be kept. The
    file is a new one, unless it replaces the user's own model of that name.

    Args:
        registry: takes the model.
        model: the model.
        replace: whether it takes the place of a model of that very name.

    Raises:
        ModelError: `duplicate_name` if a name of it is taken otherwise.
    """
    own = replace and model.name in registry and _is_own(Path(registry.place(model.name)))
    path = Path(registry.place(model.name)) if own else free_file(model.name)
    registry.add(model, place=str(path), over=registry.names() if replace else ())
    return path


def store_model(
    registry: Registry, model: ObjectModel, *, replace: bool = False
) -> tuple[Path, str | None]:
    """Puts a model among the user's own, and into a registry.

    Args:
        registry: see `place_model`.
        model: see `place_model`.
        replace: see `place_model`.

    Returns:
        The file, and where the model comes from whose place it takes, if not the user's own.

    Raises:
        ModelError: as `place_model`; `cannot_write`.
    """
    place_model(registry.copy(), model, replace=replace)
    with lock_folder(user_folder()):
        path = place_model(Registry.default(), model, replace=replace)
        save_model(model, path)
    registry.add(model, place=str(path), over=(model.name,))
    replaced = registry.replaced_place(model.name)
    return path, None if replaced == str(path) else replaced


def remove_model(text: str) -> tuple[str, Path]:
    """Removes one of the user's own models.

    Args:
        text: its name, or a synonym.

    Returns:
        Its name, and the file that is gone.

    Raises:
        ModelError: as `Registry.find_one`; `not_yours`; `cannot_write`.
    """
    _own_model(text)
    with lock_folder(user_folder()):
        name, path = _own_model(text)  # unless another process removed it meanwhile
        remove_file(path)
    return name, path


def rename_model(model: ObjectModel, name: str) -> ObjectModel:
    """The model under another name; its synonyms stay with the model that they belong to.

    Raises:
        ModelError: `bad_value` if it cannot be a name.
    """
    try:
        TypeAdapter(Name).validate_python(name, strict=True)
    except ValidationError as error:
        raise ModelError(
            "bad_value",
            f"{short_text(name)} cannot be a name",
            suggestions=("take a name of letters and digits, like 'red box'",),
        ) from error
    return model.model_copy(update={"name": name, "synonyms": ()})


def _own_model(text: str) -> tuple[str, Path]:
    """Name and file of one of the user's own models."""
    registry = Registry.default()
    name = registry.find_one(text).name
    place = registry.place(name)
    if not _is_own(Path(place)):
        raise ModelError(
            "not_yours",
            f"the {name} is not one of your own models: it comes from {place}",
            suggestions=(f"your own are in {user_folder()}",),
        )
    return name, Path(place)


def _is_own(path: Path) -> bool:
    return path.parent == user_folder()
