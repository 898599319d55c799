"""The budget of one plan, counted in work instead of time: a loaded machine gives the same answer.

A unit is about what a quiet core of today does in a quarter of a millisecond.
`benchmarks.search_work` compares the two.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from planner.refusals.refusal_builder import no_plan
from planner.types.defaults import DEFAULTS, kinds
from planner.types.marks import obstacle_mark
from planner.types.refusal import NoPlanError
from planner.types.robot import ReachAnswer

_MARKED = 2  # obstacles that the dead end names


class SearchBudget:
    """The work that all strategies of one plan may take together.

    Attributes:
        most: units that it may take.
        done: units that it has taken.
        untried: contacts or grasps that were left of one attempt when it was used up.
        answers: of the robot so far, by what was asked; nothing is asked twice.
    """

    def __init__(self, most: int = DEFAULTS.most_work) -> None:
        self.most = most
        self.done = self.untried = 0
        self.answers: dict[object, ReachAnswer] = {}

    def answer_to(self, asked: object, ask: Callable[[], ReachAnswer]) -> ReachAnswer:
        """The robot's answer to a question, which is asked once."""
        if asked not in self.answers:
            self.answers[asked] = answer = ask()
            self.spend(answer.work)
        return self.answers[asked]

    @property
    def is_used_up(self) -> bool:
        """True if no work is left."""
        return self.done >= self.most

    def spend(self, work: int) -> None:
        """Count work that was done."""
        self.done += work

    def require_rest(self, name: str, untried: int) -> None:
        """Make sure that there is work left for contacts or grasps of an object.

        Raises:
            NoPlanError: it is used up.
        """
        if self.is_used_up:
            self.untried = untried
            raise self.dead_end(name, 0)

    def dead_end(self, name: str, strategies: int) -> NoPlanError:
        """Dead end since it is used up, with some other strategies untried.

        Its marks name what stopped the hand most often so far.
        """
        numbers = {
            "work": float(self.done),
            "most_work": float(self.most),
            "untried": float(self.untried),
            "untried_strategies": float(strategies),
        }
        more = min(2.0 * self.most, kinds()["most_work"].most)
        stopped = Counter(each.blocker for each in self.answers.values() if each.blocker)
        marks = tuple(obstacle_mark(each) for each, _ in stopped.most_common(_MARKED))
        made = no_plan("work_used_up", numbers, marks=marks, object=name, more=more)
        return NoPlanError(made.refusal, ends_search=True)
