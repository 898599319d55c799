"""The planning service and its processes are killed at random moments; what had ended is there.

Two listeners at a time open sessions and say sentences, some that move something and some that do
not. After a random time the server is killed, or one of its processes. Then every run whose end
somebody was told is in the store, with the same result, all of its events and a trace that can be
read; every other run is marked; the database is sound; no half file and no process is left.
"""

from __future__ import annotations

import contextlib
import os
import random
import signal
import sqlite3
import tempfile
import threading
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx

from nlcontrol.service.run_store import RunStore
from objectmodels.files.yaml_documents import PREFIX
from sim import Trace
from tests.patience import PATIENCE, wait_until
from tests.service_process import LastingServer
from tests.unit.nlcontrol.service.processes import descendants, parent

SENTENCES = (
    "where is the mug?",
    "what happens if you push the ice tea box at the top?",
    "push the mug 2 cm to the left",
    "push the mug 2 cm to the right",
)

LONGEST = 12.0
"""Time after which something has been killed [s]; a push takes some 6 s."""


@dataclass
class Told:
    """Results that somebody was told, as JSON by the identifiers of their runs."""

    results: dict[str, Any] = field(default_factory=dict)
    unfinished: set[str] = field(default_factory=set)


def say_sentences(url: str, seed: int, told: Told, ended: threading.Event) -> None:
    """Says sentences in a session of its own, until the service or the session is lost."""
    rng = random.Random(seed)
    with (
        contextlib.suppress(httpx.TransportError),
        httpx.Client(base_url=url, timeout=PATIENCE) as http,
    ):
        opened = http.post("/v1/sessions", json={"seed": seed})
        if opened.status_code == 410:  # its process was killed as it was opened
            return
        place = f"/v1/sessions/{opened.raise_for_status().json()['session_id']}"
        while not ended.is_set():
            answer = http.post(f"{place}/say", json={"text": rng.choice(SENTENCES)})
            if answer.status_code != 202:  # the session was lost
                return
            run = answer.json()
            run_id = run["run_id"]
            told.unfinished.add(run_id)
            while run["state"] in ("queued", "running"):
                time.sleep(0.02)
                run = http.get(f"/v1/runs/{run_id}").raise_for_status().json()
            if run["state"] == "ended":
                told.results[run_id] = run["result"]
            else:
                assert run["state"] == "cut_off", run["state"]
            told.unfinished.discard(run_id)
        http.delete(place)


def require_whole(folder: Path, told: Told) -> Counter[str]:
    """Checks a store that nobody has open; the states of its runs.

    Raises:
        AssertionError: something is lost, half or left over.
    """
    store = RunStore(folder)
    runs = store.runs(limit=1_000_000).runs
    known = {run.run_id: run for run in runs}
    for run_id, result in told.results.items():
        found = known[run_id]
        assert found.state == "ended", (run_id, found.state)
        assert found.result is not None
        assert found.result.model_dump(mode="json") == result
        numbers = [each.number for each in store.events(run_id)]
        assert numbers == list(range(1, len(numbers) + 1))
        assert store.events(run_id)[-1].event.kind == "ended"
        trace = store.file(run_id, "trace")
        assert (trace is not None) == (result["execution"] is not None), run_id
        if trace is not None:
            Trace.load(trace)
    assert all(known[run_id].state in ("cut_off", "ended") for run_id in told.unfinished)
    assert all(run.state in ("ended", "cut_off") for run in runs)
    told.unfinished.clear()
    assert not list(folder.rglob(f"{PREFIX}*"))
    store.close()
    with contextlib.closing(sqlite3.connect(folder / "runs.sqlite")) as database:
        assert database.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
    return Counter(run.state for run in runs)


def _orphans_end(workers: set[int]) -> float:
    """Time until none of the processes is there any more [s]."""
    begun = time.monotonic()
    wait_until(lambda: all(parent(pid) is None for pid in workers), "the end of orphans")
    return time.monotonic() - begun


def prove_ends_kept(kills: int, seed: int) -> bool:
    """Kills, checks and prints what came of it.

    Raises:
        AssertionError: something is lost, half or left over.
    """
    rng, told, killed = random.Random(seed), Told(), Counter[str]()
    slowest_end = slowest_start = 0.0
    with tempfile.TemporaryDirectory(prefix="service-kills-") as name:
        folder = Path(name)
        server = LastingServer(folder, ("--workers", "2"))
        server.start()
        for number in range(kills):
            ended = threading.Event()
            with ThreadPoolExecutor() as pool:
                listeners = [
                    pool.submit(say_sentences, server.url, 2 * number + n, told, ended)
                    for n in range(2)
                ]
                time.sleep(rng.uniform(0.0, LONGEST))
                workers = descendants(server.pid)
                of_server = rng.random() < 0.5
                if of_server:
                    server.kill()
                    slowest_end = max(slowest_end, _orphans_end(workers))
                else:
                    os.kill(rng.choice(sorted(workers)), signal.SIGKILL)
                    time.sleep(1.0)
                    ended.set()
                for listener in listeners:
                    listener.result(PATIENCE)
            killed["server" if of_server else "process"] += 1
            if of_server:
                require_whole(folder, told)
                begun = time.monotonic()
                server.start()
                slowest_start = max(slowest_start, time.monotonic() - begun)
            print(f"{number + 1}: {dict(killed)}, {len(told.results)} runs have ended", flush=True)
        workers = descendants(server.pid)
        server.close()
        _orphans_end(workers)
        states = require_whole(folder, told)
    print(
        f"{kills} kills ({dict(killed)}): {len(told.results)} runs of whose end somebody was told "
        f"are all there and whole, {states['cut_off']} are marked as cut off; no process is left "
        f"after {slowest_end:.2f} s, the service is back within {slowest_start:.1f} s"
    )
    return True
