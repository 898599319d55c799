"""One case: its sentence said to a robot in its world, and what an observer saw of it.

A case is plain data in and out, so that any process may run it: its number goes in, `Done` comes
out. The robot is watched from outside, at the stages of its controller: which plan it made first
and how long that took, what each step's trace was, how long executions took.
"""

from __future__ import annotations

import hashlib
import time
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel, ConfigDict

from benchmarks.goals.sentences import Kind, beliefs_of, said
from benchmarks.goals.true_judge import Verdict, judged
from benchmarks.goals.worlds import Job
from benchmarks.record import Kept
from grammar.frames.command import Frame
from nlcontrol import Controller
from nlcontrol.checks.verdicts import Check
from objectmodels import ObjectModel
from planner.types.plan import Plan

if TYPE_CHECKING:
    from nlcontrol.results.result import Step
    from sim.traces.trace import Trace


class Stage(BaseModel):
    """One step of a sentence.

    Attributes:
        goal: its kind; `until` if it lasts until an event.
        status: as in a result.
        planned: whether there was a plan at all.
        reason: code of what stopped it; None if it was satisfied.
        probability: that the first plan stated; None without a plan.
        planning: time in which that plan, or the refusal, was made [s].
        plans: how many were made.
        met, broken: what the judge of `benchmarks.goals.true_judge` says.
    """

    model_config = ConfigDict(frozen=True)

    goal: str
    status: str
    planned: bool
    reason: str | None
    probability: float | None
    planning: float
    plans: int
    met: bool | None = None
    broken: tuple[str, ...] = ()


class Done(Kept[Job]):
    """What came of a case.

    Attributes:
        kind, target, text: what was said.
        sensible: whether a person would say it.
        objects: how many stood there.
        status: as in a result, or `crashed`.
        message: what it says of a failure.
        capability: what the robot lacks, if that is it.
        stages: the steps that were begun.
        wall, simulated: time of all executions [s].
        answering: time of the whole answer, if nothing was to be carried out [s].
        digest: of all traces; equal if and only if they are equal bit for bit.
    """

    kind: Kind
    target: str
    text: str
    sensible: bool
    objects: int
    status: str
    message: str = ""
    capability: str = ""
    stages: tuple[Stage, ...] = ()
    wall: float = 0.0
    simulated: float = 0.0
    answering: float | None = None
    digest: str = ""

    @property
    def lacking(self) -> bool:
        """Whether the robot lacks what it takes, so that neither success nor failure counts."""
        return self.status in ("unsupported", "not_understood")

    @property
    def falsely_done(self) -> bool:
        """Whether it says that all was done, and a goal was truly missed."""
        return self.status == "done" and any(stage.met is False for stage in self.stages)

    @property
    def accepted(self) -> bool:
        """Whether every step that was begun had a plan."""
        return bool(self.stages) and all(stage.planned for stage in self.stages)

    @property
    def refused(self) -> str | None:
        """Why it was refused, if it was."""
        if self.lacking or self.status == "crashed" or self.accepted or not self.stages:
            return None
        return self.stages[-1].reason


@dataclass
class Watch:
    """What was seen of one step.

    Attributes:
        frame: what was asked; of what was left of it in the end if there was no check.
        plans: every answer of the planner, a refusal included.
        planning: time of each [s].
        trace: of the whole step, if it was carried out.
    """

    frame: Frame
    plans: list[Any] = field(default_factory=list)
    planning: list[float] = field(default_factory=list)
    trace: Trace | None = None

    @property
    def plan(self) -> Plan | None:
        """The first plan."""
        return next((made for made in self.plans if isinstance(made, Plan)), None)


class Watched(Controller):
    """A robot that is watched.

    Attributes:
        watches: a step each, in their order.
        wall, simulated: time of all executions [s].
    """

    def __init__(self, *args: Any, **settings: Any) -> None:
        super().__init__(*args, **settings)
        self.watches: list[Watch] = []
        self.wall = self.simulated = 0.0
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
        return [judged(w.frame, w.trace, self.models) for w in self.watches if w.trace]

    def plan(self, frame: Frame, *args: Any, **settings: Any) -> Any:
        """See `Controller`; the time that it takes is noted."""
        if self._new:
            self.watches.append(Watch(frame))
            self._new = False
        watch, start = self.watches[-1], time.perf_counter()
        try:
            made = super().plan(frame, *args, **settings)
        finally:
            watch.planning.append(time.perf_counter() - start)
        watch.plans.append(made)
        return made

    def execute(self, *args: Any, **settings: Any) -> Trace:
        """See `Controller`; the time that it takes is noted."""
        began, start = self.executor.time, time.perf_counter()
        trace = super().execute(*args, **settings)
        self.wall += time.perf_counter() - start
        self.simulated += self.executor.time - began
        for values in (trace.time, trace.joints, *trace.poses.values()):
            self._digest.update(np.ascontiguousarray(values).tobytes())
        return trace

    def check(self, frame: Frame, trace: Trace, *args: Any, **settings: Any) -> tuple[Check, ...]:
        """See `Controller`; with it a step ends."""
        checks = super().check(frame, trace, *args, **settings)
        watch = self.watches[-1]
        watch.frame, watch.trace = frame, trace
        self._new = True
        return checks


def run(job: Job) -> Done:
    """Carries out a case, or only plans it; what it stumbles over is a result too."""
    scene, sentence = said(job)
    done = Done(
        job=job,
        kind=sentence.kind,
        target=sentence.target,
        text=sentence.text,
        sensible=sentence.sensible,
        objects=len(scene.objects),
        status="crashed",
    )
    controller = Watched(scene, registry=beliefs_of(job), seed=job.seed)
    start = time.perf_counter()
    try:
        result = controller.say(sentence.text, plan_only=not job.executed)
        answering = None if job.executed else time.perf_counter() - start
        stages = tuple(
            stage_of(step, watch, controller.models)
            for step, watch in zip(result.steps, controller.watches, strict=False)
        )
    except Exception:  # one case that breaks must not end a run of hundreds
        return done.model_copy(update={"message": traceback.format_exc(limit=-3)})
    return done.model_copy(
        update={
            "status": result.status,
            "message": result.error.message if result.error else "",
            "capability": (result.error.capability or "") if result.error else "",
            "stages": stages,
            "wall": controller.wall,
            "simulated": controller.simulated,
            "answering": answering,
            "digest": controller.digest,
        }
    )


def stage_of(step: Step, watch: Watch, models: Mapping[str, ObjectModel]) -> Stage:
    """What came of one step that was watched."""
    # What is done once something was moved aside was planned by the search for that.
    plan, frame = watch.plan or step.plan, watch.frame
    truly = judged(frame, watch.trace, models) if watch.trace and plan else Verdict(None)
    until = any(clause.kind == "until" for clause in frame.constraints)
    return Stage(
        goal="until" if until else frame.goal.kind,
        status=step.status,
        # A plan whose step has no successor is not carried out.
        planned=plan is not None and step.status not in ("refused", "unsupported"),
        reason=step.error.code if step.error else None,
        probability=plan.probability if plan else None,
        planning=watch.planning[0],
        plans=len(watch.plans),
        met=truly.met,
        broken=truly.broken,
    )
