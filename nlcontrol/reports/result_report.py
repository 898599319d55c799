"""Results as text: what was understood, what will be done and why it works, what happened.

Values are SI inside; people read millimetres, degrees and newtons.
"""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Iterator, Sequence
from html import escape
from itertools import islice
from pathlib import Path

from nlcontrol.checks.verdicts import HAND_ENDS, PLANNED_ENDS, Check
from nlcontrol.outcome_maps import outcome_map_table as maps
from nlcontrol.plan_text import deciding_figures, plan_lines, plan_reason
from nlcontrol.questions.answer import Answer
from nlcontrol.reports.word_explanation import save_explanation
from nlcontrol.results.result import Result, Step
from nlcontrol.text_format import error_lines, join_words, quantity, words
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
        # An answer: its sentence, what stands below it, what would be possible instead.
        yield step.answer.text
        yield from (f"  {line}" for line in step.answer.lines)
        yield from (f"  → {suggestion}" for suggestion in step.answer.suggestions)
        if step.answer.map is not None and step.answer.chart is not None:
            yield ""
            yield from maps.map_lines(step.answer.map, step.answer.chart.face)


def _is_there(result: Result, step: Step | Result) -> bool:
    """True if nothing had to be done, or nothing would have to be."""
    if step.execution is not None:
        return step.execution.end == "reached"
    if step.status != "planned":
        return False
    return not isinstance(step, Step) or result.frames[step.frame].action != "explore"


def default_line(used: DefaultUsed) -> str:
    """One value that the sentence left open."""
    return f"  not said, by default: {used.name} {quantity(used.value, used.unit)} ({used.reason})"


def check_line(text: str, check: Check) -> str:
    """One clause: a mark, its words, what was measured and what was asked.

    Where an observer saw it otherwise, that is told too.
    """
    said = f" “{words(text, check.spans)}”" if check.spans else ""
    measured = value_text(check.measured, check)
    told = f"{check.quantity}: {measured} ({asked_text(check)}{_doubt(check)})"
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
    return (
        f"; an observer saw {value_text(seen.measured, check)}: {'held' if seen.ok else 'not held'}"
    )


def value_text(value: float | str, check: Check) -> str:
    """A value of a check, with its unit."""
    return value if isinstance(value, str) else quantity(value, check.unit)


def asked_text(check: Check) -> str:
    """The asked value with its tolerance: “asked: at most 5°”."""
    expected = value_text(check.expected, check)
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


# Answers to "why": what a result, its plan or its refusal was decided by.


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
        about = f"About {join_words([f'the {name}' for name in named])}: " if named else ""
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
    held = [f"{c.quantity}: {value_text(c.measured, c)}" for c in result.checks]
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
    about = f" ({join_words(list(names))})" if names else ""
    return f"{result.paraphrase or result.text}{about}"


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


# A result as a notebook shows it: sentence, verdicts, picture of the words, report.


# Okabe and Ito's colours, which people with colour blindness tell apart.
_HELD, _MISSED, _GREY = "#00805C", "#C1121F", "#7A7A7A"


def result_html(result: Result) -> str:
    """The result as a fragment of HTML that loads nothing from elsewhere."""
    return "\n".join(_fragments(result))


def _fragments(result: Result) -> Iterator[str]:
    colour = _HELD if result.ok else _GREY if result.status == "undecided" else _MISSED
    yield '<div style="max-width: 60em">'
    yield (
        f'<p><b style="color: {colour}">{escape(result.status.replace("_", " "))}</b> '
        f'<span style="color: {_GREY}">“{escape(result.text)}”</span></p>'
    )
    if result.answer:
        yield f"<p>{escape(result.answer.text)}</p>"
    if result.error:
        yield f"<p>{escape(result.error.code)}: {escape(result.error.message)}</p>"
        yield from (f"<p>→ {escape(hint)}</p>" for hint in result.error.suggestions)
    if result.checks:
        yield '<ul style="list-style: none; padding-left: 0">'
        for check in result.checks:
            mark = {"held": _HELD, "not_held": _MISSED, "unknown": _GREY}[check.verdict]
            yield f'<li style="color: {mark}">{escape(check_line(result.text, check).strip())}</li>'
        yield "</ul>"
    if result.frames:
        yield f'<img alt="words and parameters" style="width: 100%" src="{_picture(result)}">'
    yield '<details open><summary>report</summary><pre style="white-space: pre-wrap">'
    yield f"{escape(report(result))}</pre></details>"
    yield "</div>"


def _picture(result: Result) -> str:
    """The explanation of the words as an address that holds the picture itself."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "words.svg"
        save_explanation(result, path)
        return f"data:image/svg+xml;base64,{base64.b64encode(path.read_bytes()).decode()}"
