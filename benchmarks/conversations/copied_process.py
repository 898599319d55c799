"""What is done to a robot and its world in a copy of the process leaves no trace here.

The copy is a fork: it begins with all that is in memory here, and nothing comes back but a result.
"""

from __future__ import annotations

from collections.abc import Callable
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import TypeVar

from nlcontrol.parallel_tasks import end_with_parent

T = TypeVar("T")


def result_in_copy(work: Callable[[], T]) -> T:
    """Result of what is done in a copy of this process.

    Raises:
        RuntimeError: the copy has raised something, which the message names, or has ended.
    """
    context = get_context("fork")
    here, there = context.Pipe(duplex=False)
    copy = context.Process(target=_send_result, args=(work, there))
    copy.start()
    there.close()
    try:
        result, raised = here.recv()
    except EOFError:
        raise RuntimeError("the copy of the process has ended") from None
    finally:
        copy.join()
    if raised is not None:
        raise RuntimeError(raised)
    return result  # type: ignore[no-any-return]


def _send_result(work: Callable[[], object], there: Connection) -> None:
    end_with_parent()
    try:
        there.send((work(), None))
    except Exception as raised:  # whatever it is, it is told in the process that waits for it
        there.send((None, f"{type(raised).__name__}: {raised}"))
