"""The paper's three sentences where the truth is another than what is believed.

The kitchen, by seed: mass, frictions and forces of the lid of each thing lie within 30 % of what is
believed, its centre of mass within some millimetres; the camera has a noise of 5 mm and 2° and a
constant error of 2 mm. The robot knows those bounds and no more. A sentence is satisfied, refused
before anything moves, or fails.

    python -m benchmarks.paper_sentences
"""

from __future__ import annotations

import argparse
import sys
from concurrent.futures import Executor
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks.goals.hard_worlds import VISION, drawn_truth
from benchmarks.goals.worlds import believed
from benchmarks.record import Kept, carried_out
from nlcontrol import Controller
from sim.truth.scene_file import Scene, load_scene

SENTENCES = {
    "push": "push the ice tea box away without toppling it",
    "open": "open the ice tea cup",
    "pour": "pour the contents of the ice tea into the mug",
}


class Job(NamedTuple):
    """A sentence of `SENTENCES` in the world of a seed."""

    sentence: str
    seed: int


class Said(Kept[Job]):
    """What came of a sentence.

    Attributes:
        status: of the result.
        code: of its error; none if it was satisfied.
        message: of that error.
        moved: whether the robot did anything.
        probability: of the first plan's success; none without a plan.
    """

    status: str
    code: str | None
    message: str
    moved: bool
    probability: float | None


def world(seed: int) -> Scene:
    """The kitchen with other truths."""
    scene, registry = load_scene("kitchen"), believed(wide=True)
    rng = np.random.default_rng(seed)
    objects = []
    for item in scene.objects:
        model = registry.get(item.model)
        truth = drawn_truth(model, True, rng)
        if model.container is not None and truth.container is None:
            contents = model.container.contents_l * truth.mass_kg / model.mass
            container = model.container.model_copy(update={"contents_l": contents})
            truth = truth.model_copy(update={"container": container})
        objects.append(item.model_copy(update={"truth": truth}))
    return scene.model_copy(update={"objects": tuple(objects), "vision": VISION})


def said(job: Job) -> Said:
    """Says a sentence in its world."""
    controller = Controller(world(job.seed), registry=believed(wide=True), seed=job.seed)
    result = controller.say(SENTENCES[job.sentence])
    return Said(
        job=job,
        status=result.status,
        code=result.error.code if result.error else None,
        message=result.error.message if result.error else "",
        moved=result.execution is not None,
        probability=result.plan.probability if result.plan else None,
    )


def line(done: Said) -> str:
    """What came of a sentence, in a line."""
    sure = "" if done.probability is None else f"{done.probability:.3f}"
    why = f"{done.code}: {done.message}" if done.code else ""
    return f"{done.job.sentence:5} {done.job.seed:4}  {done.status:10} {sure:5}  {why}".rstrip()


def main(executor: Executor | None = None) -> int:
    """Says all and prints what came of them; 1 if a sentence failed that was not refused."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seed", type=int, default=0, help="the first one")
    parser.add_argument("--seeds", type=int, default=20, help="how many")
    parser.add_argument("--sentences", default=",".join(SENTENCES), help="which, with commas")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--record", type=Path, help="file of JSON lines")
    options = parser.parse_args()
    seeds = range(options.seed, options.seed + options.seeds)
    names = options.sentences.split(",")
    jobs = [Job(name, seed) for name in names for seed in seeds]
    done = carried_out(
        said,
        jobs,
        Said,
        executor=executor,
        workers=options.workers,
        record=options.record,
        told=lambda one: print(line(one), flush=True),
    )
    for name in names:
        here = [done[job] for job in jobs if job.sentence == name]
        satisfied = sum(one.status == "done" for one in here)
        refused = sum(one.status == "refused" for one in here)
        print(f"{name}: {satisfied} of {len(here)} satisfied, {refused} refused beforehand")
    return 0 if all(one.status in ("done", "refused") for one in done.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
