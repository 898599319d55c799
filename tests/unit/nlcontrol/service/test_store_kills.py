"""Processes that write to a store are killed at random moments: what had ended is there, whole."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sqlite3
import time
from contextlib import closing
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from nlcontrol.results.result import Result
from nlcontrol.service.documents import NumberedEvent, RunInfo
from nlcontrol.service.run_store import RunStore
from nlcontrol.session.events import Event
from objectmodels.files.yaml_documents import PREFIX

KILLS = 30
EVENTS = 5
TRACE = bytes(range(256)) * 400


def _write_runs(folder: Path, told: Path, life: int) -> None:
    """Writes runs, and after each one its name to a file, until it is killed."""
    store = RunStore(folder)
    with told.open("ab", buffering=0) as file:
        for number in count():
            name = f"{life}-{number}"
            info = RunInfo(
                run_id=name, session_id="s", kind="say", state="queued", text="t", asked_at=1.0
            )
            store.add_run(info, key=name)
            store.put_run(info.model_copy(update={"state": "running"}))
            for n in range(1, EVENTS + 1):
                event = Event(kind="phase", time=0.1 * n, wall_time=0.1, text="…", phase="push")
                store.add_events(name, [NumberedEvent(number=n, event=event)])
            with store.write_file(name, "trace") as path:
                path.write_bytes(TRACE)
            result = Result(ok=True, status="done", text="t", scene="kitchen", seed=0)
            store.put_run(
                info.model_copy(update={"state": "ended", "ended_at": 2.0, "result": result})
            )
            file.write(f"{name}\n".encode())


@pytest.mark.slow
def test_every_run_that_had_ended_is_there(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["nlcontrol.service.run_store"])
    folder, told = tmp_path / "store", tmp_path / "told"
    told.touch()
    cut = 0
    for life in range(KILLS):
        process = context.Process(target=_write_runs, args=(folder, told, life))
        process.start()
        while f"{life}-0\n" not in told.read_text():
            time.sleep(0.001)
        time.sleep(float(rng.uniform(0.0, 0.05)))
        assert process.pid is not None
        os.kill(process.pid, signal.SIGKILL)
        process.join()
        store = RunStore(folder)
        page = store.runs(limit=100_000)
        runs = {run.run_id: run for run in page.runs}
        ended = told.read_text().split()
        assert all(runs[name].state == "ended" for name in ended)
        assert all(runs[name].events == EVENTS for name in ended)
        assert {run.state for run in page.runs} <= {"ended", "cut_off"}
        for name in runs:
            file = store.file(name, "trace")
            assert file is None or file.read_bytes() == TRACE
            assert file is not None or name not in ended
        assert list(folder.rglob(f"{PREFIX}*")) == []
        cut = sum(run.state == "cut_off" for run in page.runs)
        store.close()
        with closing(sqlite3.connect(folder / "runs.sqlite")) as database:
            assert database.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
    assert cut > 0
    assert len(ended) >= KILLS
