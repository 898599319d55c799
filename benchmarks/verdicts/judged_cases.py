"""One case carried out: the robot's own verdicts, the observer's, and a judge's of true poses.

One run in the simulator gives as many sets of frames as are wanted, of any camera: frames are drawn
anew on the motion that truly happened. What the robot did was decided by the frames that it had;
only its verdicts are made of these. Frames go on for a second after the run, as the robot looks
once more.

Of clauses that are carried out as asked nearly all hold, and by a wide margin; how a verdict does
near its limit shows where the limit is moved there: by up to `REACH` of what the robot cannot tell,
to either side of the truth. Some half of the clauses fail then.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field
from scipy.spatial.transform import Rotation, Slerp

from benchmarks.goals.cases import Watched
from benchmarks.goals.judge import judged
from benchmarks.record import Kept
from benchmarks.verdicts.cases import CAMERAS, Job, case
from nlcontrol.checks.frame_checks import check
from nlcontrol.checks.own_accounts import Knowledge
from nlcontrol.checks.own_verdicts import ToldClause, told_clauses, verdicts
from nlcontrol.checks.verdicts import Check, holds
from nlcontrol.session.conversation import Conversation
from sim.robots.cell_description import Vision
from sim.simulated_executor import SimulatedExecutor
from sim.traces.trace import Trace

LOOKS_ON = 1.0
"""After the run [s]."""
LIMITS = 5
"""Limits to which each clause is moved."""
REACH = 4.0
"""Of half the range [low, high] by which a limit is moved at most."""


class Clause(BaseModel):
    """A clause in figures.

    Attributes:
        quantity, verdict, low, high, expected: see `nlcontrol.checks.verdicts.Check`.
        own, true: what the robot and the observer measured.
        ok: the observer's verdict; None without one.
    """

    model_config = ConfigDict(frozen=True)

    quantity: str
    verdict: str
    low: float | None
    high: float | None
    expected: float | str
    own: float | str
    true: float | str | None
    ok: bool | None


class Row(Kept[Job]):
    """What came of a case.

    Attributes:
        sentence, trouble: what was said, and what was wrong.
        status: as in a result, or `crashed`.
        error: what a case stumbled over.
        met, broken: what the judge of true poses says.
        checks: the clauses.
        redrawn: the same on frames that were drawn anew, by camera, once for each time.
        moved: verdicts on limits near the truth, and whether those truly held, by camera.
    """

    sentence: str
    trouble: str
    status: str = "crashed"
    error: str = ""
    met: bool | None = None
    broken: tuple[str, ...] = ()
    checks: tuple[Clause, ...] = ()
    redrawn: dict[str, list[tuple[Clause, ...]]] = Field(default_factory=dict)
    moved: dict[str, list[tuple[str, bool]]] = Field(default_factory=dict)


class HidingRobot(SimulatedExecutor):
    """A robot of which some things are out of sight once the hand has worked on them.

    Control sees them still; only what verdicts are made of is taken away.
    """

    hidden: frozenset[str] = frozenset()
    _since = np.inf

    def execute(self, *args: Any, **options: Any) -> Trace:
        """Carries out a plan; see `SimulatedExecutor.execute`."""
        trace = super().execute(*args, **options)
        working = np.flatnonzero(trace.phase != "look")
        if len(working):
            self._since = min(self._since, float(trace.time[working[0]]))
        return self._left(trace)

    def watch(self, *args: Any, **options: Any) -> Trace:
        """Looks at the table; see `SimulatedExecutor.watch`."""
        return self._left(super().watch(*args, **options))

    def _left(self, trace: Trace) -> Trace:
        shown = {
            name: seen[seen[:, 0] < self._since]
            for name, seen in trace.sightings.items()
            if name in self.hidden
        }
        return replace(trace, sightings=trace.sightings | shown)


def run(job: Job) -> Row:
    """The row of a case, with verdicts on frames of each camera that are drawn anew so often."""
    one = case(job.suite, job.number)
    robot = HidingRobot(one.world(), seed=job.number)
    if job.suite == "covered":
        robot.hidden = frozenset(robot.cell.names)
    elif one.trouble == "hidden":
        robot.hidden = frozenset([one.box])
    controller = Watched(executor=robot)
    models = dict(controller.models)
    row = Row(job=job, sentence=one.sentence, trouble=one.trouble)
    try:
        result = Conversation(controller).say(one.sentence)
    except Exception as raised:  # one case that breaks must not end the others
        return row.model_copy(update={"error": repr(raised)})
    came: dict[str, Any] = {
        "status": result.status,
        "error": result.error.code if result.error else "",
        "checks": tuple(map(_clause, result.checks)),
    }
    if result.trace is not None and result.checks and len(result.steps) == 1:
        truly = judged(result.frames[-1], result.trace, models)
        came |= {"met": truly.met, "broken": truly.broken}
    if result.checks and job.redrawn:
        came |= _redrawn(controller, job.redrawn)
    return row.model_copy(update=came)


def _clause(check: Check) -> Clause:
    seen = check.observed
    return Clause(
        quantity=check.quantity,
        verdict=check.verdict,
        low=check.low,
        high=check.high,
        expected=check.expected,
        own=check.measured,
        true=None if seen is None else seen.measured,
        ok=None if seen is None else seen.ok,
    )


def _redrawn(controller: Watched, times: int) -> dict[str, Any]:
    """Verdicts on the last frame's motion with frames that are drawn anew, by camera.

    `redrawn` are those on the limits as they were asked, `moved` on limits near the truth.
    """
    watch, trace = [(each, each.trace) for each in controller.watches if each.trace][-1]
    frame, models = watch.frame, watch.models
    rng = np.random.default_rng([trace.seed, times])
    true = check(frame, trace, models, controller.table, defaults=controller.defaults)
    redrawn: dict[str, list[tuple[Clause, ...]]] = {camera: [] for camera in CAMERAS}
    moved: dict[str, list[tuple[str, bool]]] = {camera: [] for camera in CAMERAS}
    for camera, vision in CAMERAS.items():
        known = Knowledge(models, controller.table, vision, controller.defaults)
        for _ in range(times):
            drawn = with_frames(trace, vision, rng)
            redrawn[camera].append(tuple(map(_clause, verdicts(frame, drawn, known))))
            told = told_clauses(frame, drawn.perceived, known)
            if len(told) == len(true):
                for one, seen in zip(told, true, strict=True):
                    moved[camera] += moved_limits(one, seen, rng)
    return {"redrawn": redrawn, "moved": moved}


def with_frames(trace: Trace, vision: Vision, rng: np.random.Generator) -> Trace:
    """The trace with frames of a camera; lids and levels stay as they were seen.

    Args:
        trace: with true poses.
        vision: data sheet of the camera.
        rng: of its errors.
    """
    at = np.arange(trace.time[0], trace.time[-1] + LOOKS_ON, 1.0 / vision.rate_hz)
    within = np.clip(at, trace.time[0], trace.time[-1])
    sightings = {}
    for name, poses in trace.poses.items():
        p = np.column_stack([np.interp(within, trace.time, x) for x in poses[:, 4:].T])
        R_WB = Slerp(trace.time, Rotation.from_quat(poses[:, [1, 2, 3, 0]]))(within)
        turn = np.radians(vision.angle_bias_deg) * rng.standard_normal()
        off = np.radians(vision.angle_noise_deg) * rng.standard_normal((len(at), 3))
        seen = Rotation.from_rotvec(off) * Rotation.from_rotvec([0.0, 0.0, turn]) * R_WB
        shift = vision.position_bias_m * rng.standard_normal(3)
        shift = shift + vision.position_noise_m * rng.standard_normal((len(at), 3))
        sightings[name] = np.column_stack([at, seen.as_quat()[:, [3, 0, 1, 2]], p + shift])
    return replace(trace, sightings=sightings)


def moved_limits(
    told: ToldClause, true: Check, rng: np.random.Generator
) -> Iterator[tuple[str, bool]]:
    """Verdicts on limits near the truth, and whether those truly held.

    Args:
        told: what the robot's senses tell of a clause.
        true: an observer's check of the same clause.
        rng: of the limits.
    """
    own = told.verdict()
    if own.low is None or own.high is None or not isinstance(true.measured, float):
        return
    half = max(0.5 * (own.high - own.low), 1e-6)
    for u in rng.uniform(-REACH, REACH, LIMITS):
        # A value asked “about” has two limits; the nearer one is at its tolerance.
        side = 0.0 if true.relation != "about" else (own.tolerance or 0.0) * rng.choice([-1, 1])
        limit = true.measured + side + u * half
        if limit < 0.0 <= true.measured:
            continue
        ok = holds(true.relation, limit, true.measured, true.tolerance or 0.0)
        moved = replace(
            told,
            mean=_asked(told.mean, limit),
            drawn=[None if one is None else _asked(one, limit) for one in told.drawn],
        ).verdict()
        yield moved.verdict, ok


def _asked(check: Check, limit: float) -> Check:
    if check.verdict == "unknown" or not isinstance(check.measured, float):
        return check
    ok = holds(check.relation, limit, check.measured, check.tolerance or 0.0)
    verdict = "held" if ok else "not_held"
    return check.model_copy(update={"expected": limit, "ok": ok, "verdict": verdict})
