"""A Dask cluster of this machine: a scheduler and workers, processes that talk over sockets."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

SETTINGS = {
    "MALLOC_TRIM_THRESHOLD_": "134217728",
    "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False",
    "DASK_DISTRIBUTED__ADMIN__TICK__INTERVAL": "500ms",
}
"""Settings of a cluster whose workers keep the memory that the next plan needs, and whose processes
look after themselves less often (docs/batch.md)."""

_LONGEST_START = 60.0  # seconds; on a busy machine imports alone take ten
_LONGEST_END = 20.0  # seconds; now and then a worker's guard waits for a worker that was killed


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
            deadline = time.monotonic() + _LONGEST_START
            while not (address := _address_in(where)):
                if time.monotonic() > deadline:
                    raise TimeoutError("no scheduler has come up")
                time.sleep(0.1)
            start("worker", "--nworkers", str(workers), "--nthreads", "1")
            yield address
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
