"""File of a batch's results, one JSON line for each row in the order of the rows.

Lines are added as results come and are on the disk a second later at most. What a batch that was
killed left of its last line is no result: it is cut off before the next one is written.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

from pydantic import ValidationError

from nlcontrol.batches.row_result import RowOutcome, RowResult
from nlcontrol.errors import error, known_errors_raised
from objectmodels.files.yaml_documents import error_of_system

_SYNC_TIME = 1.0  # from one flush to the disk to the next [s]


def result_line(result: RowResult) -> str:
    """The line of a result, without its end."""
    return result.model_dump_json()


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
            self._file.write(result_line(result).encode() + b"\n")
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
