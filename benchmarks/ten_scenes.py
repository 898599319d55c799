"""The first sentence in ten worlds whose objects are not what the robot believes.

True mass and true friction of every object differ from the registry's by up to 20 %: four scenes
take the corners of that range, six are drawn from it. Each scene also has another seed for its
sensors.

    python -m benchmarks.ten_scenes
"""

from __future__ import annotations

import argparse
import math
import sys
from concurrent.futures import Executor
from functools import partial

import numpy as np

from nlcontrol import Controller, Registry
from nlcontrol.parallel_tasks import run_all
from nlcontrol.results.result import Result
from sim.truth.scene_file import Scene, load_scene

SENTENCE = "push the ice tea box away without toppling it"
SPREAD = 0.20


def shares(seed: int) -> tuple[float, float]:
    """True mass and true friction of a scene, as shares of the believed ones."""
    low, high = 1.0 - SPREAD, 1.0 + SPREAD
    corners = [(low, low), (low, high), (high, low), (high, high)]
    if seed < len(corners):
        return corners[seed]
    mass, friction = np.random.default_rng(seed).uniform(low, high, 2).tolist()
    return mass, friction


def world(seed: int) -> Scene:
    """The default scene with other truths."""
    mass, friction = shares(seed)
    scene, registry = load_scene("kitchen"), Registry.default()
    objects = []
    for item in scene.objects:
        model = registry.get(item.model)
        truth = item.truth.model_copy(
            update={"mass_kg": mass * model.mass, "friction_table": friction * model.friction}
        )
        objects.append(item.model_copy(update={"truth": truth}))
    return scene.model_copy(update={"objects": tuple(objects)})


def run(seed: int, sentence: str = SENTENCE) -> Result:
    """Says the sentence in one of the worlds."""
    result = Controller(world(seed), seed=seed).say(sentence)
    return result.model_copy(update={"trace": None})


def table(results: dict[int, Result]) -> str:
    """What happened, a line per scene."""
    lines = ["seed  mass  friction  status      moved  across  turned  tilt  force"]
    for seed, result in results.items():
        mass, friction = shares(seed)
        line = f"{seed:4}  {mass:4.2f}  {friction:8.2f}  {result.status:10}"
        if result.execution is not None:
            done = result.execution
            x, y, _ = (1e3 * value for value in done.displacement)
            turned = math.nan if done.turned is None else math.degrees(done.turned)
            tilt = math.degrees(done.largest_tilt)
            line += (
                f"{x:4.1f} mm {y:4.1f} mm {turned:5.2f}° {tilt:4.2f}°  {done.largest_force:4.2f} N"
            )
        lines.append(line)
    satisfied = sum(result.ok for result in results.values())
    return "\n".join([*lines, f"satisfied: {satisfied} of {len(results)}"])


def main(executor: Executor | None = None) -> int:
    """Runs all scenes and prints the table; 1 if any sentence was not satisfied."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--scenes", type=int, default=10)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--sentence", default=SENTENCE)
    options = parser.parse_args()
    seeds = range(options.scenes)
    say = partial(run, sentence=options.sentence)
    found = run_all(say, seeds, executor=executor, workers=options.workers)
    results = dict(zip(seeds, found, strict=True))
    print(table(results))
    return 0 if all(result.ok for result in results.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
