"""Lifting, opening and pouring in worlds that differ from seed to seed from what is believed.

Each world is a built-in scene with every object shifted by up to 10 mm along x and y and turned by
up to 10°. Its true masses, frictions and the torques and forces of its lids lie within 15 % of what
the registry believes; the carton that is poured from is 20 to 80 % full. The robot believes what
the registry says, whatever the seed. It is told one sentence as a user would tell it, and judged by
the checks of its clauses, which see the world as it truly is. A failure is *told* if the robot
itself ended with it, and *silent* if it thought that all was done.

    python -m benchmarks.handwork --seeds 20 --sentence open --record handwork.jsonl

With `--record` results are kept as they come, and a broken run goes on where it was.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
import traceback
from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from pydantic import Field

from benchmarks.record import Kept, carried_out
from nlcontrol import Controller, Registry
from nlcontrol.checks.trace_measures import tilt_at_end
from nlcontrol.checks.verdicts import PLANNED_ENDS, Check
from nlcontrol.learning.lessons import change_contents
from objectmodels import ObjectModel
from objectmodels.models.object_parts import Lid, LiftOffLid
from sim.truth.object_truth import Truth, truth_as_believed
from sim.truth.scene_file import Pose, Scene, SceneObject, load_scene

if TYPE_CHECKING:
    from sim.traces.trace import Trace

SHIFT, TURN = 0.010, 10.0
"""Largest shift of an object along x and y [m], and largest turn [degrees]."""
APART = 0.15
"""Largest relative difference of truth and belief."""
FILLED = (0.20, 0.80)
"""Share of its capacity that is in the carton."""

_POURED = "ice tea"
_OF_LIDS = ("friction_torque", "snap_torque", "retention")
_INTO = "mug"
_OUTCOMES = ("satisfied", "refused", "told", "silent", "crashed")


class Task(NamedTuple):
    """What is said where.

    Attributes:
        scene: built-in.
        text: the sentence.
        object: that it is about.
    """

    scene: str
    text: str
    object: str


TASKS = {
    "open": Task("kitchen", "open the ice tea cup", "ice tea cup"),
    "pour": Task("kitchen", "pour the contents of the ice tea into the mug", _POURED),
    "lift": Task("kitchen", "lift the mug", "mug"),
    "place": Task("kitchen", "pick up the mug and put it next to the ice tea cup", "mug"),
    "jar": Task("pantry", "take the lid off the jar", "jar"),
    "bottle": Task("pantry", "unscrew the cap of the fixed bottle", "fixed bottle"),
}


class Job(NamedTuple):
    """One sentence in one world."""

    sentence: str
    seed: int


class Done(Kept[Job]):
    """What came of a job.

    Attributes:
        status: as in a result, or `crashed`.
        end: of the last try; empty if nothing was tried.
        message: what the result says of a failure.
        tries: how many plans were carried out.
        stuck: whether the robot says that it did less than was asked.
        missed: clauses that did not hold, with what was measured.
        figures: see `figures`.
        simulated, processor: time [s].
    """

    status: str
    end: str = ""
    message: str = ""
    tries: int = 0
    stuck: bool = False
    missed: tuple[str, ...] = ()
    figures: dict[str, float] = Field(default_factory=dict)
    simulated: float = 0.0
    processor: float = 0.0

    @property
    def outcome(self) -> str:
        """`satisfied`, `refused`, `told`, `silent` or `crashed`."""
        if self.status == "done":
            return "satisfied"
        if self.status != "failed":
            return "crashed" if self.status == "crashed" else "refused"
        return "told" if self.stuck or self.end not in PLANNED_ENDS else "silent"


def world(job: Job) -> Scene:
    """The world of a job; it depends on its scene and seed alone."""
    scene = load_scene(TASKS[job.sentence].scene)
    rng, registry = np.random.default_rng(job.seed), Registry.built_in()
    objects = tuple(_drawn(item, registry.get(item.model), rng) for item in scene.objects)
    return scene.model_copy(update={"name": f"{scene.name} {job.seed}", "objects": objects})


def _drawn(item: SceneObject, model: ObjectModel, rng: np.random.Generator) -> SceneObject:
    x, y, turn = rng.uniform(-1.0, 1.0, 3).tolist()
    pose = Pose(
        x_m=item.pose.x_m + SHIFT * x,
        y_m=item.pose.y_m + SHIFT * y,
        yaw_deg=item.pose.yaw_deg + TURN * turn,
    )
    return item.model_copy(update={"pose": pose, "truth": true(model, rng)})


def true(model: ObjectModel, rng: np.random.Generator) -> Truth:
    """How an object of a model really is."""
    mass, friction, finger, contents, lid = (1.0 + APART * rng.uniform(-1.0, 1.0, 5)).tolist()
    filled = rng.uniform(*FILLED)
    container, vessel = model.container, model.vessel
    if container is None or vessel is None:
        model = model.model_copy(update={"mass": mass * model.mass})
    else:
        volume = contents * container.contents
        if model.name == _POURED:
            volume = filled * vessel.capacity
        shell = change_contents(model, -container.contents)
        model = change_contents(shell.model_copy(update={"mass": mass * shell.mass}), volume)
    return Truth.model_validate(
        dict(truth_as_believed(model))
        | {
            "friction_table": friction * model.friction,
            "friction_finger": finger * model.finger_friction,
            "container": model.container,
            "lid": None if model.lid is None else _harder(model.lid, lid),
        }
    )


def _harder(lid: Lid, factor: float) -> Lid:
    changed = {name: factor * getattr(lid, name) for name in _OF_LIDS if hasattr(lid, name)}
    return lid.model_copy(update=changed)


def run(job: Job) -> Done:
    """Says a sentence in its world; what it stumbles over is a result too."""
    task, start = TASKS[job.sentence], time.process_time()
    scene = world(job)
    lid = scene.object(task.object).truth.lid
    try:
        result = Controller(scene, seed=job.seed).say(task.text)
    except Exception:  # one case that breaks must not end the run
        return Done(job=job, status="crashed", message=traceback.format_exc(limit=-3))
    return Done(
        job=job,
        status=result.status,
        end=result.execution.end if result.execution else "",
        message=result.error.message if result.error else "",
        tries=sum(len(step.plans) for step in result.steps),
        stuck=any(step.stuck is not None for step in result.steps),
        missed=tuple(_missed(check) for check in result.checks if not check.ok),
        figures={} if result.trace is None else figures(task, result.trace, lid),
        simulated=result.execution.duration if result.execution else 0.0,
        processor=time.process_time() - start,
    )


def _missed(check: Check) -> str:
    measured, expected = (
        f"{value:.4g}" if isinstance(value, float) else value
        for value in (check.measured, check.expected)
    )
    return f"{check.quantity} {measured} {check.unit}, asked {check.relation} {expected}"


def figures(task: Task, trace: Trace, lid: Lid | None) -> dict[str, float]:
    """What truly became of the object of a sentence, and of what it was poured into.

    Args:
        task: what was said.
        trace: what happened.
        lid: of the object.
    """
    name = task.object
    found = {
        "moved [mm]": 1e3 * float(np.linalg.norm(trace.displacement(name)[:2])),
        "tilt at the end [°]": math.degrees(tilt_at_end(trace, name)[1]),
    }
    if isinstance(lid, LiftOffLid):
        found["lid [mm]"] = 1e3 * float(trace.lids[name][-1])
    elif lid is not None:
        found["lid [°]"] = math.degrees(trace.lids[name][-1])
    if name == _POURED:
        before, there = trace.contents[name][0], trace.contents[_INTO]
        found["was in it [ml]"] = 1e6 * float(before)
        found["arrived [%]"] = 100.0 * float((there[-1] - there[0]) / before)
        found["spilled [%]"] = 100.0 * float(trace.spilled[-1] / before)
        found["mug moved [mm]"] = 1e3 * float(np.linalg.norm(trace.displacement(_INTO)[:2]))
    return found


def table(results: Sequence[Done]) -> str:
    """What came of each sentence, the figures, and the worlds in which it was not satisfied."""
    lines = [
        "| sentence | runs | satisfied | refused | told | silent | crashed | tries | simulated "
        "| processor |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for sentence, these in _by_sentence(results).items():
        counts = [sum(done.outcome == outcome for done in these) for outcome in _OUTCOMES]
        tries = sum(done.tries for done in these) / len(these)
        simulated, processor = (
            float(np.median([getattr(done, name) for done in these]))
            for name in ("simulated", "processor")
        )
        cells = [sentence, len(these), *counts, f"{tries:.2f}"]
        cells += [f"{simulated:.0f} s", f"{processor:.0f} s"]
        lines.append(_row(cells))
    return "\n".join([*lines, "", *_measured(results), "", *map(_told, _amiss(results))])


def _measured(results: Sequence[Done]) -> list[str]:
    lines = ["| sentence | figure | least | median | largest |", "|---|---|---|---|---|"]
    for sentence, these in _by_sentence(results).items():
        carried = [done.figures for done in these if done.figures]
        for name in dict.fromkeys(name for found in carried for name in found):
            values = [found[name] for found in carried]
            spread = (f"{value:.1f}" for value in (min(values), np.median(values), max(values)))
            lines.append(_row([sentence, name, *spread]))
    return lines


def _by_sentence(results: Sequence[Done]) -> dict[str, list[Done]]:
    groups: dict[str, list[Done]] = {}
    for done in results:
        groups.setdefault(done.job.sentence, []).append(done)
    return groups


def _row(cells: Sequence[object]) -> str:
    return f"| {' | '.join(map(str, cells))} |"


def _amiss(results: Sequence[Done]) -> list[Done]:
    return [done for done in results if done.outcome != "satisfied"]


def _told(done: Done) -> str:
    said = f"{done.job.sentence} {done.job.seed} {done.outcome}"
    details = "; ".join(filter(None, (done.end, done.message, *done.missed)))
    return f"{said}: {details}" if details else said


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--sentence", choices=TASKS, action="append", help="all if not given")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--seeds", type=int, default=20, help="how many")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--record", type=Path, help="file of JSON lines")
    return parser.parse_args()


def main(executor: Executor | None = None) -> int:
    """Runs what the options choose and prints the tables."""
    options = _options()
    seeds = range(options.first, options.first + options.seeds)
    jobs = [Job(sentence, seed) for sentence in options.sentence or TASKS for seed in seeds]
    done = carried_out(
        run,
        jobs,
        Done,
        executor=executor,
        workers=options.workers,
        record=options.record,
        told=_tell,
    )
    print(table(list(done.values())))
    return 0


def _tell(done: Done) -> None:
    print(_told(done), file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
