"""Many tasks on an executor: results in the order of the tasks, in memory that has a bound.

Model: a task is plain data, and its result depends on that alone. Tasks go out in bundles, for what
is sent costs time whatever is in it. For each worker some bundles are under way, and some that came
out before an earlier one wait for it; no others are in memory.

A bundle that fails is taken apart: each of its tasks is tried once more by itself. A process that
ends takes its whole pool with it, and nobody tells at which task it was. So a bundle that was lost
with it is tried in a new pool in which nothing else is under way: the guilty task ends that too,
and the others come through. An executor of the caller's cannot be replaced so: Dask carries tasks
out elsewhere by itself, and blames all that were on workers that ended, so those are tried once
more with nothing else under way; where another executor breaks, the run ends.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import ExitStack, closing, contextmanager
from queue import SimpleQueue
from typing import Generic, TypeVar

# Processes that carry out a part of the work, and none of which outlives its parent.


@contextmanager
def worker_processes(
    workers: int | None = None, initializer: Callable[[], object] | None = None
) -> Iterator[ProcessPoolExecutor]:
    """Context with fresh processes; one that is forked beside threads may hang.

    Whatever breaks the context off ends them at once.

    Args:
        workers: how many; as many as there are processors if not given.
        initializer: called once in each of them.
    """
    others = set(multiprocessing.active_children())
    pool = ProcessPoolExecutor(
        workers or os.cpu_count(),
        mp_context=multiprocessing.get_context("spawn"),
        initializer=_begin,
        initargs=(initializer,),
    )
    try:
        yield pool
    except BaseException:
        for child in set(multiprocessing.active_children()) - others:
            child.kill()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _begin(initializer: Callable[[], object] | None) -> None:
    """Ends this process with its parent, and with nothing else; libraries start no threads."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    if initializer is not None:
        initializer()


def end_with_parent() -> None:
    """Ends this process, from now on, as soon as its parent has ended."""
    threading.Thread(target=_wait_for_parent, daemon=True).start()


def _wait_for_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None, "a worker has a parent"
    parent.join()
    os._exit(1)


T = TypeVar("T")
R = TypeVar("R")

UNDER_WAY = 2
"""Bundles per worker that were submitted and are not done, so that no worker waits for the next."""

AHEAD = 32
"""Tasks per worker that are under way, or done before an earlier one."""


def run_all(
    function: Callable[[T], R],
    tasks: Iterable[T],
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    initializer: Callable[[], object] | None = None,
) -> Generator[R]:
    """Results of a function for tasks, in their order.

    Arguments as for `finished_tasks`, with one task in each bundle.

    Raises:
        Exception: what the function has raised, or `BrokenExecutor` for a task that ended two
            processes.
    """
    bundles = ((task,) for task in tasks)
    finished = finished_tasks(
        function, bundles, executor=executor, workers=workers, initializer=initializer
    )
    with closing(finished):
        for future in finished:
            yield future.result()


def finished_tasks(
    function: Callable[[T], R],
    bundles: Iterable[Sequence[T]],
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    initializer: Callable[[], object] | None = None,
) -> Generator[Future[R]]:
    """Futures of a function for the tasks of bundles, in their order; all are done.

    Args:
        function: of a module, since it is carried out elsewhere.
        bundles: tasks that go to a worker together; taken from as they are needed.
        executor: carries them out, and is not shut down; processes of this machine if not given.
        workers: how many work at once; as many as there are processors if not given.
        initializer: called once in each process.

    Raises:
        BrokenExecutor: the executor has ended, or no process comes to its first result.
    """
    count = workers or os.cpu_count() or 1
    with _Pool(function, executor, count, initializer) as pool:
        for bundle in bundles:
            while pool.is_full:
                pool.wait()
                yield from pool.results()
            pool.submit(bundle)
        while pool.waiting:
            pool.wait()
            yield from pool.results()


class _Pool(ExitStack, Generic[T, R]):
    """Executor with the bundles that it has; the processes are new ones after one has ended."""

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
        self._executor = executor or self._new_processes()
        self.waiting: deque[tuple[Sequence[T], Future[list[R]]]] = deque()
        self._done: SimpleQueue[Future[list[R]]] = SimpleQueue()
        self._under_way = 0
        """Bundles."""
        self._held = 0
        """Tasks of the bundles that wait."""

    @property
    def is_full(self) -> bool:
        return self._under_way >= UNDER_WAY * self._workers or self._held >= AHEAD * self._workers

    def submit(self, bundle: Sequence[T]) -> None:
        self.waiting.append((bundle, self._begun(bundle)))
        self._held += len(bundle)

    def wait(self) -> None:
        """Waits until one more bundle is done."""
        self._done.get()
        self._under_way -= 1

    def results(self) -> Generator[Future[R]]:
        """Futures that are next in order, and done; raises `BrokenExecutor` at the first lost."""
        while self.waiting and self.waiting[0][1].done():
            bundle, future = self.waiting.popleft()
            self._held -= len(bundle)
            self._require_executor(future)
            lost = _is_lost(future) or type(_reason(future)).__name__ == "KilledWorker"
            if lost or (future.exception() and len(bundle) > 1):
                yield from self._tried_alone(bundle, quietly=lost or self._given is None)
            else:
                yield from _futures(future)

    def _tried_alone(self, bundle: Sequence[T], *, quietly: bool) -> Generator[Future[R]]:
        """Futures of tasks that failed together, each tried by itself; quietly, with no others."""
        for task in bundle:
            while self._under_way and quietly:
                self.wait()
            future = self._begun((task,))
            wait([future])
            self._require_executor(future)
            yield from _futures(future)

    def _begun(self, bundle: Sequence[T]) -> Future[list[R]]:
        try:
            future = self._executor.submit(_results, self._function, bundle)
        except BrokenExecutor:
            if self._given is not None:
                raise
            self.close()
            self._executor = self._new_processes()
            self._executor.submit(_results, self._function, ()).result()
            future = self._executor.submit(_results, self._function, bundle)
        self._under_way += 1
        future.add_done_callback(self._done.put)
        return future

    def _require_executor(self, future: Future[list[R]]) -> None:
        """Raises `BrokenExecutor` if the caller's executor has ended at a bundle."""
        if self._given is not None and _is_lost(future):
            raise BrokenExecutor("the executor has ended") from _reason(future)

    def _new_processes(self) -> Executor:
        return self.enter_context(worker_processes(self._workers, self._initializer))


def _results(function: Callable[[T], R], bundle: Sequence[T]) -> list[R]:
    return [function(task) for task in bundle]


def _futures(done: Future[list[R]]) -> Generator[Future[R]]:
    """Future of each task of a bundle; one that has failed had one task."""
    if raised := done.exception():
        failed: Future[R] = Future()
        failed.set_exception(raised)
        yield failed
        return
    for result in done.result():
        future: Future[R] = Future()
        future.set_result(result)
        yield future


def _is_lost(future: Future[R]) -> bool:
    return future.cancelled() or isinstance(future.exception(), BrokenExecutor)


def _reason(future: Future[R]) -> BaseException | None:
    return None if future.cancelled() else future.exception()
