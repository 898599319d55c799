"""Model files: a YAML file with units in its keys, read into an object model and written again.

A file begins with `format: KIND/VERSION`, e.g. `box/1`; the kind is a class of model, whose fields
are the file's keys (by their aliases, which carry the units). It is read strictly: what is unknown,
of another type or out of range is an error that names file, key, what was found and what was
expected. See `objectmodels/registry/builtin/` for examples.

YAML is read without the surprises of its version 1.1: plain values by the core schema of 1.2, a
little stricter, so that `no` is text and not false, `1:30` is text and not ninety, `2024-05-01` is
text and not a date, `1e3` is a number and `017` is text. A key that is given twice is an error, and
so is a key that is not text.
"""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Hashable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml
from pydantic import ValidationError

from objectmodels.errors import ModelError, suggest
from objectmodels.models.convex_hull import HullModel
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.parameters import Provenance
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

MAX_BYTES = 1_000_000
"""Larger files are not model files."""


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
        ModelError: `unreadable_file`, `bad_yaml`, `unknown_format`, `missing_key`, `unknown_key` or
            `bad_value`; names the file, the key, the value found and what was expected.
    """
    content = read_yaml(path)
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
        raise _explain_error(error, path, cls) from error


def save_model(model: ObjectModel, path: Path) -> None:
    """Writes a model file, whole or not at all; only what was stated, not what follows from it.

    Raises:
        ModelError: `cannot_write`.
    """
    stated = model.model_dump(mode="json", by_alias=True, exclude_unset=True, exclude={"kind"})
    stated.setdefault("provenance", model.provenance.model_dump(exclude_none=True))
    document = {"format": f"{kind_of(model)}/{type(model).version}", **stated}
    text = yaml.safe_dump(document, sort_keys=False, allow_unicode=True, default_flow_style=None)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=".tmp", dir=path.parent)
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        os.chmod(name, 0o644)
        os.replace(name, path)
    except OSError as error:
        raise ModelError(
            "cannot_write", f"cannot be written: {error.strerror}", path=str(path)
        ) from error


def _class_of(content: dict[str, Any], path: Path, kinds: Kinds) -> type[ObjectModel]:
    known = [f"{kind}/{cls.version}" for kind, cls in kinds.items()]
    found = content.get("format")
    if found in known:
        return kinds[str(found).split("/")[0]]
    what = f"format {found!r}" if "format" in content else "no `format`"
    raise ModelError(
        "unknown_format",
        f"{what}, expected one of: {', '.join(known)}",
        path=str(path),
        suggestions=(f"begin the file with `format: {known[0]}`",),
    )


def _explain_error(error: ValidationError, path: Path, cls: type[ObjectModel]) -> ModelError:
    """The first complaint of pydantic in the words of a model file's author."""
    # A key that is unknown is often the one that is missing, misspelt: that helps most.
    complaints = error.errors(include_url=False)
    first = min(complaints, key=lambda e: e["type"] != "extra_forbidden")
    key = ".".join(str(part) for part in _error_location(first)) or "file"
    where = f"{path}: {key}"
    found: Any = first["input"]
    if first["type"] == "missing":
        return ModelError("missing_key", "is required, but not given", path=where)
    if first["type"] == "extra_forbidden":
        known = Provenance.model_fields if "." in key else file_keys(cls)
        wrong = key.split(".")[-1]
        near = suggest(wrong, known) or [name for name in known if name.startswith(wrong + "_")]
        hints = tuple(f"did you mean '{name}'?" for name in near[:1])
        return ModelError(
            "unknown_key",
            "is not a key of this format",
            path=where,
            suggestions=hints or (f"known: {', '.join(known)}",),
        )
    if key == "support":  # a union, of which pydantic names one branch only
        return ModelError(
            "bad_value", f"found {_short_text(found)}, expected {_SUPPORTS}", path=where
        )
    inner = first.get("ctx", {}).get("error")
    if isinstance(inner, ModelError) and inner.path is not None:
        field = cls.model_fields[inner.path]
        return ModelError("bad_value", inner.message, path=f"{path}: {field.alias or inner.path}")
    expected = first["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    if isinstance(inner, ModelError):
        expected = inner.message
    if not first["loc"] or isinstance(found, dict):
        return ModelError("bad_value", expected, path=where)
    return ModelError("bad_value", f"found {_short_text(found)}, expected {expected}", path=where)


def _error_location(complaint: Any) -> tuple[Any, ...]:
    """Place of a complaint; in a union that is the whole of it."""
    parts: tuple[Any, ...] = complaint["loc"]
    return parts[:1] if parts[:1] == ("support",) else parts


def _short_text(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."


def file_keys(cls: type[ObjectModel]) -> list[str]:
    """Keys of a kind's model files."""
    names = [field.alias or name for name, field in cls.model_fields.items() if name != "kind"]
    return ["format", *names]


if TYPE_CHECKING or not yaml.__with_libyaml__:
    _Parser = yaml.SafeLoader
else:
    from yaml.composer import Composer
    from yaml.constructor import SafeConstructor
    from yaml.cyaml import CParser
    from yaml.resolver import Resolver

    class _Parser(Composer, CParser, SafeConstructor, Resolver):
        """libyaml's parser, ten times as fast, below the composer in Python.

        libyaml's own composer overflows the stack where text is nested too deeply.
        """

        def __init__(self, stream: str) -> None:
            CParser.__init__(self, stream)
            Composer.__init__(self)
            SafeConstructor.__init__(self)
            Resolver.__init__(self)


class _Loader(_Parser):
    """A safe loader with its own table of plain values."""

    yaml_implicit_resolvers = {}  # noqa: RUF012  (the base class's own kind of attribute)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[str] = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            line = key_node.start_mark.line + 1
            if not isinstance(key, str):
                raise yaml.constructor.ConstructorError(
                    None, None, f"key {key!r} in line {line} is not text", key_node.start_mark
                )
            if key in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"key {key!r} is given twice (line {line})", key_node.start_mark
                )
            seen.add(key)
        return super().construct_mapping(node, deep)


for _tag, _pattern, _first in (
    ("null", r"~|null|", ["~", "n", ""]),
    ("bool", r"true|false", list("tf")),
    ("int", r"[-+]?(0|[1-9][0-9]*)", list("-+0123456789")),
    (
        "float",
        r"[-+]?([0-9]+\.[0-9]*|\.[0-9]+|[0-9]+(?=[eE]))([eE][-+]?[0-9]+)?"
        r"|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
        list("-+.0123456789"),
    ),
):
    _Loader.add_implicit_resolver(
        f"tag:yaml.org,2002:{_tag}", re.compile(f"^({_pattern})$"), _first
    )


def parse_yaml(text: str) -> object:
    """Contents of a YAML text.

    Raises:
        yaml.YAMLError: it is not YAML, or a key is given twice or is not text.
    """
    return yaml.load(text, Loader=_Loader)


def read_yaml(path: Path) -> dict[str, Any]:
    """The mapping that a YAML file holds.

    Raises:
        ModelError: `unreadable_file` if it cannot be read, `bad_yaml` if it is not YAML or not a
            mapping of text keys.
    """
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise ModelError(
                "unreadable_file",
                f"is {size} bytes long, expected at most {MAX_BYTES}",
                path=str(path),
            )
        data = path.read_bytes()
        content = parse_yaml(data.decode("utf-8"))
    except OSError as error:
        raise ModelError(
            "unreadable_file", f"cannot be read: {error.strerror}", path=str(path)
        ) from error
    except (UnicodeDecodeError, yaml.YAMLError, RecursionError) as error:
        raise ModelError(
            "bad_yaml", f"is not valid YAML: {_parser_complaint(error)}", path=str(path)
        ) from error
    if not isinstance(content, dict):
        raise ModelError(
            "bad_yaml", f"holds {_node_kind(content)}, expected keys with values", path=str(path)
        )
    return content


def _parser_complaint(error: Exception) -> str:
    """The parser's complaint in one line."""
    if isinstance(error, yaml.MarkedYAMLError) and error.problem:
        mark = error.problem_mark
        where = f" (line {mark.line + 1}, column {mark.column + 1})" if mark else ""
        return error.problem + where
    if isinstance(error, RecursionError):
        return "nested too deeply"
    return " ".join(str(error).split())


def _node_kind(content: object) -> str:
    return "nothing" if content is None else f"a {type(content).__name__}"
