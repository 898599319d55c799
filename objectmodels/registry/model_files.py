"""Model files: a YAML file with units in its keys, read into an object model and written again.

A file begins with `format: KIND/VERSION`, e.g. `box/1`; the kind is a class of model, whose fields
are the file's keys (by their aliases, which carry the units). It is read strictly: what is unknown,
of another type or out of range is an error that names file, key, what was found and what was
expected. See `objectmodels/registry/builtin/` for examples.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from objectmodels.errors import ModelError
from objectmodels.files.file_writing import replace_file
from objectmodels.files.validation_faults import Fault, first_fault, short_text
from objectmodels.files.yaml_documents import read_mapping
from objectmodels.models.convex_hull import HullModel
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.upright_solids import BoxModel, CylinderModel, PrismModel

Kinds = Mapping[str, type[ObjectModel]]

BUILT_IN_KINDS: Kinds = {
    "box": BoxModel,
    "prism": PrismModel,
    "cylinder": CylinderModel,
    "hull": HullModel,
}
"""Kinds of model that a file may name without any plug-in."""


_SUPPORTS = "corners, uniform, or three or more points [x, y] or [x, y, weight]"


def kind_of(model: ObjectModel | type[ObjectModel]) -> str:
    """Name of a model's kind, as in `format: KIND/VERSION`."""
    cls = model if isinstance(model, type) else type(model)
    return str(cls.model_fields["kind"].default)


def load_model(path: Path, kinds: Kinds = BUILT_IN_KINDS) -> ObjectModel:
    """Reads a model file.

    Args:
        path: the YAML file.
        kinds: classes of model by name.

    Raises:
        ModelError: `unreadable_file`, `bad_yaml`, `unknown_format`, `missing_key`, `unknown_key`,
            `bad_value` or `broken_kind`; names the file, the key, what was found and expected.
    """
    return model_from_document(read_mapping(path, "model_file"), str(path), kinds)


def model_from_document(
    content: Mapping[str, Any], path: str, kinds: Kinds = BUILT_IN_KINDS
) -> ObjectModel:
    """The model of which `content` stands in a file, as `model_document` has it.

    Raises:
        ModelError: as `load_model` does; names `path`.
    """
    cls = _class_of(content, path, kinds)
    stated = {key: value for key, value in content.items() if key != "format"}
    if "provenance" not in stated:
        raise ModelError(
            "missing_key",
            "is required, but not given",
            path=f"{path}: provenance",
            suggestions=("say where the figures come from: `provenance: {source: …}`",),
        )
    if "kind" in stated:
        raise ModelError(
            "unknown_key",
            "is not a key of this format",
            path=f"{path}: kind",
            suggestions=("the kind stands in `format`",),
        )
    try:
        return cls.model_validate(stated, by_alias=True, by_name=False)
    except ValidationError as error:
        raise _model_fault(error, cls).error(path) from error
    except Exception as error:  # kinds of plug-ins may fail in any way
        raise ModelError(
            "broken_kind",
            f"{cls.__name__} fails on it: {type(error).__name__}: {short_text(str(error))}",
            path=path,
            suggestions=("mend or uninstall the package that the kind is from",),
        ) from error


def model_document(model: ObjectModel) -> dict[str, Any]:
    """Contents of a model's file."""
    stated = model.model_dump(mode="json", by_alias=True, exclude_unset=True, exclude={"kind"})
    stated.setdefault("provenance", model.provenance.model_dump(exclude_none=True))
    return {"format": f"{kind_of(model)}/{type(model).version}", **stated}


def save_model(model: ObjectModel, path: Path) -> None:
    """Writes a model file, whole or not at all; only what was stated, not what follows from it.

    Raises:
        ModelError: `cannot_write`.
    """
    text = yaml.safe_dump(
        model_document(model), sort_keys=False, allow_unicode=True, default_flow_style=None
    )
    with replace_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _class_of(content: Mapping[str, Any], path: str, kinds: Kinds) -> type[ObjectModel]:
    known = [f"{kind}/{cls.version}" for kind, cls in kinds.items()]
    found = content.get("format")
    if found in known:
        return kinds[str(found).split("/")[0]]
    what = f"format {short_text(found)}" if "format" in content else "no `format`"
    raise ModelError(
        "unknown_format",
        f"{what}, expected one of: {', '.join(known)}",
        path=path,
        suggestions=(f"begin the file with `format: {known[0]}`",),
    )


def _model_fault(error: ValidationError, cls: type[ObjectModel]) -> Fault:
    """The fault of a model file."""
    fault = first_fault(error, cls)
    if not fault.key.startswith("support.") and fault.key != "support":
        return fault
    # A union, of which pydantic names one branch only.
    (found, *_) = (e["input"] for e in error.errors() if e["loc"][:1] == ("support",))
    message = f"found {short_text(found)}, expected {_SUPPORTS}"
    return Fault("bad_value", "support", message, fault.suggestions)
