"""One thing at a time: what several threads ask of one robot is done in turn.

A robot has one arm, and beliefs that what it does changes. A call waits until what another thread
asked of the same controller, or of a conversation with it, is done; a call from within goes on at
once.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, Concatenate, ParamSpec, TypeVar

if TYPE_CHECKING:
    from threading import RLock

Given = ParamSpec("Given")
Returned = TypeVar("Returned")


class TakesTurns:
    """Something that several threads may use.

    Attributes:
        turn: held by the thread whose turn it is.
    """

    turn: RLock


One = TypeVar("One", bound=TakesTurns)


def in_turn(
    method: Callable[Concatenate[One, Given], Returned],
) -> Callable[Concatenate[One, Given], Returned]:
    """The method, which waits for its turn."""

    @wraps(method)
    def waiting(self: One, /, *args: Given.args, **kwargs: Given.kwargs) -> Returned:
        with self.turn:
            return method(self, *args, **kwargs)

    return waiting
