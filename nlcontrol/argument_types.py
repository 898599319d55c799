"""Arguments of public calls, held against the types that their signatures state.

A wrong one is refused at the door, with a code and what was expected, before anything begins.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, wraps
from numbers import Integral, Real
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    Literal,
    ParamSpec,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from nlcontrol.errors import error

Given = ParamSpec("Given")
Returned = TypeVar("Returned")


@dataclass(frozen=True)
class ReadByOwnRules:
    """Mark of a type whose content has a reader of its own, which says more than a type.

    Attributes:
        words: the type in words.
    """

    words: str


_WORDS = {str: "text", float: "a number", int: "a whole number", bool: "True or False"}


def checked_arguments(call: Callable[Given, Returned]) -> Callable[Given, Returned]:
    """The call, which refuses an argument that is not of its stated type with `bad_arguments`."""
    signature = inspect.signature(call)

    @wraps(call)
    def call_with_checks(*args: Given.args, **kwargs: Given.kwargs) -> Returned:
        hints, told = _hints(call), call.__qualname__.removesuffix(".__init__")
        for name, value in signature.bind(*args, **kwargs).arguments.items():
            if name in hints and not is_of_type(value, hints[name]):
                raise error(
                    "bad_arguments",
                    f"`{name}` of {told} is {_short(value)}, expected {type_words(hints[name])}",
                    suggestions=(f"help({told}) tells what it takes",),
                )
        return call(*args, **kwargs)

    return call_with_checks


@cache
def _hints(call: Callable[..., Any]) -> Mapping[str, Any]:
    """Types of a call's arguments by their names; late, since they need modules that are whole."""
    return get_type_hints(call, include_extras=True)


def is_of_type(value: object, hint: Any) -> bool:
    """Check a value against a type as annotations state it; what a container holds is looked at."""
    origin, parts = get_origin(hint), get_args(hint)
    if hint is Any or isinstance(hint, TypeVar):
        return True
    if hint in (None, NoneType):
        return value is None
    if origin in (Union, UnionType):
        return any(is_of_type(value, part) for part in parts)
    if origin is Annotated:
        of_form = not any(isinstance(mark, ReadByOwnRules) for mark in parts[1:])
        return is_of_type(value, parts[0]) if of_form else _is_of_form(value, parts[0])
    if origin is Literal:
        return any(value == part and type(value) is type(part) for part in parts)
    if origin is tuple and Ellipsis not in parts:
        fits = isinstance(value, list | tuple) and len(value) == len(parts)
        return fits and all(map(is_of_type, value, parts))  # type: ignore[call-overload]
    if origin in (tuple, list, Sequence):
        return isinstance(value, list | tuple) and all(is_of_type(v, parts[0]) for v in value)
    if origin in (dict, Mapping):
        return isinstance(value, Mapping) and all(
            is_of_type(k, parts[0]) and is_of_type(v, parts[1]) for k, v in value.items()
        )
    if origin is Callable:
        return callable(value)
    kind = origin or hint
    if kind in (float, int):
        return isinstance(value, Real if kind is float else Integral) and not isinstance(
            value, bool
        )
    if getattr(kind, "_is_protocol", False):
        return all(_has(value, name) for name in _members(kind))
    return not isinstance(kind, type) or isinstance(value, kind)


def _is_of_form(value: object, hint: Any) -> bool:
    """Check a value against the outermost of a type alone."""
    kinds = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
    kinds = tuple(get_origin(kind) or kind for kind in kinds)
    return isinstance(value, kinds) and not isinstance(value, str | bytes)


def _members(protocol: type) -> set[str]:
    """Names that a protocol asks for."""
    kinds = [kind for kind in protocol.__mro__ if getattr(kind, "_is_protocol", False)]
    named = {
        name for kind in kinds for name in (*vars(kind), *vars(kind).get("__annotations__", ()))
    }
    return {name for name in named if not name.startswith("_")}


def _has(value: object, name: str) -> bool:
    """Check for a member; a property is not asked, since it may build a world."""
    missing = object()
    return inspect.getattr_static(value, name, missing) is not missing or hasattr(value, name)


def type_words(hint: Any) -> str:
    """A type in words, as an error tells it."""
    origin, parts = get_origin(hint), get_args(hint)
    if origin is Annotated:
        marks = [mark.words for mark in parts[1:] if isinstance(mark, ReadByOwnRules)]
        return marks[0] if marks else type_words(parts[0])
    if hint in (None, NoneType):
        return "None"
    if origin in (Union, UnionType):
        return " or ".join(dict.fromkeys(map(type_words, parts)))
    if origin is Literal:
        return " or ".join(map(repr, parts))
    if origin is tuple and Ellipsis not in parts:
        return f"{len(parts)} of {type_words(parts[0])}"
    if origin in (tuple, list, Sequence):
        return f"a list of {type_words(parts[0]).removeprefix('a ')}"
    if origin in (dict, Mapping):
        return "a mapping"
    if callable(hint) and hint in _WORDS:
        return _WORDS[hint]
    name = getattr(origin or hint, "__name__", str(hint))
    return (
        "something to call"
        if name == "Callable"
        else f"{'an' if name[0] in 'AEIO' else 'a'} {name}"
    )


def _short(value: object) -> str:
    """A value in few letters."""
    told = repr(value)
    return told if len(told) <= 60 else f"a {type(value).__name__}"
