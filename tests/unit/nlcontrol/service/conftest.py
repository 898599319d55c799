"""Servers that tests share: one of a simulated kitchen, one of a robot that counts its motions."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest

from tests.patience import PATIENCE, wait_until
from tests.service_process import ServerProcess, serving, serving_counted_robot


@pytest.fixture(scope="session")
def server() -> Iterator[ServerProcess]:
    with serving("--workers", "1", "--planners", "1", "--sessions", "4") as started:
        yield started


@pytest.fixture(scope="session")
def robot_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServerProcess]:
    folder = tmp_path_factory.mktemp("table")
    with serving_counted_robot(folder, "--planners", "1", "--approve") as started:
        yield started


@pytest.fixture
def http(server: ServerProcess) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=server.url, timeout=PATIENCE) as client:
        yield client


@pytest.fixture
def robot_http(robot_server: ServerProcess) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=robot_server.url, timeout=PATIENCE) as client:
        yield client


@pytest.fixture
def session(robot_http: httpx.Client) -> Iterator[str]:
    """Path of a session of the robot; there can be one at a time."""
    _close_sessions(robot_http)  # what a test that failed has left must not fail the others
    opened = robot_http.post("/v1/sessions", json={"approval": "none"})
    assert opened.status_code == 201, opened.text
    yield f"/v1/sessions/{opened.json()['session_id']}"
    _close_sessions(robot_http)


def _close_sessions(http: httpx.Client) -> None:
    def opened() -> list[str]:
        return [each["session_id"] for each in http.get("/v1/sessions").json()["sessions"]]

    for session_id in opened():
        http.delete(f"/v1/sessions/{session_id}")
    wait_until(lambda: not opened(), "a table without a session")
