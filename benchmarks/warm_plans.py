"""Prints how long plans take where others were made before, over varied tables and sentences.

    python -m benchmarks.warm_plans [--tables 20] [--seed 0] [--task push …]

A table is a built-in scene whose objects are moved by up to `MOVED` and turned by up to `TURNED`;
sentences are drawn for it. The process has planned the task before, at another table. Refusals are
counted apart; so is the first plan at a table. Times are of `Controller.say(…, plan_only=True)`,
from the words to the result. Processor time does not depend on what else the machine does.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from nlcontrol import Controller
from sim.truth.scene_file import Scene, load_scene

Generator = np.random.Generator

MOVED, TURNED = 0.02, 10.0
"""Farthest that an object is moved in its scene, along x and y [m], and turned [degrees]."""

BOXES = ("ice tea box", "cereal box", "coffee box")
SIDES = ("away", "toward me", "to the left", "to the right")
MANNERS = ("", "", " without toppling it", " slowly", " with one finger", " with at most 15 N")


def _one(rng: Generator, choices: Sequence[str]) -> str:
    return choices[int(rng.integers(len(choices)))]


def _push(rng: Generator) -> str:
    said = f"push the {_one(rng, BOXES)} {rng.integers(3, 16)} cm {_one(rng, SIDES)}"
    return said + _one(rng, MANNERS)


def _turn(rng: Generator) -> str:
    sense = _one(rng, ("clockwise", "counterclockwise"))
    return f"turn the {_one(rng, BOXES)} {rng.integers(10, 40)} degrees {sense}"


def _topple(rng: Generator) -> str:
    return f"topple the {_one(rng, BOXES)} {_one(rng, SIDES)}"


def _lift(rng: Generator) -> str:
    return f"lift the {_one(rng, ('mug', 'ice tea'))} by {rng.integers(3, 10)} cm"


def _place(rng: Generator) -> str:
    things = "mug", "ice tea"
    return f"put the {_one(rng, things)} {_one(rng, ('next to', 'behind'))} the ice tea cup"


def _pour(rng: Generator) -> str:
    return f"pour {5 * rng.integers(4, 21)} ml of the ice tea into the mug"


def _open(rng: Generator) -> str:
    return f"open the {_one(rng, ('jar', 'ice tea cup'))}"


TASKS: dict[str, tuple[Callable[[Generator], str], tuple[str, ...], int]] = {
    "push": (_push, ("kitchen", "workbench", "breakfast"), 4),
    "turn": (_turn, ("kitchen", "workbench"), 2),
    "topple": (_topple, ("kitchen", "workbench"), 2),
    "lift": (_lift, ("kitchen",), 2),
    "place": (_place, ("kitchen",), 2),
    "pour": (_pour, ("kitchen",), 4),
    "open": (_open, ("pantry",), 2),
}
"""Sentences of a task, its tables, and how many are said at each."""


def table(name: str, rng: Generator) -> Scene:
    """A built-in scene with its objects moved."""
    scene = load_scene(name)
    objects = []
    for item in scene.objects:
        x, y, turn = rng.uniform(-1.0, 1.0, 3) * (MOVED, MOVED, TURNED)
        pose = item.pose
        moved = {"x_m": pose.x_m + x, "y_m": pose.y_m + y, "yaw_deg": pose.yaw_deg + turn}
        objects.append(item.model_copy(update={"pose": pose.model_copy(update=moved)}))
    return scene.model_copy(update={"objects": tuple(objects)})


class Timed(NamedTuple):
    """How long a plan took.

    Attributes:
        text: what was said.
        status: of the result.
        first: whether nothing was planned at its table before.
        spent, wall: processor and wall time [s].
    """

    text: str
    status: str
    first: bool
    spent: float
    wall: float


def plan_times(task: str, tables: int, seed: int) -> list[Timed]:
    """Times of the plans of a task at some tables."""
    sentence, scenes, said = TASKS[task]
    times = []
    for number in range(tables):
        rng = np.random.default_rng((seed, number))
        controller = Controller(table(scenes[number % len(scenes)], rng), seed=number)
        controller.look()
        for turn in range(said):
            text = sentence(rng)
            wall, spent = time.perf_counter(), time.process_time()
            result = controller.say(text, plan_only=True)
            spent, wall = time.process_time() - spent, time.perf_counter() - wall
            times.append(Timed(text, result.status, turn == 0, spent, wall))
    return times


def _row(what: str, times: Sequence[Timed]) -> str:
    if not times:
        return f"  {what}: none"
    columns = {name: [getattr(each, name) for each in times] for name in ("spent", "wall")}
    figures = [
        f"{name} {1e3 * np.median(column):.0f} and {1e3 * np.quantile(column, 0.95):.0f} ms"
        for name, column in columns.items()
    ]
    return f"  {what} ({len(times)}): {', '.join(figures)}"


def main() -> None:
    """Prints median and 95th percentile of processor and wall time for each task."""
    options = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    options.add_argument("--tables", type=int, default=20)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--task", choices=TASKS, nargs="*", default=list(TASKS))
    options.add_argument("--slow", type=float, default=math.inf, help="list what takes more [s]")
    given = options.parse_args()
    for task in given.task:
        plan_times(task, 1, given.seed + 1)  # the process warms up
        times = plan_times(task, given.tables, given.seed)
        made = [each for each in times if each.status == "planned"]
        print(f"{task}: median and 95th percentile")
        print(_row("plans", made))
        print(_row("of them the first at a table", [each for each in made if each.first]))
        print(_row("refusals", [each for each in times if each.status != "planned"]), flush=True)
        for each in times:
            if each.spent > given.slow:
                print(f"    {1e3 * each.spent:.0f} ms, {each.status}: {each.text}")


if __name__ == "__main__":
    main()
