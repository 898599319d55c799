"""Approvals over HTTP: a plan runs under the text that was planned, or not at all."""

from __future__ import annotations

import httpx

from tests.fakes.counted_executor import motions_in
from tests.patience import wait_until
from tests.service_process import ServerProcess

SAID = "push the ice tea box 2 cm away"


def test_an_approval_of_another_text_is_refused_and_its_suggestion_works(
    robot_http: httpx.Client, session: str, robot_server: ServerProcess
) -> None:
    assert robot_server.folder is not None
    plan_id = robot_http.post(f"{session}/plans", json={"text": SAID}).json()["plan_id"]
    before = motions_in(robot_server.folder)
    body = {"plan_id": plan_id, "text": "topple the ice tea box"}
    refused = robot_http.post(f"{session}/runs", json=body)
    assert refused.status_code == 409, refused.text
    assert refused.headers["content-type"] == "application/problem+json"
    problem = refused.json()
    assert problem["code"] == "other_sentence"
    assert f"“{SAID}”" in problem["suggestions"][-1]
    assert motions_in(robot_server.folder) == before
    begun = robot_http.post(f"{session}/runs", json={**body, "text": SAID})
    assert begun.status_code == 202, begun.text
    path = f"/v1/runs/{begun.json()['run_id']}"
    wait_until(lambda: robot_http.get(path).json()["ended_at"] is not None)
    assert motions_in(robot_server.folder) > before


def test_the_text_is_optional_and_nothing_but_a_text(
    robot_http: httpx.Client, session: str
) -> None:
    others: tuple[object, ...] = (1, ["push"], {})
    for text in others:
        body = {"plan_id": "plan-0", "text": text}
        assert robot_http.post(f"{session}/runs", json=body).status_code == 422
    plan_id = robot_http.post(f"{session}/plans", json={"text": SAID}).json()["plan_id"]
    begun = robot_http.post(f"{session}/runs", json={"plan_id": plan_id})
    assert begun.status_code == 202, begun.text
