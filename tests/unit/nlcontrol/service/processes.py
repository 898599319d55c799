"""Processes as the system lists them, for tests of what is left of them."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path


def parent(pid: int) -> int | None:
    """Parent of a process; None if that process has ended."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return None
    return None if state[0] == "Z" else int(state[1])


def descendants(pid: int) -> set[int]:
    """Processes below a process that have not ended."""
    numbers = [int(path.name) for path in Path("/proc").iterdir() if path.name.isdigit()]
    parents = {number: parent(number) for number in numbers}
    found, last = set[int](), {pid}
    while last:
        last = {number for number in numbers if parents[number] in last}
        found |= last
    return found


@contextmanager
def halted(pids: Iterable[int]) -> Iterator[None]:
    """Context in which processes do nothing, so that nothing depends on who is quicker."""
    pids = tuple(pids)
    for pid in pids:
        os.kill(pid, signal.SIGSTOP)
    try:
        yield
    finally:
        for pid in pids:
            os.kill(pid, signal.SIGCONT)
