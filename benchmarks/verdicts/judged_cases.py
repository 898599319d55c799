"""One case carried out: the robot's own verdicts, the observer's, and a judge's of true poses."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.goals.judge import judged
from benchmarks.verdicts.cases import CAMERAS, Case
from benchmarks.verdicts.moved_limits import moved_limits
from benchmarks.verdicts.redrawn_frames import first_look, with_frames
from grammar.frames.command import Frame
from nlcontrol import Controller
from nlcontrol.checks.frame_checks import check
from nlcontrol.checks.own_accounts import Knowledge
from nlcontrol.checks.own_verdicts import told_clauses, verdicts
from nlcontrol.checks.verdicts import Check
from objectmodels import ObjectModel
from sim.simulated_executor import SimulatedExecutor
from sim.traces.trace import Trace

Row = dict[str, Any]


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
        shown = first_look(trace.sightings, self._since)
        return replace(
            trace, sightings=trace.sightings | {n: shown[n] for n in self.hidden if n in shown}
        )


class RememberingController(Controller):
    """A controller that keeps what its last verdict was made of."""

    judged: tuple[Frame, Trace, dict[str, ObjectModel]]

    def check(self, frame: Frame, trace: Trace) -> tuple[Check, ...]:
        """A verdict for each clause; see `Controller.check`."""
        self.judged = frame, trace, dict(self.models)
        return super().check(frame, trace)


def run(one: Case, camera: str, redrawn: int = 0) -> Row:
    """The row of a case, with verdicts on frames of each camera that are drawn anew so often."""
    scene, begun = one.world(camera), time.perf_counter()
    robot = HidingRobot(scene, seed=one.number)
    if one.trouble == "hidden" or one.suite == "covered":
        robot.hidden = frozenset(robot.cell.names if one.suite == "covered" else [one.box])
    controller = RememberingController(executor=robot)
    models = dict(controller.models)
    row: Row = {
        "suite": one.suite, "number": one.number, "camera": camera, "scene": one.scene,
        "sentence": one.sentence, "trouble": one.trouble,
    }  # fmt: skip
    try:
        result = controller.say(one.sentence)
    except Exception as raised:  # one case that breaks must not end the others
        return {**row, "status": "crashed", "error": repr(raised)}
    told = None
    if result.trace is not None and result.checks and len(result.steps) == 1:
        told = judged(result.frames[-1], result.trace, models)
    return {
        **row,
        "status": result.status,
        "error": None if result.error is None else result.error.code,
        "met": None if told is None else told.met,
        "broken": None if told is None else told.broken,
        "pushes": len(result.steps[-1].plans) if result.steps else 0,
        "seconds": round(time.perf_counter() - begun, 1),
        "checks": [_clause(check) for check in result.checks],
        **(_redrawn(controller, redrawn) if result.checks and redrawn else {}),
    }


LIMITS = 5
"""Limits to which each clause is moved."""


def _redrawn(controller: RememberingController, times: int) -> dict[str, Row]:
    """Verdicts on the last frame's motion with frames that are drawn anew, by camera.

    `redrawn` are those on the limits as they were asked, `moved` on limits near the truth.
    """
    frame, trace, models = controller.judged
    rng = np.random.default_rng([trace.seed, times])
    true = check(frame, trace, models, controller.table, defaults=controller.defaults)
    redrawn: Row = {camera: [] for camera in CAMERAS}
    moved: Row = {camera: [] for camera in CAMERAS}
    for camera, vision in CAMERAS.items():
        known = Knowledge(models, controller.table, vision, controller.defaults)
        for _ in range(times):
            drawn = with_frames(trace, vision, rng)
            redrawn[camera].append([_clause(each) for each in verdicts(frame, drawn, known)])
            told = told_clauses(frame, drawn.perceived, known)
            if len(told) == len(true):
                for one, seen in zip(told, true, strict=True):
                    moved[camera] += moved_limits(one, seen, LIMITS, rng)
    return {"redrawn": redrawn, "moved": moved}


def _clause(check: Check) -> Row:
    seen = check.observed
    return {
        "clause": check.clause, "quantity": check.quantity, "verdict": check.verdict,
        "why": check.why, "low": check.low, "high": check.high, "expected": check.expected,
        "own": check.measured, "true": None if seen is None else seen.measured,
        "ok": None if seen is None else seen.ok,
    }  # fmt: skip
