"""Memory of the workers of a batch over many rows, after the first hundred."""

from __future__ import annotations

import multiprocessing
import time
from pathlib import Path
from typing import NamedTuple

from benchmarks.batches.drawn_rows import plan_rows
from nlcontrol import batch

SETTLED = 100
"""Rows after which a worker has all that it keeps; it counts from there."""

_EVERY = 100  # rows from one look to the next


class Growth(NamedTuple):
    """Memory of a process, resident [MB].

    Attributes:
        settled: after the first rows.
        most: the largest afterwards.
        end: in the end.
    """

    settled: float
    most: float
    end: float


def memory_growth(number: int, workers: int, output: Path) -> tuple[dict[str, Growth], float]:
    """Memory of each worker and of the batch itself, and rows per second."""
    seen: dict[str, list[float]] = {}
    start = time.perf_counter()
    results = batch(plan_rows(number), workers=workers, output=output, brief=True)
    for done, _ in enumerate(results, start=1):
        if done >= SETTLED and done % _EVERY == 0:
            children = sorted(multiprocessing.active_children(), key=lambda each: each.pid or 0)
            pids = {f"worker {i}": each.pid for i, each in enumerate(children, start=1)}
            for name, pid in {**pids, "batch": "self"}.items():
                seen.setdefault(name, []).append(_resident(pid))
    rate = number / (time.perf_counter() - start)
    return {name: Growth(each[0], max(each), each[-1]) for name, each in seen.items()}, rate


def _resident(pid: int | str | None) -> float:
    """Resident memory of a process [MB]."""
    status = Path(f"/proc/{pid}/status").read_text("ascii", errors="replace")
    line = next(line for line in status.splitlines() if line.startswith("VmRSS"))
    return int(line.split()[1]) / 1000.0
