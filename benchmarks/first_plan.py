"""What the first plan of a process costs, part by part, beyond importing the modules.

    python -m benchmarks.first_plan [--runs 9]

Each run is a fresh process. It imports all modules that the sentence ever loads, then times the
parts in turn: controller and look, parsing, planning by `Controller.plan`, and what
`Controller.say(…, plan_only=True)` adds to them at its first call. Times are of the processor, the
medians of the runs; they vary by half with what else the machine does, the imports most.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import time
from importlib import import_module

SENTENCE = "push the ice tea box 5 cm away"
PACKAGES = ("nlcontrol", "grammar", "planner", "objectmodels", "sim")


def _loaded() -> list[str]:
    """The names of the project's modules that the sentence loads."""
    _parts()
    return [name for name in sys.modules if name.partition(".")[0] in PACKAGES]


def _parts() -> dict[str, float]:
    """Processor times of the parts of the first sentence [ms]."""
    from nlcontrol import Controller

    began = time.process_time()
    times: dict[str, float] = {}

    def lap(part: str) -> None:
        nonlocal began
        now = time.process_time()
        times[part] = 1e3 * (now - began)
        began = now

    controller = Controller("kitchen")
    controller.look()
    lap("controller and look")
    command = controller.command(SENTENCE)
    lap("parse")
    frame = controller.resolve(command).frames[0]
    lap("resolve")
    controller.plan(frame)
    lap("plan")
    controller.say(SENTENCE, plan_only=True)
    lap("say, parsed and planned before")
    return times


def _after(modules: list[str]) -> dict[str, float]:
    began = time.process_time()
    for name in modules:
        import_module(name)
    return {"imports": 1e3 * (time.process_time() - began), **_parts()}


def _answer(*arguments: str, given: str = "") -> str:
    command = [sys.executable, "-m", "benchmarks.first_plan", *arguments]
    return subprocess.run(command, input=given, check=True, capture_output=True, text=True).stdout


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    options.add_argument("--runs", type=int, default=9)
    options.add_argument("--part", choices=("loaded", "after"), help=argparse.SUPPRESS)
    chosen = options.parse_args()
    if chosen.part == "loaded":
        print(json.dumps(_loaded()))
    elif chosen.part == "after":
        print(json.dumps(_after(json.load(sys.stdin))))
    else:
        modules = _answer("--part", "loaded")
        runs = [json.loads(_answer("--part", "after", given=modules)) for _ in range(chosen.runs)]
        for part in runs[0]:
            print(f"{part:32s} {statistics.median(run[part] for run in runs):6.1f} ms")


if __name__ == "__main__":
    main()
