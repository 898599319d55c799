"""Processes that plan for whoever asks, without a session and without a robot that moves.

One planner is always kept idle until there are as many as allowed, so that a long refusal delays
nobody else's plan. Calls are taken in their order, each by a planner that has their table open if
one such is idle. A planner knows until when it may search; one that does not keep to it is ended.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from concurrent.futures import Future, InvalidStateError
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any

from nlcontrol.errors import ControlError, error
from nlcontrol.service.workers.planner_host import PlannerHost
from nlcontrol.service.workers.worker_process import (
    WorkerProcess,
    daemon_timer,
    lost_error,
    time_limit_error,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from nlcontrol.service.documents import TableSpec

GRACE = 3.0
"""Time by which a planner may be late [s]."""

MOST_TRIES = 3
"""Planners that may end over a call, or one after the other before they began."""


class _Job:
    """A call for a planner, until it is answered."""

    def __init__(
        self, method: str, table: TableSpec, arguments: Mapping[str, Any], time_limit: float
    ) -> None:
        self.method, self.arguments = method, arguments
        self.table = table.model_dump_json()
        self.answer: Future[bytes] = Future()
        self.answer.set_running_or_notify_cancel()
        self.tries = 0
        self.deadline = time.monotonic() + time_limit


class _Planner:
    """A planner and its work."""

    def __init__(self) -> None:
        self.process: WorkerProcess | None = None
        self.job: _Job | None = None
        self.table: str | None = None
        self.is_ready = False

    @property
    def is_idle(self) -> bool:
        return self.is_ready and self.job is None


class PlannerPool:
    """Planners, as many as are needed.

    Args:
        most: planners at once.
        queue: calls that may wait.
        request_time: after which a call is given up [s].
    """

    def __init__(self, most: int, queue: int, request_time: float) -> None:
        self._most, self._queue, self._request_time = most, queue, request_time
        self._lock = threading.RLock()
        self._planners: list[_Planner] = []
        self._waiting: deque[_Job] = deque()
        self._failed_starts = 0
        self._is_closed = False

    def start(self) -> None:
        """Starts the first planner."""
        with self._lock:
            self._keep_one_idle()

    @property
    def size(self) -> int:
        """Number of planners."""
        return len(self._planners)

    @property
    def pids(self) -> tuple[int, ...]:
        """Numbers of their processes."""
        return tuple(p.process.pid for p in self._planners if p.process is not None)

    def call(self, method: str, table: TableSpec, **arguments: Any) -> Future[bytes]:
        """Calls a method of a session that is opened for this call alone.

        Args:
            method: of `nlcontrol.service.session_protocol.PlanningSession`.
            table: to be planned for.
            arguments: of the method.

        Returns:
            The answer as a JSON document; it raises `ControlError`, `time_limit` among them.

        Raises:
            ControlError: `queue_full`.
        """
        job = _Job(method, table, arguments, self._request_time)
        with self._lock:
            if len(self._waiting) >= self._queue and not any(p.is_idle for p in self._planners):
                raise _queue_full(len(self._waiting))
            self._waiting.append(job)
            self._hand_out()
        timer = daemon_timer(self._request_time, self._give_up, job)
        job.answer.add_done_callback(lambda _: timer.cancel())
        return job.answer

    def close(self) -> None:
        """Ends all planners."""
        with self._lock:
            self._is_closed = True
            processes = [p.process for p in self._planners if p.process is not None]
            jobs, self._waiting = self._waiting, deque()
        _fail(jobs)
        for process in processes:
            process.kill()
        for process in processes:
            process.wait()

    def _hand_out(self) -> None:
        """Gives the calls that wait to the planners that do not."""
        while self._waiting and (idle := [p for p in self._planners if p.is_idle]):
            job = self._waiting.popleft()
            planner = next((p for p in idle if p.table == job.table), idle[0])
            planner.job, planner.table = job, job.table
            assert planner.process is not None, "it is ready"
            rest = job.deadline - time.monotonic()
            call = planner.process.call(
                job.method, table=job.table, time_limit=rest, **job.arguments
            )
            call.add_done_callback(partial(self._take_answer, planner))
        self._keep_one_idle()

    def _keep_one_idle(self) -> None:
        """Starts a planner if all that there are have work, and more are allowed."""
        has_spare = any(p.job is None for p in self._planners)  # or one that is starting
        if has_spare or len(self._planners) >= self._most or self._is_closed:
            return
        planner = _Planner()
        self._planners.append(planner)
        planner.process = WorkerProcess(
            PlannerHost,
            on_ready=lambda: self._welcome(planner),
            on_end=lambda: self._remove(planner),
        )

    def _welcome(self, planner: _Planner) -> None:
        with self._lock:
            planner.is_ready = True
            self._failed_starts = 0
            self._hand_out()

    def _take_answer(self, planner: _Planner, call: Future[bytes]) -> None:
        raised = call.exception()
        with self._lock:
            job, planner.job = planner.job, None
            assert job is not None, "it was at work"
            is_lost = isinstance(raised, ControlError) and raised.code == "worker_lost"
            if is_lost:
                self._planners.remove(planner)
            job.tries += 1
            is_over = job.answer.done() or job.tries == MOST_TRIES or self._is_closed
            again = is_lost and not is_over
            if again:  # nothing moves by it, and another planner may do
                self._waiting.appendleft(job)
            self._hand_out()
        if again:
            return
        with suppress(InvalidStateError):  # its time was over
            if raised is None:
                job.answer.set_result(call.result())
            else:
                job.answer.set_exception(raised)

    def _remove(self, planner: _Planner) -> None:
        """Takes out a planner that has ended; where none begins, no call is kept waiting."""
        with self._lock:
            if planner not in self._planners:
                return
            self._planners.remove(planner)
            self._failed_starts += not planner.is_ready
            if self._failed_starts < MOST_TRIES:
                self._hand_out()
                return
            self._failed_starts = 0  # the next call may try again
            jobs, self._waiting = self._waiting, deque()
        _fail(jobs)

    def _give_up(self, job: _Job) -> None:
        """Ends a call whose time is over; its planner too if that does not come to an end."""
        with self._lock:
            if job in self._waiting:
                self._waiting.remove(job)
        daemon_timer(GRACE, self._end_planner_of, job)
        with suppress(InvalidStateError):
            job.answer.set_exception(time_limit_error(self._request_time))

    def _end_planner_of(self, job: _Job) -> None:
        with self._lock:
            planner = next((p for p in self._planners if p.job is job), None)
        if planner is not None and planner.process is not None:
            planner.process.kill()


def _fail(jobs: Iterable[_Job]) -> None:
    for job in jobs:
        with suppress(InvalidStateError):
            job.answer.set_exception(lost_error())


def _queue_full(waiting: int) -> ControlError:
    return error(
        "queue_full",
        f"{waiting} others wait already",
        suggestions=("ask again in a few seconds",),
        numbers={"waiting": float(waiting), "retry_after": 2.0},
    )
