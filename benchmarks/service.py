"""The service beside a bare endpoint, its plans while two simulations run, and its memory.

    python -m benchmarks.service [--parts rates refusal simulations memory] [--requests 200]
        [--tables 12] [--seeds 0 …] [--plans 500] [--runs 30]

Everything happens in one run on one machine. The parts: requests per second and latencies of
`parse` and `plan` beside a FastAPI endpoint that does nothing (four connections at once, the client
included); plans of others while one long refusal is sought; warm plans of pushes and of pours while
two other sessions simulate, from request to answer, at the tables and of the sentences that
`benchmarks.times` draws for each seed; memory of all processes of the service (proportional
set size, which counts shared pages once) after the first five plans and runs, and at the end.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from http.client import HTTPConnection, HTTPException
from itertools import product
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np
from fastapi import FastAPI
from pydantic import BaseModel

from benchmarks.times import TASKS, moved_table
from sim.truth.scene_file import SceneObject
from tests.service_process import serving

PUSH = "push the coffee box 5 cm away"
LONG = "turn the cereal box by 170 degrees without moving it more than 1 cm"
TURNS = ("push the ice tea box 3 cm away", "push the ice tea box 3 cm toward yourself")
DRAWN = "push", "pour"
"""Tasks of `benchmarks.times` that are planned while others simulate."""

PARTS = "rates", "refusal", "simulations", "memory"
CONNECTIONS = 4


class _Said(BaseModel):
    text: str


def bare_app() -> FastAPI:
    """An endpoint that takes a sentence and gives it back."""
    app = FastAPI()

    @app.post("/bare")
    async def bare(said: _Said) -> _Said:
        return said

    return app


class Caller:
    """A connection that is kept."""

    def __init__(self, url: str) -> None:
        address = urlsplit(url)
        self._line = HTTPConnection(address.hostname or "", address.port, timeout=120)
        self._line.connect()

    def post(self, path: str, body: object = None) -> Any:
        """The answer's document."""
        return self._answer("POST", path, b"" if body is None else json.dumps(body).encode())

    def get(self, path: str) -> Any:
        """The answer's document."""
        return self._answer("GET", path)

    def delete(self, path: str) -> None:
        """Deletes what stands there."""
        self._answer("DELETE", path)

    def _answer(self, method: str, path: str, content: bytes = b"") -> Any:
        headers = {"Content-Type": "application/json"}
        try:
            self._line.request(method, path, content, headers)
            response = self._line.getresponse()
        except (ConnectionError, HTTPException):  # the server closes a line that is idle
            self._line.close()
            self._line.request(method, path, content, headers)
            response = self._line.getresponse()
        content = response.read()
        if response.status >= 400:
            raise RuntimeError(content.decode())
        return json.loads(content) if content else None


def latencies(call: Callable[[], object], count: int) -> list[float]:
    """Time of each call [s]."""
    times = []
    for _ in range(count):
        began = time.perf_counter()
        call()
        times.append(time.perf_counter() - began)
    return times


def print_row(what: str, times: list[float], rate: float | None = None) -> None:
    told = "" if rate is None else f"{rate:8.0f}/s"
    median, late = np.quantile(times, (0.5, 0.95))
    print(f"{what:44} {told:10} {1e3 * median:8.1f} ms {1e3 * late:8.1f} ms", flush=True)


def measure_rate(what: str, url: str, path: str, body: object, count: int) -> None:
    """Prints requests per second over several connections, and their latencies."""

    def work(caller: Caller) -> list[float]:
        return latencies(lambda: caller.post(path, body), count // CONNECTIONS)

    callers = [Caller(url) for _ in range(CONNECTIONS)]
    callers[0].post(path, body)
    with ThreadPoolExecutor(CONNECTIONS) as threads:
        began = time.perf_counter()
        times = [each for found in threads.map(work, callers) for each in found]
        print_row(what, times, len(times) / (time.perf_counter() - began))


@contextmanager
def bare_server(port: int = 8765) -> Iterator[str]:
    command = [sys.executable, "-m", "uvicorn", "benchmarks.service:bare_app", "--factory"]
    command += ["--port", str(port), "--http", "h11", "--no-access-log", "--log-level", "error"]
    process = subprocess.Popen(command)
    url = f"http://127.0.0.1:{port}"
    try:
        for _ in range(100):
            try:
                Caller(url)
            except ConnectionRefusedError:
                time.sleep(0.1)
        yield url
    finally:
        process.terminate()
        process.wait()


def memory(pid: int) -> float:
    """Proportional set size of a process and all below it [MB]."""
    content = Path(f"/proc/{pid}/smaps_rollup").read_text()
    own = next(int(line.split()[1]) for line in content.splitlines() if line.startswith("Pss:"))
    tasks = Path(f"/proc/{pid}/task").iterdir()
    below = [int(n) for task in tasks for n in (task / "children").read_text().split()]
    return own / 1024 + sum(map(memory, below))


class Simulator(threading.Thread):
    """A session in which something is pushed to and fro until it is told to end."""

    def __init__(self, url: str, seed: int) -> None:
        super().__init__(daemon=True)
        self.caller = Caller(url)
        self.session = self.caller.post("/v1/sessions", {"seed": seed})["session_id"]
        self.runs = 0
        self.most = 10**9
        self.ends = False

    def run(self) -> None:
        """Pushes to and fro."""
        while not self.ends and self.runs < self.most:
            said = {"text": TURNS[self.runs % 2]}
            run = self.caller.post(f"/v1/sessions/{self.session}/say", said)
            while run["state"] in ("queued", "running"):
                time.sleep(0.1)
                run = self.caller.get(f"/v1/runs/{run['run_id']}")
            self.runs += 1


def simulate(url: str, runs: int) -> None:
    """Carries out so many runs in two sessions."""
    simulators = [Simulator(url, seed) for seed in (1, 2)]
    for number, simulator in enumerate(simulators):
        simulator.most = (runs + number) // 2
        simulator.start()
    for simulator in simulators:
        simulator.join()
        simulator.caller.delete(f"/v1/sessions/{simulator.session}")


def measure_beside_simulations(url: str, tables: int, seeds: Sequence[int]) -> None:
    """Prints latencies of warm plans at drawn tables while two other sessions simulate."""
    simulators = [Simulator(url, seed) for seed in (1, 2)]
    caller = Caller(url)
    for task in DRAWN:
        plan_latencies(
            caller, task, len(TASKS[task].scenes), max(seeds) + 1
        )  # the planners warm up
    for simulator in simulators:
        simulator.start()
    time.sleep(3.0)
    for seed, task in product(seeds, DRAWN):
        for status, times in plan_latencies(caller, task, tables, seed).items():
            print_row(f"{task} {status} ({len(times)}, seed {seed}), two simulations", times)
    for simulator in simulators:
        simulator.ends = True
    for simulator in simulators:
        simulator.join()
        simulator.caller.delete(f"/v1/sessions/{simulator.session}")
    print(f"  ({sum(s.runs for s in simulators)} runs ended meanwhile)")


def plan_latencies(caller: Caller, task: str, tables: int, seed: int) -> dict[str, list[float]]:
    """Times of the plans of a task, by their status, at drawn tables, which are stated."""
    sentence, scenes, said = TASKS[task]
    times: dict[str, list[float]] = {}
    for number in range(tables):
        rng = np.random.default_rng((seed, number))
        scene = scenes[number % len(scenes)]
        standing = [_stated(item) for item in moved_table(scene, rng).objects]
        spec = {"scene": scene, "seed": number, "objects": standing}
        session = caller.post("/v1/sessions", spec)["session_id"]
        for _ in range(said):
            text, began = sentence(rng), time.perf_counter()
            answer = caller.post(f"/v1/sessions/{session}/plans", {"text": text})
            taken = time.perf_counter() - began
            times.setdefault(answer["result"]["status"], []).append(taken)
        caller.delete(f"/v1/sessions/{session}")
    return times


def _stated(item: SceneObject) -> dict[str, object]:
    """An object of a scene as a caller states it."""
    pose = item.pose
    return {
        "name": item.name,
        "model": item.model,
        "x": pose.x_m,
        "y": pose.y_m,
        "yaw": math.radians(pose.yaw_deg),
        "synonyms": item.synonyms,
        "fragile": item.fragile,
        "fixed": item.fixed,
    }


def measure_beside_refusal(url: str, count: int) -> None:
    """Prints latencies of plans without a session while a long search goes on, and without it."""
    caller, other = Caller(url), Caller(url)

    def plan() -> object:
        return caller.post("/v1/plan", {"text": PUSH})

    latencies(plan, 5)
    print_row("plan without a session", latencies(plan, count))
    began = time.perf_counter()
    taken: list[float] = []

    def search() -> None:
        other.post("/v1/plan", {"text": LONG})
        taken.append(time.perf_counter() - began)

    thread = threading.Thread(target=search)
    thread.start()
    time.sleep(0.05)
    times = []
    while thread.is_alive():
        times += latencies(plan, 1)
    print_row(f"the same beside a search of {taken[0]:.1f} s ({len(times)})", times)


def measure_memory(plans: int, runs: int) -> None:
    """Prints the memory of all processes of a service after five plans and runs, and after all."""
    with serving("--workers", "2", "--planners", "2") as server:
        caller = Caller(server.url)
        session = caller.post("/v1/sessions", {})["session_id"]
        path = f"/v1/sessions/{session}/plans"
        latencies(lambda: caller.post(path, {"text": PUSH}), 5)
        simulate(server.url, 5)
        time.sleep(2.0)
        before = memory(server.process.pid)
        latencies(lambda: caller.post(path, {"text": PUSH}), plans - 5)
        simulate(server.url, runs - 5)
        time.sleep(2.0)
        after = memory(server.process.pid)
    print(f"memory after 5 plans and 5 runs: {before:.0f} MB")
    print(f"after {plans} plans and {runs} runs: {after:.0f} MB")


def main() -> None:
    """Prints what is asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--parts", choices=PARTS, nargs="*", default=PARTS)
    parser.add_argument("--requests", type=int, default=200)
    parser.add_argument("--tables", type=int, default=12)
    parser.add_argument("--seeds", type=int, nargs="*", default=[0])
    parser.add_argument("--plans", type=int, default=500)
    parser.add_argument("--runs", type=int, default=30)
    options = parser.parse_args()
    print(f"{'':44} {'':10} {'median':>11} {'95 %':>11}")
    if "rates" in options.parts:
        with bare_server() as url:
            measure_rate("bare endpoint", url, "/bare", {"text": PUSH}, 10 * options.requests)
    with serving("--workers", "2", "--planners", "2") as server:
        if "rates" in options.parts:
            for name, count in (("parse", 10 * options.requests), ("plan", options.requests)):
                measure_rate(name, server.url, f"/v1/{name}", {"text": PUSH}, count)
        if "refusal" in options.parts:
            measure_beside_refusal(server.url, options.requests // 4)
        if "simulations" in options.parts:
            measure_beside_simulations(server.url, options.tables, options.seeds)
    if "memory" in options.parts:
        measure_memory(options.plans, options.runs)


if __name__ == "__main__":
    main()
