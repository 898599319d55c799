"""Sessions that are opened, used and closed in every way, where a process may open few files.

What is counted is counted at rest: once as many processes are there as at the first count.
"""

from __future__ import annotations

import os
import random
import resource
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

import httpx

from tests.patience import PATIENCE
from tests.service_process import serving
from tests.unit.nlcontrol.service.processes import descendants

DESCRIPTORS = 256
"""That a process of the service may have open."""

FIRST, EVERY = 20, 40
"""Sessions before the first count, and between two."""

REST = 60.0
"""Time in which what is over has gone, on a machine that is busy [s]."""

MOST_AT_ONCE, PLACES = 3, 6
"""Sessions that are opened side by side, and that may be open; those of callers who have gone come
on top for a moment."""

USES: tuple[tuple[str, str, Any], ...] = (
    ("POST", "look", None),
    ("POST", "plans", {"text": "push the ice tea box 3 cm away"}),
    ("POST", "parse", {"text": "lift the mug"}),
    ("POST", "predict", {"object": "ice tea box", "height": 0.05}),
    ("GET", "geometry", None),
    ("POST", "say", {"text": "where is the mug?"}),
    ("POST", "say", {"text": "push the mug 3 cm to the left"}),
)
"""What is asked of a session; the last one moves something, and goes on as it is closed."""

ENDS = ("", "", "?idle=0.1", "stream", "caller")
"""How a session ends: closed, left, closed under an open stream, its opener gone meanwhile."""


class Count(NamedTuple):
    """What the service holds.

    Attributes:
        descriptors: of the server.
        of_all: of all its processes.
        processes: below it.
        folders: files and folders in the place of temporary ones.
    """

    descriptors: int
    of_all: int
    processes: int
    folders: int

    def exceeds(self, other: Count) -> bool:
        """Any number is larger."""
        return any(mine > its for mine, its in zip(self, other, strict=True))


@contextmanager
def few_descriptors(most: int) -> Iterator[None]:
    """Context in which processes are started that may have so many files open (`ulimit -n`)."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


class SessionUser:
    """Somebody who opens sessions, uses them and lets them end.

    Args:
        url: of the service.
        seed: of what is done.

    Attributes:
        failures: what did not go, in words.
        done: how often each thing was done.
    """

    def __init__(self, url: str, seed: int) -> None:
        self._rng = random.Random(seed)
        self.http = httpx.Client(base_url=f"{url}/v1", timeout=PATIENCE)
        self.failures: list[str] = []
        self.done: Counter[str] = Counter()

    def open_and_close(self, count: int) -> None:
        """Opens so many sessions side by side, uses them and lets them end."""
        self.wait_for_room(count)
        sessions = [each for _ in range(count) if (each := self._open())]
        for session in sessions:
            method, path, body = self._rng.choice(USES)
            more = {} if body is None else {"json": body}
            self._ask(method, f"/sessions/{session}/{path}", **more)
        for session in sessions:
            self._end(session, self._rng.choice(ENDS))

    def wait_for_room(self, count: int = PLACES) -> None:
        """Waits until so many sessions can be opened; those that were closed come to rest first."""
        ends = time.monotonic() + PATIENCE
        while len(self.http.get("/sessions").json()["sessions"]) + count > PLACES:
            assert time.monotonic() < ends, "sessions that are closed do not end"
            time.sleep(0.05)

    def _open(self) -> str | None:
        spec = {"scene": self._rng.choice(("kitchen", "workbench")), "seed": self._rng.randrange(9)}
        opened = self._ask("POST", "/sessions", json=spec)
        return None if opened is None else str(opened["session_id"])

    def _end(self, session: str, way: str) -> None:
        self.done[f"ended: {way or 'closed'}"] += 1
        place = f"/sessions/{session}"
        if way == "stream":
            with self.http.stream("GET", f"{place}/live"):
                self._ask("DELETE", place)
        elif way == "caller":
            with suppress(httpx.TimeoutException):
                self.http.post("/sessions", json={}, timeout=0.001)
            self._ask("DELETE", place)
        else:
            self._ask("DELETE", f"{place}{way}")

    def _ask(self, method: str, path: str, **request: Any) -> Any:
        answer = self.http.request(method, path, **request)
        if method != "DELETE":
            self.done[path.rpartition("/")[2]] += 1
        if not answer.is_success:
            self.failures.append(f"{method} {path}: {answer.status_code} {answer.text[:200]}")
            return None
        return answer.json() if answer.content else {}


def count_of(pid: int, folder: Path) -> Count:
    """What a service holds now."""
    below = descendants(pid)
    mine, *others = (_descriptors(each) for each in (pid, *below))
    return Count(mine, mine + sum(others), len(below), sum(1 for _ in folder.rglob("*")))


def _descriptors(pid: int) -> int:
    try:
        return len(os.listdir(f"/proc/{pid}/fd"))
    except OSError:
        return 0


def resting_count(pid: int, folder: Path, first: Count | None) -> Count:
    """What a service holds at rest, which may take it a while to come to."""
    ends = time.monotonic() + (5.0 if first is None else REST)
    found = count_of(pid, folder)
    while time.monotonic() < ends and (first is None or found.exceeds(first)):
        time.sleep(0.2)
        found = count_of(pid, folder)
    return found


def prove_sessions_flat(sessions: int, seed: int) -> bool:
    """Opens and closes sessions and prints what came of it; False if anything grew or failed."""
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with (
            few_descriptors(DESCRIPTORS),
            serving(
                "--sessions", str(PLACES + MOST_AT_ONCE), environment={"TMPDIR": name}
            ) as server,
        ):
            user = SessionUser(server.url, seed)
            opened, due, counts = 0, FIRST, list[Count]()
            while opened < sessions:
                together = rng.randint(1, min(MOST_AT_ONCE, sessions - opened))
                user.open_and_close(together)
                opened += together
                if opened >= due or opened == sessions:
                    user.wait_for_room()
                    first = counts[0] if counts else None
                    counts.append(resting_count(server.process.pid, folder, first))
                    print(f"{opened}: {counts[-1]}", flush=True)
                    due += EVERY
    grown = [count for count in counts if count.exceeds(counts[0])]
    most = Count(*map(max, zip(*counts, strict=True)))
    print(f"what was done: {dict(user.done)}")
    for failure in user.failures[:10]:
        print(f"failed: {failure}")
    print(
        f"{opened} sessions under ulimit -n {DESCRIPTORS}, seed {seed}: {len(user.failures)} "
        f"failed; at rest at most {most.descriptors} descriptors of the server "
        f"({counts[0].descriptors} at first), {most.of_all} of all its processes "
        f"({counts[0].of_all}), {most.processes} processes ({counts[0].processes}), "
        f"{most.folders} temporary files and folders ({counts[0].folders})"
    )
    return not grown and not user.failures
