"""Routes of runs: how they are, what happens in them, what they leave behind."""

from __future__ import annotations

import gzip
from typing import Annotated

from fastapi import APIRouter, Header, Query, Request
from starlette.responses import Response

from nlcontrol.errors import error
from nlcontrol.service.documents import RunInfo, RunPage
from nlcontrol.service.http.event_streams import STREAM_CONTENT, EventList, stream_events
from nlcontrol.service.http.openapi_document import PROBLEMS
from nlcontrol.service.http.responses import (
    AfterNumber,
    RunId,
    Service,
    document_response,
    waited,
)
from nlcontrol.service.planning_service import FileOfRun, PlanningService

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
async def trace(run_id: RunId, service: Service) -> Response:
    """Sends what happened over time, as a file of NumPy (.npz)."""
    content = await _content(service, run_id, "trace")
    headers = {"Content-Disposition": f'attachment; filename="{run_id}.npz"'}
    return Response(content, media_type="application/octet-stream", headers=headers)


@ROUTER.get(
    "/{run_id}/bundle",
    operation_id="run_bundle",
    response_class=Response,
    responses={200: {"content": {"application/zip": {}}}},
)
async def bundle(run_id: RunId, service: Service) -> Response:
    """Sends all that it takes to reproduce the run, as a ZIP file."""
    content = await _content(service, run_id, "bundle")
    headers = {"Content-Disposition": f'attachment; filename="{run_id}.zip"'}
    return Response(content, media_type="application/zip", headers=headers)


@ROUTER.get(
    "/{run_id}/replay",
    operation_id="run_replay",
    response_class=Response,
    responses={200: {"content": {"text/html": {}}}},
)
async def replay(run_id: RunId, service: Service) -> Response:
    """Sends a page that shows the run; its scripts can reach neither this service nor others."""
    content = await _content(service, run_id, "replay")
    headers = {"Content-Security-Policy": REPLAY_POLICY}
    return Response(content, media_type="text/html", headers=headers)


@ROUTER.get(
    "/{run_id}/recording",
    operation_id="run_recording",
    response_class=Response,
    responses={200: {"content": {"application/json": {"schema": {"type": "object"}}}}},
)
async def recording(run_id: RunId, request: Request, service: Service) -> Response:
    """Sends what a replay shows, for the viewer of the page at `/`; its form may change."""
    packed = await _content(service, run_id, "recording")
    if "gzip" not in request.headers.get("accept-encoding", ""):
        return Response(gzip.decompress(packed), media_type="application/json")
    headers = {"Content-Encoding": "gzip", "Vary": "Accept-Encoding"}
    return Response(packed, media_type="application/json", headers=headers)


@ROUTER.post("/{run_id}/stop", operation_id="stop_run", response_model=RunInfo)
async def stop(run_id: RunId, service: Service) -> Response:
    """Asks a run to let go and come to rest; its result is then `cancelled`."""
    service.stop_run(run_id)
    return await _as_it_is(run_id, service)


@ROUTER.post("/{run_id}/abort", operation_id="abort_run", response_model=RunInfo)
async def abort(run_id: RunId, service: Service) -> Response:
    """Ends the process of a run; its session is then lost."""
    service.abort_run(run_id)
    return await _as_it_is(run_id, service)


@ROUTER.delete("/{run_id}", operation_id="delete_run", status_code=204)
def delete_run(run_id: RunId, service: Service) -> Response:
    """Forgets a run that has ended, its events and its files."""
    service.delete_run(run_id)
    return Response(status_code=204)


async def _as_it_is(run_id: str, service: PlanningService) -> Response:
    """A run as it is now; of one that is under way nothing is waited for."""
    info = service.live_run(run_id)
    if info is None:
        info = await waited(service, service.run, run_id)
    return document_response(info)


async def _content(service: PlanningService, run_id: str, kind: FileOfRun) -> bytes:
    """A file of a run, read whole before the answer begins: the run may be deleted meanwhile.

    Raises:
        ControlError: `no_file` also where it goes between the question and the answer.
    """
    try:
        return await waited(service, lambda: service.run_file(run_id, kind).read_bytes())
    except OSError as raised:
        raise error(
            "no_file",
            f"the file of the run {run_id} cannot be read: {raised.strerror}",
            suggestions=("ask again", "read the run itself, and its events"),
        ) from raised
