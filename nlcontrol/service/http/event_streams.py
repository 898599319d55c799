"""Streams of server-sent events: what happens in a run, and where all bodies are.

Events of a run bear their number, so that a listener who was cut off goes on where it was. A silent
stream sends a comment as heartbeat, which also finds out that a listener has gone.
"""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import TYPE_CHECKING

from sse_starlette import EventSourceResponse, ServerSentEvent
from starlette.responses import Response

from nlcontrol.errors import error
from nlcontrol.json_document import Document
from nlcontrol.service.documents import NumberedEvent
from nlcontrol.service.http.responses import HttpSettings, document_response

if TYPE_CHECKING:
    from fastapi import Request
    from starlette.types import Receive, Scope, Send

    from nlcontrol.service.planning_service import PlanningService

STREAM_CONTENT = {
    "text/event-stream": {
        "schema": {
            "type": "object",
            "properties": {key: {"type": "string"} for key in ("id", "event", "data")},
            "required": ["data"],
        }
    }
}
"""Each event of a stream, as the OpenAPI document has it."""


class EventList(Document):
    """Events of a run so far.

    Attributes:
        events: events in their order.
    """

    events: tuple[NumberedEvent, ...]


class _Stream(EventSourceResponse):
    """A stream that is counted until it ends, in whichever way."""

    def __init__(self, events: AsyncIterator[ServerSentEvent], request: Request) -> None:
        self._state = request.app.state
        settings: HttpSettings = self._state.http_settings
        if self._state.streams >= settings.listeners:
            raise error(
                "too_many_requests",
                f"{settings.listeners} streams are open already",
                suggestions=("ask again later, or for a list: Accept: application/json",),
                numbers={"retry_after": 5.0},
            )
        self._state.streams += 1
        # A listener who does not take what was sent within 20 s has gone.
        super().__init__(
            events,
            ping=settings.heartbeat,
            send_timeout=20.0,
            sep="\n",
            ping_message_factory=lambda: ServerSentEvent(comment="heartbeat", sep="\n"),
        )

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Sends the stream."""
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._state.streams -= 1


async def stream_events(
    request: Request, service: PlanningService, run_id: str, after: int
) -> Response:
    """The answer with the events of a run that follow a number.

    Raises:
        ControlError: `unknown_run`, `too_many_requests`.
    """
    info = service.run(run_id)
    accepted = request.headers.get("accept", "")
    if "application/json" in accepted and "text/event-stream" not in accepted:
        return document_response(EventList(events=tuple(service.events_so_far(run_id, after))))
    if info.ended_at is not None and after >= info.events:
        return Response(status_code=204)
    return _Stream(_numbered_events(service, run_id, after), request)


async def _numbered_events(
    service: PlanningService, run_id: str, after: int
) -> AsyncIterator[ServerSentEvent]:
    async for told in service.events(run_id, after):
        yield ServerSentEvent(
            told.model_dump_json(), id=str(told.number), event=told.event.kind, sep="\n"
        )


def stream_poses(request: Request, service: PlanningService, session_id: str) -> Response:
    """The answer with poses for viewers, as long as a session is open.

    Raises:
        ControlError: `unknown_session`, `too_many_requests`.
    """
    service.session(session_id)
    return _Stream(_pose_frames(service, session_id), request)


async def _pose_frames(service: PlanningService, session_id: str) -> AsyncIterator[ServerSentEvent]:
    async for frame in service.live(session_id):
        yield ServerSentEvent(frame.decode(), event="poses", sep="\n")
