"""Result of a row, one line of a file of results."""

from __future__ import annotations

from typing import Literal

from pydantic import ConfigDict

from nlcontrol.errors import ErrorInfo
from nlcontrol.json_document import Document
from nlcontrol.results.result import Result, ResultStatus

RowStatus = ResultStatus | Literal["bad_row", "lost", "crashed"]


class RowOutcome(Document):
    """Outcome of a row in a few fields.

    Attributes:
        ok: as in the row's result; false if it has none.
        line: its place among the rows, from 1; in a file its line.
        id: as in the row.
        key: of all that determines the result: row, contents of its scene, models, versions.
        status: as in `Result`; `bad_row` if it is no row, `lost` if it ended two workers, `crashed`
            if a defect ended it.
        error: why it is not ok.
        not_held: clauses that did not hold.
        unknown: clauses that can be neither confirmed nor denied.
        differs: clauses of which an observer of the simulation has another verdict than the robot.
        seconds: time that it took in its worker, by the clock on the wall [s].
        simulated: time of its executions [s].
        digest: of result and trace; equal if and only if they are equal to the digit. Null if there
            is no result.
    """

    model_config = ConfigDict(defer_build=True, frozen=True, extra="ignore", allow_inf_nan=False)

    ok: bool
    line: int
    id: str | int | None = None
    key: str
    status: RowStatus
    error: ErrorInfo | None = None
    not_held: tuple[str, ...] = ()
    unknown: tuple[str, ...] = ()
    differs: tuple[str, ...] = ()
    seconds: float = 0.0
    simulated: float = 0.0
    digest: str | None = None

    @property
    def has_result(self) -> bool:
        """True if the row was carried out to a result, be it a refusal."""
        return self.digest is not None

    @property
    def error_with_line(self) -> ErrorInfo | None:
        """The error, with the line in its message."""
        if self.error is None:
            return None
        message = f"line {self.line}: {self.error.message}"
        return self.error.model_copy(update={"message": message})


class RowResult(RowOutcome):
    """Outcome of a row with its result.

    Attributes:
        result: of the sentence, without its trace; null if there is none, or it was left out.
    """

    result: Result | None = None
