"""A real server process that is attacked, whose robot is one that counts its motions."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx

from tests.fakes.counted_executor import (
    FOLDER_VARIABLE,
    Poses,
    first_poses,
    motions_in,
    write_poses,
)
from tests.patience import PATIENCE
from tests.service_process import serving

EXECUTOR = "tests.fakes.counted_executor:CountedExecutor"
TOKEN = "an-unguessable-token-of-a-test"


class AttackedServer:
    """A server where each motion needs an approved plan and each request a token.

    Args:
        url: of it.
        folder: of its table.
        http: a connection that bears the token.
    """

    def __init__(self, url: str, folder: Path, http: httpx.Client) -> None:
        self.url, self.folder, self.http = url, folder, http
        self.port = int(url.rpartition(":")[2])
        self.first_poses = first_poses()

    def openapi(self) -> dict[str, Any]:
        """The document that says what it answers."""
        document: dict[str, Any] = self.http.get("/v1/openapi.json").raise_for_status().json()
        return document

    def put_back(self) -> None:
        """Puts everything where it stood at the beginning, by hand."""
        write_poses(self.folder, self.first_poses)

    def move(self, name: str, by: float) -> None:
        """Moves an object away from the robot, by hand [m]."""
        x, y, yaw = self.first_poses[name]
        moved: Poses = {**self.first_poses, name: (x + by, y, yaw)}
        write_poses(self.folder, moved)

    def motions(self) -> int:
        """Motions so far."""
        return motions_in(self.folder)

    def raw_answer(self, content: bytes, *, read: bool = True) -> bytes:
        """The answer to bytes that need not be HTTP; b"" if there is none or nobody reads it."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE) as line:
            try:
                line.sendall(content)
                if not read:
                    return b""
                line.shutdown(socket.SHUT_WR)
                parts = []
                while part := line.recv(65536):
                    parts.append(part)
                return b"".join(parts)
            except OSError:
                return b""


@contextmanager
def attacked_server(folder: Path) -> Iterator[AttackedServer]:
    """Context with such a server.

    Args:
        folder: for its table.
    """
    write_poses(folder, first_poses())
    environment = {FOLDER_VARIABLE: str(folder), "NLCONTROL_TOKEN": TOKEN}
    options = ("--executor", EXECUTOR, "--approve")
    with (
        serving(*options, environment=environment) as process,
        httpx.Client(
            base_url=process.url,
            headers={"Authorization": f"Bearer {TOKEN}"},
            timeout=PATIENCE,
            trust_env=False,
            limits=httpx.Limits(keepalive_expiry=2.0),
        ) as http,
    ):
        yield AttackedServer(process.url, folder, http)
