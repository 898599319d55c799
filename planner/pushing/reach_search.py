"""Questions to the robot about pushes: no contact twice, no more than are worth it."""

from __future__ import annotations

import math
from collections.abc import Iterable

from planner.problem.planning_problem import PushProblem
from planner.refusals.blocked import search_given_up
from planner.types.actions import Push, Vector3
from planner.types.robot import FailedPush, ReachAnswer, ReachEffort
from planner.types.world_state import WorldState


class ReachSearch:
    """Questions of one attempt to the robot, within its budget.

    A contact at which a push of the frame has failed is not asked for. What is foreseen for an
    object that will stand elsewhere by then will not stand exactly there, so that the hand must get
    there with the usual effort. The problem is about the object where it stands at first.
    """

    def __init__(self, problem: PushProblem) -> None:
        self._problem = problem
        self._answers: list[ReachAnswer] = []

    @property
    def was_denied(self) -> bool:
        """True if the hand did not get to something that it has not tried before."""
        return any(not answer.ok and answer.reason != "failed" for answer in self._answers)

    def reach(self, push: Push, state: WorldState) -> ReachAnswer:
        """Ask for one push.

        Raises:
            SearchEndedError: the budget is used up.
        """
        if len(self._answers) == self._problem.effort.questions:
            raise search_given_up(self._problem.target.name, self._answers, self._problem.spared)
        answer = self._failed_before(push) or self._robots_answer(push, state)
        self._answers.append(answer)
        return answer

    def _failed_before(self, push: Push) -> ReachAnswer | None:
        for failed in self._problem.failed:
            if not isinstance(failed, FailedPush):
                continue
            other = failed.push
            # Contacts nearer than this count as the same [m].
            near = math.dist(other.p_BC, push.p_BC) < 0.02
            if near and (other.fingers, other.ends_on) == (push.fingers, push.ends_on):
                return ReachAnswer(False, "failed", "tried_before", words={"detail": failed.detail})
        return None

    def _robots_answer(self, push: Push, state: WorldState) -> ReachAnswer:
        now = self._problem.state.objects[push.object].pose
        here, budget = state.objects[push.object].pose, self._problem.budget
        effort: ReachEffort = (
            "thorough" if self._problem.effort.thorough and here == now else "usual"
        )
        # Of one plan nothing but the place of the object changes. What goes as usual goes.
        known = budget.answers.get((push, here, "usual"))
        if known is not None and known.ok:
            return known
        asked = push, here, effort
        return budget.answer_to(asked, lambda: self._problem.robot.reach(push, state, effort))


class ContactQueries:
    """Questions about the contacts of one push of an object, where it stands when that begins.

    Attributes:
        denied: answers about contacts that the hand does not get to.
    """

    def __init__(self, search: ReachSearch, problem: PushProblem) -> None:
        self._search, self._problem = search, problem
        self._asked: dict[int, dict[Vector3, Push]] = {1: {}, 2: {}}
        self.denied: list[ReachAnswer] = []
        self._crowded: list[tuple[Push, ReachAnswer]] = []

    def are_used_up(self, fingers: int) -> bool:
        """Return True if no further contact of so many fingers is asked for."""
        return len(self._asked[fingers]) == self._problem.effort.contacts

    def is_open(self, push: Push) -> bool:
        """Return True if a push may still be asked for, and was not."""
        return not self.are_used_up(push.fingers) and push.p_BC not in self._asked[push.fingers]

    def is_reached(self, push: Push) -> bool:
        """Ask for a push, if it is worth asking for; True if the hand gets there.

        Raises:
            SearchEndedError: the budget is used up.
        """
        asked = self._asked[push.fingers]
        if not self.is_open(push):
            return False
        # A glance is not sure, so one push that looks hopeless is asked for.
        if asked and self._looks_hopeless(push) and any(map(self._looks_hopeless, asked.values())):
            return False
        asked[push.p_BC] = push
        answer = self._crowded_above(push) or self._ask(push)
        if not answer.ok:
            self.denied.append(answer)
        return answer.ok

    def look_above(self, push: Push, others: Iterable[Push]) -> None:
        """Asks for the highest of some pushes over one that no hand has room for.

        If none has room there either, none has between them.
        """
        if self._crowded_above(push) is None:
            return
        above = [each for each in others if _are_in_line(each, push)]
        highest = max(above, key=lambda each: each.p_BC[2], default=push)
        if self._crowded_above(highest) is None:
            self._ask(highest)

    def _ask(self, push: Push) -> ReachAnswer:
        answer = self._search.reach(push, self._problem.state)
        if answer.crowded:
            self._crowded.append((push, answer))
        return answer

    def _crowded_above(self, push: Push) -> ReachAnswer | None:
        """The answer to a push that is no lower on the same line, where no hand had room."""
        for other, answer in self._crowded:
            if _are_in_line(push, other) and push.p_BC[2] <= other.p_BC[2]:
                return answer
        return None

    def forget(self, push: Push) -> None:
        """Lets a push be asked for again."""
        self._asked[push.fingers].pop(push.p_BC, None)

    def _looks_hopeless(self, push: Push) -> bool:
        return self._problem.robot.estimate_reach(push, self._problem.state) == 0.0


def _are_in_line(push: Push, other: Push) -> bool:
    """Return True if two pushes differ by their heights alone, as to the hand's room."""
    same = (push.fingers, push.spread, push.direction_W) == (
        other.fingers,
        other.spread,
        other.direction_W,
    )
    # Contacts nearer than this to a vertical line lie on it [m].
    return same and math.dist(push.p_BC[:2], other.p_BC[:2]) < 1e-4
