"""Routes of sessions: open, look, ask, plan, approve, say, stop, close."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING

from fastapi import APIRouter, Request
from starlette.responses import Response

from nlcontrol.errors import ControlError
from nlcontrol.questions.push_prediction import PushPrediction
from nlcontrol.results.result import Result
from nlcontrol.service.documents import (
    Affordances,
    FaceMap,
    Offer,
    RunInfo,
    SessionInfo,
    TableView,
    Understanding,
)
from nlcontrol.service.http.event_streams import STREAM_CONTENT, stream_poses
from nlcontrol.service.http.openapi_document import PROBLEMS
from nlcontrol.service.http.request_bodies import (
    ExplainedBody,
    IdempotencyKey,
    IdleTime,
    LookBody,
    MapBody,
    ObjectBody,
    PlanIdBody,
    PredictBody,
    SaidBody,
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
from nlcontrol.service.live_documents import SceneGeometry

if TYPE_CHECKING:
    from nlcontrol.service.planning_service import PlanningService

_LOOKS = 24
"""Looks at a session that is to be closed once it is idle, two in that time: what was asked of it
last, such as a plan, may take longer."""

_CLOSING: set[asyncio.Task[None]] = set()
"""Kept from being collected before they end."""

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
    service.session(session_id)
    closing = asyncio.create_task(_close_unused(service, session_id, idle))
    _CLOSING.add(closing)
    closing.add_done_callback(_CLOSING.discard)
    return Response(status_code=204)


async def _close_unused(service: PlanningService, session_id: str, idle: float) -> None:
    """Closes a session that nobody uses for a time [s]; it stays if somebody takes it up again."""
    with suppress(ControlError):  # it may have been closed meanwhile
        for _ in range(_LOOKS):
            await asyncio.sleep(idle / 2)
            if service.settings.idle_time - service.session(session_id).expires_in >= idle:
                service.close_session(session_id)
                return


@ROUTER.post("/{session_id}/look", operation_id="session_look", response_model=TableView)
async def look(session_id: SessionId, service: Service, body: LookBody | None = None) -> Response:
    """Looks at the table, or takes where everything stands from the caller."""
    arguments = {} if body is None else body.arguments
    return await answer_of(service.call_session(session_id, "look", **arguments))


@ROUTER.post("/{session_id}/parse", operation_id="session_parse", response_model=Understanding)
async def parse(session_id: SessionId, body: SaidBody, service: Service) -> Response:
    """Reads a sentence: its frames, or why it is not understood."""
    require_bounded_sentence(body, service.settings)
    return await answer_of(service.call_session(session_id, "parse", **body.arguments))


@ROUTER.post("/{session_id}/ask", operation_id="session_ask", response_model=Result)
async def ask(session_id: SessionId, body: ExplainedBody, service: Service) -> Response:
    """Answers a question from what is believed; nothing moves."""
    require_bounded_sentence(body, service.settings)
    return await answer_of(service.call_session(session_id, "ask", **body.arguments))


@ROUTER.post("/{session_id}/predict", operation_id="session_predict", response_model=PushPrediction)
async def predict(session_id: SessionId, body: PredictBody, service: Service) -> Response:
    """Predicts a push at a place of a face."""
    return await answer_of(service.call_session(session_id, "predict", **body.arguments))


@ROUTER.post("/{session_id}/map", operation_id="session_map", response_model=FaceMap)
async def map_face(session_id: SessionId, body: MapBody, service: Service) -> Response:
    """Predicts pushes all over a face."""
    return await answer_of(service.call_session(session_id, "map", **body.arguments))


@ROUTER.post(
    "/{session_id}/affordances", operation_id="session_affordances", response_model=Affordances
)
async def affordances(session_id: SessionId, body: ObjectBody, service: Service) -> Response:
    """Lists what the robot can bring about with an object, and for the rest, why not."""
    return await answer_of(service.call_session(session_id, "affordances", **body.arguments))


@ROUTER.post("/{session_id}/plans", operation_id="session_plan", response_model=Offer)
async def plan(session_id: SessionId, body: ExplainedBody, service: Service) -> Response:
    """Plans a sentence; the offer bears the plan id with which it is executed."""
    require_bounded_sentence(body, service.settings)
    return await answer_of(service.call_session(session_id, "plan", **body.arguments))


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
