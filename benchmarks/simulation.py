"""Wall seconds per simulated second of a push with everything running.

Everything: arm, hand and three objects, camera, torque sensors, control at 100 Hz, recording. The
peer is Drake alone: the same plant, holding still, without sensors and control, in the same run.

    python -m benchmarks.simulation [--runs 3]
"""

from __future__ import annotations

import argparse
import statistics
import time

from nlcontrol import Controller
from planner.plan import Plan
from sim import DrakeWorld, load_scene

SENTENCE = "push the ice tea box away without toppling it"


def everything() -> float:
    """Wall seconds per simulated second of an execution, planning and start left out."""
    controller = Controller("kitchen")
    plan = controller.plan(controller.resolve(controller.parse(SENTENCE)).frames[0])
    assert isinstance(plan, Plan)
    world = controller.world
    start = time.perf_counter()
    controller.execute(plan)
    return (time.perf_counter() - start) / world.time


def drake_alone() -> float:
    """The same for the plant alone over ten seconds."""
    world = DrakeWorld(load_scene("kitchen"))
    simulator, seconds = world.simulator, 10.0
    start = time.perf_counter()
    simulator.AdvanceTo(seconds)
    return (time.perf_counter() - start) / seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=3)
    runs = parser.parse_args().runs
    pairs = [(drake_alone(), everything()) for _ in range(runs)]
    alone, whole = (statistics.median(column) for column in zip(*pairs, strict=True))
    ratio = statistics.median(b / a for a, b in pairs)
    print(f"Drake alone:        {alone:.3f} wall s per simulated s (median of {runs})")
    print(f"everything running: {whole:.3f} wall s per simulated s, {ratio:.2f} times as much")


if __name__ == "__main__":
    main()
