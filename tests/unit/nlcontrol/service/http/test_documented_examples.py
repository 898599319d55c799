"""Examples of the OpenAPI document, each sent to a real service; and the judge of its answers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import httpx
import pytest

from nlcontrol.service.http.service_app import routes_app
from tests.documented_answers import PROBLEM, Answer, AnswerJudge
from tests.patience import PATIENCE, wait_until
from tests.service_process import serving_counted_robot

JSON = "application/json"
HEALTH = b'{"schema_version": "3.0", "version": "1", "sessions": 0, "planners": 0, "running": 0'


@pytest.fixture(scope="module")
def judge() -> AnswerJudge:
    return AnswerJudge()


def examples() -> dict[str, tuple[str, str, dict[str, Any], set[str]]]:
    """Method, path, example and documented statuses of each operation with a body, by its id."""
    return {
        operation["operationId"]: (
            method,
            path,
            operation["requestBody"]["content"][JSON]["example"],
            {status for status in operation["responses"] if status.startswith("2")},
        )
        for path, operations in routes_app().openapi()["paths"].items()
        for method, operation in operations.items()
        if "requestBody" in operation
    }


def wait_until_ended(http: httpx.Client, run_id: str) -> None:
    wait_until(lambda: http.get(f"/v1/runs/{run_id}").json()["result"] is not None, "its end")


def test_every_example_is_taken_by_a_real_service(tmp_path: Path) -> None:
    secret = examples()["login"][2]["secret"]
    with (
        serving_counted_robot(tmp_path, environment={"NLCONTROL_TOKEN": secret}) as server,
        httpx.Client(
            base_url=server.url, timeout=PATIENCE, headers={"Authorization": f"Bearer {secret}"}
        ) as http,
    ):
        ids: dict[str, str] = {}
        for name, (method, path, example, documented) in examples().items():
            sent = {**example, **{key: ids[key] for key in example.keys() & ids.keys()}}
            answer = http.request(method, path.format(**ids), json=sent)
            assert str(answer.status_code) in documented, (name, answer.text)
            found = answer.json() if answer.content else {}
            ids |= {key: found[key] for key in ("session_id", "plan_id") if found.get(key)}
            if answer.status_code == 202:
                wait_until_ended(http, found["run_id"])
        assert ids.keys() == {"session_id", "plan_id"}


@pytest.mark.parametrize(
    ("answer", "fault"),
    [
        (Answer("GET", "/v1/health", 200, JSON, HEALTH + b', "queued": 0}'), None),
        (Answer("HEAD", "/v1/health", 200, JSON, None), None),
        (Answer("GET", "/v1/health", 200, JSON, HEALTH + b"}"), "queued"),
        (Answer("GET", "/v1/health", 200, JSON, HEALTH), "schema"),
        (Answer("GET", "/v1/health", 200, "text/plain", b"well"), "media type"),
        (Answer("GET", "/v1/health", 202, JSON, HEALTH + b', "queued": 0}'), "status"),
        (Answer("GET", "/v1/health", 404, PROBLEM, b'{"title": "no"}'), "schema"),
        (Answer("DELETE", "/v1/sessions/a", 204, "", b"more"), "body"),
        (Answer("PUT", "/v1/sessions/a", 200, JSON, b"{}"), "operation"),
        (Answer("GET", "/v1/nothing", 404, "text/plain", b"no"), "media type"),
        (Answer("GET", "/docs", 200, "text/html", b"<html>"), None),
    ],
    ids=lambda value: str(value)[:60],
)
def test_what_the_document_does_not_have_is_told(
    judge: AnswerJudge, answer: Answer, fault: str | None
) -> None:
    found = judge.fault(answer)
    assert found is None if fault is None else fault in (found or "")
