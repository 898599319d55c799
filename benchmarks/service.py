"""Plans of the service while two simulations run, and its memory.

    python -m benchmarks.service [--parts simulations memory] [--tables 12] [--seeds 0 …]
        [--plans 500] [--runs 30]

Everything happens in one run on one machine. The parts: warm plans of pushes and of pours while two
other sessions simulate, from request to answer, at the tables and of the sentences that
`benchmarks.times` draws for each seed; memory of all processes of the service (proportional
set size, which counts shared pages once) after the first five plans and runs, and at the end.
"""

from __future__ import annotations

import argparse
import math
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import product
from pathlib import Path
from typing import Any

import httpx
import numpy as np

from benchmarks.times import TASKS, moved_table
from sim.truth.scene_file import SceneObject
from tests.patience import PATIENCE
from tests.service_process import serving
from tests.unit.nlcontrol.service.processes import descendants

PUSH = "push the coffee box 5 cm away"
TURNS = ("push the ice tea box 3 cm away", "push the ice tea box 3 cm toward yourself")
DRAWN = "push", "pour"
"""Tasks of `benchmarks.times` that are planned while others simulate."""

PARTS = "simulations", "memory"


class Caller:
    """A connection that is kept."""

    def __init__(self, url: str) -> None:
        self.http = httpx.Client(base_url=f"{url}/v1", timeout=PATIENCE)

    def ask(self, method: str, path: str, body: object = None) -> Any:
        """The answer's document; None if it has none."""
        answer = self.http.request(method, path, json=body).raise_for_status()
        return answer.json() if answer.content else None

    @contextmanager
    def session(self, spec: object) -> Iterator[str]:
        """Context with the path of a session."""
        place = f"/sessions/{self.ask('POST', '/sessions', spec)['session_id']}"
        yield place
        self.ask("DELETE", place)


class Simulator(threading.Thread):
    """A session in which something is pushed to and fro, so often or until it is told to end."""

    def __init__(self, url: str, seed: int, most: float = math.inf) -> None:
        super().__init__(daemon=True)
        self._caller, self._seed, self._most = Caller(url), seed, most
        self.runs = 0
        self.ends = False

    def run(self) -> None:
        """Pushes to and fro."""
        with self._caller.session({"seed": self._seed}) as place:
            while not self.ends and self.runs < self._most:
                run = self._caller.ask("POST", f"{place}/say", {"text": TURNS[self.runs % 2]})
                while run["state"] in ("queued", "running"):
                    time.sleep(0.1)
                    run = self._caller.ask("GET", f"/runs/{run['run_id']}")
                self.runs += 1


def measure_beside_simulations(url: str, tables: int, seeds: Sequence[int]) -> None:
    """Prints latencies of warm plans at drawn tables while two other sessions simulate."""
    caller = Caller(url)
    for task in DRAWN:
        # The planners warm up.
        plan_latencies(caller, task, len(TASKS[task].scenes), max(seeds) + 1)
    simulators = [Simulator(url, seed) for seed in (1, 2)]
    for simulator in simulators:
        simulator.start()
    time.sleep(3.0)
    print(f"{'':44} {'median':>11} {'95 %':>11}")
    for seed, task in product(seeds, DRAWN):
        for status, times in plan_latencies(caller, task, tables, seed).items():
            what = f"{task} {status} ({len(times)}, seed {seed}), two simulations"
            median, late = np.quantile(times, (0.5, 0.95))
            print(f"{what:44} {1e3 * median:8.1f} ms {1e3 * late:8.1f} ms", flush=True)
    for simulator in simulators:
        simulator.ends = True
    for simulator in simulators:
        simulator.join()
    print(f"  ({sum(s.runs for s in simulators)} runs ended meanwhile)")


def plan_latencies(caller: Caller, task: str, tables: int, seed: int) -> dict[str, list[float]]:
    """Times of the plans of a task, by their status, at drawn tables, which are stated."""
    sentence, scenes, said = TASKS[task]
    times: dict[str, list[float]] = {}
    for number in range(tables):
        rng = np.random.default_rng((seed, number))
        scene = scenes[number % len(scenes)]
        standing = [_stated(item) for item in moved_table(scene, rng).objects]
        with caller.session({"scene": scene, "seed": number, "objects": standing}) as place:
            for _ in range(said):
                text, began = sentence(rng), time.perf_counter()
                answer = caller.ask("POST", f"{place}/plans", {"text": text})
                taken = time.perf_counter() - began
                times.setdefault(answer["result"]["status"], []).append(taken)
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


def measure_memory(plans: int, runs: int) -> None:
    """Prints the memory of all processes of a service after five plans and runs, and after all."""
    with serving("--workers", "2", "--planners", "2") as server:
        caller = Caller(server.url)
        with caller.session({}) as place:
            for more_plans, more_runs in ((5, 5), (plans - 5, runs - 5)):
                for _ in range(more_plans):
                    caller.ask("POST", f"{place}/plans", {"text": PUSH})
                simulators = [Simulator(server.url, n + 1, (more_runs + n) // 2) for n in range(2)]
                for simulator in simulators:
                    simulator.start()
                for simulator in simulators:
                    simulator.join()
                time.sleep(2.0)
                pids = (server.process.pid, *descendants(server.process.pid))
                print(f"memory after {more_plans} plans and {more_runs} runs more: ", end="")
                print(f"{sum(map(_memory, pids)):.0f} MB", flush=True)


def _memory(pid: int) -> float:
    """Proportional set size of a process [MB]."""
    content = Path(f"/proc/{pid}/smaps_rollup").read_text()
    return next(int(line.split()[1]) for line in content.splitlines() if line[:4] == "Pss:") / 1024


def main() -> None:
    """Prints what is asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--parts", choices=PARTS, nargs="*", default=PARTS)
    parser.add_argument("--tables", type=int, default=12)
    parser.add_argument("--seeds", type=int, nargs="*", default=[0])
    parser.add_argument("--plans", type=int, default=500)
    parser.add_argument("--runs", type=int, default=30)
    options = parser.parse_args()
    if "simulations" in options.parts:
        with serving("--workers", "2", "--planners", "2") as server:
            measure_beside_simulations(server.url, options.tables, options.seeds)
    if "memory" in options.parts:
        measure_memory(options.plans, options.runs)


if __name__ == "__main__":
    main()
