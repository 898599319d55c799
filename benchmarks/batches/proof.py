"""The same rows in every way, while workers and the batch itself are killed.

Each way is the command line in a process of its own. When a third of the results are there,
something is killed; a batch that has ended is resumed. In the end each way has to have one line for
each row, with the digest that one worker alone has come to.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Collection, Sequence
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import Any

from benchmarks.batches.cluster import local_cluster, worker_pids

Kill = Callable[[subprocess.Popen[bytes]], None]

_LONGEST = 1800.0  # seconds without a further result


def compare_ways(
    rows: Sequence[dict[str, Any]], folder: Path, ways: Collection[str] | None = None
) -> dict[str, str]:
    """What is wrong with each way, in words; nothing if it is as it should be.

    Args:
        rows: that have a result.
        folder: for the files.
        ways: keys of `KILLS`; all if not given.
    """
    file = folder / "rows.jsonl"
    file.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
    expected = _carry_out(file, folder / "one.jsonl", "--workers", "1")
    wrong = {}
    if not all(_digests(expected)):
        wrong["one worker"] = "rows without a result"
    ways = KILLS if ways is None else ways
    with local_cluster(folder) if DASK in ways else nullcontext("") as address:
        for way in ways:
            where = ("--dask", address) if way == DASK else ("--workers", "2")
            kill = partial(KILLS[way], address)
            lines = _carry_out(file, folder / f"{way}.jsonl", *where, kill=kill)
            if [line["line"] for line in lines] != list(range(1, len(rows) + 1)):
                wrong[way] = f"{len(lines)} lines for {len(rows)} rows"
            elif _digests(lines) != _digests(expected):
                wrong[way] = "other digests"
    return wrong


def _digests(lines: Sequence[dict[str, Any]]) -> list[str | None]:
    return [line["digest"] for line in lines]


def _carry_out(
    rows: Path, output: Path, *options: str, kill: Kill | None = None
) -> list[dict[str, Any]]:
    """Lines of the results of a batch in which something is killed."""
    total = len(rows.read_text("utf-8").splitlines())
    with _started(rows, output, *options) as batch:
        if kill is not None:
            _await_lines(output, total // 3, batch)
            kill(batch)
        ended = batch.wait(_LONGEST)
    if ended:
        with _started(rows, output, *options, "--resume") as batch:
            if batch.wait(_LONGEST):
                raise RuntimeError(f"{output.name}: a batch that goes on ended with {ended}")
    return [json.loads(line) for line in output.read_text("utf-8").splitlines()]


def _started(rows: Path, output: Path, *options: str) -> subprocess.Popen[bytes]:
    command = (sys.executable, "-m", "nlcontrol", "batch", str(rows), "--output", str(output))
    return subprocess.Popen((*command, "--brief", "--events", *options), stderr=subprocess.DEVNULL)


def _await_lines(output: Path, number: int, batch: subprocess.Popen[bytes]) -> None:
    deadline = time.monotonic() + _LONGEST
    while batch.poll() is None and time.monotonic() < deadline:
        if output.exists() and output.read_bytes().count(b"\n") >= number:
            return
        time.sleep(0.01)
    raise RuntimeError(f"{output.name}: it ended before {number} results were there")


def _kill_worker(_: str, batch: subprocess.Popen[bytes]) -> None:
    workers = [pid for pid in child_pids(batch.pid) if b"spawn_main" in _command_line(pid)]
    os.kill(workers[0], signal.SIGKILL)


def _kill_batch(_: str, batch: subprocess.Popen[bytes]) -> None:
    workers = child_pids(batch.pid)
    batch.kill()
    deadline = time.monotonic() + 30.0
    while any(Path(f"/proc/{pid}").exists() for pid in workers):
        if time.monotonic() > deadline:
            raise RuntimeError("a worker has outlived its batch")
        time.sleep(0.05)


def _interrupt_batch(_: str, batch: subprocess.Popen[bytes]) -> None:
    batch.send_signal(signal.SIGINT)
    if batch.wait(60.0) != 130:
        raise RuntimeError(f"an interrupted batch ended with {batch.returncode}")


def _kill_dask_worker(address: str, _: subprocess.Popen[bytes]) -> None:
    os.kill(worker_pids(address)[0], signal.SIGKILL)


DASK = "on Dask, a worker killed"
KILLS = {
    "a worker killed": _kill_worker,
    "killed and resumed": _kill_batch,
    "interrupted and resumed": _interrupt_batch,
    DASK: _kill_dask_worker,
}
"""Ways to carry rows out, and what is killed there."""


def child_pids(pid: int) -> list[int]:
    """Processes that a process has begun."""
    tasks = Path(f"/proc/{pid}/task").glob("*/children")
    return [int(child) for task in tasks for child in task.read_text("ascii").split()]


def _command_line(pid: int) -> bytes:
    return Path(f"/proc/{pid}/cmdline").read_bytes()
