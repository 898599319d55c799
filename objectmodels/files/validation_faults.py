"""Complaints of pydantic about a file, in the words of the file's author."""

from __future__ import annotations

import re
import reprlib
from typing import Any, NamedTuple, get_args

from pydantic import BaseModel, ValidationError

from objectmodels.errors import ModelError, printable, suggest

_LONGEST = 80

_short = reprlib.Repr()
_short.maxstring = _short.maxother = _LONGEST

_KEYS_HINT = "docs/models.md and docs/scenes.md explain the keys"
_RANGES_HINT = "docs/limits.md has the ranges"


class Fault(NamedTuple):
    """A fault of a file.

    Attributes:
        code: `missing_key`, `unknown_key` or `bad_value`.
        key: where it is, with dots between the keys.
        message: what was found and what was expected.
        suggestions: what would be right.
    """

    code: str
    key: str
    message: str
    suggestions: tuple[str, ...]

    def error(self, place: str) -> ModelError:
        """The fault as an error of the file or the call that `place` names."""
        where = f"{place}: {self.key}"
        return ModelError(self.code, self.message, path=where, suggestions=self.suggestions)


def first_fault(error: ValidationError, cls: type[BaseModel]) -> Fault:
    """The complaint that helps most.

    Args:
        error: of a document that was validated.
        cls: as which it was.
    """
    # A key that is unknown is often the one that is missing, misspelt.
    complaints = error.errors(include_url=False)
    first = min(complaints, key=lambda e: e["type"] != "extra_forbidden")
    key = printable(".".join(map(str, first["loc"]))) or "file"
    if first["type"] == "missing":
        hint = f"add `{key.rpartition('.')[2]}: …`"
        return Fault("missing_key", key, "is required, but not given", (hint, _KEYS_HINT))
    if first["type"] == "extra_forbidden":
        return Fault("unknown_key", key, "is not a key of this format", _meant_keys(key, cls))
    return _value_fault(first, key, cls)


def _meant_keys(key: str, cls: type[BaseModel]) -> tuple[str, ...]:
    """Keys that may have been meant by an unknown one."""
    wrong, known = key.rpartition(".")[2], sorted(_all_keys(cls))
    near = suggest(wrong, known) or [name for name in known if name.startswith(wrong + "_")]
    hints = tuple(f"did you mean '{name}'?" for name in near[:1])
    return hints or (f"known: {', '.join(file_keys(cls))}" if "." not in key else _KEYS_HINT,)


def _value_fault(complaint: Any, key: str, cls: type[BaseModel]) -> Fault:
    inner = complaint.get("ctx", {}).get("error")
    expected = re.sub(r"^(Value error, |Input should be |\w+ should have )", "", complaint["msg"])
    hints = tuple(getattr(inner, "suggestions", ()))
    if isinstance(inner, ModelError):
        expected = inner.message
        if inner.path is not None:
            return Fault("bad_value", _file_key(inner.path, cls), expected, hints or (_KEYS_HINT,))
    ranges = complaint["type"].startswith(("less_", "greater_", "too_", "string_too_", "finite_"))
    hints = hints or (_RANGES_HINT if ranges else _KEYS_HINT,)
    if complaint["loc"] and not isinstance(complaint["input"], dict):
        expected = f"found {short_text(complaint['input'])}, expected {expected}"
    return Fault("bad_value", key, expected, hints)


def _file_key(path: str, cls: type[BaseModel]) -> str:
    """The place of a field in a file: its key in place of its name."""
    name, dot, rest = path.partition(".")
    field = cls.model_fields.get(name)
    return (field.alias if field and field.alias else name) + dot + rest


def file_keys(cls: type[BaseModel]) -> list[str]:
    """Keys of a class in a file."""
    return [field.alias or name for name, field in cls.model_fields.items() if name != "kind"]


def _all_keys(cls: type[BaseModel]) -> set[str]:
    """Keys of a class in a file, and those of the blocks in it."""
    found = set(file_keys(cls))
    for field in cls.model_fields.values():
        for part in classes_in(field.annotation):
            found |= _all_keys(part)
    return found


def classes_in(annotation: Any) -> list[type[BaseModel]]:
    """Models of pydantic that a type is made of."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [part for argument in get_args(annotation) for part in classes_in(argument)]


def short_text(value: object) -> str:
    """A value as it would be written in Python, cut if it is long."""
    text = _short.repr(value)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
