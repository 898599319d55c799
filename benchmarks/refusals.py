"""Refusals of random sentences about random things, each looked through for what no refusal may be.

Two to five boxes, cylinders, prisms and open boxes of random sizes and masses stand on a table, as
slippery to the fingers as 0.02 to 0.3, some of them out of reach; by every other seed they are of
usual sizes and close to each other. A sentence is said of them and planned. What leaves `say` must
be a result, or an error that is no defect; all its numbers finite; and what is named as being in
the way must be in it: without that there is a plan, or more room.

    python -m benchmarks.refusals [--seed 0] [--refusals 2000] [--blocked 200] [--record FILE]

Rows are kept by their seeds, so that a run that was broken off goes on.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import re
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.record import Kept, carried_out
from nlcontrol import Registry
from nlcontrol.errors import ErrorInfo
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from objectmodels import BoxModel, CylinderModel, ObjectModel, PrismModel
from objectmodels.models.object_parts import Cavity
from planner.types.refusal import Refusal
from planner.types.world_state import ObstacleMark
from sim.errors import SceneError
from sim.truth.scene_file import Pose, Scene, parse_scene, scene_with_object

SAID = (
    "lift the {a}", "lift the {a} 30 cm", "lift the {a} with at most 5 N", "lift the {a} gently",
    "put the {a} on the {b}", "put the {a} into the {b}", "put the {a} next to the {b}",
    "put the {a} behind the {b}", "put the {a} between the {b} and the {c}",
    "push the {a} 10 cm away", "push the {a} 60 cm to the left", "push the {a} 2 m away",
    "push the {a} at the top without toppling it", "push the {a} with at most 0.1 N",
    "push the {a} to the {b}", "push the {a} 20 cm to the right at 50 cm/s",
    "pull the {a} 10 cm toward me", "push the {a} away within 1 second",
    "topple the {a}", "topple the {a} to the left", "tilt the {a} by 20 degrees",
    "tilt the {a} by 60 degrees", "turn the {a} by 90 degrees", "turn the {a} by 5 degrees",
    "pour from the {a} into the {b}", "open the {a}", "stand the {a} up", "slide the {a} away",
    "can you lift the {a}?", "what can you do with the {a}?", "how hard is it to push the {a}?",
)  # fmt: skip
IN_THE_WAY = (
    "push the {a} 10 cm away", "push the {a} 20 cm to the left", "push the {a} 20 cm to the right",
    "topple the {a}", "tilt the {a} by 5 degrees", "lift the {a}", "slide the {a} away",
    "turn the {a} by 90 degrees", "put the {a} behind the {b}", "pull the {a} 10 cm toward me",
)  # fmt: skip
"""What is said where things stand close to each other, by every other seed."""

EXTREME = ((0.015, 0.25), (0.015, 0.25), (0.01, 0.35), (0.005, 5.0))
USUAL = ((0.04, 0.1), (0.04, 0.1), (0.06, 0.2), (0.1, 1.0))
"""Ranges of width, depth and height [m], and of the mass [kg]."""

NAMES = ("crate", "drum", "brick", "tower", "basin")
AT_ONCE = 100
"""Sentences between two looks at how many were refused."""


class Row(Kept[int]):
    """What came of one sentence; its job is its seed.

    Attributes:
        said: the sentence.
        status: of the result, or `raised`.
        code: of the error; what was raised, if that was none.
        faults: what no refusal may be, in words.
        blockers: names of what was in the way.
    """

    said: str
    status: str
    code: str | None
    faults: tuple[str, ...] = ()
    blockers: tuple[str, ...] = ()


def drawn_model(rng: np.random.Generator, name: str, *, usual: bool) -> ObjectModel:
    """A thing of a random shape, slippery to the fingers."""
    low, high = np.log(USUAL if usual else EXTREME).T
    x, y, z, mass = (float(each) for each in np.exp(rng.uniform(low, high)))
    friction, finger = rng.uniform(0.05, 0.7), rng.uniform(0.02, 0.3)
    shared: dict[str, Any] = {
        "name": name, "mass": mass, "mass_sd": 0.1 * mass * rng.integers(2),
        "friction": friction, "friction_sd": 0.15 * friction * rng.integers(2),
        "finger_friction": finger, "finger_friction_sd": 0.2 * finger * rng.integers(2),
    }  # fmt: skip
    match rng.integers(4):
        case 0:
            return CylinderModel(radius=x / 2.0, height=z, **shared)
        case 1:
            angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, 3)) + np.array([0.0, 0.3, 0.6])
            corners = np.column_stack([np.cos(angles), np.sin(angles)]) * x / 2.0
            corners -= corners.mean(axis=0)
            with suppress(ValueError):
                return PrismModel(corners=corners.tolist(), height=z, **shared)
        case 2 if min(x, y) > 0.05 and z > 0.02:
            inside = Cavity.model_validate({"size_m": (x - 0.01, y - 0.01), "floor_m": 0.004})
            return BoxModel(size=(x, y, z), inside=inside, **shared)
    return BoxModel(size=(x, y, z), **shared)


def drawn_scene(rng: np.random.Generator, *, crowded: bool) -> tuple[Scene, Registry]:
    """A table with some of them, close to each other or far off, and what is known of them."""
    scene, registry = parse_scene("{version: 1, name: drawn, objects: []}"), Registry()
    table = scene.table.extent
    middle, spread = rng.uniform((0.2, -0.3), (0.7, 0.3)), rng.choice([0.08, 0.12, 0.4])
    spread, least = (0.06, 5) if crowded else (spread, int(rng.integers(2, 6)))
    for name in NAMES[:least]:
        model = drawn_model(rng, name, usual=crowded)
        for _ in range(20):
            x, y = (float(each) for each in rng.normal(middle, spread))
            x = min(max(x, table.x_min + 0.15), table.x_max - 0.15)
            y = min(max(y, table.y_min + 0.15), table.y_max - 0.15)
            pose = Pose(x_m=x, y_m=y, yaw_deg=float(rng.uniform(-180.0, 180.0)))
            with suppress(SceneError):
                scene = scene_with_object(scene, model, pose)
                registry.add(model)
                break
    return scene, registry


def run(seed: int) -> Row:
    """Says one sentence to the robot of a seed, and looks through what comes of it."""
    rng = np.random.default_rng([seed, 43])
    crowded = seed % 2 == 0
    scene, registry = drawn_scene(rng, crowded=crowded)
    names = [str(each) for each in rng.permutation(scene.names)] * 3
    said = str(rng.choice(IN_THE_WAY if crowded else SAID)).format(
        a=names[0], b=names[1], c=names[2]
    )
    controller = Controller(scene, registry=registry, seed=seed)
    try:
        result = Conversation(controller).say(said, plan_only=True)
    except Exception as raised:
        fault = f"raised {type(raised).__name__}: {raised}"
        code = getattr(raised, "code", type(raised).__name__)
        return Row(job=seed, said=said, status="raised", code=code, faults=(fault,))
    faults: list[str] = []
    numbers = result.error.numbers if result.error else {}
    told = " ".join((result.error.message, *result.error.suggestions)) if result.error else ""
    try:
        json.dumps([result.model_dump(mode="json"), numbers], allow_nan=False)
    except ValueError:
        faults.append("a number is not finite")
    if re.search(r"\b(inf|nan)\b", told):
        faults.append("a number is not finite")
    marks = result.steps[-1].marks if result.steps and result.error else ()
    met = dict.fromkeys(mark.object for mark in marks if isinstance(mark, ObstacleMark))
    blockers = tuple(name for name in met if f"the {name}" in told)
    if blockers and result.error is not None and result.error.code == "blocked":
        faults += _not_in_the_way(controller, said, blockers, result.error)
    else:
        blockers = ()
    return Row(
        job=seed,
        said=said,
        status=result.status,
        code=result.error.code if result.error else None,
        faults=tuple(faults),
        blockers=blockers,
    )


def _not_in_the_way(
    controller: Controller, said: str, names: tuple[str, ...], error: ErrorInfo
) -> Iterator[str]:
    """A fault, if there is neither a plan nor more room without what is named."""
    numbers = error.numbers
    if "free" in numbers and any("up to" in each for each in error.suggestions):
        names = tuple(name for name in names if f"the {name}" not in said)
    if not names:
        return
    if told := [name for name in names if f"the {name}" in said]:
        yield f"{told} in the way, which the sentence is about"
        return
    frame, *_ = controller.resolve(controller.parse(said)).frames
    state = controller.look()
    # From the same look: another one's noise may decide what is close.
    rest = {name: seen for name, seen in state.objects.items() if name not in names}
    made = controller.plan(frame, replace(state, objects=rest))
    if isinstance(made, Refusal):
        room = made.numbers.get("free", math.inf)
        if not ("free" in numbers and room > numbers["free"]):
            yield f"{names} in the way, and without it: {made.message}"


def _tell_faults(row: Row) -> None:
    for fault in row.faults:
        print(f"{row.job}: “{row.said}”: {fault}", flush=True)


def main(executor: Executor | None = None) -> int:
    """Goes on until so many were refused, and so many by what is in the way; prints the faults."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--refusals", type=int, default=2000)
    parser.add_argument("--blocked", type=int, default=200)
    parser.add_argument("--record", type=Path)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    rows: dict[int, Row] = {}
    for first in itertools.count(options.seed, AT_ONCE):
        rows |= carried_out(
            run,
            range(first, first + AT_ONCE),
            Row,
            executor=executor,
            workers=options.workers,
            record=options.record,
            told=_tell_faults,
        )
        refused = sum(row.status in ("refused", "unsupported") for row in rows.values())
        blocked = sum(bool(row.blockers) for row in rows.values())
        if refused >= options.refusals and blocked >= options.blocked:
            break
    wrong = [row for row in rows.values() if row.faults]
    print(Counter(f"{row.status} {row.code or ''}" for row in rows.values()))
    print(f"{refused} refusals of {len(rows)} sentences; {blocked} named what is in the way")
    print(f"with a fault: {len(wrong)}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
