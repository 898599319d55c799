"""Servers that tests share: one of a simulated kitchen, one of a robot that counts its motions."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest

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
    with httpx.Client(base_url=server.url, timeout=30.0) as client:
        yield client


@pytest.fixture
def robot_http(robot_server: ServerProcess) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=robot_server.url, timeout=30.0) as client:
        yield client
