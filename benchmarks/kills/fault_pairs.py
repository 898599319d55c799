"""Pairs of a fault and a call, drawn by seed; after each the service is as if there had been none.

The call is any operation of the OpenAPI document; mostly a run is under way. Its answer has to be
as the document says, be the fault what it is. Once the fault is over, no run is told to be under
way that no session carries out; what had ended is told as ended; every run that was acknowledged is
there; the store has what is told; and a session takes the next sentence.
"""

from __future__ import annotations

import random
import sqlite3
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx

from benchmarks.kills.faults import (
    FAULTS,
    Fault,
    caller_gone,
    folder_not_writable,
    server_killed,
    slow_reader,
)
from benchmarks.kills.service_under_fault import MOVING, UNDER_WAY, DrawnCall, ServiceUnderFault

SETTLED = 25.0
"""Time in which everything has settled after a fault, on a machine that is busy [s]."""

PLANNED, BEGUN = 0.3, 0.7
"""Shares of the pairs before which something is planned, and before which a run is begun."""

LISTED = 60
"""Findings that are printed in full."""

DEFECTS = ("internal", "system_error")
"""Codes that no answer bears, be the fault what it is."""

NOT_OF_CALLERS = ("bad_store", "bad_trace", "unreadable_file", "cannot_write")
"""Codes for which no caller is to blame here."""

ENDLESS = ("session_live", "run_events")
"""Operations that may stream."""


class FaultPairs:
    """The pairs, and what was found.

    Args:
        folder: for the service.
        seed: of all that is drawn.

    Attributes:
        made: how often each fault was made.
        answered: how often each status came.
        found: what should not have been, per kind.
    """

    def __init__(self, folder: Path, seed: int) -> None:
        self.rng = random.Random(seed)
        self.service = ServiceUnderFault(folder, self.rng)
        self.made: Counter[str] = Counter()
        self.answered: Counter[str] = Counter()
        self.operations: Counter[str] = Counter()
        self.found: Counter[str] = Counter()
        self._pair = self._earlier = ""

    def try_pair(self) -> None:
        """One more."""
        service, rng = self.service, self.rng
        fault = rng.choices(list(FAULTS), list(FAULTS.values()))[0]
        self._earlier, self._pair = self._pair, f"{self.made.total()} {fault.__name__}"
        begins = rng.random() < BEGUN
        self._blame("not ready", service.ready())
        if rng.random() < PLANNED:
            self._blame("blocked", service.ask("plans", rng.choice(MOVING)))
        if begins:
            self._blame("blocked", service.ask("say", rng.choice(MOVING)))
        call = service.drawn_call()
        self._pair += f" {call.method} {call.path} {call.body or ''}"
        self.made[fault.__name__] += 1
        self.operations[call.operation] += 1
        time.sleep(rng.choice((0.0, 0.1, 0.3)))
        if call.operation == "delete_run":
            service.forget(call.path.split("/")[3])
        before = dict(service.told)
        with fault(service, call):
            self._call(call, fault)
        if fault is folder_not_writable:
            time.sleep(0.1)
        self._settle(fault, before)

    def _call(self, call: DrawnCall, fault: Fault) -> None:
        try:
            body = {} if call.body is None else {"json": call.body}
            with self.service.http.stream(
                call.method, call.path, headers=call.headers, **body
            ) as response:
                streams = "text/event-stream" in response.headers.get("content-type", "")
                if not (streams and call.operation in ENDLESS):
                    response.read()
        except httpx.TransportError as raised:
            self.answered["none"] += 1
            if fault is not server_killed:
                self._blame("no answer", repr(raised))
            return
        self.answered[str(response.status_code)] += 1
        self._look_at_list(fault)
        if not streams and response.headers.get("content-type", "").endswith("json"):
            document = response.json()
            self.service.note(document)
            code = None if response.is_success else document["code"]
            if code in DEFECTS or (response.is_client_error and code in NOT_OF_CALLERS):
                self._blame("a defect", f"{response.status_code} {response.text[:300]}")

    def _look_at_list(self, fault: Fault) -> None:
        """A fault may cost what it is in, never the list of all runs."""
        if fault is not server_killed:
            answer = self.service.http.get("/v1/runs?limit=10")
            if answer.status_code != 200:
                self._blame("the list", f"{answer.status_code} {answer.text[:300]}")

    # --- once the fault is over -----------------------------------------------------------------

    def _settle(self, fault: Fault, before: dict[str, str]) -> None:
        """Waits until nothing is under way, and compares what is told with what was."""
        if fault in (caller_gone, slow_reader):
            time.sleep(0.05)
        self._blame_if_lasting("a ghost", self._under_way)
        for run_id, state in before.items():
            if run_id not in self.service.told:
                continue
            now = self.service.get(f"/runs/{run_id}")
            if now is None:
                self._blame("a lost run", f"{run_id} was {state}")
                self.service.forget(run_id)
                continue
            if state not in UNDER_WAY and now["state"] != state:
                self._blame("a lost end", f"{run_id} was {state}, is {now['state']}")
            self.service.note(now)
        self._blame_if_lasting("an end that is not written", self._unwritten)

    def _under_way(self) -> list[Any]:
        """Runs that are told to be under way, beside what their sessions say."""
        page = self.service.get("/runs?limit=20")
        if page is None:
            return ["the list of runs cannot be read"]
        self.service.note({"runs": page["runs"][:3][::-1]})
        sessions = self.service.get("/sessions")["sessions"]
        told = {each["session_id"]: (each["state"], each["run_id"]) for each in sessions}
        return [
            (run["run_id"], run["state"], told.get(run["session_id"]))
            for run in page["runs"]
            if run["state"] in UNDER_WAY
        ] + [each for each in told.items() if each[1][0] == "running"]

    def _unwritten(self) -> list[Any]:
        with self.service.database() as other:
            return other.execute(
                "SELECT run_id, state FROM runs WHERE state IN ('queued', 'running')"
            ).fetchall()

    def _blame_if_lasting(self, kind: str, found: Callable[[], list[Any]]) -> None:
        """Waits until nothing is found any more; blames what stays."""
        ends = time.monotonic() + SETTLED
        while True:
            try:
                still = found()
                if not still:
                    return
                why = repr(still)[:400]
            except (httpx.TransportError, sqlite3.Error) as raised:
                why = repr(raised)
            if time.monotonic() > ends:
                self._blame(kind, why)
                self.service.restart()  # so that the next pair begins in order
                return
            time.sleep(0.03)

    def _blame(self, kind: str, why: str | None) -> None:
        if why is None:
            return
        self.found[kind] += 1
        if self.found.total() <= LISTED:
            print(f"FOUND {kind}: {self._pair}, after {self._earlier}: {why}", flush=True)


def prove_faults_pass(pairs: int, seed: int) -> bool:
    """Tries so many pairs and prints what came of it; False if anything was found."""
    with tempfile.TemporaryDirectory() as name:
        tried = FaultPairs(Path(name), seed)
        try:
            for number in range(pairs):
                tried.try_pair()
                if number % 100 == 99:
                    print(f"{number + 1}: {dict(tried.found) or 'nothing found'}", flush=True)
        finally:
            tried.service.close()
    for told in tried.service.undocumented:
        tried.found["undocumented"] += 1
        print(f"FOUND undocumented: {told}")
    print(f"faults: {dict(tried.made)}")
    print(f"answers: {dict(sorted(tried.answered.items()))}")
    print(
        f"{pairs} pairs of a fault and a call, seed {seed}, {len(tried.made)} faults and "
        f"{len(tried.operations)} of {len(tried.service.operations)} operations: "
        f"{dict(tried.found) or 'no ghost, no lost end, no undocumented answer'}"
    )
    return not tried.found
