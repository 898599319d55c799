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
from array import array
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sized
from concurrent.futures import BrokenExecutor, Executor
from contextlib import AbstractContextManager, closing, contextmanager, nullcontext
from itertools import groupby, islice
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import Field, ValidationError

from nlcontrol.batches.row_orders import Row, RowOrders
from nlcontrol.batches.row_worker import Order, run_row
from nlcontrol.batches.rows import RowOutcome, RowResult
from nlcontrol.errors import ControlError, ErrorInfo, error, known_errors_raised
from nlcontrol.json_document import Document, DocumentPart
from nlcontrol.parallel_tasks import UNDER_WAY, finished_tasks
from objectmodels import Registry
from objectmodels.files.yaml_documents import error_of_system

# File of a batch's results, one JSON line for each row in the order of the rows.
#
# Lines are added as results come and are on the disk a second later at most. What a batch that
# was killed left of its last line is no result: it is cut off before the next one is written.


_SYNC_TIME = 1.0  # from one flush to the disk to the next [s]


def read_outcomes(path: Path) -> Iterator[RowOutcome]:
    """Outcomes in a file of results; half a last line is none.

    Raises:
        ControlError: `unreadable_file`, or `bad_record` with the line that is damaged.
    """
    for outcome, _ in _outcomes(path):
        yield outcome


class ResultFile(AbstractContextManager["ResultFile"]):
    """File to which results are added.

    Args:
        path: of the file.
        resume: whether it goes on after the results that it holds; there need not be any.

    Raises:
        ControlError: `cannot_write`.
    """

    def __init__(self, path: Path, *, resume: bool = False) -> None:
        self.path = path
        if not resume and os.path.lexists(path) and os.path.getsize(path):
            raise error(
                "cannot_write",
                f"{path} holds something already",
                suggestions=("go on after its results with --resume", "choose another file"),
            )
        with self._known_failures():
            self._file = path.open("ab")
        self._sync_due = time.monotonic() + _SYNC_TIME

    def kept_outcomes(self) -> Iterator[RowOutcome]:
        """Outcomes that it holds; then half a last line is cut off.

        Raises:
            ControlError: as `read_outcomes`.
        """
        end = 0
        for outcome, end in _outcomes(self.path):  # noqa: B007
            yield outcome
        self._file.truncate(end)

    def add(self, result: RowResult) -> None:
        """Adds a result.

        Raises:
            ControlError: `cannot_write`.
        """
        with self._known_failures():
            self._file.write(result.model_dump_json().encode() + b"\n")
            self._file.flush()
            if time.monotonic() > self._sync_due:
                os.fsync(self._file.fileno())
                self._sync_due = time.monotonic() + _SYNC_TIME

    def __exit__(self, *_: object) -> None:
        with self._known_failures(), self._file:
            self._file.flush()
            os.fsync(self._file.fileno())

    @contextmanager
    def _known_failures(self) -> Iterator[None]:
        with known_errors_raised():
            try:
                yield
            except OSError as raised:
                what = "cannot be written"
                raise error_of_system("cannot_write", what, self.path, raised) from raised


def _outcomes(path: Path) -> Iterator[tuple[RowOutcome, int]]:
    """Outcomes of the whole lines, each with the place in the file where its line ends."""
    end = 0
    with known_errors_raised():
        try:
            file = path.open("rb")
        except OSError as raised:
            raise error_of_system("unreadable_file", "cannot be read", path, raised) from raised
    with file:
        for number, line in enumerate(file, start=1):
            if not line.endswith(b"\n"):
                return
            end += len(line)
            try:
                outcome = RowOutcome.model_validate_json(line)
            except ValidationError as raised:
                fault = raised.errors(include_url=False)[0]
                raise error(
                    "bad_record",
                    f"{path}, line {number} is no result of a row: {fault['msg']}",
                    suggestions=("give the file that `nlcontrol batch --output` has written",),
                ) from raised
            yield outcome, end


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


# Summary of a batch: how many rows ended how, which clauses did not hold, how long it took.


PERCENTILES = (5, 50, 95, 99)


class Spread(DocumentPart):
    """Times by percentile [s].

    Attributes:
        total: sum of all.
        p5, p50, p95, p99: percentiles.
        most: the longest.
    """

    total: float
    p5: float
    p50: float
    p95: float
    p99: float
    most: float

    @classmethod
    def of(cls, times: Iterable[float]) -> Spread | None:
        """The spread of times; None of none."""
        found = np.fromiter(times, float)
        if not len(found):
            return None
        cuts = np.percentile(found, PERCENTILES).tolist()
        named = {f"p{p}": cut for p, cut in zip(PERCENTILES, cuts, strict=True)}
        return cls(total=float(found.sum()), most=float(found.max()), **named)


class BatchSummary(Document):
    """Summary of the results of a batch.

    Attributes:
        ok: every row has a result, be it a refusal.
        rows: how many.
        statuses: number of rows by their status.
        codes: number of rows by the code of their error.
        not_held: number of rows by the clause that did not hold.
        unknown: the same by the clause that can be neither confirmed nor denied.
        differs: the same by the clause of which an observer has another verdict than the robot.
        seconds: time of the rows in their workers, by the clock on the wall.
        simulated: time of executions.
        error: of the first row without a result.
    """

    ok: bool
    rows: int
    statuses: dict[str, int]
    codes: dict[str, int]
    not_held: dict[str, int]
    unknown: dict[str, int] = Field(default={})
    differs: dict[str, int] = Field(default={})
    seconds: Spread | None
    simulated: Spread | None
    error: ErrorInfo | None = None


class Tally:
    """Counts outcomes as they come."""

    def __init__(self) -> None:
        counted = ("statuses", "codes", "not_held", "unknown", "differs")
        self._counts = {name: Counter[str]() for name in counted}
        self._seconds, self._simulated = array("d"), array("d")
        self._error: ErrorInfo | None = None

    def add(self, outcome: RowOutcome) -> None:
        """Counts one more."""
        self._counts["statuses"][outcome.status] += 1
        for name in ("not_held", "unknown", "differs"):
            self._counts[name].update(set(getattr(outcome, name)))
        if outcome.error is not None:
            self._counts["codes"][outcome.error.code] += 1
        if outcome.has_result:
            self._seconds.append(outcome.seconds)
        elif self._error is None:
            self._error = outcome.error_with_line
        if outcome.simulated > 0.0:
            self._simulated.append(outcome.simulated)

    def summary(self) -> BatchSummary:
        """The summary of all that were counted."""
        counts = {name: dict(count.most_common()) for name, count in self._counts.items()}
        return BatchSummary(
            ok=self._error is None,
            rows=self._counts["statuses"].total(),
            statuses=counts["statuses"],
            codes=counts["codes"],
            not_held=counts["not_held"],
            unknown=counts["unknown"],
            differs=counts["differs"],
            seconds=Spread.of(self._seconds),
            simulated=Spread.of(self._simulated),
            error=self._error,
        )


def summarise(outcomes: Iterable[RowOutcome]) -> BatchSummary:
    """The summary of outcomes."""
    tally = Tally()
    for outcome in outcomes:
        tally.add(outcome)
    return tally.summary()


def summary_lines(summary: BatchSummary) -> Iterator[str]:
    """A summary as a table."""
    yield f"{summary.rows} rows"
    for title, counts in (
        ("", summary.statuses),
        ("by code", summary.codes),
        ("clauses that did not hold", summary.not_held),
        ("clauses that cannot be told", summary.unknown),
        ("clauses that an observer tells otherwise", summary.differs),
    ):
        if title and counts:
            yield f"{title}:"
        for name, count in counts.items():
            yield f"  {count:>8}  {100.0 * count / summary.rows:5.1f} %  {name}"
    spreads = (("seconds in a worker", summary.seconds), ("simulated seconds", summary.simulated))
    for title, spread in spreads:
        if spread is not None:
            cuts = ", ".join(f"{getattr(spread, f'p{p}'):.3g} ({p} %)" for p in PERCENTILES)
            yield f"{title}: {cuts}, at most {spread.most:.3g}, together {spread.total:.4g}"


def data_frame(outcomes: Iterable[RowOutcome]) -> Any:
    """A `pandas.DataFrame` of outcomes, a row for each, by line.

    Raises:
        ControlError: `missing_extra`.
    """
    try:
        import pandas as pd
    except ModuleNotFoundError as raised:
        raise error(
            "missing_extra",
            "a data frame needs the package pandas, which is not installed",
            suggestions=("pip install pandas",),
        ) from raised
    columns = [_columns_of(outcome) for outcome in outcomes]
    return pd.DataFrame(columns).set_index("line") if columns else pd.DataFrame()


def _columns_of(outcome: RowOutcome) -> dict[str, Any]:
    fields = outcome.model_dump(exclude={"schema_version", "error", "result"})
    return fields | {"code": outcome.error.code if outcome.error else None}


def save_summary_picture(summary: BatchSummary, path: Path) -> None:
    """Draws counts and times of a batch, as PNG, SVG or PDF."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 4.0), layout="constrained")
    bars, times = figure.subplots(1, 2)
    counts = {**summary.statuses, **{f"({code})": n for code, n in summary.codes.items()}}
    bars.barh(list(counts), list(counts.values()), color="#2f6fd0")
    bars.invert_yaxis()
    bars.set_xlabel(f"rows of {summary.rows}; codes in brackets")
    spreads = (("in a worker", summary.seconds), ("simulated", summary.simulated))
    for label, spread in spreads:
        if spread is not None:
            cuts = [getattr(spread, f"p{p}") for p in PERCENTILES]
            times.plot([*cuts, spread.most], [*PERCENTILES, 100], marker="o", label=label)
            times.legend()
    times.set(xlabel="time of a row [s]", ylabel="rows [%]", ylim=(0.0, 105.0))
    figure.savefig(path)


# Executor of a Dask cluster, as Dask itself offers it.


@contextmanager
def dask_executor(address: str) -> Iterator[tuple[Executor, int]]:
    """Context with the executor of a cluster, and the number of threads that work there now.

    Args:
        address: of its scheduler, as `tcp://host:8786`.

    Raises:
        ControlError: `missing_extra`; `no_service` if no scheduler answers.
    """
    try:
        from distributed import Client
    except ModuleNotFoundError as raised:
        if raised.name not in ("distributed", "dask"):
            raise
        raise error(
            "missing_extra",
            "--dask needs the package distributed, which is not installed",
            suggestions=("install from the checkout: pip install '.[dask]'",),
        ) from raised
    try:
        client = Client(address, set_as_default=False)
    except (OSError, ValueError) as raised:
        raise error(
            "no_service",
            f"no Dask scheduler answers at {address}: {raised}",
            suggestions=(
                "start one with `dask scheduler`, and workers with `dask worker ADDRESS`",
            ),
        ) from raised
    with client:
        client.wait_for_workers(1)
        # A row that is tried once more is another task, and digests of orders cost time.
        yield client.get_executor(pure=False), sum(client.nthreads().values())
