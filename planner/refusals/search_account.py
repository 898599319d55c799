"""Account of a search that found nothing: what was tried, and that it proves nothing.

What is `impossible` follows from the physics of the object, whatever hand pushes it. Where the hand
does not get, a sample of its postures was looked at: another one may still get there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from planner.problem.search_budget import SearchBudget
    from planner.types.refusal import Refusal

_SEARCHED = ("out_of_reach", "blocked", "out_of_time")


def with_account(refusal: Refusal, budget: SearchBudget) -> Refusal:
    """The refusal with what was tried, if it is one of a search for what the hand can do."""
    if refusal.reason not in _SEARCHED or not budget.answers:
        return refusal
    ways, work = len(budget.answers), budget.done
    postures = sum(answer.postures for answer in budget.answers.values())
    among = f"{ways} ways of the hand" + (f" in {postures} postures" if postures else "")
    account = (
        f"{refusal.message}; none was found among {among} ({work} units of work), which does not "
        "prove that there is none"
    )
    counted = {"tried_ways": ways, "tried_postures": postures, "tried_work": work}
    tried = {name: float(count) for name, count in counted.items()}
    return refusal.model_copy(update={"message": account, "numbers": {**refusal.numbers, **tried}})
