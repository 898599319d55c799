"""What is made on first use: public names of a package, and values that are kept.

Public names of a package that are loaded on first use, so that one room loads no other.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeVar, cast

__all__ = ["cached_property", "lazy_names", "remember_answers"]


if TYPE_CHECKING:  # a property that is cached does not fit a protocol's
    from builtins import property as cached_property
else:
    from functools import cached_property


Function = TypeVar("Function", bound=Callable[..., Any])


def remember_answers(most: int) -> Callable[[Function], Function]:
    """Has a function remember its answers to so many arguments, all of which can be hashed."""
    return cast("Callable[[Function], Function]", lru_cache(maxsize=most))


def lazy_names(package: str, homes: Mapping[str, Sequence[str]]) -> Callable[[str], object]:
    """The `__getattr__` of a package that gives names of its modules to others.

    Args:
        package: its `__name__`.
        homes: module of the package → names that it defines.
    """

    def load(name: str) -> object:
        home = next((module for module, names in homes.items() if name in names), None)
        if home is None:
            raise AttributeError(f"module {package!r} has no attribute {name!r}", name=name)
        value: object = getattr(importlib.import_module(f"{package}.{home}"), name)
        setattr(sys.modules[package], name, value)
        return value

    return load
