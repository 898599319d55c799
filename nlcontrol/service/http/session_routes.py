"""Routes of sessions: open, look, ask, plan, approve, say, stop, close."""

from __future__ import annotations

from fastapi import APIRouter, Request
from starlette.responses import Response

from nlcontrol.service.documents import (
    RunInfo,
    SceneGeometry,
    SessionInfo,
)
from nlcontrol.service.http.event_streams import STREAM_CONTENT, stream_poses
from nlcontrol.service.http.openapi_document import PROBLEMS
from nlcontrol.service.http.question_routes import add_questions_of_session
from nlcontrol.service.http.request_bodies import (
    IdempotencyKey,
    IdleTime,
    PlanIdBody,
    SayBody,
    SessionBody,
    SessionId,
)
from nlcontrol.service.http.service_access import (
    Service,
    SessionList,
    answer_of,
    document_response,
    require_bounded_sentence,
    waited,
)

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


add_questions_of_session(ROUTER)


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
