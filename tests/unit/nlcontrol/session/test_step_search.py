"""The search for other steps: what it may work together with the plan that was refused before."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.events import Supervisor
from nlcontrol.session.foresight import PlanCache
from nlcontrol.session.step_search import (
    MOST_SHARE,
    MOST_WORKS,
    MOST_WORKS_GIVEN_UP,
    ways_around,
)
from planner import planning
from planner.problem.planning_problem import SearchBudget
from planner.types.defaults import CLEARED, DEFAULTS
from planner.types.refusal import Refusal
from planner.types.world_state import obstacle_mark
from tests.unit.planner.conftest import frame_of

MOST_WORK = 1000


@pytest.mark.parametrize(
    ("before", "works"),
    [(0, MOST_WORKS), (MOST_WORK // 2, MOST_WORKS), (MOST_WORK, MOST_WORKS_GIVEN_UP)],
)
def test_an_answer_has_one_budget_and_each_plan_of_the_search_a_share(
    monkeypatch: pytest.MonkeyPatch, before: int, works: float
) -> None:
    numbers = {"tried_work": float(before)} if before else {}
    marks = (obstacle_mark("mug"),)
    refusal = Refusal(
        code="blocked", reason="blocked", message="blocked", numbers=numbers, marks=marks
    )
    allowed: list[int] = []

    def used_up(*_: Any, budget: SearchBudget, **__: Any) -> Refusal:
        allowed.append(budget.most)
        budget.spend(budget.most)
        return refusal

    monkeypatch.setattr(planning, "plan", used_up)
    defaults = replace(DEFAULTS, most_work=MOST_WORK, clear=CLEARED.index("yes"))
    controller = Controller("kitchen", defaults=defaults)
    frames = (frame_of("push the ice tea box away"),)
    refused = refusal, controller.look()
    assert ways_around(controller, frames, 0, refused, Supervisor(), PlanCache()) is None
    assert sum(allowed) == works * MOST_WORK - before
    assert max(allowed) == min(MOST_SHARE * MOST_WORK, works * MOST_WORK - before)
