"""Stops of a robot that moves, while other sessions plan for long and are stopped in a loop.

A stop is timed beside a bare endpoint of the same server, asked at the same moment by another
connection, since a clock alone would judge the machine. What the robot does after it is told in the
robot's own time: each event of a run says that time and the time since the sentence was said, so
that the moments of a caller have a place in it.
"""

from __future__ import annotations

import json
import random
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import httpx
import numpy as np

from sim import Trace
from tests.patience import PATIENCE
from tests.service_process import serving

MOST_LATER = 0.3
"""Time by which a stop may be answered later than a bare endpoint is at worst [s]."""

SOON = 0.2
"""Robot's time in which it lets go [s]."""

PLANNING = 2
"""Sessions that plan for long, in turns: one processor is left to the robot."""

PAUSE = 0.1
"""Time between two stops of one of them [s]."""

THINGS, MODELS = 54, ("mug", "jar", "ice tea box")
"""On a table for which each plan takes seconds."""

SENTENCES = ("push the ice tea box 12 cm away", "push the ice tea box 10 cm to the right")

LONGEST_WAIT = 16
"""Most events of what is felt, ten in a second of the robot's, between the first and a stop."""

STILL = 0.005
"""Speed below which a thing is let go of [m/s]."""


class Told(NamedTuple):
    """An event as it came.

    Attributes:
        arrived: on the caller's clock [s].
        said_for: since the sentence was said, on the clock of the run's process [s].
        time: of the robot [s].
        phase: that begins, if one does.
    """

    arrived: float
    said_for: float
    time: float
    phase: str | None


class TimedStop(NamedTuple):
    """A stop.

    Attributes:
        answer: time until it was answered [s].
        bare: the same of the bare endpoint, asked at the same moment [s].
        letting_go: robot's time from the answer until it had let go [s].
        since_asked: robot's time from the request until then [s].
    """

    answer: float
    bare: float
    letting_go: float
    since_asked: float


def robot_time(events: Sequence[Told], moment: float) -> float:
    """The robot's time at a moment of the caller's clock [s].

    The quickest event tells best when the sentence was said on that clock.
    """
    said_at = min(each.arrived - each.said_for for each in events)
    at = [each.said_for + said_at for each in events]
    return float(np.interp(moment, at, [each.time for each in events]))


def let_go_time(trace: Trace, events: Sequence[Told]) -> float:
    """The robot's time from which on the hand goes back and what it touched stands still [s]."""
    back = min(each.time for each in events if each.phase == "retreat")
    places = trace.poses[trace.pushed][:, 4:]
    speeds = np.linalg.norm(np.gradient(places, trace.time, axis=0), axis=1)
    moving = trace.time[(speeds > STILL) & (trace.time > back)]
    return float(np.max(np.append(moving, back)))


def _time_of(call: Callable[[], object]) -> float:
    """How long a call takes [s]."""
    began = time.perf_counter()
    call()
    return time.perf_counter() - began


class OtherSessions:
    """Sessions that plan for long, one after the other, and are stopped all the time.

    Attributes:
        plans: that were made.
        stops: of these sessions.
    """

    def __init__(self, url: str) -> None:
        self._url, self._done = f"{url}/v1", threading.Event()
        self._turn = threading.Lock()
        self.plans = self.stops = 0
        self._threads = ThreadPoolExecutor(2 * PLANNING)
        with self._client() as http:
            spec = {"objects": [_thing(i) for i in range(THINGS)]}
            opened = [http.post("/sessions", json=spec).json() for _ in range(PLANNING)]
        places = [f"/sessions/{each['session_id']}" for each in opened]
        loops = (self._plan, self._stop)
        self._futures = [self._threads.submit(loop, place) for place in places for loop in loops]

    def close(self) -> None:
        """Waits until the last plan is made; raises what went wrong."""
        self._done.set()
        for future in self._futures:
            future.result(PATIENCE)

    def _client(self) -> httpx.Client:
        return httpx.Client(base_url=self._url, timeout=PATIENCE)

    def _plan(self, place: str) -> None:
        with self._client() as http:
            while not self._done.is_set():
                text = f"put m0 next to m{THINGS - 1}"
                with self._turn:
                    http.post(f"{place}/plans", json={"text": text}).raise_for_status()
                self.plans += 1
                time.sleep(PAUSE)

    def _stop(self, place: str) -> None:
        with self._client() as http:
            while not self._done.wait(PAUSE):
                http.post(f"{place}/stop").raise_for_status()
                self.stops += 1


class StoppedRobot:
    """A session whose robot moves and is stopped.

    Args:
        url: of the service.
        seed: of when it is stopped.
        folder: for a trace.
    """

    def __init__(self, url: str, seed: int, folder: Path) -> None:
        self._rng = random.Random(seed)
        self._trace = folder / "trace.npz"
        self._http = httpx.Client(base_url=f"{url}/v1", timeout=PATIENCE)
        self._line = httpx.Client(base_url=f"{url}/v1", timeout=PATIENCE)
        self._beside = ThreadPoolExecutor(1)
        self._ask_bare()
        opened = self._http.post("/sessions", json={}).raise_for_status().json()
        self._place = f"/sessions/{opened['session_id']}"

    def _ask_bare(self) -> None:
        """Asks an endpoint that does nothing, on a connection of its own."""
        self._line.get("/health").raise_for_status()

    def timed_stop(self) -> TimedStop:
        """A stop of a run that has touched something, or is about to."""
        http, wait = self._http, self._rng.randrange(LONGEST_WAIT)
        text = self._rng.choice(SENTENCES)
        run = http.post(f"{self._place}/say", json={"text": text}).raise_for_status().json()
        place = f"/runs/{run['run_id']}"
        stop = f"{place}/stop" if self._rng.random() < 0.5 else f"{self._place}/stop"
        events, asked, answer, bare = list[Told](), 0.0, 0.0, 0.0
        with httpx.Client(base_url=http.base_url, timeout=PATIENCE) as line:  # noqa: SIM117 - one after the other
            with line.stream("GET", f"{place}/events") as stream:
                for event in _data(stream):
                    told = event["wall_time"], event["time"], event.get("phase")
                    events.append(Told(time.perf_counter(), *told))
                    wait -= event["kind"] == "force"
                    if wait < 0 and not asked:
                        asked = time.perf_counter()
                        asked_bare = self._beside.submit(_time_of, self._ask_bare)
                        answer = _time_of(lambda: http.post(stop).raise_for_status())
                        bare = asked_bare.result()
        result = http.get(place).json()["result"]
        assert result["status"] == "cancelled", f"a run that was stopped is {result['status']}"
        self._trace.write_bytes(http.get(f"{place}/trace").raise_for_status().content)
        end = let_go_time(Trace.load(self._trace), events)
        http.post(f"{self._place}/reset").raise_for_status()
        late = [max(0.0, end - robot_time(events, at)) for at in (asked + answer, asked)]
        return TimedStop(answer, bare, *late)


def prove_stops_quick(stops: int, seed: int) -> bool:
    """Stops a robot so often and prints what came of it; False if a stop was late."""
    with (
        tempfile.TemporaryDirectory() as name,
        serving("--sessions", str(PLANNING + 1), "--workers", "1") as server,
    ):
        robot = StoppedRobot(server.url, seed, Path(name))
        others = OtherSessions(server.url)
        made = list[TimedStop]()
        for number in range(stops):
            made.append(robot.timed_stop())
            if number % 10 == 9:
                print(_figures_of(made, seed, others), flush=True)
        others.close()
    print(_figures_of(made, seed, others))
    answers, bare, letting_go, _ = np.array(made).T
    in_time = answers.max() <= bare.max() + MOST_LATER
    in_time &= bool(np.median(answers) <= np.median(bare) + MOST_LATER)
    return bool(in_time and letting_go.max() <= SOON)


def _figures_of(made: Sequence[TimedStop], seed: int, others: OtherSessions) -> str:
    answers, bare, letting_go, since_asked = np.array(made).T
    return (
        f"{len(made)} stops, seed {seed}, beside {others.plans} long plans and {others.stops} "
        f"stops of {PLANNING} other sessions: answered after {_figures(answers)}, a bare endpoint "
        f"at the same moments after {_figures(bare)}; let go within {letting_go.max():.2f} s of "
        f"the robot's time from the answer ({since_asked.max():.2f} s from the request, in the "
        f"middle {np.median(since_asked):.3f} s)"
    )


def _figures(times: Any) -> str:
    return f"{1e3 * np.median(times):.0f} ms in the middle and {1e3 * np.max(times):.0f} ms at most"


def _thing(number: int) -> dict[str, Any]:
    row, column = divmod(number, 6)
    place = {"x": round(0.25 + 0.12 * column, 3), "y": round(-0.55 + 0.13 * row, 3)}
    return {"name": f"m{number}", "model": MODELS[number % 3], **place}


def _data(stream: httpx.Response) -> Any:
    for line in stream.iter_lines():
        if line.startswith("data:"):
            yield json.loads(line[5:])["event"]
