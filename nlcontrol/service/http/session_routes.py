"""Routes of sessions: open, look, ask, plan, approve, say, stop, close."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from inspect import Parameter, Signature
from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import Response

from nlcontrol.service.documents import (
    RunInfo,
    SceneGeometry,
    SessionInfo,
    SessionList,
)
from nlcontrol.service.http.event_streams import STREAM_CONTENT, stream_poses
from nlcontrol.service.http.openapi_document import PROBLEMS
from nlcontrol.service.http.responses import (
    IdempotencyKey,
    IdleTime,
    PlanIdBody,
    SayBody,
    Service,
    SessionBody,
    SessionId,
    answer_of,
    document_response,
    require_bounded_sentence,
    waited,
)
from nlcontrol.service.methods import (
    QUESTIONS,
    Question,
    RequestBody,
    SaidBody,
    TableBody,
    body_example,
)
from nlcontrol.service.planning_service import PlanningService

# Routes of questions: without a session, about a table that is stated, and of a session.


def add_questions(router: APIRouter, *, session: bool) -> None:
    """Adds the questions of a session, or those that need none and bear their table."""
    for question in QUESTIONS:
        asks = question.asks if session else question.alone
        if asks is not None:
            example = {**body_example(asks), **question.example}
            content = {"application/json": {"example": example}}
            router.add_api_route(
                f"/{{session_id}}/{question.path}" if session else f"/{question.name}",
                _endpoint(question, asks, session=session),
                methods=["POST"],
                operation_id=f"session_{question.name}" if session else question.name,
                response_model=question.answers,
                openapi_extra={"requestBody": {"content": content}},
            )


def _endpoint(
    question: Question, asks: type[RequestBody], *, session: bool
) -> Callable[..., Awaitable[Response]]:
    """The endpoint of a question, with the signature from which the framework reads its form."""

    async def asked(
        service: PlanningService, body: RequestBody | None = None, session_id: str = ""
    ) -> Response:
        if isinstance(body, SaidBody):
            require_bounded_sentence(body, service.settings)
        arguments = {} if body is None else body.arguments
        if session:
            return await answer_of(service.call_session(session_id, question.name, **arguments))
        assert isinstance(body, TableBody), "where it is asked alone, it bears its table"
        return await answer_of(service.call_planner(question.name, body.table, **arguments))

    empty = not any(field.is_required() for field in asks.model_fields.values()) and not issubclass(
        asks, SaidBody
    )
    kind, default = (asks | None, None) if empty else (asks, Parameter.empty)
    told: list[tuple[str, Any, Any]] = [("session_id", SessionId, Parameter.empty)] * session
    told += [("service", Service, Parameter.empty), ("body", kind, default)]
    asked.__signature__ = Signature(  # type: ignore[attr-defined]
        [
            Parameter(name, Parameter.KEYWORD_ONLY, default=value, annotation=annotation)
            for name, annotation, value in told
        ]
    )
    asked.__name__ = question.name
    asked.__doc__ = question.told if session else question.told_alone
    return asked


ROUTER = APIRouter(prefix="/v1/sessions", tags=["sessions"], responses=PROBLEMS)


@ROUTER.post("", operation_id="open_session", response_model=SessionInfo, status_code=201)
async def open_session(spec: SessionBody, request: Request, service: Service) -> Response:
    """Opens a session: a table, a robot and a conversation."""
    if request.app.state.http_settings.approve:
        spec = spec.model_copy(update={"approval": "plan"})
    info = await waited(service, service.open_session, spec)
    if await request.is_disconnected():  # nobody knows its name, and it would keep others out
        service.close_session(info.session_id)
    return document_response(info, 201)


@ROUTER.get("", operation_id="list_sessions", response_model=SessionList)
async def list_sessions(service: Service) -> Response:
    """Lists the sessions that are open."""
    return document_response(SessionList(sessions=tuple(service.sessions())))


@ROUTER.get("/{session_id}", operation_id="read_session", response_model=SessionInfo)
async def read_session(session_id: SessionId, service: Service) -> Response:
    """Tells how a session is."""
    return document_response(service.session(session_id))


@ROUTER.delete("/{session_id}", operation_id="close_session", status_code=204)
async def close_session(session_id: SessionId, service: Service, idle: IdleTime = None) -> Response:
    """Closes a session; what is being carried out in it is stopped first."""
    if idle is None:
        service.close_session(session_id)
        return Response(status_code=204)
    service.leave_session(session_id, idle)
    return Response(status_code=204)


add_questions(ROUTER, session=True)


@ROUTER.post(
    "/{session_id}/runs", operation_id="session_execute", response_model=RunInfo, status_code=202
)
async def execute(
    session_id: SessionId, body: PlanIdBody, service: Service, key: IdempotencyKey = None
) -> Response:
    """Begins to carry out the plan that was approved; the robot looks again first."""
    info = await waited(
        service,
        service.begin_run,
        session_id,
        plan_id=body.plan_id,
        said=body.text,
        idempotency_key=key,
    )
    return document_response(info, 202)


@ROUTER.post(
    "/{session_id}/say", operation_id="session_say", response_model=RunInfo, status_code=202
)
async def say(
    session_id: SessionId, body: SayBody, service: Service, key: IdempotencyKey = None
) -> Response:
    """Begins to do what a sentence says, planned and executed at one go."""
    require_bounded_sentence(body, service.settings)
    info = await waited(
        service, service.begin_run, session_id, idempotency_key=key, **body.arguments
    )
    return document_response(info, 202)


@ROUTER.post("/{session_id}/stop", operation_id="session_stop", status_code=204)
async def stop(session_id: SessionId, service: Service) -> Response:
    """Asks what is being carried out to let go and come to rest; plans are dropped."""
    service.stop_session(session_id)
    return Response(status_code=204)


@ROUTER.post("/{session_id}/reset", operation_id="session_reset", response_model=SessionInfo)
async def reset(session_id: SessionId, service: Service) -> Response:
    """Puts everything back as it was at the beginning."""
    await answer_of(service.call_session(session_id, "reset"))
    return document_response(service.session(session_id))


@ROUTER.get("/{session_id}/geometry", operation_id="session_geometry", response_model=SceneGeometry)
async def geometry(session_id: SessionId, service: Service) -> Response:
    """Sends the shapes of all bodies, which `live` moves."""
    return await answer_of(service.scene_geometry(session_id))


@ROUTER.get(
    "/{session_id}/live",
    operation_id="session_live",
    response_class=Response,
    responses={200: {"content": STREAM_CONTENT}},
)
async def live(session_id: SessionId, request: Request, service: Service) -> Response:
    """Streams poses of all bodies for a viewer, as server-sent events (`PoseFrame`)."""
    return stream_poses(request, service, session_id)
