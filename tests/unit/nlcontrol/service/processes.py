"""Processes as the system lists them, for tests of what is left of them."""

from __future__ import annotations

import time
from collections.abc import Callable
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


def wait_until(holds: Callable[[], bool], timeout: float = 10.0) -> None:
    """Waits until something holds, no longer than a time [s]."""
    end = time.monotonic() + timeout
    while not holds():
        assert time.monotonic() < end, "it did not come to hold in time"
        time.sleep(0.02)
