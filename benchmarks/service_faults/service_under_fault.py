"""A service whose robot lingers, and all that was told of its runs, for faults to be made in it."""

from __future__ import annotations

import random
import sqlite3
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

import httpx

from tests.browser.lasting_server import LastingServer
from tests.fakes.counted_executor import FOLDER_VARIABLE, first_poses, write_poses
from tests.unit.nlcontrol.service.processes import descendants

ROBOT = "benchmarks.service_faults.lingering_robot:LingeringRobot"

TIME_LIMIT = 4.0
"""That the service gives a plan or an answer [s]."""

ANSWER_TIME = 30.0
"""Longest time for any answer, all that a fault may cost among it [s]."""

REMEMBERED = 12
"""Runs that are asked after."""

UNDER_WAY = ("queued", "running")


class ServiceUnderFault:
    """A service that is started again when it was killed, and what is known of it.

    Args:
        folder: for its store and its robot.
        rng: that draws.

    Attributes:
        server: the service.
        http: a connection to it.
        sessions: ids of those that were opened, the last one last.
        plans: ids of those that were offered.
        told: per run, the newest last, the state that was told last.
    """

    def __init__(self, folder: Path, rng: random.Random) -> None:
        self.rng, self._robot = rng, folder / "robot"
        self._robot.mkdir()
        write_poses(self._robot, first_poses())
        options = ("--executor", ROBOT, "--time-limit", str(TIME_LIMIT), "--planners", "1")
        environment = {FOLDER_VARIABLE: str(self._robot)}
        self.server = LastingServer(folder / "store", options, environment)
        self.server.start()
        self.http = httpx.Client(base_url=self.server.url, timeout=ANSWER_TIME)
        self.sessions: list[str] = []
        self.plans: list[str] = []
        self.told: dict[str, str] = {}

    def get(self, path: str) -> Any:
        """The document of a path, None if there is none such."""
        answer = self.http.get(f"/v1{path}")
        return answer.json() if answer.is_success else None

    @property
    def runs_folder(self) -> Path:
        """Of the files of all runs."""
        return self.server.store / "runs"

    @contextmanager
    def database(self) -> Iterator[sqlite3.Connection]:
        """Another connection to the database of the store."""
        path = self.server.store / "runs.sqlite"
        with closing(sqlite3.connect(path, isolation_level=None, timeout=20.0)) as connection:
            yield connection

    def workers(self) -> list[int]:
        """Processes of the service, that from which the others are forked among them."""
        return sorted(descendants(self.server.pid))

    def ready(self) -> str | None:
        """Opens a session if none is open, and puts everything back; why that does not go."""
        write_poses(self._robot, first_poses())
        ends = time.monotonic() + ANSWER_TIME
        answer = None
        while time.monotonic() < ends:
            answer = self.http.get("/v1/sessions")
            there = answer.json()["sessions"]
            lost = [each["session_id"] for each in there if each["state"] == "lost"]
            if there and not lost:
                self.sessions.append(there[0]["session_id"])
                return None
            for each in lost:
                self.http.delete(f"/v1/sessions/{each}")
            answer = self.http.post("/v1/sessions", json={})
            if answer.is_success:
                self.sessions.append(answer.json()["session_id"])
                return None
            time.sleep(0.1)
        return f"no session can be opened: {answer and answer.text[:200]}"

    def plan(self, text: str) -> str | None:
        """Plans something in the open session; why that does not go."""
        answer = self.http.post(f"/v1/sessions/{self.sessions[-1]}/plans", json={"text": text})
        if answer.is_success:
            self.note(answer.json())
            return None
        return f"{answer.status_code} {answer.text[:300]}"

    def begin(self, text: str) -> str | None:
        """Begins a run in the open session; why that does not go."""
        answer = self.http.post(f"/v1/sessions/{self.sessions[-1]}/say", json={"text": text})
        if answer.status_code == 202:
            self.note(answer.json())
            return None
        return f"{answer.status_code} {answer.text[:300]}"

    def note(self, document: Any) -> None:
        """Takes from an answer what it tells of runs and plans."""
        if not isinstance(document, dict):
            return
        for run in (document, *document.get("runs", ())):
            if "run_id" in run and "state" in run and "kind" in run:
                self.told.pop(run["run_id"], None)
                self.told[run["run_id"]] = run["state"]
        if document.get("plan_id") and "result" in document and "kind" not in document:
            self.plans.append(document["plan_id"])
        while len(self.told) > REMEMBERED:
            del self.told[next(iter(self.told))]

    def forget(self, run_id: str) -> None:
        """Knows nothing further of a run, since it may have been deleted."""
        self.told.pop(run_id, None)

    def close(self) -> None:
        """Ends it."""
        self.http.close()
        with suppress(OSError):
            self.server.close()
