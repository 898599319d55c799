"""A run in this process: a thread that carries something out, and all that it tells."""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable, Iterator
from threading import Condition, Thread
from typing import TYPE_CHECKING

from nlcontrol.errors import ControlError, ErrorInfo, exception_info
from nlcontrol.service.documents import NumberedEvent, RunInfo, RunKind, TableSpec
from sim.supervision import StopToken

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from nlcontrol.service.bundles.run_request import RunRequest
    from nlcontrol.session.events import Event
    from sim.traces.trace import Trace

    Deed = Callable[[Callable[[Event], None], StopToken], Result]


class SessionRun:
    """Something that a session carries out, from its construction on.

    Args:
        deed: carries it out; it is given who is told of events, and what asks it to stop.
        session_id: of the session.
        kind: of the run.
        text: the sentence.
        plan_id: that was approved.
        table: on which.
        on_event: told of every event, in the thread of the run.
        request: makes the request of what has just been carried out.

    Attributes:
        request: with all that it takes to repeat it; None until it has a result.
    """

    def __init__(
        self,
        deed: Deed,
        *,
        session_id: str,
        kind: RunKind,
        text: str,
        plan_id: str | None = None,
        table: TableSpec,
        on_event: Callable[[Event], object] | None = None,
        request: Callable[[Result], RunRequest],
    ) -> None:
        self.run_id = f"run-{secrets.token_hex(8)}"
        self.request: RunRequest | None = None
        self._deed, self._on_event, self._make_request = deed, on_event, request
        self._stop = StopToken()
        self._changed = Condition()
        self._events: list[NumberedEvent] = []
        self._result: Result | None = None
        now = time.time()
        self._info = RunInfo(
            run_id=self.run_id,
            session_id=session_id,
            kind=kind,
            state="running",
            text=text,
            plan_id=plan_id,
            scene=table.scene,
            seed=table.seed,
            asked_at=now,
            begun_at=now,
        )
        self._thread = Thread(target=self._carry_out, name=self.run_id)
        self._thread.start()

    def _carry_out(self) -> None:
        result: Result | None = None
        failure: ErrorInfo | None = None
        try:
            result = self._deed(self._tell, self._stop)
            self.request = self._make_request(result)
        except Exception as raised:
            failure = exception_info(raised)
        with self._changed:
            self._result = result
            self._info = self._info.model_copy(
                update={
                    "state": "defect" if result is None else "ended",
                    "ended_at": time.time(),
                    "result": result,
                    "error": failure,
                }
            )
            self._changed.notify_all()

    def _tell(self, event: Event) -> None:
        with self._changed:
            self._events.append(NumberedEvent(number=len(self._events) + 1, event=event))
            self._changed.notify_all()
        if self._on_event is not None:
            self._on_event(event)

    @property
    def is_over(self) -> bool:
        """It has ended, in whichever way."""
        return self._info.ended_at is not None

    @property
    def is_stopped(self) -> bool:
        """It was asked to come to rest."""
        return self._stop.requested

    def info(self) -> RunInfo:
        """The run as it is now."""
        with self._changed:
            return self._info.model_copy(update={"events": len(self._events)})

    def events(self, after: int = 0) -> Iterator[NumberedEvent]:
        """Its events as they happen, until it has ended; see `Run.events`."""
        while fresh := self._events_after(after):
            yield from fresh
            after += len(fresh)

    def _events_after(self, number: int) -> list[NumberedEvent]:
        """The events since one, as soon as there is any; none if it has ended."""
        with self._changed:
            self._changed.wait_for(lambda: len(self._events) > number or self.is_over)
            return self._events[number:]

    def result(self, timeout: float | None = None) -> Result:
        """The result; waits until it has ended; see `Run.result`."""
        with self._changed:
            if not self._changed.wait_for(lambda: self.is_over, timeout):
                raise TimeoutError(f"it goes on after {timeout} s")
        if self._info.error is not None:
            raise ControlError(self._info.error)
        assert self._result is not None, "a run ends with a result, or with an error"
        return self._result

    def stop(self) -> None:
        """Asks it to let go and come to rest; its result is then `cancelled`."""
        self._stop.request()

    def join(self) -> None:
        """Waits until it has ended."""
        self._thread.join()

    def trace(self) -> Trace | None:
        """The trace of what happened; None if nothing moved. Waits until it has ended."""
        self.join()
        return None if self._result is None else self._result.trace
