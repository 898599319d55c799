"""Worker processes of a service: leased to sessions, and asked by whoever has no session.

One worker is always kept idle for further calls and one for the next session, until there are as
many as allowed, so that a long refusal delays nobody else's plan. Calls without a session are taken
in their order, each by a worker that has their table open if one such is idle. A worker knows until
when it may search; one that does not keep to it is ended.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from concurrent.futures import Future, InvalidStateError
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any

from nlcontrol.errors import ControlError
from nlcontrol.service.workers.session_host import SessionHost
from nlcontrol.service.workers.worker_process import (
    WorkerProcess,
    daemon_timer,
    lost_error,
    queue_full,
    time_limit_error,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from nlcontrol.service.documents import TableSpec


MOST_TRIES = 3
"""Workers that may end over a call, or one after the other before they began."""


class _Job:
    """A call without a session, until it is answered."""

    def __init__(
        self, method: str, table: TableSpec, arguments: Mapping[str, Any], time_limit: float
    ) -> None:
        self.method, self.arguments = method, arguments
        self.table = table.model_dump_json()
        self.answer: Future[bytes] = Future()
        self.answer.set_running_or_notify_cancel()
        self.tries = 0
        self.deadline = time.monotonic() + time_limit


class _Worker:
    """A worker and its work."""

    def __init__(self, process: Callable[[_Worker], WorkerProcess]) -> None:
        self.job: _Job | None = None
        self.table: str | None = None
        self.is_ready = False
        self.on_lease_end: Callable[[], object] = lambda: None
        self.process = process(self)


class WorkerPool:
    """Workers, as many as are needed.

    Args:
        most: workers that answer calls without a session at once.
        sessions: workers that sessions may lease at once.
        queue: calls that may wait.
        request_time: time after which a call is given up [s].
    """

    def __init__(self, most: int, sessions: int, queue: int, request_time: float) -> None:
        self._most, self._sessions = most, sessions
        self._queue, self._request_time = queue, request_time
        self._lock = threading.RLock()
        self._workers: list[_Worker] = []
        self._leased: list[_Worker] = []
        self._waiting: deque[_Job] = deque()
        self._failed_starts = 0
        self._is_closed = False

    def start(self) -> None:
        """Starts the first workers."""
        with self._lock:
            self._keep_idle_ones()

    @property
    def size(self) -> int:
        """Number of workers that no session has."""
        return len(self._workers)

    @property
    def pids(self) -> tuple[int, ...]:
        """Numbers of their processes."""
        with self._lock:
            workers = list(self._workers)
        return tuple(worker.process.pid for worker in workers)

    def lease(
        self, on_told: Callable[[str, bytes], object], on_end: Callable[[], object]
    ) -> WorkerProcess:
        """A worker for a session, until its process ends; it may just be starting.

        Args:
            on_told: called with topic and content of what it tells by itself.
            on_end: called once its process has ended.
        """
        with self._lock:
            free = [worker for worker in self._workers if worker.job is None]
            worker = min(free, key=lambda each: each.table is not None, default=None)
            if worker is None:
                worker = self._started()
            else:
                self._workers.remove(worker)
            worker.on_lease_end, worker.process.on_told = on_end, on_told
            self._leased.append(worker)
            self._keep_idle_ones()
            return worker.process

    def call(self, method: str, table: TableSpec, **arguments: Any) -> Future[bytes]:
        """Calls a method of a session that is opened for this call alone.

        Args:
            method: name of a method of `nlcontrol.service.methods.Questions`.
            table: table to plan for.
            arguments: arguments of the method.

        Returns:
            The answer as a JSON document; it raises `ControlError`, `time_limit` among them.

        Raises:
            ControlError: `queue_full`.
        """
        job = _Job(method, table, arguments, self._request_time)
        with self._lock:
            if len(self._waiting) >= self._queue and not self._idle_ones():
                waiting = len(self._waiting)
                message = f"{waiting} others wait already"
                raise queue_full(message, waiting, "ask again in a few seconds", retry_after=2.0)
            self._waiting.append(job)
            self._hand_out()
        timer = daemon_timer(self._request_time, self._give_up, job)
        job.answer.add_done_callback(lambda _: timer.cancel())
        return job.answer

    def close(self) -> None:
        """Ends all workers."""
        with self._lock:
            self._is_closed = True
            processes = [worker.process for worker in (*self._workers, *self._leased)]
            jobs, self._waiting = self._waiting, deque()
        _fail(jobs)
        for process in processes:
            process.kill()
        for process in processes:
            process.wait()

    def _idle_ones(self) -> list[_Worker]:
        """Workers that may take a call now."""
        if sum(worker.job is not None for worker in self._workers) >= self._most:
            return []
        return [worker for worker in self._workers if worker.is_ready and worker.job is None]

    def _hand_out(self) -> None:
        """Gives the calls that wait to the workers that do not."""
        while self._waiting and (idle := self._idle_ones()):
            job = self._waiting.popleft()
            worker = next((each for each in idle if each.table == job.table), idle[0])
            worker.job, worker.table = job, job.table
            call = worker.process.call(
                "answer_alone",
                asked=job.method,
                table=job.table,
                time_limit=job.deadline - time.monotonic(),
                arguments=job.arguments,
            )
            call.add_done_callback(partial(self._take_answer, worker))
        self._keep_idle_ones()

    def _keep_idle_ones(self) -> None:
        """Starts workers if all that there are have work, and more are allowed."""
        for_session = len(self._leased) < self._sessions
        while not self._is_closed:
            free = sum(worker.job is None for worker in self._workers)  # or just starting
            busy = len(self._workers) - free
            if free >= (busy < self._most) + for_session:
                return
            if len(self._workers) >= self._most + for_session:
                return
            self._workers.append(self._started())

    def _started(self) -> _Worker:
        return _Worker(
            lambda worker: WorkerProcess(
                SessionHost,
                on_ready=lambda: self._welcome(worker),
                on_end=lambda: self._remove(worker),
            )
        )

    def _welcome(self, worker: _Worker) -> None:
        with self._lock:
            worker.is_ready = True
            self._failed_starts = 0
            self._hand_out()

    def _take_answer(self, worker: _Worker, call: Future[bytes]) -> None:
        raised = call.exception()
        with self._lock:
            job, worker.job = worker.job, None
            assert job is not None, "it was at work"
            is_lost = isinstance(raised, ControlError) and raised.code == "worker_lost"
            if is_lost:
                self._workers.remove(worker)
            job.tries += 1
            is_over = job.answer.done() or job.tries == MOST_TRIES or self._is_closed
            again = is_lost and not is_over
            if again:  # nothing moves by it, and another worker may do
                self._waiting.appendleft(job)
            self._hand_out()
        if again:
            return
        with suppress(InvalidStateError):  # its time was over
            if raised is None:
                job.answer.set_result(call.result())
            else:
                job.answer.set_exception(raised)

    def _remove(self, worker: _Worker) -> None:
        """Takes out a worker that has ended; where none begins, no call is kept waiting."""
        with self._lock:
            if worker in self._leased:
                self._leased.remove(worker)
            if worker in self._workers:
                self._workers.remove(worker)
                self._failed_starts += not worker.is_ready
            jobs: deque[_Job] = deque()
            if self._failed_starts < MOST_TRIES:
                self._hand_out()
            else:
                self._failed_starts = 0  # the next call may try again
                jobs, self._waiting = self._waiting, jobs
        _fail(jobs)
        worker.on_lease_end()

    def _give_up(self, job: _Job) -> None:
        """Ends a call whose time is over; its worker too if that does not come to an end."""
        with self._lock:
            if job in self._waiting:
                self._waiting.remove(job)
        # A worker may be 3 s late.
        daemon_timer(3.0, self._end_worker_of, job)
        with suppress(InvalidStateError):
            job.answer.set_exception(time_limit_error(self._request_time))

    def _end_worker_of(self, job: _Job) -> None:
        with self._lock:
            worker = next((each for each in self._workers if each.job is job), None)
        if worker is not None:
            worker.process.kill()


def _fail(jobs: Iterable[_Job]) -> None:
    for job in jobs:
        with suppress(InvalidStateError):
            job.answer.set_exception(lost_error())
