"""Worker processes: warm from the beginning, deaf to a terminal, in their parent's surroundings."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from nlcontrol.errors import ControlError
from nlcontrol.service.workers.session_host import warm_up
from nlcontrol.service.workers.worker_process import MOST_UNSENT, Tell, WorkerProcess
from tests.patience import PATIENCE, wait_until
from tests.unit.nlcontrol.service.processes import parent


class Reporter:
    """Tells of its process what it is asked for."""

    urgent: frozenset[str] = frozenset()

    def __init__(self, tell: Tell) -> None:
        pass

    def answer(self, method: str, arguments: Mapping[str, Any]) -> bytes:
        if method == "surroundings":
            return json.dumps(dict(os.environ)).encode()
        return json.dumps({"warm_ups": warm_up.cache_info().currsize}).encode()


def asked(method: str) -> dict[str, Any]:
    worker = WorkerProcess(Reporter)
    try:
        answer: dict[str, Any] = json.loads(worker.call(method).result(PATIENCE))
        return answer
    finally:
        worker.kill()
        assert worker.wait(PATIENCE)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere workers are not forked")
def test_a_worker_is_warm_before_its_host_is_made_and_forked_beside_no_thread() -> None:
    assert asked("warmth") == {"warm_ups": 1}
    worker = WorkerProcess(Reporter)
    forked_from = parent(worker.pid)
    assert len(list(Path(f"/proc/{forked_from}/task").iterdir())) == 1
    worker.kill()


def test_a_worker_has_the_surroundings_of_the_moment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SAID_LATER", "once")
    first = asked("surroundings")
    monkeypatch.setenv("SAID_LATER", "twice")
    second = asked("surroundings")
    assert (first["SAID_LATER"], second["SAID_LATER"]) == ("once", "twice")
    assert first["OMP_NUM_THREADS"] == "1"


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere workers are not forked")
def test_another_process_is_forked_from_if_the_first_has_ended() -> None:
    worker = WorkerProcess(Reporter)
    forked_from = parent(worker.pid)
    assert forked_from is not None
    os.kill(forked_from, 9)
    wait_until(partial(lambda pid: parent(pid) is None, forked_from))
    assert asked("warmth") == {"warm_ups": 1}
    assert json.loads(worker.call("warmth").result(PATIENCE)) == {"warm_ups": 1}  # it goes on
    worker.kill()
    assert worker.wait(PATIENCE)


def _descriptors() -> int:
    return len(list(Path("/proc/self/fd").iterdir()))


@pytest.mark.skipif(sys.platform != "linux", reason="descriptors are counted by /proc")
def test_a_worker_leaves_no_descriptor() -> None:
    asked("warmth")
    before = _descriptors()
    for _ in range(5):
        asked("warmth")
    assert _descriptors() == before


@pytest.mark.skipif(sys.platform != "linux", reason="a process is halted by a signal")
def test_a_worker_that_does_not_read_holds_up_nobody_but_its_callers() -> None:
    worker = WorkerProcess(Reporter)
    worker.call("warmth").result(PATIENCE)
    os.kill(worker.pid, signal.SIGSTOP)
    waiting = [worker.call("warmth", padding="x" * 10**6) for _ in range(MOST_UNSENT + 2)]
    refused = waiting[-1].exception(PATIENCE)
    assert isinstance(refused, ControlError)
    assert refused.code == "queue_full"
    command = worker.command("warmth")  # as a stop: it is not turned away
    assert not command.done()
    os.kill(worker.pid, signal.SIGCONT)
    assert command.result(PATIENCE)
    os.kill(worker.pid, signal.SIGSTOP)
    waiting = [worker.call("warmth", padding="x" * 10**6) for _ in range(3)]
    worker.kill()
    assert worker.wait(PATIENCE)
    lost = waiting[0].exception(PATIENCE)
    assert isinstance(lost, ControlError)
    assert lost.code == "worker_lost"


def test_a_program_that_leaves_its_workers_ends_in_silence() -> None:
    code = (
        "from nlcontrol.service.workers.session_host import SessionHost\n"
        "from nlcontrol.service.workers.worker_process import WorkerProcess\n"
        "assert all(worker.pid for worker in [WorkerProcess(SessionHost) for _ in range(3)])\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
