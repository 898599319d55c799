"""Answers to "why": what a result, its plan or its refusal was decided by."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from nlcontrol.checks.verdicts import HAND_ENDS, PLANNED_ENDS, Check
from nlcontrol.plan_text import deciding_figures, plan_reason
from nlcontrol.questions.answer import Answer
from nlcontrol.text_format import enumeration, quantity

if TYPE_CHECKING:
    from nlcontrol.results.result import Result


def why_answer(result: Result) -> Answer:
    """Why a sentence was refused, or failed, or is done in this way and no other."""
    missed = [check for check in result.checks if check.verdict == "not_held"]
    unknown = [check for check in result.checks if check.verdict == "unknown"]
    if result.error and unknown and not missed:
        told = "; ".join(map(_unknown_text, unknown))
        text = f"It was executed, but I cannot tell whether it is as asked: {told}."
        return Answer(text=text, numbers=_measured_figures(unknown))
    if result.error and missed:
        told = "; ".join(map(_missed_text, missed))
        text = " ".join((f"It was executed, but {told}.", *_end_texts(result)))
        return Answer(text=text, numbers=_measured_figures(missed))
    if result.error:
        understood = result.status != "not_understood" or result.error.code == "nothing_before"
        failed = "I cannot" if understood else "I did not understand it"
        instead = "".join(f" What would do: {s}." for s in result.error.suggestions[:1])
        text = f"{failed}: {result.error.message}.{instead}"
        return Answer(text=text, numbers=result.error.numbers)
    if result.plan:
        return Answer(text=plan_reason(result.plan), numbers=deciding_figures(result.plan))
    if result.answer and result.answer.query == "possible":
        named = [frame.object.id for frame in result.frames if frame.object and frame.object.id]
        about = f"About {enumeration([f'the {name}' for name in named])}: " if named else ""
        return result.answer.model_copy(update={"text": about + result.answer.text})
    if result.answer:
        return result.answer
    return Answer(text="There was nothing to be done.")


def why_not_answer(result: Result) -> Answer:
    """Why something that nobody asked for is not done: it was not asked for, or it cannot be."""
    answer = why_answer(result)
    if result.error or not result.plan:
        return answer
    told = f"It was not asked for, and could be done. {answer.text}"
    return answer.model_copy(update={"text": told})


def deed_answer(deeds: Sequence[Result], *, first: bool = False) -> Answer:
    """What the last command was, or the first, and what was measured of it.

    Args:
        deeds: what came of all commands; those before the last are told below, in their order.
        first: whether the first is asked for.
    """
    result, before = (deeds[0], ()) if first else (deeds[-1], deeds[:-1])
    names = _names(result)
    lines = tuple(f"{i}. {_told(each)}" for i, each in enumerate(before, 1))
    objects = names if len(names) == 1 else ()
    if not result.checks:
        ends = {"planned": "It was planned, not done", "done": "It was done"}
        why = f": {result.error.message}" if result.error else ""
        text = f"I was told to {_told(result)}. {ends.get(result.status, 'It was not done')}{why}."
        return Answer(query="did", text=text, lines=lines, objects=objects)
    held = [f"{c.quantity}: {_value_text(c.measured, c)}" for c in result.checks]
    ended = {"done": "It was done", "undecided": "It was carried out, and I cannot tell all of it"}
    came = ended.get(result.status, "It failed")
    return Answer(
        query="did",
        text=f"I was told to {_told(result)}. {came}: {'; '.join(held)}.",
        lines=lines,
        objects=objects,
        numbers=_measured_figures(list(result.checks)),
    )


def _names(result: Result) -> tuple[str, ...]:
    return tuple(dict.fromkeys(f.object.id for f in result.frames if f.object and f.object.id))


def _told(result: Result) -> str:
    """What a result was to be, and with which objects."""
    names = _names(result)
    about = f" ({enumeration(list(names))})" if names else ""
    return f"{result.paraphrase or result.text}{about}"


def _value_text(value: float | str, check: Check) -> str:
    return value if isinstance(value, str) else quantity(value, check.unit)


def _missed_text(check: Check) -> str:
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


def _unknown_text(check: Check) -> str:
    if check.low is None or check.high is None or isinstance(check.expected, str):
        return f"{check.quantity} was not perceived"
    low, high = (quantity(value, check.unit) for value in (check.low, check.high))
    return f"{check.quantity} was {low} to {high}, too near to what was asked"


def _end_texts(result: Result) -> Iterator[str]:
    """Why the pushes ended before it was there."""
    execution = result.execution
    if execution is not None and execution.end not in PLANNED_ENDS:
        what = "The hand stopped" if execution.end in HAND_ENDS else "The push ended early"
        yield f"{what}: {execution.detail}."
    if result.steps and result.steps[-1].stuck:
        yield f"Nothing more was done: {result.steps[-1].stuck}."


def _measured_figures(missed: list[Check]) -> dict[str, float]:
    return {check.clause: float(c) for check in missed if not isinstance(c := check.measured, str)}
