"""Rates of a batch beside that of a plain loop over the same rows, in one run.

Model: the loop is one process that carries out one row after the other, with all that a worker
keeps from row to row, and writes nothing. The batch has two workers, reads rows and writes results.
All have worked before, but on other rows: a row that was done comes sooner from a process that
keeps what it computed, and which of two workers that is, changes. The yardstick is twice the
loop's rate; rounds go through all ways one after the other, and medians count.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from benchmarks.batches.cluster import local_cluster
from nlcontrol import Registry, batch
from nlcontrol.batches.batch import dask_executor
from nlcontrol.batches.row_orders import RowOrders
from nlcontrol.batches.row_worker import Order, run_row
from nlcontrol.batches.rows import RowResult
from nlcontrol.parallel_tasks import worker_processes

WORKERS = 2


def measured_rates(
    rows_of: Callable[[int], Sequence[dict[str, Any]]], rounds: int
) -> dict[str, list[float]]:
    """Rows per second of each way in each round, given the rows of a round."""
    with ExitStack() as opened:
        folder = Path(opened.enter_context(tempfile.TemporaryDirectory()))
        alone = opened.enter_context(worker_processes(1))
        processes = opened.enter_context(worker_processes(WORKERS))
        address = opened.enter_context(local_cluster(folder, WORKERS))
        dask, _ = opened.enter_context(dask_executor(address))
        ways: dict[str, Callable[[Sequence[dict[str, Any]], Path], float]] = {
            "loop": lambda rows, _: _loop_time(rows, alone),
            "processes": lambda rows, path: _batch_time(rows, processes, path),
            "dask": lambda rows, path: _batch_time(rows, dask, path),
        }
        found: dict[str, list[float]] = {name: [] for name in ways}
        for number in range(rounds + 1):
            rows = rows_of(number)
            for name, way in ways.items():
                seconds = way(rows, folder / f"{name}-{number}.jsonl")
                found[name].append(len(rows) / seconds)
    return {name: rates[1:] for name, rates in found.items()}


def _loop_time(rows: Sequence[dict[str, Any]], executor: Executor) -> float:
    orders = list(RowOrders(Registry.default(), Path()).orders(rows))
    return executor.submit(_carry_out, orders).result()


def _carry_out(orders: Sequence[Order | RowResult]) -> float:
    start = time.perf_counter()
    for order in orders:
        run_row(order)
    return time.perf_counter() - start


def _batch_time(rows: Sequence[dict[str, Any]], executor: Executor, output: Path) -> float:
    start = time.perf_counter()
    for _ in batch(rows, executor=executor, workers=WORKERS, output=output):
        pass
    return time.perf_counter() - start


def rate_table(what: str, rates: dict[str, list[float]]) -> str:
    """The medians, and their shares of twice the loop's."""
    medians = {name: statistics.median(each) for name, each in rates.items()}
    shares = {
        name: f" ({100 * statistics.median(each) / (WORKERS * medians['loop']):.0f} % of twice it)"
        for name, each in rates.items()
        if name != "loop"
    }
    told = ", ".join(f"{name} {m:.3g}{shares.get(name, '')}" for name, m in medians.items())
    return f"{what}, rows per second, medians of {len(rates['loop'])}: {told}"
