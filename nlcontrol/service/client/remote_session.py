"""A planning session at a server, as one in this process is."""

from __future__ import annotations

import uuid
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from pydantic import BaseModel

from nlcontrol.errors import ControlError
from nlcontrol.results.result import Result
from nlcontrol.service.client.remote_run import RemoteRun
from nlcontrol.service.client.service_connection import ServiceConnection
from nlcontrol.service.documents import (
    RunInfo,
    SessionInfo,
    SessionSpec,
)
from nlcontrol.service.methods import Question, SaidBody
from nlcontrol.service.session_protocol import PlanningSession, is_question

if TYPE_CHECKING:
    import httpx

    from nlcontrol.session.events import Event
    from nlcontrol.session.executor import Motion
    from nlcontrol.session.frame_documents import Frames

D = TypeVar("D", bound=BaseModel)


class Client(PlanningSession):
    """A planning session at a server; see `nlcontrol.service.session_protocol.PlanningSession`.

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
