"""A planning session at a server, as one in this process is."""

from __future__ import annotations

import importlib.util
import time
import uuid
import weakref
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Thread
from typing import TYPE_CHECKING, Any, Literal, NoReturn, TypeVar

from pydantic import BaseModel, ValidationError

from nlcontrol.errors import ControlError, ErrorInfo, error
from nlcontrol.results.result import Result
from nlcontrol.service.documents import NumberedEvent, RunInfo, SessionInfo, SessionSpec
from nlcontrol.service.methods import PlanningSession, Question, SaidBody, is_question
from nlcontrol.session.events import LOGGER, Event
from sim.traces.trace import Trace

if TYPE_CHECKING:
    import httpx
    from httpx_sse import ServerSentEvent

    from nlcontrol.session.executor import Motion
    from nlcontrol.session.frame_documents import Frames


# A connection to a planning service: requests, answers as documents, problems as errors.
#
# A request that is lost on its way is sent again where that cannot do anything twice.


D = TypeVar("D", bound=BaseModel)

PAUSES = (0.1, 0.3, 1.0, 3.0)
"""Waits before what was lost is tried again [s]."""

CONNECT_TIME, SILENCE, KEPT = 5.0, 45.0, 2.0
"""Longest time to connect, longest silence of a stream (it has a heartbeat), and the time for which
an idle connection is kept: less than servers keep it, which would lose a request [s]."""


class ServiceConnection:
    """A connection to a planning service; threads may share it.

    Args:
        url: of the service.
        token: that it asks for, if any.
        timeout: longest time to wait for an answer, by the clock on the wall [s].
        transport: of the requests, if not over a network.

    Raises:
        ControlError: `missing_extra`; `usage` if the URL is none.
    """

    def __init__(
        self,
        url: str,
        *,
        token: str | None = None,
        timeout: float = 120.0,
        transport: httpx.BaseTransport | None = None,
    ) -> None:
        if importlib.util.find_spec("httpx") is None:
            raise error(
                "missing_extra",
                "a client of the planning service needs httpx",
                suggestions=("install from the checkout: pip install '.[serve]'",),
            )
        import httpx

        try:
            base = httpx.URL(url)
            if base.scheme not in ("http", "https") or not base.host:
                raise ValueError
            self._http = httpx.Client(
                base_url=base,
                headers={} if token is None else {"Authorization": f"Bearer {token}"},
                timeout=httpx.Timeout(timeout, connect=CONNECT_TIME),
                limits=httpx.Limits(keepalive_expiry=KEPT),
                transport=transport,
                # A proxy of the environment does not lead to this machine.
                trust_env=base.host not in ("127.0.0.1", "localhost", "::1"),
            )
        except (httpx.InvalidURL, ValueError, TypeError) as raised:
            raise error(
                "usage",
                f"'{url}' with this token is no address of a service",
                suggestions=("give one like http://127.0.0.1:8000",),
            ) from raised
        self.url = url
        # Runs outlive the session that began them, and need it still.
        weakref.finalize(self, self._http.close)

    def document(
        self, kind: type[D], method: str, path: str, body: Any = None, **options: Any
    ) -> D:
        """The answer to a request, as a document; see `response`.

        Raises:
            ControlError: also `bad_answer`, if it is no such document.
        """
        answer = self.response(method, path, body, **options)
        try:
            return kind.model_validate_json(answer.content)
        except ValidationError as raised:
            self._refuse_answer(f"no {kind.__name__} came for {method} {path}", raised)

    def response(
        self,
        method: str,
        path: str,
        body: Any = None,
        *,
        headers: Mapping[str, str] | None = None,
        repeatable: bool = True,
    ) -> httpx.Response:
        """The answer to a request.

        Args:
            method: of HTTP.
            path: below the service's URL.
            body: to be sent as JSON.
            headers: further ones.
            repeatable: it may be sent again if it is not known whether it arrived.

        Raises:
            ControlError: that of the service; `no_service` if it cannot be reached; `bad_answer`.
        """
        import httpx

        pauses = iter(PAUSES if repeatable else ())
        while True:
            try:
                response = self._http.request(method, path, json=body, headers=headers)
            except httpx.TransportError as raised:
                pause = next(pauses, None)
                if pause is None or isinstance(raised, httpx.ReadTimeout):
                    self._tell_lost(raised)
                time.sleep(pause)
            else:
                self._require_success(response)
                return response

    def stream(self, path: str, after: int = 0) -> Iterator[ServerSentEvent]:
        """The events of a stream, those after a number alone.

        Raises:
            ControlError: as in `response`; `no_service` where the stream is lost.
        """
        import httpx
        from httpx_sse import EventSource

        headers = {"Accept": "text/event-stream", "Last-Event-ID": str(after)}
        timeout = httpx.Timeout(SILENCE, connect=CONNECT_TIME)
        try:
            with self._http.stream("GET", path, headers=headers, timeout=timeout) as response:
                if not response.is_success:
                    response.read()
                self._require_success(response)
                if response.status_code != httpx.codes.NO_CONTENT:
                    yield from EventSource(response).iter_sse()
        except httpx.TransportError as raised:
            self._tell_lost(raised)

    def _require_success(self, response: httpx.Response) -> None:
        if response.is_success:
            return
        try:
            problem = response.json()
            known = {key: problem[key] for key in ErrorInfo.model_fields if key in problem}
            info = ErrorInfo.model_validate({"message": problem.get("detail", ""), **known})
        except (ValueError, TypeError, AttributeError) as raised:
            self._refuse_answer(f"HTTP status {response.status_code} came", raised)
        raise ControlError(info)

    def _refuse_answer(self, message: str, raised: Exception) -> NoReturn:
        raise error(
            "bad_answer",
            f"{self.url}: {message}",
            suggestions=("see that `nlcontrol serve` of this version answers there",),
        ) from raised

    def _tell_lost(self, raised: Exception) -> NoReturn:
        raise error(
            "no_service",
            f"{self.url} cannot be reached: {raised or type(raised).__name__}",
            suggestions=(f"`nlcontrol serve` starts one; see that it runs at {self.url}",),
        ) from raised


# A run at a server.


UNDER_WAY = ("queued", "running")


class RemoteRun:
    """A run at a server; see `nlcontrol.service.methods.Run`.

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
        pause = 0.02
        while (info := self.info()).state in UNDER_WAY:
            if deadline is not None and time.monotonic() + pause > deadline:
                raise TimeoutError(f"run {self._run_id} goes on after {timeout} s")
            time.sleep(pause)
            pause = min(1.5 * pause, 0.25)
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


class Client(PlanningSession):
    """A planning session at a server; see `nlcontrol.service.methods.PlanningSession`.

    Args:
        url: of the service, like `http://127.0.0.1:8000`.
        scene: name of a scene of the host, or all that is asked for of the session.
        seed, defaults, approval: as in a `SessionSpec`, if none is given.
        token: that the service asks for, if any.
        timeout: longest time to wait for an answer, by the clock on the wall [s].
        transport: of the requests, if not over a network.

    Raises:
        ControlError: `no_service`, or what the service has against it; `missing_extra` without
            httpx. Every call raises `no_service` where the service is lost.
    """

    def __init__(
        self,
        url: str,
        scene: SessionSpec | str = "kitchen",
        *,
        seed: int = 0,
        defaults: Mapping[str, float] | None = None,
        approval: Literal["plan", "none"] = "none",
        token: str | None = None,
        timeout: float = 120.0,
        transport: httpx.BaseTransport | None = None,
    ) -> None:
        self._connection = ServiceConnection(url, token=token, timeout=timeout, transport=transport)
        spec = scene
        if not isinstance(spec, SessionSpec):
            spec = SessionSpec(
                scene=spec, seed=seed, defaults=dict(defaults or {}), approval=approval
            )
        info = self._connection.document(
            SessionInfo, "POST", "/v1/sessions", spec.model_dump(mode="json"), repeatable=False
        )
        self.session_id = info.session_id

    def answer_question(self, asked: Question, fields: Mapping[str, Any]) -> BaseModel:
        """The document with which the service answers a question."""
        return self._document(asked.answers, asked.path, dict(fields))

    def ask(self, said: str | Frames, *, motion: Motion = "never") -> Result:
        """The answer to a question; it moves nothing unless that is allowed."""
        if motion == "simulate" and is_question(self, said):
            return self.say(said, motion=motion).result()
        return super().ask(said)

    def execute(
        self,
        plan_id: str,
        *,
        text: str | None = None,
        on_event: Callable[[Event], object] | None = None,
    ) -> RemoteRun:
        """Begins to carry out a plan that was approved; see `PlanningSession.execute`."""
        return self._begin_run("runs", {"plan_id": plan_id, "text": text}, on_event)

    def say(
        self,
        said: str | Frames,
        *,
        motion: Motion | None = None,
        on_event: Callable[[Event], object] | None = None,
    ) -> RemoteRun:
        """Begins to do what a sentence says; see `PlanningSession.say`."""
        return self._begin_run(
            "say", {**SaidBody.fields_of({"said": said}), "motion": motion}, on_event
        )

    def stop(self) -> None:
        """Asks what is being carried out to let go and come to rest; plans are dropped."""
        self._post("stop")

    def reset(self) -> None:
        """Puts everything back as it was at the beginning; see `PlanningSession.reset`."""
        self._post("reset")

    def close(self) -> None:
        """Ends the session; one that has ended with its server is left at that."""
        try:
            self._connection.response("DELETE", self._path, repeatable=False)
        except ControlError as raised:
            if raised.code not in ("unknown_session", "no_service"):
                raise

    @property
    def _path(self) -> str:
        return f"/v1/sessions/{self.session_id}"

    def _begin_run(
        self, call: str, body: dict[str, Any], on_event: Callable[[Event], object] | None
    ) -> RemoteRun:
        # With a key, what is sent again moves nothing again.
        key = {"Idempotency-Key": uuid.uuid4().hex}
        info = self._document(RunInfo, call, body, headers=key)
        return RemoteRun(self._connection, info, on_event)

    def _document(self, kind: type[D], call: str, body: Any = None, **options: Any) -> D:
        return self._connection.document(kind, "POST", f"{self._path}/{call}", body, **options)

    def _post(self, call: str, body: Any = None) -> httpx.Response:
        return self._connection.response("POST", f"{self._path}/{call}", body)
