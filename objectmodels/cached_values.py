"""Values that are computed once, in words that type checkers match with protocols."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeVar, cast

if TYPE_CHECKING:  # a property that is cached does not fit a protocol's
    from builtins import property as cached_property
else:
    from functools import cached_property

__all__ = ["cached_property", "remember_answers"]

Function = TypeVar("Function", bound=Callable[..., Any])


def remember_answers(most: int) -> Callable[[Function], Function]:
    """Has a function remember its answers to so many arguments, all of which can be hashed."""
    return cast("Callable[[Function], Function]", lru_cache(maxsize=most))
