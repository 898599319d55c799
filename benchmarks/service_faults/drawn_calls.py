"""Calls of all documented operations of the service, drawn by seed, about what there is or was."""

from __future__ import annotations

import json
import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from benchmarks.service_faults.documented_answers import DocumentedAnswers

MOVING = ("push the ice tea box 3 cm away", "push the mug 3 cm to the left")
SAID = (*MOVING, "how heavy is the mug?", "push the mug 3 m away", "colourless green ideas")

OF_RUNS = 3.0
"""How much more often what is about runs is asked than the rest."""

ENDLESS = ("session_live", "run_events")
"""Operations that may stream."""


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


class CallDrawer:
    """Draws calls.

    Args:
        answers: the document of the service.
        rng: that draws.
    """

    def __init__(self, answers: DocumentedAnswers, rng: random.Random) -> None:
        self._operations, self._rng = answers.operations, rng

    def drawn(
        self, sessions: Sequence[str], runs: Sequence[str], plans: Sequence[str]
    ) -> DrawnCall:
        """A call of any operation; those about runs are more likely.

        Args:
            sessions: ids to be asked for, the newest last; one that never was is, too.
            runs: the same of runs.
            plans: the same of plans.
        """
        rng = self._rng
        names = sorted(self._operations)
        weights = [OF_RUNS if "/runs" in self._operations[name][1] else 1.0 for name in names]
        operation = rng.choices(names, weights)[0]
        method, path, described = self._operations[operation]
        filled = {
            "{session_id}": _latest(rng, ["session-0123456789abcdef", *sessions[-2:]]),
            "{run_id}": _latest(rng, runs or ["run-0123456789abcdef"]),
            "{name}": rng.choice(("mug", "ice tea box", "unicorn")).replace(" ", "%20"),
        }
        for name, value in filled.items():
            path = path.replace(name, value)
        takes_body = "requestBody" in described
        body = self._body(operation.removeprefix("session_"), plans) if takes_body else None
        query = self._query(operation)
        headers = {"Accept": "application/json"} if rng.random() < 0.5 else {}
        if operation in ("session_say", "session_execute") and rng.random() < 0.5:
            headers["Idempotency-Key"] = f"key-{rng.randrange(20)}"
        return DrawnCall(operation, method, path + query, body, headers)

    def _query(self, operation: str) -> str:
        rng = self._rng
        key, values = {
            "list_runs": ("limit", (1, 10, 200)),
            "run_events": ("after", (0, 3, 1000)),
            "close_session": ("idle", (0.1, 5.0)),
        }.get(operation, ("", (0,)))
        return f"?{key}={rng.choice(values)}" if key and rng.random() < 0.7 else ""

    def _body(self, what: str, plans: Sequence[str]) -> Any:
        """A body for an operation, with a session or without; most fit."""
        rng = self._rng
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
                return {"plan_id": _latest(rng, plans or ["plan-0123456789abcdef"])}
            case "parse" | "ask" | "plan" | "say":
                return {"text": rng.choice(SAID)}
            case "predict":
                return {"object": "ice tea box", "height": rng.choice((0.05, 0.1, 3.0))}
            case "map":
                return {"object": "ice tea box", "spacing": 0.05}
            case "affordances":
                return {"object": rng.choice(("mug", "unicorn"))}  # of a box they take 17 s
        raise LookupError(f"there is no body for the operation {what}: add one here")


def _latest(rng: random.Random, ids: Sequence[str]) -> str:
    """One of some ids, the last one as likely as all others."""
    return ids[-1] if rng.random() < 0.5 else rng.choice(ids)
