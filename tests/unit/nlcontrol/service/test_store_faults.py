"""A store that is locked, full or damaged: each has its code, and costs no more than it must."""

from __future__ import annotations

import errno
import os
import sqlite3
import threading
from collections.abc import Iterator
from concurrent.futures import Future
from pathlib import Path
from typing import Any, cast

import pytest

from nlcontrol.errors import ControlError, ErrorInfo, error
from nlcontrol.service import planning_service
from nlcontrol.service.documents import RunInfo, SessionSpec
from nlcontrol.service.planning_service import RunFiles
from nlcontrol.service.run_store import RunStore, bundle_file, store_error
from nlcontrol.service.service_settings import ServiceSettings
from nlcontrol.service.workers import live_runs
from nlcontrol.service.workers.live_runs import LiveRuns
from nlcontrol.service.workers.live_session import LiveSession
from nlcontrol.service.workers.session_host import RunEnd
from nlcontrol.service.workers.worker_process import WorkerProcess
from tests.patience import PATIENCE, wait_until
from tests.unit.nlcontrol.service.test_run_store import ended_info, event, run_info


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Of a store with two runs that have ended."""
    store = RunStore(tmp_path / "store")
    for name in ("first", "second"):
        store.add_run(run_info(name))
        store.add_events(name, [event(1), event(2)])
        store.put_run(ended_info(name))
        with store.write_file(name, "request") as path:
            path.write_text("{}")
    store.close()
    return tmp_path / "store"


@pytest.fixture
def store(folder: Path) -> Iterator[RunStore]:
    opened = RunStore(folder)
    yield opened
    opened.close()


def damage(folder: Path, statement: str) -> None:
    with sqlite3.connect(folder / "runs.sqlite") as database:
        database.execute(statement)
    database.close()


def test_a_damaged_run_takes_no_other_along(folder: Path) -> None:
    damage(folder, "UPDATE runs SET document = '{' WHERE run_id = 'first'")
    store = RunStore(folder)
    told = {info.run_id: info for info in store.runs().runs}
    assert told["second"].state == "ended"
    broken = told["first"]
    assert (broken.state, broken.error and broken.error.code) == ("unreadable", "unreadable")
    assert len(store.events("first")) == 2
    store.delete_run("first")
    assert [info.run_id for info in store.runs().runs] == ["second"]
    store.close()


@pytest.mark.parametrize("column", ["document", "session_id"])
def test_bytes_that_are_no_text_cost_their_row_alone(folder: Path, column: str) -> None:
    damage(folder, f"UPDATE runs SET {column} = CAST(x'fffe7b' AS TEXT) WHERE run_id = 'first'")
    damage(folder, "UPDATE events SET event = CAST(x'fffe7b' AS TEXT) WHERE run = 2 AND number = 1")
    store = RunStore(folder)
    told = {info.run_id: info.state for info in store.runs().runs}
    assert told == {"first": "unreadable" if column == "document" else "ended", "second": "ended"}
    assert store.events("second") == (event(2),)
    store.close()


def test_a_damaged_event_and_a_damaged_request_cost_themselves(folder: Path) -> None:
    damage(folder, "UPDATE events SET event = 'no JSON' WHERE run = 1 AND number = 1")
    store = RunStore(folder)
    assert store.events("first") == (event(2),)
    assert bundle_file(store, "first").is_file()  # its request is no RunRequest
    trace = store.file("second", "request")
    assert trace is not None
    trace.unlink()
    trace.mkdir()
    assert store.file("second", "request") is None
    store.close()


def _zero_half(folder: Path) -> None:
    with (folder / "runs.sqlite").open("r+b") as file:
        size = file.seek(0, 2)
        file.seek(size // 2)
        file.write(bytes(size - size // 2))


def _make_folder(folder: Path) -> None:
    (folder / "runs.sqlite").unlink()
    (folder / "runs.sqlite").mkdir()


@pytest.mark.parametrize(
    ("harm", "code"),
    [
        (_zero_half, "bad_store"),
        (lambda folder: damage(folder, "DROP TABLE events"), "bad_store"),
        (_make_folder, "store_not_writable"),
        (lambda folder: (folder / "runs.sqlite").write_bytes(b"no database" * 99), "bad_store"),
    ],
)
def test_a_damaged_store_is_told_as_it_is_opened(folder: Path, harm: Any, code: str) -> None:
    harm(folder)
    with pytest.raises(ControlError) as raised:
        RunStore(folder)
    assert raised.value.code == code
    assert raised.value.info.suggestions


def test_a_locked_and_a_full_store_have_their_codes(
    store: RunStore, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    database = store._database
    database.execute("PRAGMA busy_timeout = 10")
    other = sqlite3.connect(folder / "runs.sqlite", isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    assert _code(store) == "store_locked"
    other.execute("ROLLBACK")
    other.close()
    (pages,) = database.execute("PRAGMA page_count").fetchone()
    database.execute(f"PRAGMA max_page_count = {pages}")
    assert _code(store, "x" * 10**6) == "store_full"
    database.execute("PRAGMA max_page_count = 1000000")
    store.add_run(run_info("third"))


def test_files_that_cannot_be_written_are_told_as_the_store(
    store: RunStore, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (files := folder / "runs" / "1").rename(folder / "away")
    files.touch()
    with pytest.raises(ControlError) as raised:
        bundle_file(store, "first")
    assert raised.value.code == "store_not_writable"
    monkeypatch.setattr(os, "fsync", _full_disk)
    with pytest.raises(ControlError) as raised:
        bundle_file(store, "second")
    assert raised.value.code == "store_full"
    assert raised.value.info.suggestions


def _full_disk(_: object) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


def test_a_disk_that_fails_does_not_condemn_the_store(tmp_path: Path) -> None:
    """SQLite tells the same of a limit of size; the folder is not to be moved away for that."""
    raised = sqlite3.OperationalError("disk I/O error")
    raised.sqlite_errorcode = sqlite3.SQLITE_IOERR_WRITE
    assert store_error(tmp_path, "cannot be written", raised).code == "store_not_writable"


class ReplayProcess:
    """A process that makes replays, and cannot."""

    code = "bad_trace"

    def __init__(self, _: object) -> None:
        self.future: Future[bytes] = Future()
        self.future.set_exception(ControlError(ErrorInfo(code=self.code, message="it is none")))

    def call(self, *_: object, **__: object) -> Future[bytes]:
        return self.future

    def kill(self) -> None:
        pass


def test_a_damaged_trace_costs_its_replay_and_not_the_bundle(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    store.add_session("s", SessionSpec())
    with store.write_file("first", "trace") as path:
        path.write_bytes(b"no trace")
    monkeypatch.setattr(planning_service, "WorkerProcess", ReplayProcess)
    files = RunFiles(store, time_limit=PATIENCE)
    with pytest.raises(ControlError) as raised:
        files.file("first", "replay")
    assert raised.value.code == "no_file"
    assert "damaged" in raised.value.info.message
    monkeypatch.setattr(ReplayProcess, "code", "system_error")
    with pytest.raises(ControlError) as raised:
        files.file("first", "replay")
    assert raised.value.code == "store_not_writable"
    assert files.file("first", "bundle").is_file()


def _code(store: RunStore, text: str = "") -> str:
    with pytest.raises(ControlError) as raised:
        store.add_run(run_info("third", text=text))
    return raised.value.code


# --- runs beside a store that fails -----------------------------------------------------------


class Process:
    """A process of a session as runs see it: it begins what it is asked to."""

    def __init__(self) -> None:
        self.called: list[str] = []

    def command(self, method: str) -> Future[bytes]:
        return self.call(method)

    def call(self, method: str, **arguments: Any) -> Future[bytes]:
        self.called.append(method)
        future: Future[bytes] = Future()
        begun = run_info("", state="running", begun_at=1.0).model_dump_json().encode()
        future.set_result(begun if method == "begin_run" else b"{}")
        return future


@pytest.fixture
def process() -> Process:
    return Process()


@pytest.fixture
def session(process: Process) -> LiveSession:
    worker = cast("WorkerProcess", process)
    session = LiveSession("session", SessionSpec(), ServiceSettings())
    session.process = worker
    return session


ASKED = {"plan_id": None, "said": "push it", "motion": None}
BUSY = error("busy", "another run is under way", suggestions=("wait",))


def _failing(*_: object, **__: object) -> None:
    raise error("store_full", "it is full", suggestions=("free some space",))


def test_a_run_that_cannot_be_noted_leaves_no_ghost(
    store: RunStore, session: LiveSession, process: Process, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs = LiveRuns(store, workers=1, queue=1)
    with monkeypatch.context() as patch:
        patch.setattr(store, "add_run", _failing)
        with pytest.raises(ControlError) as raised:
            runs.begin(session, ASKED, None)
    assert raised.value.code == "store_full"
    assert process.called == ["begin_run", "drop_run"]
    assert session.run_id is None
    assert runs.begin(session, ASKED, None).state == "running"


@pytest.mark.parametrize(
    ("method", "undone"),
    [
        ("begin_run", [[], ["drop_run"]]),  # once it has begun: it would wait for its turn for ever
        ("ask", [["give_up_answer"], ["give_up_answer"]]),  # at once: it may move something
        ("plan", [[], []]),  # it ends by itself
    ],
)
def test_what_is_answered_too_late_is_undone(
    process: Process, monkeypatch: pytest.MonkeyPatch, method: str, undone: list[list[str]]
) -> None:
    late: Future[bytes] = Future()

    def called(method: str, **_: object) -> Future[bytes]:
        process.called.append(method)
        return late

    monkeypatch.setattr(process, "call", called)
    monkeypatch.setattr(process, "command", called)
    settings = ServiceSettings(request_time=0.01)
    session = LiveSession("session", SessionSpec(), settings)
    session.process = cast("WorkerProcess", process)
    with pytest.raises(ControlError) as raised:
        session.call(method, **ASKED).result()
    assert raised.value.code == "time_limit"
    assert process.called == [method, *undone[0]]
    late.set_result(b"{}")
    assert process.called == [method, *undone[1]]


@pytest.mark.parametrize("is_begun", [True, False])
def test_the_next_run_waits_until_one_that_was_given_up_is_dropped(
    store: RunStore,
    session: LiveSession,
    process: Process,
    monkeypatch: pytest.MonkeyPatch,
    is_begun: bool,
) -> None:
    late: Future[bytes] = Future()
    with monkeypatch.context() as patch:
        patch.setattr(session, "_settings", ServiceSettings(request_time=0.01))
        patch.setattr(process, "call", lambda *_, **__: late)
        with pytest.raises(ControlError):
            session.call("begin_run", **ASKED).result()
    wait = session.wait_undone

    def wait_undone(timeout: float) -> None:
        late.set_result(b"{}") if is_begun else late.set_exception(BUSY)
        wait(timeout)

    monkeypatch.setattr(session, "wait_undone", wait_undone)
    runs = LiveRuns(store, workers=1, queue=1)
    assert runs.begin(session, ASKED, None).state == "running"
    assert process.called[: 1 + is_begun] == [*["drop_run"] * is_begun, "begin_run"]


def test_an_end_that_cannot_be_written_is_told_and_written_later(
    store: RunStore, session: LiveSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live_runs, "WRITTEN_AGAIN", 0.01)
    runs = LiveRuns(store, workers=1, queue=1)
    run = runs.begin(session, ASKED, None)
    with monkeypatch.context() as patch:
        patch.setattr(store, "put_run", _failing)
        patch.setattr(store, "add_events", _failing)
        runs.take(session, "event", event(1).event.model_dump_json().encode())
        runs.take(session, "ended", RunEnd(error=None).model_dump_json().encode())
        assert runs.run(run.run_id).state == "ended"
        assert session.run_id is None
        page = [(runs.live_info(info.run_id) or info).state for info in store.runs("s").runs]
        assert "queued" not in page[1:]
    wait_until(lambda: store.run(run.run_id).state == "ended", "the end in the store")
    assert len(store.events(run.run_id)) == 1


def test_a_stop_takes_no_lock(store: RunStore, session: LiveSession, process: Process) -> None:
    """Neither that of the store nor that of the runs, which others may hold for long."""
    runs = LiveRuns(store, workers=1, queue=1)
    run = runs.begin(session, ASKED, None)
    held, done = threading.Event(), threading.Event()

    def hold() -> None:
        with store._turn, runs._lock, runs._writing:
            held.set()
            done.wait()

    holder = threading.Thread(target=hold)
    holder.start()
    held.wait()
    runs.stop(run.run_id)
    assert process.called[-1] == "stop_run"
    info: RunInfo | None = runs.live_info(run.run_id)
    assert info is not None
    done.set()
    holder.join()
