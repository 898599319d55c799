"""A real server of the planning service in a process of its own, for tests that talk to it."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import httpx

from nlcontrol.service.run_store import STORE_VARIABLE
from nlcontrol.service.service_settings import ServiceSettings
from tests.documented_server import FAULTS_VARIABLE
from tests.fakes.counted_executor import FOLDER_VARIABLE, first_poses, write_poses
from tests.patience import PATIENCE

ROOT = Path(__file__).parents[1]

MOST_SESSIONS = 3
"""Of a lasting server, if it is not told otherwise."""


def patient_settings(**given: Any) -> ServiceSettings:
    """Settings of a service that gives up nothing because the machine is busy."""
    return ServiceSettings(**{"request_time": PATIENCE, "stop_time": PATIENCE, **given})


@dataclass(frozen=True)
class ServerProcess:
    """A server that runs.

    Attributes:
        url: of it.
        process: of it.
        log: file of its standard error.
        folder: of the robot that counts its motions, if it has that.
    """

    url: str
    process: subprocess.Popen[str]
    log: Path
    folder: Path | None = None


@contextmanager
def serving(
    *options: str, environment: Mapping[str, str] | None = None, root: Path = ROOT
) -> Iterator[ServerProcess]:
    """Context with a server on a free port; its processes end with it.

    Args:
        options: of the command.
        environment: variables on top of those here.
        root: folder with the packages.

    Raises:
        AssertionError: at the end, if an answer was not as the OpenAPI document has it.
    """
    with TemporaryDirectory() as folder:
        log, undocumented = Path(folder, "log"), Path(folder, "undocumented")
        undocumented.touch()
        with log.open("w") as errors:
            process = subprocess.Popen(
                [
                    sys.executable,
                    "-m",
                    "tests.documented_server",
                    "serve",
                    "--port",
                    "0",
                    "--time-limit",
                    str(PATIENCE),
                    *options,
                ],
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
                cwd=root,
                env=os.environ
                | {
                    "PYTHONPATH": f"{root}{os.pathsep}{ROOT}",
                    STORE_VARIABLE: str(Path(folder, "store")),
                }
                | {FAULTS_VARIABLE: str(undocumented)}
                | dict(environment or {}),
            )
        try:
            assert process.stdout is not None
            line = process.stdout.readline()
            assert line.startswith("nlcontrol serves at http://"), line + log.read_text()
            yield ServerProcess(line.split()[-1], process, log)
        finally:
            process.terminate()
            try:
                process.wait(PATIENCE)
            finally:
                process.kill()
                process.communicate()
        assert not (told := undocumented.read_text("utf-8")), told


@contextmanager
def serving_counted_robot(
    folder: Path, *options: str, environment: Mapping[str, str] | None = None
) -> Iterator[ServerProcess]:
    """Context with a server of the robot that counts its motions in a folder; see its module."""
    write_poses(folder, first_poses())
    robot = "tests.fakes.counted_executor:CountedExecutor"
    with serving(
        *("--executor", robot, *options),
        environment={FOLDER_VARIABLE: str(folder), **(environment or {})},
    ) as server:
        yield replace(server, folder=folder)


class LastingServer:
    """A service that is killed and started again, at one address and with one store.

    Args:
        store: its folder.
        options: of `nlcontrol serve`.
        environment: of it, beside ours.
    """

    def __init__(
        self,
        store: Path,
        options: Sequence[str] = ("--sessions", str(MOST_SESSIONS)),
        environment: Mapping[str, str] | None = None,
    ) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.url = f"http://127.0.0.1:{self.port}"
        self.store = store
        self._options, self._environment = options, dict(environment or {})
        self._running = ExitStack()

    def start(self) -> None:
        options = ("--port", str(self.port), *self._options)
        environment = {STORE_VARIABLE: str(self.store), **self._environment}
        self._server = self._running.enter_context(serving(*options, environment=environment))

    @property
    def pid(self) -> int:
        return self._server.process.pid

    def log(self) -> str:
        return self._server.log.read_text()

    def kill(self) -> None:
        self._server.process.kill()
        self._running.close()

    def close(self) -> None:
        self._running.close()

    def get(self, path: str) -> Any:
        return httpx.get(f"{self.url}/v1/{path}", timeout=PATIENCE).json()

    def session_ids(self) -> set[str]:
        return {each["session_id"] for each in self.get("sessions")["sessions"]}
