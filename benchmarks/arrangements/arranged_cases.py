"""One case: its sentence planned and carried out, and judged by where everything truly is then."""

from __future__ import annotations

import time
import traceback
from typing import TYPE_CHECKING

from benchmarks.arrangements.arranged_worlds import Job, draw_case
from benchmarks.arrangements.wishes import Kind, Placed, harm, is_met
from benchmarks.goals.worlds import believed
from benchmarks.record import Kept
from nlcontrol import Controller, Registry
from objectmodels.geometry.base_shapes import Array
from sim.rotations import from_quaternion
from sim.truth.scene_file import Scene, SceneObject

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from sim.traces.trace import Trace


class Done(Kept[Job]):
    """What came of a case.

    Attributes:
        kind, text: what was said.
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

    kind: Kind
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
        """Whether there was a plan, or nothing left to do."""
        return self.planned in ("planned", "done")

    @property
    def falsely_done(self) -> bool:
        """Whether it says that all was done, and it truly was not."""
        return self.status == "done" and self.met is False


def run(job: Job, *, plan_only: bool = False) -> Done:
    """Plans a case, and carries it out; what it stumbles over is a result too."""
    asked = draw_case(job)
    scene, text, wish = asked.scene, asked.text, asked.wish
    done = Done(job=job, kind=wish.kind, text=text, sensible=asked.sensible)
    try:
        start = time.process_time()
        planned = Controller(scene, registry=believed(), seed=job.seed).say(text, plan_only=True)
        took = time.process_time() - start
        done = done.model_copy(update={"planning": took, "planned": planned.status})
        done = done.model_copy(update=_told(planned))
        if plan_only or not done.accepted:
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
    if trace is None:
        return _things(scene)
    poses = {item.name: trace.poses[item.name][-1] for item in scene.objects}
    return {
        item.name: _placed(item, from_quaternion(poses[item.name][:4]), poses[item.name][4:])
        for item in scene.objects
    }


def _placed(item: SceneObject, R_WB: Array, p_WB: Array) -> Placed:
    return Placed(Registry.built_in().get(item.model), R_WB, p_WB, item.fragile)
