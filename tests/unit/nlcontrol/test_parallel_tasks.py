"""Many tasks: in order, within bounds, and whole though processes end in the midst of it."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Future, ThreadPoolExecutor
from typing import Any

import pytest

from nlcontrol.parallel_tasks import AHEAD, finished_tasks, run_all

GUILTY = 5


def square(x: int) -> int:
    return x * x


def square_or_end(x: int) -> int:
    if x == GUILTY:
        os.kill(os.getpid(), signal.SIGKILL)
    return x * x


def end() -> None:
    os._exit(1)


def square_slowly_at_first(x: int) -> int:
    time.sleep(0.05 if x == 0 else 0.0)
    return x * x


def test_results_are_in_the_order_of_the_tasks() -> None:
    with ThreadPoolExecutor(4) as executor:
        found = list(run_all(square_slowly_at_first, range(100), executor=executor, workers=4))
        assert found == [x * x for x in range(100)]
        assert executor.submit(int).result() == 0  # it is the caller's, and still open


def test_tasks_are_taken_as_they_are_needed() -> None:
    taken = 0

    def tasks() -> Iterator[int]:
        nonlocal taken
        for task in range(1000):
            taken = task
            yield task

    with ThreadPoolExecutor(2) as executor:
        results = run_all(square, tasks(), executor=executor, workers=2)
        for given, _ in enumerate(results, start=1):
            assert taken <= given + 2 * AHEAD


@pytest.mark.parametrize("size", [1, 4])
def test_only_the_task_that_ends_its_process_twice_is_lost(size: int) -> None:
    bundles = [range(12)[i : i + size] for i in range(0, 12, size)]
    finished = list(finished_tasks(square_or_end, bundles, workers=1))
    lost = [x for x, future in enumerate(finished) if future.exception() is not None]
    assert lost == [GUILTY]
    assert isinstance(finished[GUILTY].exception(), BrokenExecutor)
    assert [f.result() for x, f in enumerate(finished) if x != GUILTY] == [
        x * x for x in range(12) if x != GUILTY
    ]


def test_processes_that_cannot_begin_end_the_run() -> None:
    with pytest.raises(BrokenExecutor):
        list(run_all(square, range(10), workers=1, initializer=end))


def test_a_bundle_that_fails_on_an_executor_is_taken_apart() -> None:
    with ThreadPoolExecutor(2) as executor:
        bundles = [(4, -1, 9), (16, 25)]
        finished = list(finished_tasks(_root, bundles, executor=executor, workers=2))
    assert [future.exception() is None for future in finished] == [True, False, True, True, True]
    assert isinstance(finished[1].exception(), ValueError)
    assert [future.result() for future in finished[2:]] == [3.0, 4.0, 5.0]


def test_an_error_of_a_task_comes_home() -> None:
    with pytest.raises(ValueError, match="math domain"):
        list(run_all(_root, [4, -1], workers=1))


def _root(x: int) -> float:
    import math

    return math.sqrt(x)


class KilledWorker(Exception):  # noqa: N818
    """Named as Dask's, which is for all tasks that were on workers that ended."""


class _BlamingExecutor(ThreadPoolExecutor):
    """Gives up a task once that did nothing but stand beside one that ended its workers."""

    def __init__(self, blamed: int, guilty: int) -> None:
        super().__init__(2)
        self._blamed, self._given_up = blamed, {blamed, guilty}

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        (task,) = args[1]
        if task not in self._given_up:
            return super().submit(fn, *args, **kwargs)
        self._given_up -= {task} & {self._blamed}
        future: Future[Any] = Future()
        future.set_exception(KilledWorker())
        return future


def test_who_stood_beside_what_ended_its_workers_is_not_blamed() -> None:
    bundles = [(n,) for n in range(8)]
    with _BlamingExecutor(blamed=5, guilty=1) as executor:
        done = list(finished_tasks(str, bundles, executor=executor, workers=2))
    assert [future.exception() is None for future in done] == [n != 1 for n in range(8)]
    assert done[5].result() == "5"
