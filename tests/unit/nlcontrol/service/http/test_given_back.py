"""Sessions that are given back: they end once nobody uses them, and stay if somebody does again."""

from __future__ import annotations

import time

import httpx

from tests.patience import wait_until

IDLE = 1.0


def test_a_session_that_is_given_back_ends(robot_http: httpx.Client, session: str) -> None:
    for wrong in ("0", "-1", "61", "nan"):
        refused = robot_http.delete(session, params={"idle": wrong})
        assert refused.status_code == 422, wrong
    assert robot_http.delete(session, params={"idle": IDLE}).status_code == 204
    wait_until(lambda: robot_http.get(session).status_code == 404)
    assert robot_http.delete(session, params={"idle": IDLE}).status_code == 404


def test_a_session_that_is_listened_to_again_stays(robot_http: httpx.Client, session: str) -> None:
    assert robot_http.delete(session, params={"idle": IDLE}).status_code == 204
    with robot_http.stream("GET", f"{session}/live"):
        time.sleep(3 * IDLE)
        assert robot_http.get(session).status_code == 200


def test_a_session_that_is_left_in_the_middle_of_a_run_ends_after_it(
    robot_http: httpx.Client, session: str
) -> None:
    text = "push the ice tea box 3 cm away"
    plan = robot_http.post(f"{session}/plans", json={"text": text}).json()["plan_id"]
    begun = robot_http.post(f"{session}/runs", json={"plan_id": plan, "text": text})
    assert begun.status_code == 202
    assert robot_http.delete(session, params={"idle": 0.01}).status_code == 204
    wait_until(lambda: robot_http.get(session).status_code == 404)
    run = robot_http.get(f"/v1/runs/{begun.json()['run_id']}").json()
    assert run["state"] == "ended"
    assert run["result"]["ok"]


def test_a_request_that_comes_in_late_keeps_nothing_open(
    robot_http: httpx.Client, session: str
) -> None:
    assert robot_http.delete(session, params={"idle": IDLE}).status_code == 204
    assert robot_http.post(f"{session}/look").status_code == 200
    wait_until(lambda: robot_http.get(session).status_code == 404)
