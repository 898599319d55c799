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
