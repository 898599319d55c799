"""One case carried out: the robot's own verdicts, the observer's, and a judge's of true poses."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.goals.true_judge import judged
from benchmarks.verdicts.cases import Case
from nlcontrol import Controller
from nlcontrol.checks.verdicts import Check
from sim.simulated_executor import SimulatedExecutor
from sim.traces.trace import Trace

Row = dict[str, Any]


class CoveredRobot(SimulatedExecutor):
    """A robot of which a thing is out of its camera's sight once the hand has worked on it.

    Control sees it still; only what verdicts are made of is taken away.
    """

    hidden: frozenset[str] = frozenset()

    def execute(self, *args: Any, **options: Any) -> Trace:
        """Carries out a plan; see `SimulatedExecutor.execute`."""
        return self._covered(super().execute(*args, **options))

    def watch(self, *args: Any, **options: Any) -> Trace:
        """Looks at the table; see `SimulatedExecutor.watch`."""
        trace = super().watch(*args, **options)
        return replace(trace, sightings=self._left(trace, -np.inf))

    def _covered(self, trace: Trace) -> Trace:
        working = np.flatnonzero(trace.phase != "look")
        since = float(trace.time[working[0]]) if len(working) else -np.inf
        return replace(trace, sightings=self._left(trace, since))

    def _left(self, trace: Trace, since: float) -> dict[str, np.ndarray]:
        return {
            name: seen[seen[:, 0] < since] if name in self.hidden else seen
            for name, seen in trace.sightings.items()
        }


def run(one: Case, camera: str) -> Row:
    """The row of a case."""
    scene, begun = one.world(camera), time.perf_counter()
    robot = CoveredRobot(scene, seed=one.number)
    if one.trouble == "hidden" or one.suite == "covered":
        robot.hidden = frozenset(robot.cell.names if one.suite == "covered" else [one.box])
    controller = Controller(executor=robot)
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
    }


def _clause(check: Check) -> Row:
    seen = check.observed
    return {
        "clause": check.clause, "quantity": check.quantity, "verdict": check.verdict,
        "why": check.why, "low": check.low, "high": check.high, "expected": check.expected,
        "own": check.measured, "true": None if seen is None else seen.measured,
        "ok": None if seen is None else seen.ok,
    }  # fmt: skip
