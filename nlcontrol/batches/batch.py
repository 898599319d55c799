"""Many rows on an executor: results in the order of the rows, kept as they come, told as they come.

Rows are read when workers need them, and results wait for those of earlier rows alone, so that
memory does not grow with their number. A row's result depends on the row alone, so that it is the
same on any executor, in any order, and after a run was broken off. Rows that follow one another are
often alike, and plans of one scene and seed share much of what a worker computes; so a few go to it
together.
"""

from __future__ import annotations

import math
import os
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sized
from concurrent.futures import BrokenExecutor, Executor
from contextlib import closing, nullcontext
from itertools import groupby, islice
from pathlib import Path
from typing import Literal

from nlcontrol.batches.result_file import ResultFile
from nlcontrol.batches.row_orders import Row, RowOrders
from nlcontrol.batches.row_result import RowResult
from nlcontrol.batches.row_worker import Order, run_row
from nlcontrol.errors import ControlError, ErrorInfo, error
from nlcontrol.json_document import DocumentPart
from nlcontrol.parallel_tasks import UNDER_WAY, finished_tasks
from objectmodels import Registry

PLANS_TOGETHER = 5
"""Rows that follow one another and are only planned, given to a worker together."""


class BatchProgress(DocumentPart):
    """Event of a batch: how far it is.

    Attributes:
        done: rows that are done, those of an earlier run included.
        total: of the rows; null if nobody knows.
        without_result: rows done now that have no result: bad, lost or crashed ones.
        rate: rows per second of this run, by the clock on the wall.
        left: time until the last row, at that rate [s]; null if nobody knows.
    """

    done: int
    total: int | None
    without_result: int
    rate: float
    left: float | None


def batch(
    rows: Iterable[Row],
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    registry: Registry | None = None,
    folder: Path | str = ".",
    plan_only: bool = False,
    brief: bool = False,
    output: Path | str | None = None,
    resume: bool = False,
    on_error: Literal["skip", "stop"] = "skip",
    on_event: Callable[[BatchProgress], object] | None = None,
    total: int | None = None,
) -> Generator[RowResult]:
    """Results of rows, in their order, as they come; rows are begun when the first is asked for.

    Args:
        rows: `BatchRow`s, their JSON, or dictionaries as their JSON.
        executor: any of `concurrent.futures`, which is not shut down; processes of this machine if
            not given.
        workers: how many work at once; as many as there are processors if not given.
        registry: models on top of the built-in ones; those of the user if not given.
        folder: to which paths of scene files are relative.
        plan_only: nothing is carried out, whatever the rows say.
        brief: without the `result` of each row.
        output: file to which results are added as JSON lines too.
        resume: rows that have a line in `output` are not done again.
        on_error: whether a row without a result is passed over, or ends the batch.
        on_event: told of the progress, after each row.
        total: number of rows, if `rows` does not know it.

    Raises:
        ControlError: `bad_record` if `output` has results of other rows; `cannot_write`;
            `worker_lost` if the executor has ended; the error of a row if that is to end the batch.
    """
    models = Registry.default() if registry is None else registry
    order_maker = RowOrders(models, Path(folder), plan_only=plan_only, brief=brief)
    orders = order_maker.orders(rows)
    total = len(rows) if total is None and isinstance(rows, Sized) else total
    with nullcontext() if output is None else ResultFile(Path(output), resume=resume) as file:
        kept = _skip_kept_rows(orders, file) if file and resume else 0
        meter = _ProgressMeter(kept, total, on_event)
        for result in _results(orders, executor, workers):
            if on_error == "stop" and not result.has_result and result.error_with_line:
                raise ControlError(result.error_with_line)
            if file:
                file.add(result)
            meter.count_row(result)
            yield result


def _skip_kept_rows(orders: Iterator[Order | RowResult], file: ResultFile) -> int:
    """Passes over the rows that have a line in the file; returns how many.

    Raises:
        ControlError: `bad_record` if these are other rows.
    """
    count = 0
    for count, kept in enumerate(file.kept_outcomes(), start=1):
        order = next(orders, None)
        if order is None or order.key != kept.key:
            raise error(
                "bad_record",
                f"{file.path}, line {count} is the result of another row, or of another version",
                suggestions=("give the rows that it was begun with", "choose another --output"),
            )
    return count


def _results(
    orders: Iterator[Order | RowResult], executor: Executor | None, workers: int | None
) -> Generator[RowResult]:
    """Results of orders; that of a row that ended two workers says so."""
    under_way = deque[Order | RowResult]()

    def noted_orders() -> Iterator[Order | RowResult]:
        for order in orders:
            under_way.append(order)
            yield order

    bundles = _bundles(noted_orders(), workers or os.cpu_count() or 1)
    tasks = finished_tasks(run_row, bundles, executor=executor, workers=workers)
    try:
        with closing(tasks):
            for future in tasks:
                order, raised = under_way.popleft(), future.exception()
                if isinstance(raised, ControlError):
                    raise raised
                yield future.result() if raised is None else _lost_row(order, raised)
    except BrokenExecutor as raised:
        raise error(
            "worker_lost",
            f"the workers have ended: {raised}",
            suggestions=("run it again with --resume: what was done is kept in --output",),
        ) from raised


def _bundles(
    orders: Iterator[Order | RowResult], workers: int
) -> Iterator[tuple[Order | RowResult, ...]]:
    """Orders that a worker carries out together: one execution, or some plans."""
    for is_carried_out, alike in groupby(orders, _is_carried_out):
        most = 1 if is_carried_out else PLANS_TOGETHER
        yield from _shrinking_bundles(alike, most, UNDER_WAY * workers)


def _shrinking_bundles(
    orders: Iterator[Order | RowResult], most: int, share: int
) -> Iterator[tuple[Order | RowResult, ...]]:
    """Bundles of so many orders, of fewer at the end, so that all workers end at about one time."""
    ahead = deque(islice(orders, most * share))
    while ahead:
        size = math.ceil(len(ahead) / share)
        yield tuple(ahead.popleft() for _ in range(size))
        ahead.extend(islice(orders, size))


def _is_carried_out(order: Order | RowResult) -> bool:
    return isinstance(order, Order) and order.row.execute


def _lost_row(order: Order | RowResult, raised: BaseException) -> RowResult:
    """The result of a row that ended the process that it was in, twice."""
    info = ErrorInfo(
        code="worker_lost",
        message=f"its worker has ended twice: {type(raised).__name__}: {raised}",
        suggestions=("look whether the machine ran out of memory, and run this row by itself",),
    )
    return RowResult(ok=False, line=order.line, key=order.key, status="lost", error=info)


class _ProgressMeter:
    """Counts rows and tells how far the batch is."""

    def __init__(
        self, kept: int, total: int | None, on_event: Callable[[BatchProgress], object] | None
    ) -> None:
        self._kept, self._total, self._tell = kept, total, on_event
        self._done = self._without = 0
        self._begun = time.monotonic()

    def count_row(self, result: RowResult) -> None:
        self._done += 1
        self._without += not result.has_result
        if self._tell is None:
            return
        rate = self._done / max(time.monotonic() - self._begun, 1e-9)
        done = self._kept + self._done
        left = None if self._total is None else max(self._total - done, 0) / rate
        self._tell(
            BatchProgress(
                done=done, total=self._total, without_result=self._without, rate=rate, left=left
            )
        )
