"""A caller of the service who keeps account of what he may have moved."""

from __future__ import annotations

import random
import time
import uuid
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote

import httpx

from benchmarks.service_attacks.attack_tally import Tally
from benchmarks.service_attacks.attacked_server import AttackedServer
from tests.patience import PATIENCE

SENTENCES = (
    "push the ice tea box 5 cm away",
    "push the mug 3 cm to the left",
    "push the ice tea box 4 cm to the right",
    "push the cereal box 3 cm away",
)


class Attacker:
    """A caller with one session in which only approved plans may be carried out.

    Args:
        server: that is attacked.
        tally: of the answers.
        seed: of the attacks.

    Attributes:
        session: id of the session that is open.
        old_plans: ids of plans of sessions that were closed.
        permits: ids of the plans that were approved in time, each for one run.
    """

    def __init__(self, server: AttackedServer, tally: Tally, seed: int) -> None:
        self.server, self.tally = server, tally
        self.rng = random.Random(seed)
        self.session = ""
        self.old_plans: list[str] = []
        self.permits: set[str] = set()
        self._runs: set[str] = set()
        self._due = 0  # motions that the permits of this sequence allow
        self._before = server.motions()
        self._spare: str | None = None

    # --- calls ---------------------------------------------------------------------------------

    def send(
        self,
        attack: str,
        method: str,
        template: str | None,
        *,
        names: Mapping[str, str] | None = None,
        path: str | None = None,
        expected: tuple[str, ...] = (),
        **request: Any,
    ) -> tuple[str, httpx.Response | None]:
        """The code and the answer of a request; the code is `closed` where no answer came.

        Args:
            attack: what it is counted as.
            method: of HTTP.
            template: path of the OpenAPI document, in which names are put; None if it has none.
            names: to be put there; the open session's if not given.
            path: instead of that.
            expected: see `Tally.judge`; `closed` where the line may be closed as well.
            request: body and headers.
        """
        filled = {"session_id": self.session, **(names or {})}
        if path is None:
            path = template or "/"
            for name, value in filled.items():
                path = path.replace(f"{{{name}}}", quote(value, safe=""))
        try:
            response = self.server.http.request(method, path, **request)
        except (httpx.InvalidURL, httpx.LocalProtocolError):
            return "ok", None  # such a request cannot even be written
        except httpx.TransportError as raised:
            self.tally.note(attack, "closed")
            if "closed" not in expected:
                self.tally.blame("no answer", attack, f"{method} {path[:120]}: {raised!r}")
            return "closed", None
        return self.tally.judge(attack, response, template, expected), response

    def call(self, method: str, path: str, **request: Any) -> dict[str, Any]:
        """The answer to a request that is no attack; {} if it has none."""
        response = self.server.http.request(method, path, **request)
        if not response.is_success:
            raise RuntimeError(f"{method} {path}: {response.status_code} {response.text}")
        document: dict[str, Any] = response.json() if response.content else {}
        return document

    # --- what is in order ----------------------------------------------------------------------

    def open_session(self) -> None:
        """Opens a session, after closing the last one."""
        self.drop_spare_plan()
        if self.session:
            self.old_plans = [self.fresh_plan()]
            self.call("DELETE", f"/v1/sessions/{self.session}")
        self.session = self.call("POST", "/v1/sessions", json={"approval": "plan"})["session_id"]

    def fresh_plan(self) -> str:
        """Id of a plan of the open session, from where everything stood at the beginning."""
        self.server.put_back()
        text = self.rng.choice(SENTENCES)
        offer = self.call("POST", f"/v1/sessions/{self.session}/plans", json={"text": text})
        plan_id = offer["plan_id"]
        if plan_id is None:
            raise RuntimeError(f"'{text}' is not planned: {offer['result']['error']}")
        return str(plan_id)

    def spare_plan(self) -> str:
        """Id of a plan of the open session, made for an attack before and not used up by it."""
        self._spare = self._spare or self.fresh_plan()
        return self._spare

    def execute(self, plan_id: str, key: str | None = None) -> str:
        """Id of the run that carries out a fresh plan, once it has ended."""
        self.allow(plan_id)
        headers = {"Idempotency-Key": key or uuid.uuid4().hex}
        run = self.call(
            "POST",
            f"/v1/sessions/{self.session}/runs",
            json={"plan_id": plan_id},
            headers=headers,
        )
        self.wait()
        return str(run["run_id"])

    def allow(self, plan_id: str, motions: int = 1) -> None:
        """Notes that a plan was approved, and moves something."""
        self.drop_spare_plan()
        self.permits.add(plan_id)
        self._due += motions

    def drop_spare_plan(self) -> None:
        """Notes that the spare plan is used up, or holds no more."""
        self._spare = None

    def wait(self) -> None:
        """Waits until nothing is carried out in the session."""
        deadline = time.monotonic() + PATIENCE
        while self.call("GET", f"/v1/sessions/{self.session}")["state"] == "running":
            if time.monotonic() > deadline:
                raise RuntimeError("a run does not end")
            time.sleep(0.005)

    # --- the account ---------------------------------------------------------------------------

    def settle(self, sequence: str) -> None:
        """Compares what has moved, and what was carried out, with what was allowed.

        Args:
            sequence: what was done, in words.
        """
        self.wait()
        motions = self.server.motions()
        moved, self._before = motions - self._before, motions
        if moved > self._due:
            self.tally.blame("motion", sequence, f"{moved} motions, {self._due} allowed")
        page = self.call("GET", "/v1/runs", params={"session": self.session, "limit": 10})
        for run in page["runs"]:
            if run["run_id"] in self._runs:
                continue
            self._runs.add(run["run_id"])
            if run["kind"] != "execute" or run["plan_id"] not in self.permits:
                self.tally.blame("motion", sequence, f"run {run['run_id']} of {run['plan_id']}")
            self.permits.discard(run["plan_id"])
        self._due = 0
        if moved:
            self.server.put_back()
