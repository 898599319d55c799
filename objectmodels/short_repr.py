"""Short representations of documents, as an interpreter or a notebook shows them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pydantic import BaseModel

_LONGEST = 120
_LONGEST_VALUE = 40


class ShortRepr(BaseModel):
    """A document whose representation is one short line; `model_dump` gives all of it."""

    def __repr__(self) -> str:
        told = (f"{name}={_short(value)}" for name, value in self if _says_something(name, value))
        line = f"{type(self).__name__}({', '.join(told)})"
        return line if len(line) <= _LONGEST else f"{line[: _LONGEST - 2]}…)"

    def __str__(self) -> str:
        return repr(self)


def _says_something(name: str, value: object) -> bool:
    is_empty = isinstance(value, tuple | list | dict) and not value
    return name != "schema_version" and value is not None and not is_empty


def _short(value: object) -> str:
    """A value in few letters; of what holds others, its kind and their number."""
    if isinstance(value, BaseModel):
        return f"<{type(value).__name__}>"
    if isinstance(value, float):
        return f"{value:.6g}"
    told = repr(value)
    if len(told) <= _LONGEST_VALUE and not isinstance(value, Mapping):
        return told
    if isinstance(value, str):
        return f"{told[: _LONGEST_VALUE - 2]}…'"
    if isinstance(value, Mapping | Sequence):
        return f"<{len(value)}>"
    return f"<{type(value).__name__}>"
