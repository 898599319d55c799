"""Results as text: what was understood, what will be done and why it works, what happened.

Values are SI inside; people read millimetres, degrees and newtons.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice

from nlcontrol.checks.verdicts import Check
from nlcontrol.outcome_maps import outcome_map_table as maps
from nlcontrol.plan_text import plan_lines
from nlcontrol.questions.answer import Answer
from nlcontrol.results.result import Result, Step
from nlcontrol.text_format import error_lines, quantity, words
from planner.types.plan import DefaultUsed

MARKS = {"held": "✓", "not_held": "✗", "unknown": "?"}
"""Marks of verdicts."""


def report(result: Result) -> str:
    """A whole result as text."""
    return "\n".join(report_lines(result))


def report_lines(result: Result) -> Iterator[str]:
    """The lines of a report: what was understood and planned, and what came of it."""
    if result.paraphrase:
        yield from understanding_lines(result.paraphrase, result.left_out)
    yield from _lines_after_understanding(result, planned=True)


def understanding_lines(paraphrase: str, left_out: Sequence[str]) -> Iterator[str]:
    """What was understood, and the words of the sentence that set nothing."""
    yield f"I understood: {paraphrase}"
    if left_out:
        yield f"  left out: {', '.join(f'“{words}”' for words in left_out)}"


def later_lines(result: Result) -> Iterator[str]:
    """The lines of a report without what was understood and the plans, which were told before."""
    return _lines_after_understanding(result, planned=False)


def conclusion_lines(result: Result) -> Iterator[str]:
    """What came of it, and no more: an error, an answer, a plan, or that it is done."""
    if result.error:
        yield from error_lines(result.error, result.text)
    elif result.answer:
        yield result.answer.text
    elif result.status == "done" and result.checks:
        yield "Done: every clause held."
    elif result.plan:
        yield from islice(plan_lines(result.plan), 1)
    else:
        yield from filter(None, _step_lines(result, *(result.steps or (result,)), planned=True))


def _lines_after_understanding(result: Result, *, planned: bool) -> Iterator[str]:
    yield from (f"  {note}" for note in result.notes)
    if planned:
        yield from dict.fromkeys(map(default_line, result.defaults))
    if len(result.steps) > 1:
        for step in result.steps:
            yield ""
            yield f"Step {step.frame + 1} of {len(result.frames)}: {step.status}"
            yield from _step_lines(result, step, planned=planned)
    else:
        yield from _step_lines(result, *(result.steps or (result,)), planned=planned)
    if result.error:
        if result.paraphrase:
            yield ""
        yield from error_lines(result.error, result.text)
    elif result.status == "done" and result.checks:
        yield "Done: every clause held."


def _step_lines(result: Result, step: Step | Result, *, planned: bool) -> Iterator[str]:
    """The pushes for one frame: their plan, what happened and what that taught; or one answer."""
    if step.plan and planned:
        yield ""
        yield from plan_lines(step.plan)
    elif not step.plan and _is_there(result, step):
        yield ""
        yield "It is there already: nothing is to be done."
    if step.checks:
        times = len(step.plans) if isinstance(step, Step) else 1
        what = "pushes" if step.plan and step.plan.pushes else "tries"
        yield ""
        yield "What happened:" if times < 2 else f"What happened, in {times} {what}:"
        yield from (check_line(result.text, check) for check in step.checks)
    if isinstance(step, Step) and step.lessons:
        yield ""
        yield f"What {'the pushes' if step.plan and step.plan.pushes else 'that'} taught:"
        yield from (f"  {lesson.text}" for lesson in step.lessons)
    if step.answer:
        yield ""
        yield from answer_lines(step.answer)


def _is_there(result: Result, step: Step | Result) -> bool:
    """True if nothing had to be done, or nothing would have to be."""
    if step.execution is not None:
        return step.execution.end == "reached"
    if step.status != "planned":
        return False
    return not isinstance(step, Step) or result.frames[step.frame].action != "explore"


def answer_lines(answer: Answer) -> Iterator[str]:
    """An answer: its sentence, what stands below it, what would be possible instead."""
    yield answer.text
    yield from (f"  {line}" for line in answer.lines)
    yield from (f"  → {suggestion}" for suggestion in answer.suggestions)
    if answer.map is not None and answer.chart is not None:
        yield ""
        yield from maps.map_lines(answer.map, answer.chart.face)


def default_line(used: DefaultUsed) -> str:
    """One value that the sentence left open."""
    return f"  not said, by default: {used.name} {quantity(used.value, used.unit)} ({used.reason})"


def check_line(text: str, check: Check) -> str:
    """One clause: a mark, its words, what was measured and what was asked.

    Where an observer saw it otherwise, that is told too.
    """
    said = f" “{words(text, check.spans)}”" if check.spans else ""
    told = f"{check.quantity}: {measured_text(check)} ({asked_text(check)}{_doubt(check)})"
    return f"  {MARKS[check.verdict]}{said} {told}{_observed(check)}"


def _doubt(check: Check) -> str:
    """Why a clause can be neither confirmed nor denied."""
    if check.why != "too_near":
        return ""
    if check.low is None or check.high is None:
        return "; too near to tell"
    low, high = (quantity(value, check.unit) for value in (check.low, check.high))
    return f"; it is {low} to {high}, too near to tell"


def _observed(check: Check) -> str:
    """What an observer saw, if that is another verdict."""
    seen = check.observed
    if seen is None or not check.differs:
        return ""
    return f"; an observer saw {_value(seen.measured, check)}: {'held' if seen.ok else 'not held'}"


def measured_text(check: Check) -> str:
    """The measured value, with its unit."""
    return _value(check.measured, check)


def _value(value: float | str, check: Check) -> str:
    return value if isinstance(value, str) else quantity(value, check.unit)


def asked_text(check: Check) -> str:
    """The asked value with its tolerance: “asked: at most 5°”."""
    expected = _value(check.expected, check)
    if check.relation == "is" or check.tolerance is None:
        return f"asked: {expected}"
    tolerance = quantity(check.tolerance, check.unit)
    if check.relation == "about":
        return f"asked: {expected} ± {tolerance}"
    bound = "at most" if check.relation == "at_most" else "at least"
    if check.tolerance == 0.0:
        return f"asked: {bound} {expected}"
    if check.expected == 0.0:
        return f"asked: {bound} {tolerance}"
    return f"asked: {bound} {expected}, tolerance {tolerance}"
