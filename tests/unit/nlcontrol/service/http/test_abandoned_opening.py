"""A caller who gives up while a session opens leaves none behind."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterator
from typing import Any

import pytest

from nlcontrol.service.http.responses import HttpSettings
from nlcontrol.service.http.service_app import service_app
from nlcontrol.service.planning_service import PlanningService
from tests.patience import wait_until
from tests.service_process import patient_settings


@pytest.fixture(scope="module")
def service() -> Iterator[PlanningService]:
    with PlanningService(patient_settings(sessions=1, planners=1)) as service:
        yield service


def opened(service: PlanningService, *, stays: bool) -> tuple[int, str]:
    """Status and session of an opening whose caller is there at its end, or is not."""
    body = {"type": "http.request", "body": b"{}", "more_body": False}
    received, sent = [body], list[Any]()

    async def receive() -> Any:
        if received:
            return received.pop()
        if stays:
            await asyncio.Event().wait()
        return {"type": "http.disconnect"}

    async def send(message: Any) -> None:
        sent.append(message)

    scope: Any = {
        "type": "http", "asgi": {"version": "3.0"}, "http_version": "1.1", "method": "POST",
        "scheme": "http", "path": "/v1/sessions", "raw_path": b"/v1/sessions", "query_string": b"",
        "root_path": "", "client": ("127.0.0.1", 1), "server": ("127.0.0.1", 8000),
        "headers": [(b"host", b"localhost"), (b"content-type", b"application/json"),
                    (b"content-length", b"2")],
    }  # fmt: skip
    asyncio.run(service_app(service, HttpSettings())(scope, receive, send))
    return sent[0]["status"], json.loads(sent[1]["body"])["session_id"]


def test_who_has_gone_leaves_no_session(service: PlanningService) -> None:
    assert opened(service, stays=False)[0] == 201
    wait_until(lambda: not service.sessions())
    _, session_id = opened(service, stays=True)
    assert [each.session_id for each in service.sessions()] == [session_id]
