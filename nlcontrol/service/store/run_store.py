"""Store of the runs: what was asked, what happened, what came of it; after a crash as well.

A run is there from the moment when `add_run` returns, and its end from the moment when `put_run`
returns: these wait for the disk. Events do not. A process may be killed at any moment: at the next
opening the runs that had not ended are `cut_off`, and files that belong to no run are gone.

Runs that have ended are kept up to a number of bytes, theirs, their events' and their files'
together. When one more has ended, those that ended first are removed until that holds again; never
the last one, and never one that is queued or running.
"""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from threading import RLock
from typing import Any, NoReturn

from nlcontrol.errors import ErrorInfo, error
from nlcontrol.service.documents import NumberedEvent, RunInfo, RunPage, SessionSpec
from nlcontrol.service.store.store_folder import FileKind, StoreFolder
from nlcontrol.service.store.store_schema import file_error, open_database, store_error
from nlcontrol.session.events import Event
from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import replace_file

KEEP_BYTES = 2_000_000_000
"""Bytes of ended runs that are kept, if nothing else is said."""

_UNDER_WAY = ("queued", "running")


class RunStore:
    """A store, open in this process alone; threads may share it.

    Args:
        folder: of it; it is made if need be.
        keep_bytes: of the runs that have ended.

    Raises:
        ControlError: `store_in_use`, `bad_store`.
        ModelError: `cannot_write`.
    """

    def __init__(self, folder: Path, *, keep_bytes: int = KEEP_BYTES) -> None:
        self.keep_bytes = keep_bytes
        self._folder = StoreFolder(folder)
        self._turn = RLock()
        try:
            self._database = open_database(self._folder.database)
            self._recover()
        except BaseException:
            self._folder.close()
            raise

    def close(self) -> None:
        """Closes the store; another process may open it then."""
        with self._turn:
            self._database.close()
            self._folder.close()

    # --- sessions ------------------------------------------------------------------------------

    def add_session(self, session_id: str, spec: SessionSpec) -> None:
        """Notes that a session was opened; it is kept as long as a run of it."""
        with self._transaction():
            self._database.execute(
                "INSERT INTO sessions VALUES (?, ?, ?)",
                (session_id, time.time(), spec.model_dump_json()),
            )

    def session_spec(self, session_id: str) -> SessionSpec | None:
        """The session as it was asked for; None if it is not known (any more)."""
        row = self._one("SELECT spec FROM sessions WHERE session_id = ?", session_id)
        return None if row is None else SessionSpec.model_validate_json(row[0])

    # --- runs ----------------------------------------------------------------------------------

    def add_run(self, info: RunInfo, *, key: str | None = None, request: bytes = b"") -> RunInfo:
        """Puts a run into the store, unless it is there under the same key.

        Args:
            info: the run.
            key: under which the caller asks for it, once per session; None for none.
            request: a digest of what is asked for; the same for the same key.

        Returns:
            The run, or the one that was begun under that key.

        Raises:
            ControlError: `key_reused` if something else was asked for under that key.
        """
        with self._transaction(promised=True):
            if key is not None and (known := self.run_of_key(info.session_id, key, request)):
                return known
            added = self._database.execute(
                "INSERT INTO runs (run_id, session_id, state, ended_at, document)"
                " VALUES (:run_id, :session_id, :state, :ended_at, :document)",
                _row(info),
            )
            if key is not None:
                self._database.execute(
                    "INSERT INTO idempotency_keys VALUES (?, ?, ?, ?)",
                    (
                        info.session_id,
                        key.encode("utf-8", "surrogatepass"),
                        request,
                        added.lastrowid,
                    ),
                )
        return info

    def run_of_key(self, session_id: str, key: str, request: bytes) -> RunInfo | None:
        """The run that a session has under a key, or None; raises `key_reused` (see `add_run`)."""
        found = self._one(_KEYED, session_id, key.encode("utf-8", "surrogatepass"))
        if found is None:
            return None
        if found[1] != request:
            raise error(
                "key_reused",
                "this idempotency key belongs to another request",
                suggestions=("give each request a key of its own",),
            )
        return self.run(found[0])

    def put_run(self, info: RunInfo) -> None:
        """Replaces what is known of a run; once it has ended, older ones may be removed.

        Raises:
            ControlError: `unknown_run`.
        """
        with self._transaction(promised=True):
            number = self._number(info.run_id)
            self._database.execute(
                "UPDATE runs SET state = :state, ended_at = :ended_at, document = :document"
                " WHERE run_id = :run_id",
                _row(info),
            )
            self._measure(number)
        if info.state not in _UNDER_WAY:
            self.remove_old_runs()

    def run(self, run_id: str) -> RunInfo:
        """A run as it was last put here, with the number of its events.

        Raises:
            ControlError: `unknown_run`.
        """
        row = self._one(f"{_SELECT} WHERE run_id = ?", run_id)
        return _run_info(row) if row else _refuse_run(run_id)

    def runs(
        self, session_id: str | None = None, *, cursor: str | None = None, limit: int = 50
    ) -> RunPage:
        """Runs, the newest first, a page at a time.

        Runs that are added or removed meanwhile make no other run appear twice or never.

        Args:
            session_id: of whose runs; of all if not given.
            cursor: `RunPage.cursor` of the page before.
            limit: number of runs on the page.

        Raises:
            ControlError: `bad_cursor`.
        """
        below = _number_of_cursor(cursor)
        rows = self._all(
            f"{_SELECT} WHERE number < ? AND session_id = coalesce(?, session_id)"
            " ORDER BY number DESC LIMIT ?",
            *(below, session_id, limit + 1),
        )
        more = str(rows[limit - 1][0]) if len(rows) > limit else None
        return RunPage(runs=tuple(map(_run_info, rows[:limit])), cursor=more)

    def delete_run(self, run_id: str) -> None:
        """Removes a run, its events and its files.

        Raises:
            ControlError: `unknown_run`; `run_under_way` if it has not ended.
        """
        with self._transaction(promised=True):
            number = self._number(run_id)
            if self.run(run_id).state in _UNDER_WAY:
                raise error(
                    "run_under_way",
                    f"the run {run_id} has not ended",
                    suggestions=("stop it, and wait until it has ended",),
                )
            self._database.execute("DELETE FROM runs WHERE number = ?", (number,))
        self._folder.remove_files(number)

    def remove_old_runs(self) -> int:
        """Removes runs that ended first, until those that are left keep to the limit of bytes.

        Returns:
            How many were removed.
        """
        with self._transaction():
            rows = self._all(
                "SELECT number, bytes FROM runs WHERE state NOT IN (?, ?)"
                " ORDER BY ended_at, number",
                *_UNDER_WAY,
            )
            total = sum(size for _, size in rows)
            old: list[int] = []
            for number, size in rows[:-1]:
                if total <= self.keep_bytes:
                    break
                total -= size
                old.append(number)
                self._database.execute("DELETE FROM runs WHERE number = ?", (number,))
        for number in old:
            self._folder.remove_files(number)
        return len(old)

    # --- events --------------------------------------------------------------------------------

    def add_events(self, run_id: str, events: Sequence[NumberedEvent]) -> None:
        """Adds events to a run; a number that is there already stays as it is.

        Raises:
            ControlError: `unknown_run`.
        """
        with self._transaction():
            number = self._number(run_id)
            self._database.executemany(
                "INSERT OR IGNORE INTO events VALUES (?, ?, ?)",
                [(number, each.number, each.event.model_dump_json()) for each in events],
            )

    def events(self, run_id: str, after: int = 0) -> tuple[NumberedEvent, ...]:
        """The events of a run that follow a number, in their order.

        Raises:
            ControlError: `unknown_run`.
        """
        with self._turn:
            rows = self._all(
                "SELECT number, event FROM events WHERE run = ? AND number > ? ORDER BY number",
                *(self._number(run_id), after),
            )
        return tuple(filter(None, (_event(number, text) for number, text in rows)))

    # --- files ---------------------------------------------------------------------------------

    @contextmanager
    def write_file(self, run_id: str, kind: FileKind) -> Iterator[Path]:
        """A temporary file that becomes a file of a run when all went well.

        Raises:
            ControlError: `unknown_run`, `store_full`, `store_not_writable`.
        """
        path = self._file(run_id, kind)
        try:
            with replace_file(path, private=True) as temporary:
                yield temporary
        except ModelError as raised:
            if raised.code != "cannot_write":
                raise
            raise file_error(self._folder.path, raised) from raised
        with self._transaction():
            self._measure(self._number(run_id))

    def file(self, run_id: str, kind: FileKind) -> Path | None:
        """A file of a run; None if there is none of that kind.

        Raises:
            ControlError: `unknown_run`.
        """
        path = self._file(run_id, kind)
        return path if path.is_file() else None

    def _file(self, run_id: str, kind: FileKind) -> Path:
        with self._turn:
            return self._folder.file(self._number(run_id), kind)

    # --- inside --------------------------------------------------------------------------------

    def _recover(self) -> None:
        """Marks the runs that a crash has cut off, and removes what it left."""
        with self._transaction(promised=True):
            for row in self._all(f"{_SELECT} WHERE state IN (?, ?)", *_UNDER_WAY):
                info = _run_info(row).model_copy(
                    update={
                        "state": "cut_off",
                        "place": None,
                        "ended_at": time.time(),
                        "error": _CUT_OFF,
                    }
                )
                self._database.execute(
                    "UPDATE runs SET state = :state, ended_at = :ended_at, document = :document"
                    " WHERE run_id = :run_id",
                    _row(info),
                )
                self._measure(row[0])
            self._database.execute(
                "DELETE FROM sessions WHERE session_id NOT IN (SELECT session_id FROM runs)"
            )
        self._folder.clean([number for (number,) in self._all("SELECT number FROM runs")])
        self.remove_old_runs()

    @contextmanager
    def _transaction(self, *, promised: bool = False) -> Iterator[None]:
        """All or nothing of what is done in it.

        Args:
            promised: whether it is on the disk at the end, even if the power fails.
        """
        with self._turn:
            if self._database.in_transaction:  # of the caller, in this thread
                yield
                return
            try:
                self._database.execute(f"PRAGMA synchronous = {'FULL' if promised else 'NORMAL'}")
                self._database.execute("BEGIN IMMEDIATE")
                try:
                    yield
                    self._database.execute("COMMIT")
                except BaseException:
                    if self._database.in_transaction:
                        self._database.execute("ROLLBACK")
                    raise
            except sqlite3.Error as raised:
                raise store_error(self._folder.path, "cannot be written", raised) from raised

    def _all(self, query: str, *values: object) -> list[Any]:
        with self._turn:
            if self._database.in_transaction:  # which tells of it
                return self._database.execute(query, values).fetchall()
            try:
                return self._database.execute(query, values).fetchall()
            except sqlite3.Error as raised:
                raise store_error(self._folder.path, "cannot be read", raised) from raised

    def _one(self, query: str, *values: object) -> Any:
        return next(iter(self._all(query, *values)), None)

    def _number(self, run_id: str) -> int:
        row = self._one("SELECT number FROM runs WHERE run_id = ?", run_id)
        return int(row[0]) if row else _refuse_run(run_id)

    def _measure(self, number: int) -> None:
        """Notes how many bytes a run takes."""
        self._database.execute(
            "UPDATE runs SET bytes = ? + length(CAST(document AS BLOB)) + (SELECT"
            " coalesce(sum(length(CAST(event AS BLOB))), 0) FROM events WHERE run = runs.number)"
            " WHERE number = ?",
            (self._folder.file_bytes(number), number),
        )


_SELECT = """SELECT number, run_id, session_id, ended_at, document,
    (SELECT coalesce(max(events.number), 0) FROM events WHERE run = runs.number) FROM runs"""

_KEYED = """SELECT run_id, request FROM runs JOIN idempotency_keys ON run = number
    WHERE idempotency_keys.session_id = ? AND key = ?"""

_CUT_OFF = ErrorInfo(
    code="cut_off",
    message="the service ended while this was queued or carried out",
    suggestions=("look at the table, and say it again",),
)


_UNREADABLE = ErrorInfo(
    code="unreadable",
    message="what the store has of this run is damaged",
    suggestions=("delete the run", "see what its files have"),
)


def _row(info: RunInfo) -> dict[str, object]:
    """Row of a run in the table of runs."""
    return {
        "run_id": info.run_id,
        "session_id": info.session_id,
        "state": info.state,
        "ended_at": info.ended_at,
        "document": info.model_dump_json(),
    }


def _run_info(row: tuple[int, str, str, float | None, str, int]) -> RunInfo:
    """The run of a row; one whose document is damaged is told as that, and takes no other along."""
    _, run_id, session_id, ended_at, document, events = row
    try:
        info = RunInfo.model_validate_json(document)
    except ValueError:
        info = RunInfo(
            run_id=str(run_id), session_id=str(session_id), kind="unknown", state="unreadable",
            text="", asked_at=0.0, ended_at=ended_at or 0.0, error=_UNREADABLE,
        )  # fmt: skip
    return info.model_copy(update={"events": events})


def _event(number: int, text: str) -> NumberedEvent | None:
    """The event of a row; None if the row is damaged."""
    try:
        return NumberedEvent(number=number, event=Event.model_validate_json(text))
    except ValueError:
        return None


def _refuse_run(run_id: str) -> NoReturn:
    raise error(
        "unknown_run",
        f"there is no run {run_id[:80]!r}",
        suggestions=("list the runs: it may have been deleted, or have been too old to keep",),
    )


def _number_of_cursor(cursor: str | None) -> int:
    if cursor is None:
        return 2**63 - 1
    if not (cursor.isascii() and cursor.isdigit() and len(cursor) <= 18):
        raise error(
            "bad_cursor",
            f"{cursor[:80]!r} is no cursor",
            suggestions=("take the `cursor` of the page before as it is",),
        )
    return int(cursor)
