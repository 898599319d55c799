"""Runs over real connections: plans that are approved, numbered events, listeners that vanish."""

from __future__ import annotations

import json
import socket
from contextlib import ExitStack
from typing import Any
from urllib.parse import urlsplit

import httpx

from nlcontrol.service.documents import RunInfo
from nlcontrol.service.http.responses import HttpSettings
from tests.patience import PATIENCE, wait_until
from tests.service_process import ServerProcess
from tests.unit.nlcontrol.service.http.test_request_guard import code

SAID = {"text": "push the ice tea box 2 cm away"}


def executed(client: httpx.Client, session: str, **headers: str) -> RunInfo:
    """A run of a plan, once it has ended."""
    offer = client.post(f"{session}/plans", json=SAID).json()
    begun = client.post(f"{session}/runs", json={"plan_id": offer["plan_id"]}, headers=headers)
    assert begun.status_code == 202, begun.text
    path = f"/v1/runs/{begun.json()['run_id']}"
    wait_until(lambda: client.get(path).json()["state"] not in ("queued", "running"))
    return RunInfo.model_validate_json(client.get(path).content)


def streamed(client: httpx.Client, run: RunInfo, **options: Any) -> list[tuple[int, Any]]:
    """Id and data of each event of a stream, until it ends."""
    answer = client.get(f"/v1/runs/{run.run_id}/events", **options)
    assert answer.headers["content-type"].startswith("text/event-stream")
    found = []
    for block in answer.text.strip().split("\n\n"):
        fields = dict(line.partition(": ")[::2] for line in block.split("\n"))
        data = json.loads(fields["data"])
        assert fields["event"] == data["event"]["kind"]
        found.append((int(fields["id"]), data))
    return found


def test_events_are_numbered_and_a_stream_goes_on_where_it_was(
    robot_http: httpx.Client, session: str
) -> None:
    run = executed(robot_http, session)
    assert run.state == "ended"
    assert run.result is not None
    every = streamed(robot_http, run)
    assert [number for number, _ in every] == list(range(1, run.events + 1))
    assert every[-1][1]["event"]["kind"] == "ended"
    assert streamed(robot_http, run, headers={"Last-Event-ID": "3"}) == every[3:]
    assert streamed(robot_http, run, params={"after": 4}) == every[4:]
    path = f"/v1/runs/{run.run_id}/events?after=2"
    listed = robot_http.get(path, headers={"Accept": "application/json"}).json()
    assert listed["events"] == [data for _, data in every[2:]]
    nothing = robot_http.get(path, headers={"Last-Event-ID": str(run.events)})
    assert (nothing.status_code, nothing.content) == (204, b"")


def test_only_a_fresh_plan_moves_anything(
    robot_http: httpx.Client, robot_server: ServerProcess, session: str
) -> None:
    assert robot_server.folder is not None
    motions = robot_server.folder / "motions"
    before = len(motions.read_text().splitlines()) if motions.exists() else 0
    assert code(robot_http.post(f"{session}/say", json=SAID)) == (409, "approval_required")
    forged = robot_http.post(f"{session}/runs", json={"plan_id": "plan-0123456789abcdef"})
    assert code(forged) == (404, "unknown_plan")
    assert robot_http.post("/v1/plan", json=SAID).json()["plan_id"] is None
    run = executed(robot_http, session)
    used = robot_http.post(f"{session}/runs", json={"plan_id": run.plan_id})
    assert code(used) == (409, "used_plan")
    made = len(motions.read_text().splitlines())
    assert made > before
    for path in ("", "/live"):
        with robot_http.stream("GET", session + path):
            pass
    for path in ("", "/events", "/trace", "/replay", "/bundle"):
        robot_http.get(f"/v1/runs/{run.run_id}{path}")
    assert len(motions.read_text().splitlines()) == made


def test_a_key_begins_a_run_once(robot_http: httpx.Client, session: str) -> None:
    offer = robot_http.post(f"{session}/plans", json=SAID).json()
    asked: dict[str, Any] = {
        "json": {"plan_id": offer["plan_id"]},
        "headers": {"Idempotency-Key": "a-1"},
    }
    first, second = (robot_http.post(f"{session}/runs", **asked) for _ in range(2))
    assert first.status_code == second.status_code == 202
    assert first.json()["run_id"] == second.json()["run_id"]
    other = robot_http.post(f"{session}/runs", json={"plan_id": "x"}, headers=asked["headers"])
    assert code(other) == (409, "key_reused")


def test_poses_say_where_they_come_from(robot_http: httpx.Client, session: str) -> None:
    robot_http.post(f"{session}/look")
    with robot_http.stream("GET", f"{session}/live") as stream:
        data = next(line for line in stream.iter_lines() if line.startswith("data: "))
    frame = json.loads(data.removeprefix("data: "))
    assert frame["source"] == "belief"
    assert "ice tea box" in frame["poses"]


def test_listeners_are_bounded_and_those_who_vanish_make_room(
    robot_http: httpx.Client, robot_server: ServerProcess, session: str
) -> None:
    address = urlsplit(robot_server.url)
    request = f"GET {session}/live HTTP/1.1\r\nHost: localhost\r\n\r\n".encode()
    with ExitStack() as lines:
        for _ in range(HttpSettings().listeners):
            place = (address.hostname or "", address.port or 0)
            line = lines.enter_context(socket.create_connection(place, timeout=PATIENCE))
            line.sendall(request)
            assert line.recv(100).startswith(b"HTTP/1.1 200")
        refused = robot_http.get(f"{session}/live")
        assert code(refused) == (429, "too_many_requests")
        assert int(refused.headers["retry-after"]) > 0
        assert robot_http.get("/v1/health").status_code == 200

    def is_heard() -> bool:
        with robot_http.stream("GET", f"{session}/live") as stream:
            return stream.status_code == 200

    wait_until(is_heard)
