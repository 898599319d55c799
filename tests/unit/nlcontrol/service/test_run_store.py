"""The store keeps what it was given, through crashes, earlier versions and too little room."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from nlcontrol.errors import ControlError
from nlcontrol.results.result import Result
from nlcontrol.service import run_store
from nlcontrol.service.documents import NumberedEvent, RunInfo, SessionSpec
from nlcontrol.service.run_store import RunStore
from nlcontrol.session.events import Event
from objectmodels.files.yaml_documents import PREFIX

ODD = "push the \u202emug\u0000 \U0001f916 ' \" \\ % \x7f\ufffe\n2 cm"


def run_info(run_id: str, **fields: object) -> RunInfo:
    known = {"session_id": "s", "kind": "say", "state": "queued", "text": "push", "asked_at": 1.0}
    return RunInfo.model_validate({"run_id": run_id, **known, **fields})


def ended_info(run_id: str, ended_at: float = 2.0) -> RunInfo:
    result = Result(ok=True, status="answered", text=ODD, scene="kitchen", seed=0)
    return run_info(run_id, state="ended", begun_at=1.5, ended_at=ended_at, result=result)


def event(number: int, text: str = "felt") -> NumberedEvent:
    told = Event(kind="force", time=0.1 * number, wall_time=1e-9, text=text, forces={"ring": 0.1})
    return NumberedEvent(number=number, event=told)


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    opened = RunStore(tmp_path / "store")
    yield opened
    opened.close()


def test_what_was_put_there_comes_back(store: RunStore) -> None:
    spec = SessionSpec(scene=ODD, defaults={"margin": 0.1})
    store.add_session("s", spec)
    store.add_run(run_info("r", text=ODD))
    store.add_events("r", [event(1, ODD), event(2)])
    store.add_events("r", [event(2), event(3)])
    assert store.session_spec("s") == spec
    assert store.session_spec("t") is None
    assert store.run("r") == run_info("r", text=ODD, events=3)
    assert store.events("r", after=1) == (event(2), event(3))
    assert store.events("r")[0].event.text == ODD
    store.put_run(ended_info("r"))
    assert store.run("r") == ended_info("r").model_copy(update={"events": 3})


def test_files_are_whole_or_absent(store: RunStore) -> None:
    store.add_run(run_info("../../r"))
    with suppress(ZeroDivisionError), store.write_file("../../r", "trace") as path:
        path.write_bytes(b"half")
        raise ZeroDivisionError
    assert store.file("../../r", "trace") is None
    with store.write_file("../../r", "trace") as path:
        path.write_bytes(b"whole")
    found = store.file("../../r", "trace")
    assert found is not None
    assert found.read_bytes() == b"whole"
    assert found.parent.name == "1"


def test_a_second_process_is_refused(store: RunStore, tmp_path: Path) -> None:
    with pytest.raises(ControlError) as raised:
        RunStore(tmp_path / "store")
    assert raised.value.code == "store_in_use"
    store.close()
    RunStore(tmp_path / "store").close()


def test_what_a_crash_left_is_marked_and_cleaned(tmp_path: Path) -> None:
    store = RunStore(tmp_path)
    store.add_session("s", SessionSpec())
    store.add_session("idle", SessionSpec())
    for name, state in (("queued", "queued"), ("running", "running"), ("lost", "aborted")):
        store.add_run(run_info(name, state=state, place=1))
        with store.write_file(name, "request") as path:
            path.write_text("{}")
    store.add_run(ended_info("ended"))
    (tmp_path / "runs" / "2" / f"{PREFIX}half").write_bytes(b"half a trace")
    (tmp_path / "runs" / "77").mkdir()
    (tmp_path / "runs" / "77" / "trace.npz").write_bytes(b"of a run that was never put there")
    store.close()

    store = RunStore(tmp_path)
    assert [store.run(name).state for name in ("queued", "running", "lost", "ended")] == [
        "cut_off", "cut_off", "aborted", "ended",
    ]  # fmt: skip
    cut = store.run("running")
    assert cut.error is not None
    assert cut.error.code == "cut_off"
    assert cut.place is None
    assert cut.ended_at is not None
    assert store.file("running", "request") is not None
    assert sorted(path.name for path in (tmp_path / "runs").iterdir()) == ["1", "2", "3"]
    assert [path.name for path in (tmp_path / "runs" / "2").iterdir()] == ["request.json"]
    assert store.session_spec("s") is not None
    assert store.session_spec("idle") is None
    store.close()


def test_pages_show_every_run_once(store: RunStore) -> None:
    for number in range(10):
        store.add_run(run_info(f"r{number}", session_id="even" if number % 2 == 0 else "odd"))
    page = store.runs(limit=4)
    assert [run.run_id for run in page.runs] == ["r9", "r8", "r7", "r6"]
    store.add_run(ended_info("new"))
    store.put_run(ended_info("r6"))
    store.delete_run("r6")
    store.put_run(ended_info("r4"))
    store.delete_run("r4")
    page = store.runs(cursor=page.cursor, limit=4)
    assert [run.run_id for run in page.runs] == ["r5", "r3", "r2", "r1"]
    page = store.runs(cursor=page.cursor, limit=4)
    assert [run.run_id for run in page.runs] == ["r0"]
    assert page.cursor is None
    assert [run.run_id for run in store.runs("even").runs] == ["r8", "r2", "r0"]
    assert store.runs("none").runs == ()
    for bad in ("", "-1", "1e3", "٣", "9" * 30, "1; DROP TABLE runs"):
        with pytest.raises(ControlError) as raised:
            store.runs(cursor=bad)
        assert raised.value.code == "bad_cursor"


def test_a_key_begins_one_run(store: RunStore) -> None:
    first = store.add_run(run_info("a"), key="k\ud800", request=b"1")
    assert store.add_run(run_info("b"), key="k\ud800", request=b"1") == first
    assert store.add_run(run_info("c", session_id="t"), key="k\ud800").run_id == "c"
    with pytest.raises(ControlError) as raised:
        store.add_run(run_info("d"), key="k\ud800", request=b"2")
    assert raised.value.code == "key_reused"
    assert [run.run_id for run in store.runs().runs] == ["c", "a"]


def test_runs_that_ended_first_make_room(tmp_path: Path) -> None:
    store = RunStore(tmp_path, keep_bytes=25_000)
    for name, ended_at in (("late", 9.0), ("early", 3.0), ("middle", 6.0)):
        store.add_run(run_info(name))
        with store.write_file(name, "trace") as path:
            path.write_bytes(bytes(10_000))
        store.put_run(ended_info(name, ended_at))
    store.add_run(run_info("running", state="running"))
    with store.write_file("running", "trace") as path:
        path.write_bytes(bytes(50_000))
    assert [run.run_id for run in store.runs().runs] == ["running", "middle", "late"]
    assert sorted(path.name for path in (tmp_path / "runs").iterdir()) == ["1", "3", "4"]
    store.put_run(ended_info("running", 10.0))
    assert [run.run_id for run in store.runs().runs] == ["running"]
    store.close()


def test_what_is_under_way_or_unknown_is_not_deleted(store: RunStore) -> None:
    store.add_run(run_info("r", state="running"))
    with pytest.raises(ControlError) as raised:
        store.delete_run("r")
    assert raised.value.code == "run_under_way"
    store.put_run(ended_info("r"))
    store.add_events("r", [event(1)])
    store.delete_run("r")
    for call in (store.delete_run, store.run, store.events):
        with pytest.raises(ControlError) as raised:
            call("r")
        assert raised.value.code == "unknown_run"


VERSION_1 = """
CREATE TABLE sessions (session_id TEXT PRIMARY KEY, opened_at REAL NOT NULL, spec TEXT NOT NULL);
CREATE TABLE runs (number INTEGER PRIMARY KEY AUTOINCREMENT, run_id TEXT NOT NULL UNIQUE,
    session_id TEXT NOT NULL, state TEXT NOT NULL, ended_at REAL, bytes INTEGER NOT NULL DEFAULT 0,
    document TEXT NOT NULL);
CREATE INDEX runs_by_session ON runs (session_id, number);
CREATE INDEX runs_by_end ON runs (ended_at);
CREATE TABLE events (run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
    number INTEGER NOT NULL, event TEXT NOT NULL, PRIMARY KEY (run, number));
CREATE TABLE idempotency_keys (session_id TEXT NOT NULL, key BLOB NOT NULL, request BLOB NOT NULL,
    run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE, PRIMARY KEY (session_id, key));
CREATE INDEX keys_by_run ON idempotency_keys (run);
INSERT INTO runs VALUES (5, 'old', 's', 'ended', 2.0, 10, '{"schema_version": "3.0",
    "run_id": "old", "session_id": "s", "kind": "say", "state": "ended", "text": "push it",
    "asked_at": 1.0, "ended_at": 2.0}');
INSERT INTO events VALUES (5, 1,
    '{"kind": "ended", "time": 1.5, "wall_time": 0.2, "text": "", "status": "done"}');
PRAGMA user_version = 1;
"""


def _write_version_1(folder: Path) -> None:
    with sqlite3.connect(folder / "runs.sqlite") as database:
        database.executescript(VERSION_1)
    database.close()


@pytest.mark.parametrize("steps", [(), ("ALTER TABLE runs ADD COLUMN more TEXT DEFAULT 'x'",)])
def test_a_store_of_version_1_opens(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, steps: tuple[str, ...]
) -> None:
    _write_version_1(tmp_path)
    later = tuple((step,) for step in steps)
    monkeypatch.setattr(run_store, "MIGRATIONS", (*run_store.MIGRATIONS, *later))
    store = RunStore(tmp_path)
    assert store.run("old").text == "push it"
    assert store.events("old")[0].event.kind == "ended"
    store.add_run(ended_info("new"))
    assert [run.run_id for run in store.runs().runs] == ["new", "old"]
    store.close()
    with sqlite3.connect(tmp_path / "runs.sqlite") as database:
        (version,) = database.execute("PRAGMA user_version").fetchone()
    assert version == len(run_store.MIGRATIONS)


def test_a_migration_that_fails_leaves_the_version_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _write_version_1(tmp_path)
    broken = ("ALTER TABLE runs ADD COLUMN more TEXT", "ALTER TABLE nothing ADD COLUMN more TEXT")
    with monkeypatch.context() as patch:
        patch.setattr(run_store, "MIGRATIONS", (*run_store.MIGRATIONS, broken))
        with pytest.raises(ControlError) as raised:
            RunStore(tmp_path)
        assert raised.value.code == "bad_store"
    store = RunStore(tmp_path)
    assert store.run("old").text == "push it"
    store.close()


@pytest.mark.parametrize("content", ["PRAGMA user_version = 999", None])
def test_what_is_no_store_of_this_version_is_refused(tmp_path: Path, content: str | None) -> None:
    path = tmp_path / "runs.sqlite"
    if content is None:
        path.write_bytes(b"SQLite format 3\x00" + bytes(range(256)) * 20)
    else:
        with sqlite3.connect(path) as database:
            database.execute(content)
    for _ in range(2):  # and the lock is let go of
        with pytest.raises(ControlError) as raised:
            RunStore(tmp_path)
        assert raised.value.code == "bad_store"
