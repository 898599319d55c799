"""Faults of a service: each is a context, which has passed once it is left."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import socket
import sqlite3
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, suppress
from pathlib import Path

from benchmarks.kills.service_under_fault import DrawnCall, ServiceUnderFault

Fault = Callable[[ServiceUnderFault, DrawnCall], AbstractContextManager[None]]
"""Of a service, beside a call that is made in it."""

LONGEST_LOCK = 7.0
"""Time for which a store is locked at most [s]; SQLite waits for 5 s."""

FULL = 4096
"""Size beyond which no file grows where the disk is full [bytes]."""

_NO_TEXT = b"\xff\xfe{"
"""Bytes that are no text."""

_BAD: tuple[str | bytes, ...] = ("{", "{}", "null", "7", '{"run_id": 3}', _NO_TEXT)
"""In the place of documents."""


@contextmanager
def worker_killed(service: ServiceUnderFault, _: DrawnCall) -> Iterator[None]:
    """A process of the service is killed, now or within the call."""
    victim = service.rng.choice(service.workers() or [0])
    timer = threading.Timer(service.rng.choice((0.0, 0.05, 0.3)), _signal, (victim, signal.SIGKILL))
    timer.start()
    try:
        yield
    finally:
        timer.join()


@contextmanager
def worker_hung(service: ServiceUnderFault, _: DrawnCall) -> Iterator[None]:
    """A process of the service does nothing for a while."""
    victim = service.rng.choice(service.workers() or [0])
    _signal(victim, signal.SIGSTOP)
    try:
        yield
    finally:
        _signal(victim, signal.SIGCONT)


@contextmanager
def store_locked(service: ServiceUnderFault, _: DrawnCall) -> Iterator[None]:
    """Another program holds the database, all through the call or until it begins."""
    held_for = service.rng.choice((0.3, 1.0, LONGEST_LOCK))
    with service.database() as other:
        other.execute("BEGIN IMMEDIATE")
        try:
            if held_for < LONGEST_LOCK:
                time.sleep(held_for)
                other.execute("ROLLBACK")
            yield
        finally:
            if other.in_transaction:
                other.execute("ROLLBACK")


@contextmanager
def disk_full(service: ServiceUnderFault, _: DrawnCall) -> Iterator[None]:
    """No file of the service grows: a limit on their size stands for a full disk."""
    pid, unlimited = service.server.pid, resource.RLIM_INFINITY
    resource.prlimit(pid, resource.RLIMIT_FSIZE, (FULL, unlimited))
    try:
        yield
    finally:
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (unlimited, unlimited))


@contextmanager
def row_garbled(service: ServiceUnderFault, _: DrawnCall) -> Iterator[None]:
    """The row of a run is damaged: its document, or a column beside it."""
    run_id = _newest(service)
    bad = service.rng.choice(_BAD)
    column = service.rng.choice(("document", "document", "ended_at", "session_id"))
    with _garbled(service, "runs", column, bad, "run_id = ?", (run_id,)):
        yield


@contextmanager
def event_garbled(service: ServiceUnderFault, _: DrawnCall) -> Iterator[None]:
    """An event of a run is damaged."""
    where = "number = 1 AND run = (SELECT number FROM runs WHERE run_id = ?)"
    bad = service.rng.choice(_BAD)
    with _garbled(service, "events", "event", bad, where, (_newest(service),)):
        yield


@contextmanager
def file_missing(service: ServiceUnderFault, _: DrawnCall) -> Iterator[None]:
    """A file of a run is gone, or a folder stands in its place."""
    files = sorted(service.runs_folder.glob("*/*.*"))[-8:]
    if not files:
        yield
        return
    file = service.rng.choice(files)
    away = service.server.store / "taken away"
    with suppress(FileNotFoundError):
        file.rename(away)
    as_folder = service.rng.random() < 0.3
    if as_folder:
        with suppress(OSError):
            file.mkdir()
    try:
        yield
    finally:
        if file.is_dir():
            file.rmdir()
        if file.parent.is_dir() and away.exists() and not file.exists():
            away.rename(file)
        away.unlink(missing_ok=True)


@contextmanager
def folder_not_writable(service: ServiceUnderFault, _: DrawnCall) -> Iterator[None]:
    """No file of a run can be written, nor read: a file stands in the place of their folder.

    Taking permissions away would not do where the service may do everything.
    """
    folders = [service.runs_folder, *sorted(service.runs_folder.iterdir(), key=_number)[-3:]]
    folder = service.rng.choice(folders)
    away = service.server.store / "runs away"
    with suppress(FileNotFoundError):
        folder.rename(away)
    with suppress(OSError):
        folder.touch()
    try:
        yield
    finally:
        if folder.is_file():
            folder.unlink()
        if away.is_dir():
            if folder.is_dir() or not folder.parent.is_dir():  # it was made anew, or deleted
                shutil.rmtree(away)
            else:
                away.rename(folder)


@contextmanager
def server_killed(service: ServiceUnderFault, _: DrawnCall) -> Iterator[None]:
    """The service is killed as the call is under way, and started again after it."""
    timer = threading.Timer(service.rng.choice((0.0, 0.02, 0.2)), _signal, (service.server.pid, 9))
    timer.start()
    try:
        yield
    finally:
        timer.join()
        service.restart()


@contextmanager
def caller_gone(service: ServiceUnderFault, call: DrawnCall) -> Iterator[None]:
    """Another caller sends the same, or the half of it, and hangs up."""
    content = call.raw(service.server.port)
    if service.rng.random() < 0.5:
        content = content[: max(1, len(content) - 3)]
    with suppress(OSError), socket.create_connection(("127.0.0.1", service.server.port)) as line:
        line.sendall(content)
        time.sleep(service.rng.choice((0.0, 0.05)))
    yield


@contextmanager
def slow_reader(service: ServiceUnderFault, call: DrawnCall) -> Iterator[None]:
    """Others ask the same and read nothing of the answer."""
    content = call.raw(service.server.port)
    lines = [socket.create_connection(("127.0.0.1", service.server.port)) for _ in range(3)]
    try:
        for line in lines if call.method == "GET" else lines[:1]:
            line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
            with suppress(OSError):
                line.sendall(content)
        yield
    finally:
        for line in lines:
            line.close()


FAULTS: Mapping[Fault, float] = {
    worker_killed: 10,
    worker_hung: 6,
    store_locked: 6,
    disk_full: 10,
    row_garbled: 15,
    event_garbled: 10,
    file_missing: 12,
    folder_not_writable: 10,
    server_killed: 4,
    caller_gone: 12,
    slow_reader: 12,
}
"""All of them, by how often they are tried."""


@contextmanager
def _garbled(
    service: ServiceUnderFault,
    table: str,
    column: str,
    bad: str | bytes,
    where: str,
    values: tuple[str, ...],
) -> Iterator[None]:
    """Context in which a cell is damaged; bytes are put there as if they were text."""
    put = "CAST(? AS TEXT)" if isinstance(bad, bytes) else "?"
    with service.database() as other:
        other.text_factory = bytes
        before = other.execute(f"SELECT {column} FROM {table} WHERE {where}", values).fetchone()
        other.execute(f"UPDATE {table} SET {column} = {put} WHERE {where}", (bad, *values))
    try:
        yield
    finally:
        if before is not None:
            old = "CAST(? AS TEXT)" if isinstance(before[0], bytes) else "?"
            mend = f"UPDATE {table} SET {column} = {old} WHERE {where} AND {column} IS {put}"
            # Where the service has written the cell anew, it stays.
            with service.database() as other, suppress(sqlite3.IntegrityError):
                other.execute(mend, (before[0], *values, bad))


def _newest(service: ServiceUnderFault) -> str:
    """Id of one of the newest runs."""
    return service.rng.choice([*service.told, "none"][-5:])


def _number(folder: Path) -> int:
    return int(folder.name) if folder.name.isdigit() else 0


def _signal(pid: int, number: int) -> None:
    if pid:
        with suppress(ProcessLookupError):
            os.kill(pid, number)
