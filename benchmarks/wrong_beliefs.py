"""The first sentence to a robot that believes half of the true friction, and a mass off by 40 %.

The beliefs of the registry about the ice tea box are replaced by half of the friction that is true
in the scene, and by 0.6 or 1.4 times the true mass in turn; how sure it is of them stays, relative
to the value. Each run has another seed for its sensors. The robot has only its own updates to get
there.

    python -m benchmarks.wrong_beliefs
"""

from __future__ import annotations

import argparse
import sys
from concurrent.futures import Executor

from benchmarks.ten_scenes import SENTENCE
from nlcontrol import Controller, Registry
from nlcontrol.parallel_tasks import run_all
from nlcontrol.results.result import Result
from objectmodels import ObjectModel
from sim.truth.scene_file import load_scene

OBJECT = "ice tea box"
FRICTION, MASSES = 0.5, (0.6, 1.4)


def believed(seed: int) -> ObjectModel:
    """The model with its wrong beliefs."""
    model = Registry.built_in().get(OBJECT)
    truth = load_scene("kitchen").object(OBJECT).truth
    friction, mass = FRICTION * truth.friction_table, MASSES[seed % 2] * truth.mass_kg
    return model.model_copy(
        update={
            "friction": friction,
            "friction_sd": model.friction_sd * friction / model.friction,
            "mass": mass,
            "mass_sd": model.mass_sd * mass / model.mass,
        }
    )


def run(seed: int) -> Result:
    """Says the sentence to the robot of a seed."""
    registry = Registry()
    for model in Registry.built_in():
        registry.add(believed(seed) if model.name == OBJECT else model)
    result = Controller("kitchen", registry=registry, seed=seed).say(SENTENCE)
    return result.model_copy(update={"trace": None})


def line(seed: int, result: Result) -> str:
    """What happened, in a line."""
    done = result.execution
    moved = f"{1e3 * done.displacement[0]:6.1f} mm" if done else "         "
    lessons = result.steps[0].lessons if result.steps else ()
    taught = ", ".join(f"{lesson.moved} {lesson.force:.2f} N" for lesson in lessons)
    why = f"  {result.error.message}" if result.error else ""
    return f"{seed:4}  {MASSES[seed % 2]:4.1f}  {result.status:8}  {moved}  {taught}{why}"


def main(executor: Executor | None = None) -> int:
    """Runs all seeds and prints a line for each."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    print("seed  mass  status       moved  felt")
    satisfied = 0
    results = run_all(run, range(options.seeds), executor=executor, workers=options.workers)
    for seed, result in enumerate(results):
        satisfied += result.ok
        print(line(seed, result), flush=True)
    print(f"satisfied: {satisfied} of {options.seeds}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
