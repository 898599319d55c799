"""One case: drawn, its sentence planned and carried out, and judged by where everything truly is.

A case is drawn by seed, kind and number alone: another kind leaves those of all others as they are.
What stands there has true masses, frictions and centres of mass as in
`nlcontrol.batches.drawn_scenes`. It is drawn again until the sentence makes sense
(`arranged_labels`), `TRIES` times at most; one in ten is drawn blindly.
"""

from __future__ import annotations

import math
import time
import traceback
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple, get_args

import numpy as np

from benchmarks.arrangements.arranged_labels import is_sensible
from benchmarks.arrangements.arranged_sentences import say
from benchmarks.arrangements.arranged_worlds import draw_things, table_of
from benchmarks.arrangements.wishes import Kind, Placed, Wish, harm, is_met, is_told
from benchmarks.goals.worlds import believed, standing
from benchmarks.record import Kept
from nlcontrol import Controller, Registry
from nlcontrol.batches.drawn_scenes import FRAGILE, Generator, draw_truth, scene_of
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.rotations import from_quaternion
from objectmodels.models.shapes import standing_height
from planner.types.world_state import SeenObject
from sim.robots.cell_description import Vision
from sim.truth.scene_file import Pose, Scene, SceneObject

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from sim.traces.trace import Trace


KINDS: tuple[Kind, ...] = get_args(Kind)
TRIES = 30
"""Worlds that are drawn until one makes sense."""
BLIND = 0.1
"""Share of the sentences that need not make sense."""


class Job(NamedTuple):
    """One case: which world and sentence, and whether it is carried out if there is a plan."""

    seed: int
    kind: Kind
    number: int
    executed: bool = True

    def __str__(self) -> str:
        return f"{self.seed}-{self.kind}-{self.number}"


class Asked(NamedTuple):
    """A world, what is said in it and meant by it, and whether a person would say it."""

    scene: Scene
    text: str
    wish: Wish
    sensible: bool


class Done(Kept[Job]):
    """What came of a case.

    Attributes:
        text: what was said.
        sensible: whether a person would say it.
        planned: status of planning alone: `planned` if there was a plan to the end, as far as it
            is foreseen.
        status: as in a result; that of planning if nothing was carried out; or `crashed`.
        reason, message: code and words of what stopped it.
        planning: processor time until the first plan or the refusal, all steps foreseen [s].
        steps: objects that were moved, in order.
        met: whether it truly came about; None if nothing was carried out.
        harmed: names of what fell or was stirred that should not.
        simulated: time of the execution [s].
    """

    text: str
    sensible: bool
    planned: str = ""
    status: str = "crashed"
    reason: str = ""
    message: str = ""
    planning: float = 0.0
    steps: tuple[str, ...] = ()
    met: bool | None = None
    harmed: tuple[str, ...] = ()
    simulated: float = 0.0

    @property
    def accepted(self) -> bool:
        """Whether there was a plan, an answer, or nothing left to do."""
        return self.planned in ("planned", "answered", "done")

    @property
    def falsely_done(self) -> bool:
        """Whether it says that all was done, and it truly was not."""
        return self.status in ("done", "answered") and self.met is False


def run(job: Job) -> Done:
    """Plans a case, and carries it out; what it stumbles over is a result too."""
    asked = draw_case(job)
    scene, text, wish = asked.scene, asked.text, asked.wish
    done = Done(job=job, text=text, sensible=asked.sensible)
    try:
        start = time.process_time()
        planned = Controller(scene, registry=believed(), seed=job.seed).say(text, plan_only=True)
        took = time.process_time() - start
        done = done.model_copy(update={"planning": took, "planned": planned.status})
        done = done.model_copy(update=_told(planned))
        if planned.answer is not None:
            names = [item.name for item in scene.objects]
            met = is_told(wish, text, planned.answer.text, names)
            return done.model_copy(update={"met": met})
        if not (job.executed and done.accepted):
            return done
        robot = Controller(scene, registry=believed(), seed=job.seed)
        result = robot.say(text)
        done = done.model_copy(update=_told(result))
        after = _things_after(scene, result.trace)
    except Exception:  # one case that breaks must not end a run of many
        return done.model_copy(
            update={"status": "crashed", "message": traceback.format_exc(limit=-3)}
        )
    before = _things(scene)
    return done.model_copy(
        update={
            "met": is_met(wish, before, after),
            "harmed": tuple(harm(wish, before, after)),
            "simulated": robot.executor.time,
        }
    )


def _told(result: Result) -> dict[str, object]:
    """What a result says of itself."""
    error = result.error
    return {
        "status": result.status,
        "reason": error.code if error else "",
        "message": error.message if error else "",
        "steps": tuple(f.object.id or "" for f in result.frames if f.object is not None),
    }


def _things(scene: Scene) -> dict[str, Placed]:
    """Where everything truly stands at the start."""
    return {item.name: _placed(item, item.pose.R_WB, item.p_WB) for item in scene.objects}


def _things_after(scene: Scene, trace: Trace | None) -> dict[str, Placed]:
    """Where everything truly is in the end."""
    before = _things(scene)
    if trace is None:
        return before
    after = {}
    for item in scene.objects:
        poses = trace.poses[item.name]
        ways = np.linalg.norm(poses[:, 4:6] - before[item.name].p_WB[:2], axis=1)
        there = _placed(item, from_quaternion(poses[-1, :4]), poses[-1, 4:])
        after[item.name] = replace(there, farthest=float(ways.max()))
    return after


def _placed(item: SceneObject, R_WB: Array, p_WB: Array) -> Placed:
    return Placed(Registry.built_in().get(item.model), R_WB, p_WB, item.fragile)


def draw_case(job: Job) -> Asked:
    """The case of a job."""
    rng = np.random.default_rng((job.seed, job.number, *job.kind.encode()))
    blind = bool(rng.random() < BLIND)
    for _ in range(1 if blind else TRIES):
        things = draw_things(job.kind, rng)
        text, wish = say(job.kind, things, rng)
        truths = [draw_truth(Registry.built_in().get(_model_of(seen)), rng) for seen in things]
        objects = [_scene_object(seen, truth, things)
                   for seen, truth in zip(things, truths, strict=True)]  # fmt: skip
        objects = [item if item.name in (*wish.moved, *wish.told) else _maybe_fragile(item, rng)
                   for item in objects]  # fmt: skip
        scene = scene_of(str(job), objects, Vision())
        scene = scene.model_copy(update={"table": table_of(job.kind)})
        if sensible := is_sensible(wish, standing(scene)):
            break
    return Asked(scene, text, wish, sensible)


def _model_of(seen: SeenObject) -> str:
    return seen.standing_model.name


def _scene_object(seen: SeenObject, truth: object, things: Sequence[SeenObject]) -> SceneObject:
    roll, pitch = 0.0, 0.0
    if seen.pose.attitude is not None:
        R = np.reshape(seen.pose.attitude, (3, 3))
        roll, pitch = (90.0 * round(float(sine)) for sine in (R[2, 1], R[0, 2]))
    z = next((standing_height(other.model) for other in things if other.name == seen.on), 0.0)
    yaw = math.degrees(seen.pose.yaw)
    pose = Pose(x_m=seen.pose.x, y_m=seen.pose.y, z_m=z, yaw_deg=yaw, roll_deg=roll,
                pitch_deg=pitch)  # fmt: skip
    values: dict[str, object] = {
        "name": seen.name,
        "model": _model_of(seen),
        "pose": pose,
        "truth": truth,
    }
    return SceneObject.model_validate(values)


def _maybe_fragile(item: SceneObject, rng: Generator) -> SceneObject:
    return item.model_copy(update={"fragile": bool(rng.random() < FRAGILE)})
