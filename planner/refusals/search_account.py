"""Account of a search that found nothing: what was tried, and that it proves nothing.

What is `impossible` follows from the physics of the object, whatever hand pushes it. Where the hand
does not get, a sample of its postures was looked at: another one may still get there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection

    from planner.types.refusal import Refusal
    from planner.types.robot import ReachAnswer

_SEARCHED = ("out_of_reach", "blocked", "out_of_time")


def with_account(refusal: Refusal, answers: Collection[ReachAnswer], work: int) -> Refusal:
    """The refusal with what was tried, if it is one of a search for what the hand can do.

    Args:
        refusal: why there is no plan.
        answers: of the robot, each to another question.
        work: units of work that were done.
    """
    if refusal.reason not in _SEARCHED or not answers:
        return refusal
    ways, postures = len(answers), sum(answer.postures for answer in answers)
    among = f"{ways} ways of the hand" + (f" in {postures} postures" if postures else "")
    account = (
        f"{refusal.message}; none was found among {among} ({work} units of work), which does not "
        "prove that there is none"
    )
    counted = {"tried_ways": ways, "tried_postures": postures, "tried_work": work}
    tried = {name: float(count) for name, count in counted.items()}
    return refusal.model_copy(update={"message": account, "numbers": {**refusal.numbers, **tried}})
