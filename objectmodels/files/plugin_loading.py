"""Code of other packages, taken in so that it can harm no command but by being slow once.

What runs as a plug-in is loaded may raise anything, print, or never end. It runs in a thread of its
own, for so long at most; what it writes to standard output, which may be a document's, goes to
standard error.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout, suppress
from importlib.metadata import EntryPoint
from typing import Generic, TypeVar

LOADING_TIME = 10.0
"""Time in which a plug-in has to say what it brings [s]."""

T = TypeVar("T")


class PluginError(Exception):
    """A plug-in that brought nothing: its message says why, `__cause__` what it raised."""


def package_name(point: EntryPoint) -> str:
    """Name of the package of an entry point."""
    return point.dist.name if point.dist else point.value.partition(":")[0]


def place_of(point: EntryPoint) -> str:
    """An entry point in words."""
    return f"plug-in {point.name!r} of {package_name(point)}"


def taken_in(point: EntryPoint, read: Callable[[object], T]) -> T:
    """The offer of an entry point, as it is read from the object that it names.

    Args:
        point: of another package.
        read: makes something of the object; it too runs code of the package.

    Raises:
        PluginError: it raised something, or took longer than `LOADING_TIME`.
    """
    work = _Work(lambda: read(point.load()))
    with _silence():
        work.start()
        work.join(LOADING_TIME)
    if work.is_alive():
        raise PluginError(f"it brought nothing within {LOADING_TIME:g} s")
    if work.failure is not None:
        kind = type(work.failure).__name__
        raise PluginError(f"{kind}: {work.failure}") from work.failure
    return work.brought[0]


class _Work(threading.Thread, Generic[T]):
    """A call in a thread that keeps no program from ending."""

    def __init__(self, call: Callable[[], T]) -> None:
        super().__init__(name="plug-in", daemon=True)
        self._call = call
        self.brought: list[T] = []
        self.failure: BaseException | None = None

    def run(self) -> None:
        """Calls it; SystemExit and the like are failures as all others."""
        try:
            self.brought.append(self._call())
        except BaseException as raised:
            self.failure = raised


@contextmanager
def _silence() -> Iterator[None]:
    """Context in which what is written to standard output goes to standard error."""
    kept: int | None = None
    with suppress(OSError, ValueError, AttributeError):  # there may be no such files
        sys.stdout.flush()
        kept = os.dup(1)
        os.dup2(2, 1)
    try:
        with redirect_stdout(sys.stderr):
            yield
    finally:
        if kept is not None:
            os.dup2(kept, 1)
            os.close(kept)
