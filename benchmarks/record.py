"""Results kept as they come, as JSON lines: a run that was broken off goes on where it was.

A result is one line, written at once and flushed to the disk. What a broken run left of a last line
is no result: it is cut off before the next one is written.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterable
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, Generic, TypeVar

from pydantic import BaseModel, ConfigDict

from nlcontrol.parallel_tasks import run_all

J = TypeVar("J", bound=Hashable)


class Kept(BaseModel, Generic[J]):
    """What came of a job.

    Attributes:
        job: which; it says all that the result depends on.
    """

    model_config = ConfigDict(frozen=True)

    job: J


K = TypeVar("K", bound=Kept[Any])


def recorded(path: Path | None, kind: type[K]) -> list[K]:
    """What a record holds, in its order; nothing if there is none."""
    if path is None or not path.exists():
        return []
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    return [kind.model_validate_json(line) for line in lines if line.endswith("\n")]


def add(path: Path, done: BaseModel) -> None:
    """Adds a result to a record."""
    with path.open("ab") as file:
        file.write((done.model_dump_json() + "\n").encode())
        file.flush()
        os.fsync(file.fileno())


def mend(path: Path) -> None:
    """Cuts off half a last line."""
    if path.exists():
        whole = path.read_bytes().rfind(b"\n") + 1
        os.truncate(path, whole)


def carried_out(
    run: Callable[[J], K],
    jobs: Iterable[J],
    kind: type[K],
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    record: Path | None = None,
    told: Callable[[K], None] | None = None,
) -> dict[J, K]:
    """All jobs' results; those that the record lacks are run and added to it.

    Args:
        run: a function of a module, as it is carried out elsewhere.
        jobs: which, each once.
        kind: of the results.
        executor: where; processes of this machine if not given.
        workers: how many.
        record: file of JSON lines.
        told: of each new result.
    """
    jobs = list(jobs)
    known: dict[Hashable, K] = {done.job: done for done in recorded(record, kind)}
    if record is not None:
        mend(record)
    missing = [job for job in jobs if job not in known]
    for done in run_all(run, missing, executor=executor, workers=workers):
        known[done.job] = done
        if record is not None:
            add(record, done)
        if told is not None:
            told(done)
    return {job: known[job] for job in jobs}
