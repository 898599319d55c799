"""Rates of a batch beside that of a plain loop over the same rows, in one run; memory of workers.

The loop is one process that carries out one row after the other, with all that a worker keeps from
row to row, and writes nothing. The batch has two workers, reads rows and writes results. All have
worked before, but on other rows: a row that was done comes sooner from a process that keeps what it
computed, and which of two workers that is, changes. The yardstick is twice the loop's rate; rounds
go through all ways one after the other, and medians count.
"""

from __future__ import annotations

import multiprocessing
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from itertools import count, islice
from pathlib import Path
from typing import Any

from benchmarks.batches.proof import local_cluster
from nlcontrol import Registry, batch
from nlcontrol.batches.batch import dask_executor
from nlcontrol.batches.row_orders import RowOrders
from nlcontrol.batches.row_worker import Order, run_row
from nlcontrol.batches.rows import RowResult
from nlcontrol.parallel_tasks import worker_processes

Row = dict[str, Any]

SENTENCES = (
    "push the ice tea box away without toppling it",
    "push the mug 7 cm to the left",
    "push the coffee box to the right slowly",
    "turn the ice tea box by 20 degrees",
)
SHORT = "push the mug 3 cm to the left"
"""Carried out in little time."""

WORKERS = 2

EVERY = 100
"""Rows from one look at the memory to the next; after the first ones a worker has all it keeps."""


def plan_rows(number: int, first_seed: int = 0) -> list[Row]:
    """Rows that are planned: each sentence for each seed, every fifth row in a drawn scene."""

    def plans() -> Iterator[Row]:
        for seed in count(first_seed):
            for text in SENTENCES:
                yield {"text": text, "seed": seed, "execute": False}
            scene = {"draw": "table", "seed": seed, "object": "mug"}
            yield {"text": SENTENCES[1], "seed": seed, "scene": scene, "execute": False}

    return list(islice(plans(), number))


def execution_rows(number: int, first_seed: int = 0) -> list[Row]:
    """Rows that are carried out."""
    return [{"text": SHORT, "seed": first_seed + seed} for seed in range(number)]


def measured_rates(
    rows_from: Callable[[int, int], list[Row]], number: int, rounds: int
) -> dict[str, list[float]]:
    """Rows per second of each way in each round, of so many rows each."""
    with ExitStack() as opened:
        folder = Path(opened.enter_context(tempfile.TemporaryDirectory()))
        alone = opened.enter_context(worker_processes(1))
        processes = opened.enter_context(worker_processes(WORKERS))
        address = opened.enter_context(local_cluster(folder, WORKERS))
        dask, _ = opened.enter_context(dask_executor(address))
        found: dict[str, list[float]] = {"loop": [], "processes": [], "dask": []}
        for which in range(rounds + 1):
            rows = rows_from(number, which * number)
            orders = list(RowOrders(Registry.default(), Path()).orders(rows))
            found["loop"].append(number / alone.submit(_loop_time, orders).result())
            for name, executor in (("processes", processes), ("dask", dask)):
                output = folder / f"{name}-{which}.jsonl"
                found[name].append(number / _batch_time(rows, executor, output))
    return {name: rates[1:] for name, rates in found.items()}


def _loop_time(orders: Sequence[Order | RowResult]) -> float:
    start = time.perf_counter()
    for order in orders:
        run_row(order)
    return time.perf_counter() - start


def _batch_time(rows: Sequence[Row], executor: Executor, output: Path) -> float:
    start = time.perf_counter()
    for _ in batch(rows, executor=executor, workers=WORKERS, output=output):
        pass
    return time.perf_counter() - start


def rate_table(what: str, rates: dict[str, list[float]]) -> str:
    """The medians, and their shares of twice the loop's."""
    medians = {name: statistics.median(each) for name, each in rates.items()}
    shares = {
        name: f" ({100 * median / (WORKERS * medians['loop']):.0f} % of twice it)"
        for name, median in medians.items()
        if name != "loop"
    }
    told = ", ".join(f"{name} {m:.3g}{shares.get(name, '')}" for name, m in medians.items())
    return f"{what}, rows per second, medians of {len(rates['loop'])}: {told}"


def watch_memory(number: int, workers: int, output: Path) -> None:
    """Prints the resident memory of each worker and of the batch itself, and rows per second."""
    seen: dict[str, list[float]] = {}
    start = time.perf_counter()
    results = batch(plan_rows(number), workers=workers, output=output, brief=True)
    for done, _ in enumerate(results, start=1):
        if done % EVERY == 0:
            children = sorted(multiprocessing.active_children(), key=lambda each: each.pid or 0)
            pids = {f"worker {i}": each.pid for i, each in enumerate(children, start=1)}
            for name, pid in {**pids, "batch": "self"}.items():
                seen.setdefault(name, []).append(_resident(pid))
    rate = number / (time.perf_counter() - start)
    for name, (settled, *later) in seen.items():
        most, end = max(settled, *later), [settled, *later][-1]
        print(f"{name}: {settled:.0f} MB, at most {most - settled:+.1f}, in the end {end:.0f}")
    print(f"{number} rows, {rate:.3g} a second with {workers} workers")


def _resident(pid: int | str | None) -> float:
    """Resident memory of a process [MB]."""
    status = Path(f"/proc/{pid}/status").read_text("ascii", errors="replace")
    line = next(line for line in status.splitlines() if line.startswith("VmRSS"))
    return int(line.split()[1]) / 1000.0
