"""Why it came out as it did: the last result in one or two sentences, from its own numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from nlcontrol import grasp_plan_text as handwords
from nlcontrol.checks.verdicts import HAND_ENDS, PLANNED_ENDS
from nlcontrol.questions.answer import Answer
from nlcontrol.text_format import quantity
from planner.geometry.directions import phrase

if TYPE_CHECKING:
    from nlcontrol.checks.verdicts import Check
    from nlcontrol.results.result import Result
    from planner.types.actions import PushAction
    from planner.types.plan import Plan


def reason(result: Result) -> Answer:
    """Why a sentence was refused, or failed, or is done in this way and no other."""
    missed = [check for check in result.checks if not check.ok]
    if result.error and missed:
        told = "; ".join(map(_missed, missed))
        text = " ".join((f"It was executed, but {told}.", *_ended(result)))
        return Answer(text=text, numbers=_measured(missed))
    if result.error:
        understood = result.status != "not_understood" or result.error.code == "nothing_before"
        failed = "I cannot" if understood else "I did not understand it"
        instead = "".join(f" What would do: {s}." for s in result.error.suggestions[:1])
        text = f"{failed}: {result.error.message}.{instead}"
        return Answer(text=text, numbers=result.error.numbers)
    if result.plan:
        if result.plan.pushes:
            return Answer(text=_chosen(result.plan), numbers=_deciding(result.plan.push))
        return Answer(text=_held(result.plan), numbers=handwords.deciding(result.plan))
    if result.answer:
        return result.answer
    return Answer(text="There was nothing to be done.")


def _missed(check: Check) -> str:
    if isinstance(check.measured, str) or isinstance(check.expected, str):
        return f"{check.quantity} was {check.measured} instead of {check.expected}"
    bound = {"at_most": "at most ", "at_least": "at least "}.get(check.relation, "")
    spare = f" ± {quantity(check.tolerance, check.unit)}" if check.tolerance and not bound else ""
    limit = check.expected
    if bound and check.tolerance and check.expected == 0.0:
        limit = check.tolerance
    return (
        f"{check.quantity} was {quantity(check.measured, check.unit)}, "
        f"where {bound}{quantity(limit, check.unit)}{spare} was asked"
    )


def _ended(result: Result) -> Iterator[str]:
    """Why the pushes ended before it was there."""
    execution = result.execution
    if execution is not None and execution.end not in PLANNED_ENDS:
        what = "The hand stopped" if execution.end in HAND_ENDS else "The push ended early"
        yield f"{what}: {execution.detail}."
    if result.steps and result.steps[-1].stuck:
        yield f"Nothing more was done: {result.steps[-1].stuck}."


def _measured(missed: list[Check]) -> dict[str, float]:
    return {check.clause: float(c) for check in missed if not isinstance(c := check.measured, str)}


def _held(plan: Plan) -> str:
    """What the hand does, and the numbers by which that works."""
    why = handwords.reasons(plan) or handwords.predicted(plan)
    notes = f" Besides: {'; '.join(plan.notes)}." if plan.notes else ""
    return f"To {plan.task} the {plan.object}: {handwords.doing(plan)}; {'; '.join(why)}.{notes}"


def _chosen(plan: Plan) -> str:
    push = plan.push
    x, y, _ = push.direction_W
    way = {
        "stroke": f"moves {phrase(math.atan2(y, x))}",
        "turned": "turns",
        "tilted": "tilts and stands again",
        "toppled": "falls over",
    }[push.ends_on]
    later = len(plan.pushes) - 1
    more = f" It is the first of {later + 1} pushes, as foreseen." if later else ""
    notes = f" Besides: {'; '.join(plan.notes)}." if plan.notes else ""
    return (
        f"Pushed on its {push.face} face, {quantity(push.p_BC[2], 'm')} above the table, the "
        f"{push.object} {way}, since {_other_outcome(push)}. "
        f"It starts to move at {quantity(push.prediction.onset, 'N')}, "
        f"so at most {quantity(push.force_limit, 'N')} are used.{more}{notes}"
    )


def _other_outcome(push: PushAction) -> str:
    """Where it would do something else."""
    p = push.prediction
    if p.critical_height is None or p.critical_height_worst is None:
        return "no push on this face topples it"
    verb, side = ("topple", "above") if p.outcome == "slide" else ("slide", "below")
    return (
        f"it would {verb} only when pushed {side} {quantity(p.critical_height, 'm')}, and "
        f"{side} {quantity(p.critical_height_worst, 'm')} in the worst case"
    )


def _deciding(push: PushAction) -> dict[str, float]:
    p = push.prediction
    numbers = {
        "contact_height": push.p_BC[2],
        "critical_height": p.critical_height,
        "critical_height_worst": p.critical_height_worst,
        "margin_height": push.margins.height,
        "margin_force": push.margins.force,
        "onset_force": p.onset,
        "force_limit": push.force_limit,
    }
    return {name: value for name, value in numbers.items() if value is not None}
