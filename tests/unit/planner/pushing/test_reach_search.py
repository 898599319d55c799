"""Questions to the robot: within a budget, and never where a push has failed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from planner.problem.planning_problem import PushProblem, PushStep
from planner.pushing import contact_planner
from planner.pushing.contact_planner import best_push
from planner.pushing.contact_sampling import Contacts, rate_contacts
from planner.pushing.reach_search import ContactQueries, ReachSearch
from planner.refusals.blocked import Blocked, SearchEndedError
from planner.types.actions import Push
from planner.types.defaults import DEFAULTS
from planner.types.robot import FailedPush, ReachAnswer
from planner.types.world_state import PlanarPose, WorldState
from tests.unit.planner.conftest import RuledReach, frame_of, planned, problem_of

SENTENCE = "push the ice tea box away"


@pytest.mark.parametrize("thorough", [False, True])
def test_a_contact_that_has_failed_is_not_tried_again(kitchen: WorldState, thorough: bool) -> None:
    robot = RuledReach()
    push = planned(SENTENCE, kitchen, robot).push
    problem = problem_of(frame_of(SENTENCE), kitchen, DEFAULTS, robot)
    problem = replace(problem, effort=replace(problem.effort, thorough=thorough))
    assert ReachSearch(problem).reach(push, kitchen).ok
    search = ReachSearch(replace(problem, failed=(FailedPush(push, "it slipped off"),)))
    answer = search.reach(push, kitchen)
    assert (answer.ok, answer.reason) == (False, "failed")
    assert not search.was_denied
    # Contacts up to 20 mm from it count as the same.
    for off, is_tried in ((0.019, False), (0.021, True)):
        aside = push.model_copy(update={"p_BC": (push.p_BC[0], push.p_BC[1], push.p_BC[2] + off)})
        assert search.reach(aside, kitchen).ok == is_tried


def test_a_budget_that_is_used_up_ends_the_search(kitchen: WorldState) -> None:
    robot = RuledReach(lambda _: False)
    push = planned(SENTENCE, kitchen).push
    problem = problem_of(frame_of(SENTENCE), kitchen, DEFAULTS, robot)
    search = ReachSearch(replace(problem, effort=replace(problem.effort, questions=2)))
    search.reach(push, kitchen)
    search.reach(push, kitchen)
    with pytest.raises(SearchEndedError) as ended:
        search.reach(push, kitchen)
    assert ended.value.blocked.reason == "out_of_time"
    assert ended.value.blocked.numbers["looks"] == 2.0


def test_only_what_stands_as_now_is_looked_at_thoroughly(kitchen: WorldState) -> None:
    robot = RuledReach(lambda _: False, last=lambda _: True)
    push = planned(SENTENCE, kitchen).push
    problem = problem_of(frame_of(SENTENCE), kitchen, DEFAULTS, robot)
    search = ReachSearch(replace(problem, effort=replace(problem.effort, thorough=True)))
    assert search.reach(push, kitchen).ok
    later = problem.with_target(replace(problem.target, pose=PlanarPose(0.5, 0.0)))
    assert not search.reach(push, later.state).ok


def test_what_goes_as_usual_is_not_looked_at_thoroughly(kitchen: WorldState) -> None:
    robot = RuledReach()
    push = planned(SENTENCE, kitchen).push
    problem = problem_of(frame_of(SENTENCE), kitchen, DEFAULTS, robot)
    usual = ReachSearch(problem).reach(push, kitchen)
    thorough = replace(problem, effort=replace(problem.effort, thorough=True))
    assert ReachSearch(thorough).reach(push, kitchen) == usual
    assert len(robot.asked) == 1


class _Crowded(ReachSearch):
    """A search in which no hand has room anywhere, or the arm gets nowhere."""

    def __init__(self, problem: PushProblem, *, crowded: bool) -> None:
        super().__init__(problem)
        self.asked: list[Push] = []
        self._crowded = crowded

    def reach(self, push: Push, state: WorldState) -> ReachAnswer:
        self.asked.append(push)
        return ReachAnswer(ok=False, reason="obstacle", blocker="jar", crowded=self._crowded)


def test_where_no_hand_has_room_nothing_is_asked_below(kitchen: WorldState) -> None:
    """Two contacts one above the other: the upper one tells of all that lie between."""
    robot = RuledReach(lambda _: False)
    push = planned(SENTENCE, kitchen).push
    x, y, z = push.p_BC
    low, middle, high = (
        push.model_copy(update={"p_BC": (x, y, z + up)}) for up in (0.0, 0.01, 0.02)
    )
    problem = problem_of(frame_of(SENTENCE), kitchen, DEFAULTS, robot)
    for crowded in (True, False):
        search = _Crowded(problem, crowded=crowded)
        queries = ContactQueries(search, problem)
        assert not queries.is_reached(low)
        queries.look_above(low, (middle, high))
        assert not queries.is_reached(middle)
        assert len(queries.denied) == 2
        assert search.asked == ([low, high] if crowded else [low, middle])


def test_no_contact_is_asked_for_twice(kitchen: WorldState) -> None:
    robot = RuledReach(lambda _: False)
    push = planned(SENTENCE, kitchen).push
    problem = problem_of(frame_of(SENTENCE), kitchen, DEFAULTS, robot)
    queries = ContactQueries(ReachSearch(problem), problem)
    assert not queries.is_reached(push)
    assert not queries.is_reached(push)
    assert (len(robot.asked), len(queries.denied)) == (1, 1)


def test_contacts_are_rated_as_long_as_more_are_asked_for(
    kitchen: WorldState, monkeypatch: pytest.MonkeyPatch
) -> None:
    rated: list[int] = []

    def counted(*args: Any) -> Iterator[list[Contacts]]:
        for case in rate_contacts(*args):
            rated.append(args[-1])
            yield case

    monkeypatch.setattr(contact_planner, "rate_contacts", counted)
    robot = RuledReach(lambda _: False)
    problem = problem_of(frame_of(SENTENCE), kitchen, DEFAULTS, robot)
    few = replace(problem, effort=replace(problem.effort, contacts=1))
    step = PushStep.from_goal(problem.goal)
    why = best_push(few, step, ReachSearch(few))
    assert isinstance(why, Blocked)
    assert why.reason == "out_of_reach"
    # The surest case of two fingers, and of one, has a contact; there are six of each.
    assert rated == [2, 1]
