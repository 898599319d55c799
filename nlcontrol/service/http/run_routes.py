"""Routes of runs: how they are, what happens in them, what they leave behind."""

from __future__ import annotations

import gzip
from typing import Annotated

from fastapi import APIRouter, Header, Query, Request
from starlette.responses import FileResponse, Response

from nlcontrol.service.documents import RunInfo, RunPage
from nlcontrol.service.http.event_streams import STREAM_CONTENT, EventList, stream_events
from nlcontrol.service.http.openapi_document import PROBLEMS
from nlcontrol.service.http.request_bodies import AfterNumber, RunId
from nlcontrol.service.http.service_access import Service, document_response

REPLAY_POLICY = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; img-src data: blob:; connect-src data: blob:; "
    "worker-src blob:; frame-ancestors 'none'"
)
"""Content security policy of a replay: a page of its own, with all that it needs inside."""

ROUTER = APIRouter(prefix="/v1/runs", tags=["runs"], responses=PROBLEMS)


@ROUTER.get("", operation_id="list_runs", response_model=RunPage)
def list_runs(
    service: Service,
    session: Annotated[
        str | None, Query(pattern=r"^[A-Za-z0-9_-]{1,64}$", description="Those of a session alone.")
    ] = None,
    cursor: Annotated[
        str | None, Query(max_length=100, description="The `cursor` of the page before.")
    ] = None,
    limit: Annotated[int, Query(ge=1, le=200, description="Runs on the page, at most.")] = 50,
) -> Response:
    """Lists runs, the latest first."""
    return document_response(service.runs(session, cursor, limit))


@ROUTER.get("/{run_id}", operation_id="read_run", response_model=RunInfo)
def read_run(run_id: RunId, service: Service) -> Response:
    """Tells how a run is; once it has ended, with its result."""
    return document_response(service.run(run_id))


@ROUTER.get(
    "/{run_id}/events",
    operation_id="run_events",
    response_model=EventList,
    responses={
        200: {"content": STREAM_CONTENT},
        204: {"description": "It has ended, and no event follows: do not connect again."},
    },
)
async def events(
    run_id: RunId,
    request: Request,
    service: Service,
    after: AfterNumber = 0,
    last_event_id: Annotated[
        str | None,
        Header(pattern=r"^\d{1,15}$", description="Number of the last event that has arrived."),
    ] = None,
) -> Response:
    """Streams the events of a run as server-sent events; as a list if JSON alone is accepted."""
    known = max(after, int(last_event_id or 0))
    return await stream_events(request, service, run_id, known)


@ROUTER.get(
    "/{run_id}/trace",
    operation_id="run_trace",
    response_class=Response,
    responses={200: {"content": {"application/octet-stream": {}}}},
)
def trace(run_id: RunId, service: Service) -> Response:
    """Sends what happened over time, as a file of NumPy (.npz)."""
    return FileResponse(
        service.trace_file(run_id),
        media_type="application/octet-stream",
        filename=f"{run_id}.npz",
    )


@ROUTER.get(
    "/{run_id}/bundle",
    operation_id="run_bundle",
    response_class=Response,
    responses={200: {"content": {"application/zip": {}}}},
)
def bundle(run_id: RunId, service: Service) -> Response:
    """Sends all that it takes to reproduce the run, as a ZIP file."""
    return FileResponse(
        service.bundle(run_id), media_type="application/zip", filename=f"{run_id}.zip"
    )


@ROUTER.get(
    "/{run_id}/replay",
    operation_id="run_replay",
    response_class=Response,
    responses={200: {"content": {"text/html": {}}}},
)
def replay(run_id: RunId, service: Service) -> Response:
    """Sends a page that shows the run; its scripts can reach neither this service nor others."""
    return FileResponse(
        service.replay_file(run_id),
        media_type="text/html",
        headers={"Content-Security-Policy": REPLAY_POLICY},
    )


@ROUTER.get(
    "/{run_id}/recording",
    operation_id="run_recording",
    response_class=Response,
    responses={200: {"content": {"application/json": {"schema": {"type": "object"}}}}},
)
def recording(run_id: RunId, request: Request, service: Service) -> Response:
    """Sends what a replay shows, for the viewer of the page at `/`; its form may change."""
    packed = service.recording_file(run_id).read_bytes()
    if "gzip" not in request.headers.get("accept-encoding", ""):
        return Response(gzip.decompress(packed), media_type="application/json")
    headers = {"Content-Encoding": "gzip", "Vary": "Accept-Encoding"}
    return Response(packed, media_type="application/json", headers=headers)


@ROUTER.post("/{run_id}/stop", operation_id="stop_run", response_model=RunInfo)
def stop(run_id: RunId, service: Service) -> Response:
    """Asks a run to let go and come to rest; its result is then `cancelled`."""
    service.stop_run(run_id)
    return document_response(service.run(run_id))


@ROUTER.post("/{run_id}/abort", operation_id="abort_run", response_model=RunInfo)
def abort(run_id: RunId, service: Service) -> Response:
    """Ends the process of a run; its session is then lost."""
    service.abort_run(run_id)
    return document_response(service.run(run_id))


@ROUTER.delete("/{run_id}", operation_id="delete_run", status_code=204)
def delete_run(run_id: RunId, service: Service) -> Response:
    """Forgets a run that has ended, its events and its files."""
    service.delete_run(run_id)
    return Response(status_code=204)
