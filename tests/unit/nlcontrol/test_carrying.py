"""Pushes that go otherwise than predicted: learned from, and planned anew."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nlcontrol import Controller
from nlcontrol.result import Result
from planner.defaults import DEFAULTS
from planner.plan import Plan
from sim.trace import Trace
from tests.unit.nlcontrol.pushes import TraceMaker, seen, stuck

SENTENCE = "push the ice tea box away without toppling it"
BOX = "ice tea box"

Says = Callable[..., Result]


class Stage:
    """Plays the simulator: hands out traces made beforehand, the last one again and again."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *traces: Trace) -> None:
        self.traces = list(traces)
        self.executed: list[Plan] = []
        self.told: list[tuple[str, float, str]] = []
        monkeypatch.setattr("sim.execute", self.execute)
        monkeypatch.setattr("sim.DrakeWorld", lambda *_, **__: None)

    def execute(self, plan: Plan, *_: object, progress: Any = None, **__: object) -> Trace:
        self.executed.append(plan)
        return self.traces.pop(0) if len(self.traces) > 1 else self.traces[0]

    def tell(self, *report: Any) -> None:
        self.told.append(report)


@pytest.fixture
def controller() -> Controller:
    return Controller(seed=1)


def tilted(trace: Trace) -> Trace:
    """Stopped because it tilted: the force rises before anything moves, and falls from then on."""
    push = np.flatnonzero(trace.phase == "push")
    before, after = np.array_split(push, [len(push) // 3])
    rise = np.ones(len(trace.time))
    rise[before] = np.linspace(0.0, 1.0, len(before))
    rise[after] = np.linspace(1.0, 0.8, len(after))
    start = {name: p[push[0]] for name, p in trace.tips.items()}
    late = np.zeros(len(trace.time))
    late[after] = np.linspace(0.0, 1.0, len(after))
    late[push[-1] + 1 :] = 1.0
    tips = {
        name: start[name] + np.outer(late, p[-1] - start[name]) for name, p in trace.tips.items()
    }
    felt = {name: rise[:, None] * f for name, f in trace.felt.items()}
    return replace(trace, end="tilted", tips=tips, felt=felt)


def test_planned_anew_after_a_contradiction(
    controller: Controller, make_trace: TraceMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    believed = controller.models[BOX].friction
    stage = Stage(monkeypatch, seen(stuck(make_trace(force=7.0))), seen(make_trace(force=6.0)))
    result = controller.say(SENTENCE, progress=stage.tell)
    assert (result.ok, result.status) == (True, "done")
    first, second = stage.executed
    assert result.plan == second
    assert result.planned == 1  # one frame, however many plans it took
    # It was pushed as hard as the first plan allows; the second one allows more.
    assert second.prediction.onset > first.prediction.onset
    assert second.push.force_limit > first.push.force_limit
    assert controller.models[BOX].friction > believed
    (step,) = result.steps
    stood, went = step.lessons
    assert (stood.moved, stood.contradicts) == ("none", True)
    assert (went.moved, went.contradicts) == ("slide", False)
    assert stage.told[0][0] == "learn"
    assert stage.told[0][2] == stood.text
    assert "What the pushes taught:" in str(result)
    assert stood.text in str(result)
    again = json.loads(result.to_json())["steps"][0]["lessons"]
    assert [lesson["moved"] for lesson in again] == ["none", "slide"]
    assert again[0]["changes"][0].keys() == {
        "parameter", "before", "before_sd", "after", "after_sd"
    }  # fmt: skip


def test_an_end_as_predicted_is_not_planned_anew(
    controller: Controller, make_trace: TraceMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = Stage(monkeypatch, seen(make_trace(travel=(0.05, 0.0), force=3.7)))
    result = controller.say(SENTENCE)
    # Half the way is too short, but nothing was otherwise than predicted.
    assert (result.status, len(stage.executed)) == ("failed", 1)


def test_given_up_after_so_many_plans(
    controller: Controller, make_trace: TraceMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = Stage(monkeypatch, seen(stuck(make_trace(force=4.0))))
    result = controller.say(SENTENCE)
    assert (result.ok, result.status, result.exit_status) == (False, "failed", 5)
    assert len(stage.executed) == DEFAULTS.most_pushes
    assert len(result.steps[0].lessons) == DEFAULTS.most_pushes
    assert result.error is not None
    assert result.error.code == "clause_not_held"
    assert result.trace is not None
    assert len(result.trace.time) == DEFAULTS.most_pushes * len(stage.traces[0].time)
    limits = [plan.push.force_limit for plan in stage.executed]
    # It learns that 4 N are too little, and no more than that from the second time on.
    assert limits[1] > 1.05 * limits[0]
    assert min(limits[1:]) > 0.99 * limits[1]


def test_a_refusal_after_a_contradiction_keeps_what_happened(
    controller: Controller, make_trace: TraceMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    # No two fingertips of this hand push an object that withstood 60 N.
    stage = Stage(monkeypatch, seen(stuck(make_trace(force=60.0))))
    result = controller.say(SENTENCE)
    assert (result.ok, result.status, result.exit_status) == (False, "unsupported", 4)
    assert len(stage.executed) == 1
    assert result.trace is stage.traces[0]
    assert result.execution is not None
    assert result.execution.end == "force"
    (step,) = result.steps
    assert step.execution == result.execution
    assert [lesson.moved for lesson in step.lessons] == ["none"]
    assert step.lessons[0].text in str(result)


def test_the_rest_of_the_way_is_planned(
    controller: Controller, make_trace: TraceMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    part = tilted(seen(make_trace(travel=(0.04, 0.0), force=15.0)))
    rest = seen(make_trace(travel=(0.06, 0.0), force=3.7), moved_by=(0.04, 0.0))
    stage = Stage(monkeypatch, part, rest)
    result = controller.say(SENTENCE)
    first, second = stage.executed
    assert first.displacement == pytest.approx((0.1, 0.0, 0.0))
    assert second.displacement == pytest.approx((0.06, 0.0, 0.0), abs=1e-6)
    assert second.push.stroke == pytest.approx(first.push.stroke - 0.04, abs=0.002)
    # Judged is the whole way, over both pushes.
    assert (result.ok, result.status) == (True, "done")
    assert "displace" in {check.clause for check in result.checks}
    assert result.trace is not None
    assert result.trace.displacement(BOX)[0] == pytest.approx(0.1)
    assert [lesson.moved for lesson in result.steps[0].lessons] == ["topple", "slide"]


def test_a_clause_broken_by_the_first_push_stays_broken(
    controller: Controller, make_trace: TraceMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    part = tilted(seen(make_trace(travel=(0.04, 0.0), force=15.0, tilt=0.8, tilt_at_end=0.0)))
    rest = seen(make_trace(travel=(0.06, 0.0), force=3.7), moved_by=(0.04, 0.0))
    Stage(monkeypatch, part, rest)
    result = controller.say(SENTENCE)
    assert result.status == "failed"
    assert {check.clause for check in result.checks if not check.ok} == {"no_topple"}


def test_what_went_the_whole_way_is_not_pushed_back(
    controller: Controller, make_trace: TraceMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    part = tilted(seen(make_trace(travel=(0.12, 0.0), force=15.0)))
    rest = seen(make_trace(travel=(0.005, 0.0), force=3.7, speed=0.01), moved_by=(0.12, 0.0))
    stage = Stage(monkeypatch, part, rest)
    controller.say(SENTENCE)
    assert stage.executed[1].displacement == pytest.approx((0.005, 0.0, 0.0), abs=1e-6)
