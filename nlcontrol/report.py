"""Results as text: what was understood, what will be done and why it works, what happened.

Values are SI inside; people read millimetres, degrees and newtons.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from nlcontrol import maps
from nlcontrol.answers import Answer
from nlcontrol.checks import Check
from nlcontrol.learning import Lesson
from nlcontrol.result import Result
from nlcontrol.text import error_lines, quantity, words
from planner.directions import phrase
from planner.plan import DefaultUsed, Plan


def report(result: Result) -> str:
    """A whole result as text."""
    return "\n".join(_lines(result))


def _lines(result: Result) -> Iterator[str]:
    if result.paraphrase:
        yield f"I understood: {result.paraphrase}"
    yield from (f"  {note}" for note in result.notes)
    yield from dict.fromkeys(map(default_line, result.defaults))
    if len(result.steps) > 1:
        for step in result.steps:
            yield ""
            yield f"Step {step.frame + 1} of {len(result.frames)}: {step.status}"
            yield from _step_lines(result.text, step.plan, step.checks, step.answer, step.lessons)
    else:
        lessons = result.steps[0].lessons if result.steps else ()
        yield from _step_lines(result.text, result.plan, result.checks, result.answer, lessons)
    if result.error:
        if result.paraphrase:
            yield ""
        yield from error_lines(result.error, result.text)
    elif result.status == "done" and result.checks:
        yield "Done: every clause held."


def _step_lines(
    text: str,
    plan: Plan | None,
    checks: Sequence[Check],
    answer: Answer | None,
    lessons: Sequence[Lesson],
) -> Iterator[str]:
    """One push: its plan, what happened and what that taught; or one answer."""
    if plan:
        yield ""
        yield from plan_lines(plan)
    if checks:
        yield ""
        yield "What happened:"
        yield from (check_line(text, check) for check in checks)
    if lessons:
        yield ""
        yield "What the pushes taught:"
        yield from (f"  {lesson.text}" for lesson in lessons)
    if answer:
        yield ""
        yield from answer_lines(answer)


def answer_lines(answer: Answer) -> Iterator[str]:
    """An answer: its sentence, what stands below it, what would be possible instead."""
    yield answer.text
    yield from (f"  {line}" for line in answer.lines)
    yield from (f"  → {suggestion}" for suggestion in answer.suggestions)
    if answer.map is not None and answer.chart is not None:
        yield ""
        yield from maps.text(answer.map, answer.chart.face)


def default_line(used: DefaultUsed) -> str:
    """One value that the sentence left open."""
    return f"  not said, by default: {used.name} {quantity(used.value, used.unit)} ({used.reason})"


def plan_lines(plan: Plan) -> Iterator[str]:
    """Where and how hard it will push, and why that does what was asked."""
    push = plan.push
    fingers = "one finger" if push.fingers == 1 else "two fingers"
    apart = f" {quantity(push.spread, 'm')} apart" if push.fingers == 2 else ""
    yield (
        f"Plan: push the {push.object} with {fingers}{apart} on its {push.face} face, "
        f"{quantity(push.p_BC[2], 'm')} above the table, {_heading(plan)}, "
        f"with at most {quantity(push.force_limit, 'N')} at {quantity(push.speed, 'm/s')} "
        f"over {quantity(push.stroke, 'm')}."
    )
    yield f"  Predicted: {_prediction(plan)}"
    yield f"  Why that is safe: {_safety(plan)}"
    yield from (f"  {note}" for note in plan.notes)


def _heading(plan: Plan) -> str:
    x, y, _ = plan.push.direction_W
    return phrase(math.atan2(y, x))


def _prediction(plan: Plan) -> str:
    p = plan.prediction
    starts = [
        f"{verb} would start at {quantity(force, 'N')}"
        for verb, force in (("sliding", p.slide_force), ("toppling", p.topple_force))
        if force is not None
    ]
    verb = {"slide": "slides", "topple": "topples", "none": "stays"}.get(p.outcome, p.outcome)
    text = f"it {verb} (probability {_probability(p.probability)}); {', '.join(starts)}."
    if p.critical_height is not None and p.critical_height_worst is not None:
        text += (
            f" Pushed above {quantity(p.critical_height, 'm')} it would topple instead of slide "
            f"({quantity(p.critical_height_worst, 'm')} in the worst case)."
        )
    elif p.topple_force is None:
        text += " It cannot topple this way."
    return text


def _safety(plan: Plan) -> str:
    """How far the push is from the outcome that it must not have."""
    margins = plan.margins
    plural = "" if margins.sigmas == 1 else "s"
    case = (
        f"in the worst case of {margins.sigmas:g} standard deviation{plural}, "
        "whichever way it is pressed"
    )
    if plan.prediction.critical_height is None:
        return f"no push on this face topples it; {quantity(margins.force, 'N')} to spare, {case}."
    slides = plan.prediction.outcome == "slide"
    where, other = ("below", "topple") if slides else ("above", "slide")
    return (
        f"the contact is {quantity(margins.height, 'm')} {where} where it could {other} instead, "
        f"and that would take {quantity(margins.force, 'N')} more, {case}."
    )


def _probability(p: float) -> str:
    return "over 0.999" if p > 0.999 else f"{p:.3f}"


def check_line(text: str, check: Check) -> str:
    """One clause: a mark, its words, what was measured and what was asked."""
    mark = "✓" if check.ok else "✗"
    said = f" “{words(text, check.spans)}”" if check.spans else ""
    return f"  {mark}{said} {check.quantity}: {_value(check.measured, check)} ({_asked(check)})"


def _value(value: float | str, check: Check) -> str:
    return value if isinstance(value, str) else quantity(value, check.unit)


def _asked(check: Check) -> str:
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
