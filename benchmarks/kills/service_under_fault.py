"""A service whose robot lingers, all that was told of its runs, and calls that are drawn."""

from __future__ import annotations

import json
import random
import sqlite3
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx

from tests.fakes.counted_executor import FOLDER_VARIABLE, first_poses, write_poses
from tests.service_process import LastingServer
from tests.unit.nlcontrol.service.processes import descendants

ROBOT = "benchmarks.kills.lingering_robot:LingeringRobot"

TIME_LIMIT = 4.0
"""That the service gives a plan or an answer [s]."""

ANSWER_TIME = 30.0
"""Longest time for any answer, all that a fault may cost among it [s]."""

REMEMBERED = 12
"""Runs that are asked after."""

UNDER_WAY = ("queued", "running")

MOVING = ("push the ice tea box 3 cm away", "push the mug 3 cm to the left")
SAID = (*MOVING, "how heavy is the mug?", "push the mug 3 m away", "colourless green ideas")

OF_RUNS = 3.0
"""How much more often what is about runs is asked than the rest."""


@dataclass(frozen=True)
class DrawnCall:
    """A request.

    Attributes:
        operation: id of it in the document.
        method, path: of HTTP.
        body: as JSON; None for none.
        headers: beside those of every request.
    """

    operation: str
    method: str
    path: str
    body: Any = None
    headers: Mapping[str, str] = field(default_factory=dict)

    def raw(self, port: int) -> bytes:
        """The bytes of it."""
        content = b"" if self.body is None else json.dumps(self.body).encode()
        headers = {"Host": f"127.0.0.1:{port}", "Content-Length": str(len(content)), **self.headers}
        if self.body is not None:
            headers["Content-Type"] = "application/json"
        head = "".join(f"{name}: {value}\r\n" for name, value in headers.items())
        return f"{self.method} {self.path} HTTP/1.1\r\n{head}\r\n".encode() + content


class ServiceUnderFault:
    """A service that is started again when it was killed, and what is known of it.

    Args:
        folder: for its store and its robot.
        rng: that draws.

    Attributes:
        server: the service.
        http: a connection to it.
        operations: method, path and description of each documented operation, by its id.
        sessions: ids of those that were opened, the last one last.
        plans: ids of those that were offered.
        told: per run, the newest last, the state that was told last.
        undocumented: answers that the document does not have.
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
        self.operations: dict[str, tuple[str, str, dict[str, Any]]] = {
            operation["operationId"]: (method.upper(), path, operation)
            for path, methods in self.get("/openapi.json")["paths"].items()
            for method, operation in methods.items()
        }
        self.sessions: list[str] = []
        self.plans: list[str] = []
        self.told: dict[str, str] = {}
        self.undocumented: list[str] = []

    def end(self) -> None:
        """Kills it; what was not documented in its answers is noted."""
        try:
            self.server.kill()
        except AssertionError as raised:
            self.undocumented.append(str(raised))

    def restart(self) -> None:
        """Kills it and starts it again."""
        self.end()
        self.server.start()

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

    def ask(self, what: str, text: str) -> str | None:
        """Asks the open session for `plans` or to `say` something; why that does not go."""
        answer = self.http.post(f"/v1/sessions/{self.sessions[-1]}/{what}", json={"text": text})
        if answer.is_success:
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
            self.end()

    # --- calls ----------------------------------------------------------------------------------

    def drawn_call(self) -> DrawnCall:
        """A call of any operation about what there is or was; those about runs are more likely."""
        rng = self.rng
        names = sorted(self.operations)
        weights = [OF_RUNS if "/runs" in self.operations[name][1] else 1.0 for name in names]
        operation = rng.choices(names, weights)[0]
        method, path, described = self.operations[operation]
        filled = {
            "{session_id}": self._latest(["session-0123456789abcdef", *self.sessions[-2:]]),
            "{run_id}": self._latest(list(self.told) or ["run-0123456789abcdef"]),
            "{name}": rng.choice(("mug", "ice tea box", "unicorn")).replace(" ", "%20"),
        }
        for name, value in filled.items():
            path = path.replace(name, value)
        body = None
        if "requestBody" in described:
            body = self._body(operation.removeprefix("session_"))
        key, values = {
            "list_runs": ("limit", (1, 10, 200)),
            "run_events": ("after", (0, 3, 1000)),
            "close_session": ("idle", (0.1, 5.0)),
        }.get(operation, ("", (0,)))
        if key and rng.random() < 0.7:
            path += f"?{key}={rng.choice(values)}"
        headers = {"Accept": "application/json"} if rng.random() < 0.5 else {}
        if operation in ("session_say", "session_execute") and rng.random() < 0.5:
            headers["Idempotency-Key"] = f"key-{rng.randrange(20)}"
        return DrawnCall(operation, method, path, body, headers)

    def _body(self, what: str) -> Any:
        """A body for an operation, with a session or without; most fit."""
        rng = self.rng
        if rng.random() < 0.05:
            return rng.choice(([], {"unknown": 1}, {"text": 3}))
        match what:
            case "login":
                return {"secret": "none"}
            case "open_session":
                return {"scene": "kitchen", "seed": rng.randrange(3)}
            case "look":
                return {}
            case "execute":
                return {"plan_id": self._latest(self.plans or ["plan-0123456789abcdef"])}
            case "parse" | "ask" | "plan" | "say":
                return {"text": rng.choice(SAID)}
            case "predict":
                return {"object": "ice tea box", "height": rng.choice((0.05, 0.1, 3.0))}
            case "map":
                return {"object": "ice tea box", "spacing": 0.05}
            case "affordances":
                return {"object": rng.choice(("mug", "unicorn"))}  # of a box they take 17 s
        raise LookupError(f"there is no body for the operation {what}: add one here")

    def _latest(self, ids: Sequence[str]) -> str:
        """One of some ids, the last one as likely as all others."""
        return ids[-1] if self.rng.random() < 0.5 else self.rng.choice(ids)
