"""Scene documents completed: by the scene that they extend, and by models where no truth is said.

A document is what stands in a scene file, before it is a `Scene`. What is not of the right form is
left as it is: it is refused when the scene is made.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeGuard

from pydantic import ValidationError

from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import first_fault
from sim.truth.object_truth import Truth
from sim.truth.truth_from_model import whole_truth

if TYPE_CHECKING:
    from objectmodels import Registry

Document = dict[str, Any]

_OF_ITSELF = ("version", "name", "extends")  # what no scene takes from another


def document_beside(document: Document, folder: Path) -> Document:
    """The document with the paths of its model files, which in the file are relative to it."""
    if not _are_texts(document.get("models")):
        return document
    return document | {"models": [str(folder / path) for path in document["models"]]}


def extended_document(base: Document, own: Document) -> Document:
    """A scene's own document on top of that of the scene that it extends.

    A block, such as `vision`, is changed key by key. Model files are added. An object of a new name
    is added; one of a name that is there takes its place if it names its model, else it changes
    what is there key by key.
    """
    merged = {key: value for key, value in base.items() if key not in _OF_ITSELF}
    for key, value in own.items():
        old = merged.get(key)
        if key == "objects" and _are_objects(old) and _are_objects(value):
            merged[key] = _merged_objects(old, value)
        elif isinstance(old, list) and isinstance(value, list):
            merged[key] = [*old, *value]
        elif isinstance(old, dict) and isinstance(value, dict):
            merged[key] = old | value
        elif key != "extends":
            merged[key] = value
    return merged


def _merged_objects(standing: list[Document], added: list[Document]) -> list[Document]:
    found = {item["name"]: item for item in standing}
    for item in added:
        kept = {} if "model" in item else found.get(item["name"], {})
        found[item["name"]] = kept | item
    return list(found.values())


def completed_document(document: Document) -> Document:
    """The document with a truth for each object that has none: what its model says.

    Raises:
        ModelError: there is no such model, or its file is no good.
    """
    objects = document.get("objects")
    if not _are_objects(objects) or not any(map(_lacks_truth, objects)):
        return document
    from objectmodels import Registry

    registry = Registry.default()
    for path in models if _are_texts(models := document.get("models")) else ():
        registry.load(path)
    completed = [
        item | {"truth": _truth(registry, item["model"])} if _lacks_truth(item) else item
        for item in objects
    ]
    return document | {"objects": completed}


def _lacks_truth(item: Document) -> bool:
    return "truth" not in item and isinstance(item.get("model"), str)


def _truth(registry: Registry, name: str) -> Truth:
    try:
        return whole_truth(registry.find_one(name))
    except ValidationError as raised:
        message = f"the {name}: {first_fault(raised, Truth).message}"
        hint = "write its truth into the scene file"
        raise ModelError("bad_model", message, suggestions=(hint,)) from raised


def _are_texts(value: object) -> TypeGuard[list[str]]:
    return isinstance(value, list) and all(isinstance(each, str) for each in value)


def _are_objects(value: object) -> TypeGuard[list[Document]]:
    return isinstance(value, list) and all(
        isinstance(each, dict) and isinstance(each.get("name"), str) for each in value
    )
