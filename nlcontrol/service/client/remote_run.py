"""A run at a server."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Thread
from typing import TYPE_CHECKING

from pydantic import ValidationError

from nlcontrol.errors import ControlError, ErrorInfo
from nlcontrol.service.client.service_connection import PAUSES
from nlcontrol.service.documents import NumberedEvent, RunInfo
from nlcontrol.session.events import LOGGER, Event

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from nlcontrol.service.client.service_connection import ServiceConnection
    from sim.traces.trace import Trace

UNDER_WAY = ("queued", "running")

SOONEST, LATEST = 0.02, 0.25
"""Bounds of the waits between two questions whether a run has ended [s]."""


class RemoteRun:
    """A run at a server; see `nlcontrol.service.session_protocol.Run`.

    Args:
        connection: to the service.
        info: of the run, as it began.
        on_event: told of every event, in a thread of its own. If it fails, the run is told to stop,
            and `result` raises what it raised.
    """

    def __init__(
        self,
        connection: ServiceConnection,
        info: RunInfo,
        on_event: Callable[[Event], object] | None = None,
    ) -> None:
        self._connection = connection
        self._run_id = info.run_id
        self._path = f"/v1/runs/{info.run_id}"
        self._listener: Thread | None = None
        self._failure: Exception | None = None
        if on_event is not None:
            self._listener = Thread(target=self._listen, args=(on_event,), daemon=True)
            self._listener.start()

    @property
    def run_id(self) -> str:
        """Name of the run."""
        return self._run_id

    def info(self) -> RunInfo:
        """The run as it is now."""
        return self._connection.document(RunInfo, "GET", self._path)

    def events(self, after: int = 0) -> Iterator[NumberedEvent]:
        """Its events as they happen, until it has ended; what is lost on the way is had again.

        Args:
            after: number of the last event that is known already.

        Raises:
            ControlError: `no_service` if the service stays away.
        """
        failures = 0
        while True:
            try:
                for streamed in self._connection.stream(f"{self._path}/events", after):
                    if (told := _numbered_event(streamed.data)) is None or told.number <= after:
                        continue
                    after, failures = told.number, 0
                    yield told
                    if told.event.kind == "ended":
                        return
            except ControlError as lost:
                if lost.code != "no_service" or failures == len(PAUSES):
                    raise
            info = self.info()
            if info.state not in UNDER_WAY and (after >= info.events or failures == len(PAUSES)):
                return
            time.sleep(PAUSES[min(failures, len(PAUSES) - 1)])
            failures += 1

    def result(self, timeout: float | None = None) -> Result:
        """The result; waits until it has ended.

        Args:
            timeout: longest time to wait, by the clock on the wall [s]; None for no limit.

        Raises:
            TimeoutError: it goes on.
            ControlError: it has no result; the code says why.
            Exception: what the callback has raised.
        """
        info = self._ended_info(timeout)
        if self._failure is not None:
            raise self._failure
        if info.result is None:
            raise ControlError(info.error or ErrorInfo(code="internal", message=info.state))
        return info.result

    def stop(self) -> None:
        """Asks it to let go and come to rest; its result is then `cancelled`."""
        self._connection.response("POST", f"{self._path}/stop")

    def trace(self) -> Trace | None:
        """The trace of what happened; None if nothing moved. Waits until it has ended."""
        from sim.traces.trace import Trace

        self._ended_info(None)
        try:
            content = self._connection.response("GET", f"{self._path}/trace").content
        except ControlError as raised:
            if raised.code == "no_file":
                return None
            raise
        with TemporaryDirectory() as folder:
            file = Path(folder, "trace.npz")
            file.write_bytes(content)
            return Trace.load(file)

    def _ended_info(self, timeout: float | None) -> RunInfo:
        """The run once it has ended, and the callback was told so."""
        deadline = None if timeout is None else time.monotonic() + timeout
        if self._listener is not None:
            self._listener.join(timeout)
        pause = SOONEST
        while (info := self.info()).state in UNDER_WAY:
            if deadline is not None and time.monotonic() + pause > deadline:
                raise TimeoutError(f"run {self._run_id} goes on after {timeout} s")
            time.sleep(pause)
            pause = min(1.5 * pause, LATEST)
        return info

    def _listen(self, on_event: Callable[[Event], object]) -> None:
        try:
            for told in self.events():
                if self._failure is None:
                    self._tell(on_event, told.event)
        except ControlError as lost:
            LOGGER.warning("events of run %s are missing: %s", self._run_id, lost)

    def _tell(self, on_event: Callable[[Event], object], event: Event) -> None:
        try:
            on_event(event)
        except Exception as raised:
            self._failure = raised
            self.stop()


def _numbered_event(data: str) -> NumberedEvent | None:
    """An event of the run; None if it is of another kind, as that of a place in the queue."""
    try:
        return NumberedEvent.model_validate_json(data)
    except ValidationError:
        return None
