"""Many tasks on an executor: results in the order of the tasks, in memory that has a bound.

Model: a task is plain data, and its result depends on that alone. For each worker some tasks are
under way, and some that came out before an earlier one wait for it; no others are in memory.

A process that ends takes its whole pool with it, and nobody tells at which task it was. So those
that were under way are tried once more in a new pool, one by one: the guilty one breaks it again,
and the others come through. An executor of the caller's cannot be replaced so: Dask does the like
by itself, and where another one breaks, the run ends.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import BrokenExecutor, Executor, Future, wait
from contextlib import ExitStack, closing
from queue import SimpleQueue
from typing import Generic, TypeVar

from nlcontrol.worker_processes import worker_processes

T = TypeVar("T")
R = TypeVar("R")

UNDER_WAY = 2
"""Tasks per worker that were submitted and are not done, so that no worker waits for the next."""

AHEAD = 16
"""Tasks per worker that are under way, or done before an earlier one."""


def run_all(
    function: Callable[[T], R],
    tasks: Iterable[T],
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    initializer: Callable[[], object] | None = None,
) -> Generator[R]:
    """Results of a function for tasks, in their order; see `finished_tasks`.

    Raises:
        Exception: what the function has raised, or `BrokenExecutor` for a task that ended two
            processes.
    """
    finished = finished_tasks(
        function, tasks, executor=executor, workers=workers, initializer=initializer
    )
    with closing(finished):
        for future in finished:
            yield future.result()


def finished_tasks(
    function: Callable[[T], R],
    tasks: Iterable[T],
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    initializer: Callable[[], object] | None = None,
) -> Generator[Future[R]]:
    """Futures of a function for tasks, in their order; all are done.

    Args:
        function: of a module, since it is carried out elsewhere.
        tasks: taken from as they are needed.
        executor: carries them out, and is not shut down; processes of this machine if not given.
        workers: how many work at once; as many as there are processors if not given.
        initializer: called once in each process.

    Raises:
        BrokenExecutor: the executor has ended, or no process comes to its first result.
    """
    count = workers or os.cpu_count() or 1
    with _Pool(function, executor, count, initializer) as pool:
        for task in tasks:
            while pool.is_full:
                pool.wait()
                yield from pool.results()
            pool.submit(task)
        while pool.is_busy:
            pool.wait()
            yield from pool.results()


class _Pool(ExitStack, Generic[T, R]):
    """Executor with the tasks that it has; the processes are new ones after one has ended."""

    def __init__(
        self,
        function: Callable[[T], R],
        executor: Executor | None,
        workers: int,
        initializer: Callable[[], object] | None,
    ) -> None:
        super().__init__()
        self._function, self._given = function, executor
        self._workers, self._initializer = workers, initializer
        self._executor: Executor | None = executor
        self._waiting: deque[tuple[T, Future[R]]] = deque()
        self._done: SimpleQueue[Future[R]] = SimpleQueue()
        self._under_way = 0
        self._works = False
        """A task has come to its end here."""

    @property
    def is_full(self) -> bool:
        return (
            self._under_way >= UNDER_WAY * self._workers
            or len(self._waiting) >= AHEAD * self._workers
        )

    @property
    def is_busy(self) -> bool:
        return bool(self._waiting)

    def submit(self, task: T) -> None:
        try:
            future = self._opened().submit(self._function, task)
        except BrokenExecutor:
            if self._given is not None:
                raise
            self._settle()
            future = self._opened().submit(self._function, task)
        self._waiting.append((task, future))
        self._under_way += 1
        future.add_done_callback(self._done.put)

    def wait(self) -> None:
        """Waits until one more task is done, or all of them where a process has ended."""
        future = self._done.get()
        self._under_way -= 1
        if not _is_lost(future):
            self._works = True
        elif self._given is None:
            self._settle()

    def results(self) -> Generator[Future[R]]:
        """Futures that are next in order, and done; raises `BrokenExecutor` at the first lost."""
        while self._waiting and self._waiting[0][1].done():
            future = self._waiting.popleft()[1]
            if self._given is not None and _is_lost(future):
                raise BrokenExecutor("the executor has ended") from _reason(future)
            yield future

    def _settle(self) -> None:
        """Tries the tasks that a broken pool had once more, each alone, in pools that are whole."""
        for _ in range(self._under_way):
            self._works |= not _is_lost(self._done.get())
        self._under_way = 0
        self._renew()
        lost = [index for index, (_, future) in enumerate(self._waiting) if _is_lost(future)]
        for index in lost:
            task, _ = self._waiting[index]
            again = self._opened().submit(self._function, task)
            wait([again])
            self._waiting[index] = task, again
            if _is_lost(again):
                self._renew()
            else:
                self._works = True
        if not self._works and len(lost) > 1:
            raise BrokenExecutor("no process comes to its first result") from _reason(again)

    def _opened(self) -> Executor:
        if self._executor is None:
            processes = worker_processes(self._workers, self._initializer)
            self._executor = self.enter_context(processes)
        return self._executor

    def _renew(self) -> None:
        self.close()
        self._executor = None


def _is_lost(future: Future[R]) -> bool:
    return future.cancelled() or isinstance(future.exception(), BrokenExecutor)


def _reason(future: Future[R]) -> BaseException | None:
    return None if future.cancelled() else future.exception()
