"""An open session as the service holds it: its process, its run, when it was last used."""

from __future__ import annotations

import math
import re
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Future, InvalidStateError
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from nlcontrol.errors import ControlError, error
from nlcontrol.service.documents import SessionInfo, SessionSpec
from nlcontrol.service.offers import LIFE
from nlcontrol.service.workers.worker_process import (
    LoopNotifier,
    WorkerProcess,
    daemon_timer,
    queue_full,
    time_limit_error,
)

if TYPE_CHECKING:
    from nlcontrol.service.service_settings import ServiceSettings

MOST_CALLS = 8
"""Calls of one session that may be open at once."""

LEFT_ALONE = 60.0
"""Time after which a session that nobody uses may make room for another one [s]."""


class LiveSession:
    """A session that is open.

    Args:
        session_id: name of the session.
        spec: specification with which it was opened.
        settings: settings of the service.

    Attributes:
        process: process in which it is open.
        run_id: name of the run that is under way or queued.
        is_lost: its process has ended.
        frames: rung at each pose frame; `frame` is the last one, as JSON.
    """

    process: WorkerProcess

    def __init__(
        self,
        session_id: str,
        spec: SessionSpec,
        settings: ServiceSettings,
    ) -> None:
        self.session_id, self.spec = session_id, spec
        self.run_id: str | None = None
        self._beginning, self._begins = threading.Lock(), threading.Semaphore(MOST_CALLS)
        self.is_lost = False
        self.frames = LoopNotifier()
        self.frame: bytes | None = None
        self._settings = settings
        self._used_at = time.monotonic()
        self._kept_for, self._left_at = settings.idle_time, -math.inf
        self._planned_at = -LIFE
        self._calls: set[Future[bytes]] = set()
        self._is_undone = threading.Event()
        self._is_undone.set()

    @property
    def expires_in(self) -> float:
        """Time until it is closed if nothing is asked of it [s]; all of it while it is used."""
        return max(0.0, self._kept_for - self.idle_for)

    @property
    def idle_for(self) -> float:
        """Time for which nobody has used it [s]."""
        if self.run_id is not None or self._calls or self.frames.listeners:
            self.note_use()
        return time.monotonic() - self._used_at

    @property
    def is_left_alone(self) -> bool:
        """It may make room for another one: unused for long, and no plan waits to be approved."""
        waits = time.monotonic() - self._planned_at < LIFE
        return self.is_lost or (self.idle_for >= LEFT_ALONE and not waits)

    def note_use(self) -> None:
        """Puts off the end of an idle session."""
        self._used_at = time.monotonic()

    def leave(self, after: float) -> None:
        """Lets it end once it has been idle for a time [s], unless somebody takes it up again.

        Uses within that time put the end off: a page that is left has requests under way, which
        may come in after it has told so.
        """
        self._kept_for = min(after, self._settings.idle_time)
        self._left_at = time.monotonic()

    def take_up(self) -> None:
        """Notes that somebody uses the session, so that it is kept as long as any."""
        if time.monotonic() - self._left_at > self._kept_for:
            self._kept_for = self._settings.idle_time
        self.note_use()

    @contextmanager
    def beginning(self) -> Iterator[None]:
        """Context in which a run is begun, one after the other; raises `queue_full`."""
        if not self._begins.acquire(blocking=False):
            raise _too_many_calls(MOST_CALLS)
        try:
            with self._beginning:
                yield
        finally:
            self._begins.release()

    def info(self) -> SessionInfo:
        """The session as it is now."""
        run_id = self.run_id
        return SessionInfo(
            session_id=self.session_id,
            spec=self.spec,
            has_robot=self.spec.objects is None,
            state="lost" if self.is_lost else "running" if run_id else "idle",
            run_id=run_id,
            expires_in=self.expires_in,
        )

    def require_process(self) -> None:
        """Notes a use of the session.

        Raises:
            ControlError: `session_lost`.
        """
        self.take_up()
        if self.is_lost:
            raise error(
                "session_lost",
                f"the process of the session {self.session_id} has ended, and its table with it",
                suggestions=("open a new session",),
            )

    def call(self, method: str, **arguments: Any) -> Future[bytes]:
        """Calls a method of the session; it is given up when its time is over.

        Raises:
            ControlError: `session_lost`; `queue_full` if too many calls are open.
        """
        self.require_process()
        if len(self._calls) >= MOST_CALLS:
            raise _too_many_calls(len(self._calls))
        limit = self._settings.request_time
        answer: Future[bytes] = Future()
        answer.set_running_or_notify_cancel()
        call = self.process.call(method, **arguments)
        self._calls.add(call)

        def give_up() -> None:
            if method == "begin_run":
                self._is_undone.clear()
            elif method == "ask":  # it may have the robot touch something
                self.process.command("give_up_answer")
            try:
                answer.set_exception(time_limit_error(limit))
            except InvalidStateError:  # it has just been answered
                self._is_undone.set()

        timer = daemon_timer(limit, give_up)

        def settle(call: Future[bytes]) -> None:
            timer.cancel()
            self._calls.discard(call)
            self.note_use()
            raised = call.exception()
            if method == "plan" and raised is None and _OFFERED.search(call.result()):
                self._planned_at = time.monotonic()
            elif method in ("begin_run", "reset"):
                self._planned_at = -LIFE
            try:
                if raised is None:
                    answer.set_result(call.result())
                else:
                    answer.set_exception(self._cause(raised))
            except InvalidStateError:  # it was given up
                is_done = raised is None
                if method == "begin_run" and is_done:
                    dropped = self.process.command("drop_run")
                    dropped.add_done_callback(lambda _: self._is_undone.set())
                elif method == "begin_run":
                    self._is_undone.set()

        call.add_done_callback(settle)
        return answer

    def wait_undone(self, timeout: float) -> None:
        """Waits [s] until a run whose beginning was given up has ended."""
        self._is_undone.wait(timeout)

    def tell_frames(self, wanted: bool) -> None:
        """Lets frames of poses be told, or ends that."""
        if not wanted:
            self.frame = None
        if not self.is_lost:
            self.process.call("tell_poses", wanted=wanted)

    def _cause(self, raised: BaseException) -> BaseException:
        """An error of a call, that of a session without process among them."""
        if isinstance(raised, ControlError) and raised.code == "worker_lost":
            self.is_lost = True
            try:
                self.require_process()
            except ControlError as lost:
                return lost
        return raised


_OFFERED = re.compile(rb'"plan_id":\s*"')


def _too_many_calls(calls: int) -> ControlError:
    message = f"{calls} calls of this session are open"
    return queue_full(message, calls, "wait for the answers", retry_after=1.0)
