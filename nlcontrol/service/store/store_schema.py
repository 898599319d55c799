"""Tables of a store, and how those of an earlier version become those of this one.

`user_version` of the database is the number of steps of `MIGRATIONS` that it has taken. A step is
never changed once it has been released: what is to be different is a further step.
"""

from __future__ import annotations

import sqlite3
from pathlib import Path

from nlcontrol.errors import error

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
    connection = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
    try:
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("PRAGMA synchronous = NORMAL")
        connection.execute("PRAGMA foreign_keys = ON")
        _migrate(connection)
    except sqlite3.DatabaseError as raised:
        connection.close()
        raise _bad_store(path, f"cannot be opened: {raised}") from raised
    except ValueError as raised:
        connection.close()
        raise _bad_store(path, str(raised)) from raised
    return connection


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


def _bad_store(path: Path, message: str) -> Exception:
    hints = ("give another folder with --store", "take the version of nlcontrol that wrote it")
    return error("bad_store", f"the store {path} {message}", suggestions=hints)
