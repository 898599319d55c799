"""One case: its sentence said to a robot in its world, and what an observer saw of it.

A case is plain data in and out, so that any process may run it: its number goes in, `Done` comes
out. The robot is watched from outside, at the stages of its controller: which plans it made, and
what each step's trace was. A sentence about several things is planned, timed, before it is said to
a robot that carries it out.
"""

from __future__ import annotations

import hashlib
import time
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.goals.judge import TruePlace, Verdict, judged
from benchmarks.goals.sentences import Job, Kind, Sentence, beliefs_of, said
from benchmarks.goals.wishes import Wished, harm, is_met, is_told
from benchmarks.record import Kept
from grammar.frames.command import Frame
from nlcontrol import Registry
from nlcontrol.checks.verdicts import Check
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from objectmodels import ObjectModel
from objectmodels.geometry.rotations import from_quaternion
from planner.types.plan import Plan
from sim.truth.scene_file import Scene

if TYPE_CHECKING:
    from nlcontrol.results.result import Result, Step
    from sim.traces.trace import Trace

GOOD = ("done", "answered")


class Done(Kept[Job]):
    """What came of a case.

    Attributes:
        kind, text: what was said.
        sensible: whether a person would say it.
        status: as in a result, or `crashed`.
        reason, message: code and words of what stopped it.
        accepted: whether every step that was begun had a plan, or there was nothing to plan.
        executed: whether it was carried out, or answered.
        satisfied: whether it came about.
        met: False if the judge of true poses finds a goal missed; None if poses do not tell.
        broken: kinds of the clauses that truly were broken, names of what fell or was stirred.
        seconds: time of the answer if nothing is carried out, of the first plan of several things.
        digest: of all traces; equal if and only if they are equal bit for bit.
    """

    kind: Kind | Wished
    text: str
    sensible: bool
    status: str = "crashed"
    reason: str = ""
    message: str = ""
    accepted: bool = False
    executed: bool = False
    satisfied: bool = False
    met: bool | None = None
    broken: tuple[str, ...] = ()
    seconds: float | None = None
    digest: str = ""

    @property
    def lacking(self) -> bool:
        """Whether the robot lacks what it takes."""
        return self.status in ("unsupported", "not_understood")

    @property
    def falsely_done(self) -> bool:
        """Whether it says that all was done, and a goal was truly missed."""
        return self.status in GOOD and self.met is False

    @property
    def refused(self) -> str:
        """Why it was refused, if it was."""
        counts = not (self.lacking or self.accepted or self.status == "crashed")
        return self.reason if counts else ""


@dataclass
class Watch:
    """What was seen of one step.

    Attributes:
        frame: what was asked; of what was left of it in the end if there was no check.
        plans: every answer of the planner, a refusal included.
        trace: of the whole step, if it was carried out.
        models: what was believed of everything, when it was checked.
    """

    frame: Frame
    plans: list[Any] = field(default_factory=list)
    trace: Trace | None = None
    models: Mapping[str, ObjectModel] = field(default_factory=dict)

    def plan_of(self, step: Step) -> Plan | None:
        """The first plan that could be carried out.

        What is done once something was moved aside was planned by the search for that. A plan
        whose step has no successor is not carried out.
        """
        plan = next((made for made in self.plans if isinstance(made, Plan)), step.plan)
        return None if step.status in ("refused", "unsupported") else plan


class Watched(Controller):
    """A robot that is watched.

    Attributes:
        watches: a step each, in their order.
    """

    def __init__(self, *args: Any, **settings: Any) -> None:
        super().__init__(*args, **settings)
        self.watches: list[Watch] = []
        self._digest = hashlib.sha256()
        self._new = True

    @property
    def digest(self) -> str:
        """Of all traces so far."""
        return self._digest.hexdigest()

    def forget_steps(self) -> None:
        """Begin to watch anew, for a further sentence."""
        self.watches, self._new = [], True

    def true_verdicts(self) -> list[Verdict]:
        """What the judge of true poses says of each step that was carried out."""
        return [judged(w.frame, w.trace, w.models) for w in self.watches if w.trace]

    def plan(self, frame: Frame, *args: Any, **settings: Any) -> Any:
        """See `Controller`."""
        if self._new:
            self.watches.append(Watch(frame))
            self._new = False
        made = super().plan(frame, *args, **settings)
        self.watches[-1].plans.append(made)
        return made

    def execute(self, *args: Any, **settings: Any) -> Trace:
        """See `Controller`."""
        trace = super().execute(*args, **settings)
        for values in (trace.time, trace.joints, *trace.poses.values()):
            self._digest.update(np.ascontiguousarray(values).tobytes())
        return trace

    def check(self, frame: Frame, trace: Trace, *args: Any, **settings: Any) -> tuple[Check, ...]:
        """See `Controller`; with it a step ends."""
        checks = super().check(frame, trace, *args, **settings)
        watch = self.watches[-1]
        watch.frame, watch.trace, watch.models = frame, trace, dict(self.models)
        self._new = True
        return checks


def run(job: Job) -> Done:
    """Carries out a case, or only plans it; what it stumbles over is a result too."""
    scene, sentence = said(job)
    done = Done(job=job, kind=sentence.kind, text=sentence.text, sensible=sentence.sensible)
    try:
        outcome = _said if sentence.wish is None else _wished
        came = outcome(job, scene, sentence)
    except Exception:  # one case that breaks must not end a run of hundreds
        came = {"message": traceback.format_exc(limit=-3)}
    return done.model_copy(update=came)


def _told(result: Result) -> dict[str, Any]:
    """What a result says of itself."""
    error = result.error
    return {
        "status": result.status,
        "reason": error.code if error else "",
        "message": error.message if error else "",
    }


def _said(job: Job, scene: Scene, sentence: Sentence) -> dict[str, Any]:
    """What came of a sentence whose steps are judged one by one."""
    robot, start = Watched(scene, registry=beliefs_of(job), seed=job.seed), time.perf_counter()
    result = Conversation(robot).say(sentence.text, plan_only=not job.executed)
    seconds = time.perf_counter() - start
    begun = list(zip(result.steps, robot.watches, strict=False))
    accepted = bool(begun) and all(watch.plan_of(step) for step, watch in begun)
    verdicts = [
        judged(watch.frame, watch.trace, watch.models)
        for step, watch in begun
        if watch.trace and watch.plan_of(step)
    ]
    known = [each.met for each in verdicts if each.met is not None]
    met = all(known) if known else None
    error = begun[-1][0].error if begun else None
    return _told(result) | {
        "reason": error.code if error else "",
        "accepted": accepted,
        "executed": job.executed and accepted,
        "satisfied": accepted and result.status == "done",
        "met": met,
        "broken": tuple(kind for each in verdicts if each.met for kind in each.broken),
        "seconds": None if job.executed else seconds,
        "digest": robot.digest,
    }


def _wished(job: Job, scene: Scene, sentence: Sentence) -> dict[str, Any]:
    """What came of a sentence about several things, judged by where they were and are."""
    wish, registry = sentence.wish, beliefs_of(job)
    assert wish is not None, "it is about several things"
    start = time.process_time()
    planned = Conversation(Controller(scene, registry=registry, seed=job.seed)).say(
        sentence.text, plan_only=True
    )
    accepted = planned.status in ("planned", "answered", "done")
    came = _told(planned) | {"seconds": time.process_time() - start, "accepted": accepted}
    if planned.answer is not None:
        met = is_told(wish, sentence.text, planned.answer.text, scene.names)
        good = met and planned.status in GOOD
        return came | {"executed": True, "met": met, "satisfied": good}
    if not (job.executed and accepted):
        return came
    result = Conversation(Controller(scene, registry=registry, seed=job.seed)).say(sentence.text)
    before = {
        item.name: TruePlace(
            Registry.built_in().get(item.model), item.pose.R_WB, item.p_WB, fragile=item.fragile
        )
        for item in scene.objects
    }
    after = before if result.trace is None else _after(before, result.trace)
    met = is_met(wish, before, after)
    came |= _told(result)
    return came | {
        "executed": True,
        "met": met,
        "satisfied": met and result.status in GOOD,
        "broken": tuple(harm(wish, before, after)),
    }


def _after(before: Mapping[str, TruePlace], trace: Trace) -> dict[str, TruePlace]:
    """Where everything truly is in the end."""
    after = {}
    for name, was in before.items():
        poses = trace.poses[name]
        ways = np.linalg.norm(poses[:, 4:6] - was.p_WB[:2], axis=1)
        R_WB, p_WB = from_quaternion(poses[-1, :4]), poses[-1, 4:]
        after[name] = replace(was, R_WB=R_WB, p_WB=p_WB, farthest=float(ways.max()))
    return after
