"""Tables of a store, and how those of an earlier version become those of this one.

`user_version` of the database is the number of steps of `MIGRATIONS` that it has taken. A step is
never changed once it has been released: what is to be different is a further step.
"""

from __future__ import annotations

import errno
import sqlite3
from contextlib import ExitStack
from pathlib import Path

from nlcontrol.errors import ControlError, error
from objectmodels.errors import ModelError

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
            _require_sound(connection)
            _migrate(connection)
            _require_tables(connection)
        except sqlite3.Error as raised:
            raise store_error(path, "cannot be opened", raised) from raised
        except ValueError as raised:
            raise _bad_store(path, str(raised)) from raised
        resources.pop_all()
    return connection


def store_error(path: Path, what: str, raised: sqlite3.Error) -> ControlError:
    """The error of a database that does not do what is asked, by the cause that SQLite names.

    Args:
        path: of the database.
        what: did not go.
        raised: by SQLite.
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
        path: of the store.
        raised: as the file was written.
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


def _require_sound(connection: sqlite3.Connection) -> None:
    (told,) = connection.execute("PRAGMA quick_check(1)").fetchone()
    if told != "ok":
        raise ValueError(f"is damaged: {told}")


def _require_tables(connection: sqlite3.Connection) -> None:
    """Looks for the tables that the steps have made."""
    there = {name for (name,) in connection.execute("SELECT name FROM sqlite_master")}
    said = (statement.split() for step in MIGRATIONS for statement in step)
    missing = sorted({words[2] for words in said if words[:2] == ["CREATE", "TABLE"]} - there)
    if missing:
        raise ValueError(f"is damaged: its table {missing[0]} is gone")


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
