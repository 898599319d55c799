"""The budget of work: one for all that a plan tries, and never a clock."""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import dataclass, replace

import pytest

from planner import plan
from planner.clearing import obstacles
from planner.problem.planning_problem import SearchBudget
from planner.types.actions import Push
from planner.types.defaults import DEFAULTS, with_settings
from planner.types.plan import PlanningResult
from planner.types.refusal import Refusal
from planner.types.robot import ReachAnswer, ReachEffort
from planner.types.world_state import WorldState
from tests.unit.planner.conftest import RuledReach, frame_of

SENTENCE = "push the ice tea box away"


@dataclass
class Laborious(RuledReach):
    """A robot that works for its answers, and gets nowhere before so many questions."""

    work: int = 1
    seconds: float = 0.0
    finds: int = 1_000_000

    def reach(self, push: Push, state: WorldState, effort: ReachEffort = "usual") -> ReachAnswer:
        time.sleep(self.seconds)
        answer = super().reach(push, state, effort)
        return replace(answer, ok=len(self.asked) >= self.finds, work=self.work)


def made(robot: RuledReach, kitchen: WorldState, most: int) -> PlanningResult:
    """What comes of the sentence within so much work."""
    defaults = with_settings(DEFAULTS, {"most_work": most})
    return plan(frame_of(SENTENCE), kitchen, robot, defaults=defaults)


def test_a_search_that_is_out_of_work_says_what_was_left(kitchen: WorldState) -> None:
    robot = Laborious(work=100)
    found = made(robot, kitchen, 500)
    assert isinstance(found, Refusal)
    assert (found.code, found.reason) == ("work_used_up", "out_of_time")
    assert 500 <= found.numbers["work"] < 600 + 100
    assert found.numbers["untried"] >= 1
    assert found.numbers["untried_strategies"] >= 1
    # The suggestion is one that the command line and the defaults take, and it leads on.
    option, _, value = found.suggestions[0].removeprefix("--set ").partition("=")
    more = made(Laborious(work=100), kitchen, int(value))
    assert option == "most_work"
    assert isinstance(more, Refusal)
    assert more.numbers.get("work", 1e9) > found.numbers["work"]


def test_a_search_that_is_out_of_work_marks_what_stopped_the_hand_most(
    kitchen: WorldState,
) -> None:
    budget = SearchBudget(100)
    for number, blocker in enumerate(["mug", "vase", "vase", None, "lamp", "lamp", "lamp"]):
        budget.answers[number] = ReachAnswer(blocker is None, "obstacle", blocker=blocker)
    budget.spend(100)
    found = plan(frame_of(SENTENCE), kitchen, RuledReach(), budget=budget)
    assert isinstance(found, Refusal)
    assert found.code == "work_used_up"
    assert obstacles(found) == ("lamp", "vase")


def test_nothing_is_asked_twice_and_all_that_was_asked_is_told(kitchen: WorldState) -> None:
    robot = Laborious(work=7)
    found = plan(frame_of(SENTENCE), kitchen, robot, budget=SearchBudget())
    assert isinstance(found, Refusal)
    assert found.reason == "out_of_reach"
    assert found.numbers["tried_ways"] == len(robot.asked)
    assert found.numbers["tried_work"] >= 7 * len(robot.asked)
    # The same push is asked for once as usual and once thoroughly.
    assert max(Counter(robot.asked).values()) <= 2
    impossible = plan(frame_of("topple the ice tea box at the bottom"), kitchen, Laborious())
    assert isinstance(impossible, Refusal)
    assert impossible.reason == "impossible"
    assert "tried_ways" not in impossible.numbers


def test_all_strategies_share_one_budget(kitchen: WorldState) -> None:
    free = Laborious()
    assert isinstance(made(free, kitchen, 1_000_000), Refusal)
    bounded = Laborious(work=100)
    made(bounded, kitchen, 1000)
    assert len(bounded.asked) <= 10 < len(free.asked)


def test_a_budget_that_others_used_up_is_told(kitchen: WorldState) -> None:
    spent = SearchBudget(100)
    spent.spend(100)
    found = plan(frame_of(SENTENCE), kitchen, RuledReach(), budget=spent)
    assert isinstance(found, Refusal)
    assert (found.code, found.reason) == ("work_used_up", "out_of_time")


@pytest.mark.parametrize("most", [400, 1_000_000])
def test_the_answer_does_not_depend_on_the_speed(kitchen: WorldState, most: int) -> None:
    quick, slow = (
        made(Laborious(work=100, seconds=seconds, finds=6), kitchen, most)
        for seconds in (0.0, 0.02)
    )
    assert quick == slow
    assert quick.status == ("refused" if most == 400 else "planned")


def test_a_budget_that_is_large_enough_changes_nothing(kitchen: WorldState) -> None:
    least, most = (made(Laborious(finds=3), kitchen, work) for work in (200, 1_000_000))
    assert least.status == "planned"
    assert least == most
