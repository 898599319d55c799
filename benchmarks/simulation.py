"""Wall seconds per simulated second of a push with everything running.

Everything: arm, hand and objects, camera, torque sensors, control at 100 Hz, recording. The peer is
Drake alone: the same plant, holding still, without sensors and control, in the same run. Every
object on the table costs, also one that is not touched: rows are for the kitchen's boxes alone and
for all that stands in it.

    python -m benchmarks.simulation [--runs 3]
"""

from __future__ import annotations

import argparse
import statistics
import time

from nlcontrol import Controller
from planner.types.plan import Plan
from sim import load_scene
from sim.simulated_executor import simulation
from sim.truth.scene_file import Scene
from sim.worlds.drake.drake_world import DrakeWorld

SENTENCE = "push the ice tea box away without toppling it"
BOXES = 3  # objects of the kitchen that come first


def everything(scene: Scene) -> float:
    """Wall seconds per simulated second of an execution, planning and start left out."""
    controller = Controller(scene)
    plan = controller.plan(controller.resolve(controller.parse(SENTENCE)).frames[0])
    assert isinstance(plan, Plan)
    world = simulation(controller.executor).world
    start = time.perf_counter()
    controller.execute(plan)
    return (time.perf_counter() - start) / world.time


def drake_alone(scene: Scene) -> float:
    """The same for the plant alone over ten seconds."""
    simulator, seconds = DrakeWorld(scene).simulator, 10.0
    start = time.perf_counter()
    simulator.AdvanceTo(seconds, interruptible=False)
    return (time.perf_counter() - start) / seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=3)
    runs = parser.parse_args().runs
    kitchen = load_scene("kitchen")
    print("| objects | Drake alone | everything | times as much |  (wall s per simulated s)")
    print("|---|---|---|---|")
    for count in (BOXES, len(kitchen.objects)):
        scene = kitchen.model_copy(update={"objects": kitchen.objects[:count]})
        pairs = [(drake_alone(scene), everything(scene)) for _ in range(runs)]
        alone, whole = (statistics.median(column) for column in zip(*pairs, strict=True))
        ratio = statistics.median(b / a for a, b in pairs)
        print(f"| {count} | {alone:.3f} | {whole:.3f} | {ratio:.2f} |")


if __name__ == "__main__":
    main()
