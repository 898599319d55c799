"""Summary of a batch: how many rows ended how, which clauses did not hold, how long it took."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import Field

from nlcontrol.batches.row_result import RowOutcome
from nlcontrol.errors import ErrorInfo, error
from nlcontrol.json_document import Document, DocumentPart

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
        self._statuses, self._codes = Counter[str](), Counter[str]()
        self._not_held, self._unknown = Counter[str](), Counter[str]()
        self._differs = Counter[str]()
        self._seconds, self._simulated = array("d"), array("d")
        self._error: ErrorInfo | None = None

    def add(self, outcome: RowOutcome) -> None:
        """Counts one more."""
        self._statuses[outcome.status] += 1
        self._not_held.update(set(outcome.not_held))
        self._unknown.update(set(outcome.unknown))
        self._differs.update(set(outcome.differs))
        if outcome.error is not None:
            self._codes[outcome.error.code] += 1
        if outcome.has_result:
            self._seconds.append(outcome.seconds)
        elif self._error is None:
            self._error = outcome.error_with_line
        if outcome.simulated > 0.0:
            self._simulated.append(outcome.simulated)

    def summary(self) -> BatchSummary:
        """The summary of all that were counted."""
        return BatchSummary(
            ok=self._error is None,
            rows=self._statuses.total(),
            statuses=dict(self._statuses.most_common()),
            codes=dict(self._codes.most_common()),
            not_held=dict(self._not_held.most_common()),
            unknown=dict(self._unknown.most_common()),
            differs=dict(self._differs.most_common()),
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
