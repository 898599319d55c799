"""The same rows in every way, on a Dask cluster of this machine too, while processes are killed.

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
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import Any

from tests.patience import wait_until
from tests.unit.nlcontrol.service.processes import descendants, parent

SETTINGS = {
    "MALLOC_TRIM_THRESHOLD_": "134217728",
    "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False",
    "DASK_DISTRIBUTED__ADMIN__TICK__INTERVAL": "500ms",
}
"""Settings of a cluster whose workers keep the memory that the next plan needs, and whose processes
look after themselves less often (docs/batch.md)."""

_LONGEST_END = 20.0  # seconds; now and then a worker's guard waits for a worker that was killed

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
            wait_until(lambda: batch.poll() is not None or _lines_of(output) >= total // 3)
            if batch.poll() is not None:
                raise RuntimeError(
                    f"{output.name}: it ended before {total // 3} results were there"
                )
            kill(batch)
        ended = batch.wait(_LONGEST)
    if ended:
        with _started(rows, output, *options, "--resume") as batch:
            if batch.wait(_LONGEST):
                raise RuntimeError(f"{output.name}: a batch that goes on ended with {ended}")
    return [json.loads(line) for line in output.read_text("utf-8").splitlines()]


def _lines_of(output: Path) -> int:
    return output.read_bytes().count(b"\n") if output.exists() else 0


def _started(rows: Path, output: Path, *options: str) -> subprocess.Popen[bytes]:
    command = (sys.executable, "-m", "nlcontrol", "batch", str(rows), "--output", str(output))
    return subprocess.Popen((*command, "--brief", "--events", *options), stderr=subprocess.DEVNULL)


def _kill_worker(_: str, batch: subprocess.Popen[bytes]) -> None:
    below = sorted(descendants(batch.pid))
    workers = [pid for pid in below if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes()]
    os.kill(workers[0], signal.SIGKILL)


def _kill_batch(_: str, batch: subprocess.Popen[bytes]) -> None:
    workers = descendants(batch.pid)
    batch.kill()
    wait_until(lambda: all(parent(pid) is None for pid in workers), "the end of its workers")


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


@contextmanager
def local_cluster(folder: Path, workers: int = 2) -> Iterator[str]:
    """Context with the address of a scheduler that has so many workers, of one thread each."""
    where = folder / "scheduler.json"
    common = ("--scheduler-file", str(where), "--no-dashboard")
    local = ("--host", "127.0.0.1")
    environment = os.environ | SETTINGS
    started = []
    with (folder / "cluster.log").open("wb") as log:

        def start(role: str, *options: str) -> None:
            command = (sys.executable, "-m", f"distributed.cli.dask_{role}", *common, *options)
            started.append(subprocess.Popen(command, stdout=log, stderr=log, env=environment))

        try:
            start("scheduler", *local, "--port", "0")
            wait_until(lambda: _address_in(where), "a scheduler")
            start("worker", "--nworkers", str(workers), "--nthreads", "1")
            yield str(_address_in(where))
        finally:
            for process in reversed(started):
                process.terminate()
            for process in started:
                try:
                    process.wait(_LONGEST_END)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()


def worker_pids(address: str) -> list[int]:
    """Process of each worker."""
    from distributed import Client

    with Client(address, set_as_default=False) as client:
        client.wait_for_workers(1)
        return list(client.run(os.getpid).values())


def _address_in(file: Path) -> str | None:
    try:
        return str(json.loads(file.read_text("utf-8"))["address"])
    except (OSError, ValueError, KeyError):
        return None
