"""Calls of a planning service's operations, as exchanges of requests and answers.

`nlcontrol.service.remote_session` waits for them, `nlcontrol.service.async_session` awaits them.
"""

from __future__ import annotations

import time
import uuid
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from pydantic import BaseModel, ValidationError

from nlcontrol.errors import ControlError, ErrorInfo
from nlcontrol.results.result import Result
from nlcontrol.service import connection as connections
from nlcontrol.service.connection import Exchange, Pause, Request, ServiceConnection
from nlcontrol.service.documents import NumberedEvent, Offer, RunInfo, SessionInfo, SessionSpec
from nlcontrol.service.methods import Question, SaidBody, start_arguments
from sim.traces.trace import Trace

if TYPE_CHECKING:
    from nlcontrol.session.executor import Motion
    from nlcontrol.session.frame_documents import Frames

D = TypeVar("D", bound=BaseModel)

UNDER_WAY = ("queued", "running")


class HostCalls:
    """What a service is asked for beside sessions and runs that are known.

    Args:
        connection: connection to the service.
    """

    def __init__(self, connection: ServiceConnection) -> None:
        self._connection = connection

    def read(self, kind: type[D], path: str, **params: Any) -> Exchange[D]:
        """A document of the host, below `/v1`."""
        told = {name: value for name, value in params.items() if value is not None}
        return self._connection.document(kind, Request("GET", f"/v1/{path}", params=told or None))

    def open_session(self, spec: SessionSpec) -> Exchange[SessionInfo]:
        """Opens a session."""
        request = Request("POST", "/v1/sessions", spec.model_dump(mode="json"))
        return self._connection.document(SessionInfo, request, repeatable=False)

    def delete_run(self, run_id: str) -> Exchange[None]:
        """Has the service forget a run that has ended."""
        yield from self._connection.response(Request("DELETE", f"/v1/runs/{run_id}"))


class SessionCalls:
    """Operations of one session.

    Args:
        connection: connection to the service.
        info: the session.
    """

    def __init__(self, connection: ServiceConnection, info: SessionInfo) -> None:
        self._connection = connection
        self._path = f"/v1/sessions/{info.session_id}"

    def answer(self, asked: Question, fields: Mapping[str, Any]) -> Exchange[BaseModel]:
        """The document with which the service answers a question."""
        request = Request("POST", f"{self._path}/{asked.path}", dict(fields))
        return self._connection.document(asked.answers, request)

    def start(
        self,
        said: str | Frames | Offer | None,
        plan_id: str | None,
        text: str | None,
        motion: Motion | None,
    ) -> Exchange[RunInfo]:
        """Begins a run; see `nlcontrol.service.methods.PlanningSession.start`."""
        said, plan_id = start_arguments(said, plan_id)
        call, body = "runs", {"plan_id": plan_id, "text": text}
        if said is not None:
            call, body = "say", {**SaidBody.fields_of({"said": said}), "motion": motion}
        # With a key, what is sent again moves nothing again.
        key = {"Idempotency-Key": uuid.uuid4().hex}
        request = Request("POST", f"{self._path}/{call}", body, headers=key)
        return self._connection.document(RunInfo, request)

    def post(self, call: Literal["stop", "reset"]) -> Exchange[None]:
        """Stops what is under way, or puts everything back."""
        yield from self._connection.response(Request("POST", f"{self._path}/{call}"))

    def close(self) -> Exchange[None]:
        """Ends the session; one that has ended with its server is left at that."""
        try:
            yield from self._connection.response(Request("DELETE", self._path), repeatable=False)
        except ControlError as raised:
            if raised.code not in ("unknown_session", "no_service"):
                raise


class RunCalls:
    """Operations of one run.

    Args:
        connection: connection to the service.
        run_id: name of the run.
    """

    def __init__(self, connection: ServiceConnection, run_id: str) -> None:
        self._connection, self._run_id = connection, run_id
        self.path = f"/v1/runs/{run_id}"

    def read(self) -> Exchange[RunInfo]:
        """The run as it is now."""
        return self._connection.document(RunInfo, Request("GET", self.path))

    def read_ended(self, timeout: float | None) -> Exchange[RunInfo]:
        """The run once it has ended; raises `TimeoutError` if it goes on for longer [s]."""
        deadline = None if timeout is None else time.monotonic() + timeout
        pause = 0.02
        while (info := (yield from self.read())).state in UNDER_WAY:
            if deadline is not None and time.monotonic() + pause > deadline:
                raise TimeoutError(f"run {self._run_id} goes on after {timeout} s")
            yield Pause(pause)
            pause = min(1.5 * pause, 0.25)
        return info

    def stop(self) -> Exchange[None]:
        """Asks it to let go and come to rest."""
        yield from self._connection.response(Request("POST", f"{self.path}/stop"))

    def trace(self) -> Exchange[Trace | None]:
        """The trace of a run that has ended; None if nothing moved."""
        try:
            answer = yield from self._connection.response(Request("GET", f"{self.path}/trace"))
        except ControlError as raised:
            if raised.code == "no_file":
                return None
            raise
        with TemporaryDirectory() as folder:
            file = Path(folder, "trace.npz")
            file.write_bytes(answer.content)
            return Trace.load(file)


def result_of(info: RunInfo) -> Result:
    """The result of a run that has ended; raises why there is none."""
    if info.result is None:
        raise ControlError(info.error or ErrorInfo(code="internal", message=info.state))
    return info.result


class EventReading:
    """How far the events of a run were read, and whether more are worth the wait.

    What is lost on the way is asked for again, after a pause that grows with the losses.

    Args:
        after: number of the last event that is known already.
    """

    def __init__(self, after: int) -> None:
        self.after = after
        self._losses = 0

    def fresh_event(self, data: str) -> NumberedEvent | None:
        """An event of the run that was not read yet; None for another, as of a place in a queue."""
        try:
            told = NumberedEvent.model_validate_json(data)
        except ValidationError:
            return None
        if told.number <= self.after:
            return None
        self.after, self._losses = told.number, 0
        return told

    def require_hope(self, lost: ControlError) -> None:
        """Raises the loss again if it is of another kind, or one of too many in a row."""
        if lost.code != "no_service" or self._losses == len(connections.PAUSES):
            raise lost

    def is_over(self, info: RunInfo) -> bool:
        """Check for a run that has ended and whose events were all read, or do not come."""
        ended = info.state not in UNDER_WAY
        return ended and (self.after >= info.events or self._losses == len(connections.PAUSES))

    def next_pause(self) -> float:
        """Time until the next try [s]."""
        pause = connections.PAUSES[min(self._losses, len(connections.PAUSES) - 1)]
        self._losses += 1
        return pause
