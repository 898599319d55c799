"""Store of the runs: what was asked, what happened, what came of it; after a crash as well.

A run is there from the moment when `add_run` returns, and its end from the moment when `put_run`
returns: these wait for the disk. Events do not. A process may be killed at any moment: at the next
opening the runs that had not ended are `cut_off`, and files that belong to no run are gone.

Runs that have ended are kept up to a number of bytes, theirs, their events' and their files'
together. When one more has ended, those that ended first are removed until that holds again; never
the last one, and never one that is queued or running.
"""

from __future__ import annotations

import errno
import fcntl
import os
import shutil
import sqlite3
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from threading import RLock
from types import MappingProxyType
from typing import IO, Any, Literal, NoReturn

from nlcontrol.errors import ControlError, ErrorInfo, error
from nlcontrol.installed_versions import installed_versions, platform_name
from nlcontrol.service.bundle import RunRequest, write_bundle
from nlcontrol.service.documents import NumberedEvent, RunInfo, RunPage, SessionSpec
from nlcontrol.session.events import Event
from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import PREFIX, error_of_system, replace_file

# Folder of a store: its database, a lock, and a folder of files for each run.
#
# Nothing that a caller says becomes a part of a path: the folder of a run is named by its number
# in the database. One process at a time has a store open; the lock ends with the process.


STORE_VARIABLE = "NLCONTROL_STORE"
"""Environment variable that names the folder of the store."""

FileKind = Literal["trace", "replay", "recording", "request", "bundle"]

FILE_NAMES: Mapping[FileKind, str] = MappingProxyType(
    {
        "trace": "trace.npz",
        "replay": "replay.html",
        "recording": "recording.json.gz",
        "request": "request.json",
        "bundle": "bundle.zip",
    }
)


def default_folder() -> Path:
    """The user's own store, unless the environment names another one."""
    named = os.environ.get(STORE_VARIABLE)
    if named:
        return Path(named)
    state = os.environ.get("LOCALAPPDATA" if os.name == "nt" else "XDG_STATE_HOME")
    home = Path(state) if state else Path.home() / ".local" / "state"
    return home / "nlcontrol" / "service"


def lock_folder(path: Path) -> IO[str]:
    """The lock of a store's folder, held until it is closed; the folder is made if need be.

    Raises:
        ControlError: `store_in_use`.
        ModelError: `cannot_write`.
    """
    try:
        path.mkdir(parents=True, exist_ok=True, mode=0o700)  # what people said is theirs
        (path / "runs").mkdir(exist_ok=True)
        lock = (path / "lock").open("a")
    except OSError as raised:
        raise error_of_system("cannot_write", "cannot be written to", path, raised) from raised
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as raised:
        lock.close()
        raise error(
            "store_in_use",
            f"another process has the store {path} open",
            suggestions=("end that one first", "give another folder with --store"),
        ) from raised
    return lock


# Tables of a store, and how those of an earlier version become those of this one.
#
# `user_version` of the database is the number of steps of `MIGRATIONS` that it has taken. A step
# is never changed once it has been released: what is to be different is a further step.


MIGRATIONS: tuple[tuple[str, ...], ...] = (
    (
        """CREATE TABLE sessions (
            session_id TEXT PRIMARY KEY,
            opened_at REAL NOT NULL,        -- seconds since 1970, UTC
            spec TEXT NOT NULL              -- JSON of a SessionSpec
        )""",
        """CREATE TABLE runs (
            number INTEGER PRIMARY KEY AUTOINCREMENT,   -- in the order of asking; never used twice
            run_id TEXT NOT NULL UNIQUE,
            session_id TEXT NOT NULL,
            state TEXT NOT NULL,            -- as in the document
            ended_at REAL,                  -- as in the document
            bytes INTEGER NOT NULL DEFAULT 0,           -- of it, its events and its files
            document TEXT NOT NULL          -- JSON of a RunInfo
        )""",
        "CREATE INDEX runs_by_session ON runs (session_id, number)",
        "CREATE INDEX runs_by_end ON runs (ended_at)",
        """CREATE TABLE events (
            run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
            number INTEGER NOT NULL,        -- in its run, from 1
            event TEXT NOT NULL,            -- JSON of an Event
            PRIMARY KEY (run, number)
        )""",
        """CREATE TABLE idempotency_keys (
            session_id TEXT NOT NULL,
            key BLOB NOT NULL,
            request BLOB NOT NULL,          -- digest of what was asked for under this key
            run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
            PRIMARY KEY (session_id, key)
        )""",
        "CREATE INDEX keys_by_run ON idempotency_keys (run)",
    ),
)
"""Steps from an empty database to the tables of this version."""


def open_database(path: Path) -> sqlite3.Connection:
    """A connection to the database of a store, with the tables of this version.

    The write-ahead log lets a process be killed at any moment: what was committed is there at the
    next opening, what was not has left nothing. Commits do not wait for the disk (NORMAL), so a
    power cut may take the last of them, but never damages the rest; where a caller was promised
    something, `RunStore` waits.

    Raises:
        ControlError: `bad_store`.
    """
    with ExitStack() as resources:
        try:
            connection = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
            connection.text_factory = _read_text
            resources.callback(connection.close)
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("PRAGMA synchronous = NORMAL")
            connection.execute("PRAGMA foreign_keys = ON")
            (told,) = connection.execute("PRAGMA quick_check(1)").fetchone()
            if told != "ok":
                raise ValueError(f"is damaged: {told}")
            _migrate(connection)
            # Looks for the tables that the steps have made.
            there = {name for (name,) in connection.execute("SELECT name FROM sqlite_master")}
            said = (statement.split() for step in MIGRATIONS for statement in step)
            missing = sorted(
                {words[2] for words in said if words[:2] == ["CREATE", "TABLE"]} - there
            )
            if missing:
                raise ValueError(f"is damaged: its table {missing[0]} is gone")
        except sqlite3.Error as raised:
            raise store_error(path, "cannot be opened", raised) from raised
        except ValueError as raised:
            raise _bad_store(path, str(raised)) from raised
        resources.pop_all()
    return connection


def store_error(path: Path, what: str, raised: sqlite3.Error) -> ControlError:
    """The error of a database that does not do what is asked, by the cause that SQLite names.

    Args:
        path: path of the database.
        what: what failed.
        raised: exception of SQLite.
    """
    cause = getattr(raised, "sqlite_errorcode", None)
    cause = None if cause is None else cause & 0xFF  # without what extends it
    message = f"the store {path} {what}: {raised}"
    for causes, code, hint in _CURES:
        if cause in causes:
            return error(code, message, suggestions=(hint,))
    return _bad_store(path, f"{what}: {raised}")


_DISK = "see whether its disk is full, is damaged, or has gone"

_CURES: tuple[tuple[frozenset[int], str, str], ...] = (
    (
        frozenset({sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED}),
        "store_locked",
        "end the program that has its file runs.sqlite open",
    ),
    (frozenset({sqlite3.SQLITE_FULL}), "store_full", "free some space on its disk"),
    (
        frozenset({sqlite3.SQLITE_READONLY, sqlite3.SQLITE_PERM, sqlite3.SQLITE_CANTOPEN}),
        "store_not_writable",
        "let this user write to its folder, or give another one with --store",
    ),
    (frozenset({sqlite3.SQLITE_IOERR}), "store_not_writable", _DISK),
)
"""What SQLite tells, the code of it, and what to do."""


def file_error(path: Path, raised: ModelError) -> ControlError:
    """The error of a file of a store that cannot be written, by the cause that the system names.

    Args:
        path: path of the store.
        raised: exception of the system as the file was written.
    """
    cause = getattr(raised.__cause__, "errno", None)
    full = cause in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
    code = "store_full" if full else "store_not_writable"
    hint = next(hint for _, known, hint in _CURES if known == code)
    return error(code, f"the store {path} cannot be written: {raised}", suggestions=(hint,))


def unwritable(message: str) -> ControlError:
    """The error of a file of the store that another process could not write."""
    return error("store_not_writable", f"the store: {message}", suggestions=(_DISK,))


def _read_text(content: bytes) -> str:
    """Text of a cell; bytes that are none cost that cell, which is then no document."""
    return content.decode("utf-8", "replace")


def _migrate(connection: sqlite3.Connection) -> None:
    """Takes the steps that a database has not taken yet, all or none.

    Raises:
        ValueError: it is of a later version.
    """
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    if version > len(MIGRATIONS):
        raise ValueError(f"is of version {version}; this program knows {len(MIGRATIONS)}")
    if version == len(MIGRATIONS):
        return
    connection.execute("BEGIN IMMEDIATE")
    try:
        for step in MIGRATIONS[version:]:
            for statement in step:
                connection.execute(statement)
        connection.execute(f"PRAGMA user_version = {len(MIGRATIONS)}")
    except BaseException:
        connection.execute("ROLLBACK")
        raise
    connection.execute("COMMIT")


def _bad_store(path: Path, message: str) -> ControlError:
    damaged = "move the folder away: a new store is begun in its place"
    earlier = "take the version of nlcontrol that wrote it"
    hints = ("give another folder with --store", earlier if "version" in message else damaged)
    return error("bad_store", f"the store {path} {message}", suggestions=hints)


KEEP_BYTES = 2_000_000_000
"""Bytes of ended runs that are kept, if nothing else is said."""

_UNDER_WAY = ("queued", "running")


class RunStore:
    """A store, open in this process alone; threads may share it.

    Args:
        folder: folder of the store; it is made if need be.
        keep_bytes: space for runs that have ended.

    Raises:
        ControlError: `store_in_use`, `bad_store`.
        ModelError: `cannot_write`.
    """

    def __init__(self, folder: Path, *, keep_bytes: int = KEEP_BYTES) -> None:
        self.keep_bytes = keep_bytes
        self._folder, self._runs = folder, folder / "runs"
        self._lock = lock_folder(folder)
        self._turn = RLock()
        try:
            self._database = open_database(folder / "runs.sqlite")
            self._recover()
        except BaseException:
            self._lock.close()
            raise

    def close(self) -> None:
        """Closes the store; another process may open it then."""
        with self._turn:
            self._database.close()
            self._lock.close()

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

    def add_run(self, info: RunInfo, *, key: str | None = None, request: bytes = b"") -> RunInfo:
        """Puts a run into the store, unless it is there under the same key.

        Args:
            info: the run.
            key: idempotency key of the caller, unique in the session; None for none.
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
            session_id: session whose runs are meant; all if not given.
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
        self._remove_files(number)

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
            self._remove_files(number)
        return len(old)

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
            raise file_error(self._folder, raised) from raised
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
            return self._runs / str(self._number(run_id)) / FILE_NAMES[kind]

    def _remove_files(self, number: int) -> None:
        shutil.rmtree(self._runs / str(number), ignore_errors=True)

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
        # What belongs to no run goes, and temporary files that nobody writes any more.
        names = {str(number) for (number,) in self._all("SELECT number FROM runs")}
        for folder in self._runs.iterdir():
            if folder.name not in names:
                shutil.rmtree(folder, ignore_errors=True)
        for left in self._runs.glob(f"*/{PREFIX}*"):
            left.unlink(missing_ok=True)
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
                raise store_error(self._folder, "cannot be written", raised) from raised

    def _all(self, query: str, *values: object) -> list[Any]:
        with self._turn:
            if self._database.in_transaction:  # which tells of it
                return self._database.execute(query, values).fetchall()
            try:
                return self._database.execute(query, values).fetchall()
            except sqlite3.Error as raised:
                raise store_error(self._folder, "cannot be read", raised) from raised

    def _one(self, query: str, *values: object) -> Any:
        return next(iter(self._all(query, *values)), None)

    def _number(self, run_id: str) -> int:
        row = self._one("SELECT number FROM runs WHERE run_id = ?", run_id)
        return int(row[0]) if row else _refuse_run(run_id)

    def _measure(self, number: int) -> None:
        """Notes how many bytes a run takes."""
        size = sum(file.stat().st_size for file in (self._runs / str(number)).glob("*"))
        self._database.execute(
            "UPDATE runs SET bytes = ? + length(CAST(document AS BLOB)) + (SELECT"
            " coalesce(sum(length(CAST(event AS BLOB))), 0) FROM events WHERE run = runs.number)"
            " WHERE number = ?",
            (size, number),
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
            run_id=str(run_id),
            session_id=str(session_id),
            kind="unknown",
            state="unreadable",
            text="",
            asked_at=0.0,
            ended_at=ended_at or 0.0,
            error=_UNREADABLE,
        )
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


# The bundle of a run in a store, made when somebody first asks for it.


def bundle_file(store: RunStore, run_id: str) -> Path:
    """The bundle of a run that has ended, in whichever way; it is kept beside the other files.

    Raises:
        ControlError: `unknown_run`, `run_under_way`, `no_file`; what the store does not take.
    """
    info = store.run(run_id)
    if info.state in ("queued", "running"):
        raise error(
            "run_under_way",
            f"the run {run_id} has not ended",
            suggestions=("ask for its bundle when it has",),
        )
    if store.file(run_id, "bundle") is None:
        request = _request(store, info)
        with store.write_file(run_id, "bundle") as path:
            write_bundle(
                path,
                request,
                info.result,
                events=store.events(run_id),
                trace=store.file(run_id, "trace"),
                replay=store.file(run_id, "replay"),
            )
    found = store.file(run_id, "bundle")
    if found is None:
        raise error(
            "no_file",
            f"the bundle of the run {run_id} has gone as it was written",
            suggestions=("ask again",),
        )
    return found


def _request(store: RunStore, info: RunInfo) -> RunRequest:
    """The request of a run; without a recipe if there is none that can be read."""
    path = store.file(info.run_id, "request")
    why_not = f"it was not carried out to its end: {info.state}"
    if path is not None:
        try:
            return RunRequest.model_validate_json(path.read_bytes())
        except ValueError:
            why_not = "its request in the store is damaged"
    spec = store.session_spec(info.session_id)
    return RunRequest(
        text=info.text,
        scene="" if spec is None else spec.scene,
        seed=0 if spec is None else spec.seed,
        versions=installed_versions(),
        platform=platform_name(),
        recipe=None,
        why_not=why_not,
    )
