"""`nlcontrol serve` as a command: what it refuses to begin, and how it ends."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import tomllib
from pathlib import Path

import httpx
import pytest

from nlcontrol.service.http.web_server import listening_socket, url_of
from tests.patience import PATIENCE, wait_until
from tests.service_process import ROOT, serving
from tests.unit.nlcontrol.service.processes import descendants, parent


def refused(*options: str, path: str = "") -> tuple[int, str]:
    """Exit code and standard error of a server that does not begin."""
    found = subprocess.run(
        [sys.executable, "-m", "nlcontrol", "serve", "--port", "0", *options],
        env=os.environ | {"PYTHONPATH": f"{path}:{ROOT}", "NLCONTROL_TOKEN": ""},
        capture_output=True, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    return found.returncode, found.stderr


def test_without_the_extra_it_says_how_to_install_it(tmp_path: Path) -> None:
    (tmp_path / "uvicorn.py").write_text("raise ModuleNotFoundError('no', name='uvicorn')")
    status, said = refused(path=str(tmp_path))
    assert status == 2
    assert "pip install '.[serve]'" in said
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert any(need.startswith("fastapi") for need in project["optional-dependencies"]["serve"])


def test_other_machines_need_a_token(tmp_path: Path) -> None:
    status, said = refused("--host", "0.0.0.0")
    assert (status, "--token-file" in said) == (2, True)
    short = tmp_path / "token"
    short.write_text("short\n")
    assert refused("--host", "0.0.0.0", "--token-file", str(short))[0] == 2


def test_a_port_that_is_taken_is_told() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        status, said = refused("--port", str(taken.getsockname()[1]))
    assert (status, "--port" in said) == (2, True)


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_ends_it_with_all_its_processes(number: signal.Signals, status: int) -> None:
    with serving("--planners", "1", "--workers", "1") as server:
        opened = httpx.post(f"{server.url}/v1/sessions", json={}, timeout=PATIENCE)
        live = f"{server.url}/v1/sessions/{opened.json()['session_id']}/live"
        children = descendants(server.process.pid)
        assert len(children) >= 3
        with httpx.stream("GET", live, timeout=PATIENCE) as stream:
            assert stream.status_code == 200
            server.process.send_signal(number)
            for _ in stream.iter_raw():  # a stream that is cut off raises
                pass
        assert server.process.wait(PATIENCE) == status
        # The tracker of Python's own resources ends a moment after its parent.
        wait_until(lambda: all(parent(pid) is None for pid in children))


@pytest.mark.parametrize(
    ("address", "names", "host"),
    [
        ("127.0.0.1", ("robot.example",), "127.0.0.1"),
        ("0.0.0.0", ("robot.example", "other"), "robot.example"),
        ("0.0.0.0", (), "0.0.0.0"),
    ],
)
def test_a_link_names_the_machine_where_the_address_does_not(
    address: str, names: tuple[str, ...], host: str
) -> None:
    with listening_socket(address, 0) as listening:
        port = listening.getsockname()[1]
        assert url_of(listening, names) == f"http://{host}:{port}"
