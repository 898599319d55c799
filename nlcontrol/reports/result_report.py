"""Results as text: what was understood, what will be done and why it works, what happened.

Values are SI inside; people read millimetres, degrees and newtons.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from nlcontrol import grasp_plan_text as handwords
from nlcontrol.checks.verdicts import Check
from nlcontrol.outcome_maps import outcome_map_table as maps
from nlcontrol.questions.answer import Answer
from nlcontrol.references.object_names import listed
from nlcontrol.results.result import Result, Step
from nlcontrol.text_format import error_lines, quantity, words
from planner.geometry.directions import phrase
from planner.types.actions import Aim, Limits, Push, PushAction
from planner.types.plan import DefaultUsed, Plan


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
            yield from _step_lines(result, step)
    else:
        yield from _step_lines(result, *(result.steps or (result,)))
    if result.error:
        if result.paraphrase:
            yield ""
        yield from error_lines(result.error, result.text)
    elif result.status == "done" and result.checks:
        yield "Done: every clause held."


def _step_lines(result: Result, step: Step | Result) -> Iterator[str]:
    """The pushes for one frame: their plan, what happened and what that taught; or one answer."""
    if step.plan:
        yield ""
        yield from plan_lines(step.plan)
    elif _is_there(result, step):
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
    """Whether nothing had to be done, or nothing would have to be."""
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
        yield from maps.text(answer.map, answer.chart.face)


def default_line(used: DefaultUsed) -> str:
    """One value that the sentence left open."""
    return f"  not said, by default: {used.name} {quantity(used.value, used.unit)} ({used.reason})"


def plan_lines(plan: Plan) -> Iterator[str]:
    """Where and how hard it will push, why that does what was asked, and what comes after it."""
    if not plan.pushes:
        yield from handwords.plan_lines(plan)
        return
    yield f"Plan: {push_line(plan.push)}."
    yield f"  Predicted: {_prediction(plan.push)}"
    yield f"  Why that is safe: {_safety(plan.push)}"
    if guards := _guards(plan.push.limits):
        yield f"  It is stopped before it {guards}."
    for number, push in enumerate(plan.pushes[1:], start=2):
        yield f"  {number}. Then, as foreseen: {push_line(push)}."
    if plan.aim is not None:
        yield f"  {_end(plan, plan.aim)}"
    yield from (f"  {note}" for note in plan.notes)


def push_line(push: Push) -> str:
    """One push in words: with what, where, which way, how hard, and until when."""
    fingers = "one finger" if push.fingers == 1 else "two fingers"
    apart = f" {quantity(push.spread, 'm')} apart" if push.fingers == 2 else ""
    x, y, _ = push.direction_W
    return (
        f"push the {push.object} with {fingers}{apart} on its {push.face} face, "
        f"{quantity(push.p_BC[2], 'm')} above the table, {phrase(math.atan2(y, x))}, "
        f"with at most {quantity(push.force_limit, 'N')} at {quantity(push.speed, 'm/s')} "
        f"{_extent(push)}"
    )


def _extent(push: Push) -> str:
    """How far, or until when, a push goes."""
    way = quantity(push.stroke, "m")
    event = {
        "moves": "until it moves",
        "touching": f"until it touches the {push.meets}",
        "tips": "until it begins to tip",
    }.get(push.until or "")
    angle = quantity(abs(push.turn), "rad")
    turned = f"{angle} to the {'left' if push.turn > 0.0 else 'right'}"
    if push.ends_on == "tilted":
        return f"{event or 'until it is tilted by ' + quantity(push.tilt, 'rad')}, then let it back"
    if event:
        return f"{event}, at most over {way}"
    if push.ends_on == "turned":
        return f"until it has turned by {turned}"
    if push.ends_on == "toppled":
        return f"until it falls, at most over {way}"
    return f"over {way}" + (f", turning it by {turned}" if round(push.turn, 3) else "")


def _guards(limits: Limits) -> str:
    """What stops a push."""
    told = []
    for clear in dict.fromkeys(clear for _, clear in limits.clear_of):
        names = [f"the {name}" for name, kept in limits.clear_of if kept == clear]
        told.append(f"comes closer than {quantity(clear, 'm')} to {listed(names, 'or')}")
    if limits.tilt is not None:
        told.append(f"tilts by more than {quantity(limits.tilt, 'rad')}")
    if limits.turn is not None:
        told.append(f"turns by more than {quantity(limits.turn, 'rad')}")
    if limits.duration is not None:
        told.append(f"has been pushed for {quantity(limits.duration, 's')}")
    return listed(told, "or")


def _end(plan: Plan, aim: Aim) -> str:
    """Where everything leads, and how sure that is."""
    heading = "" if aim.yaw is None else f", heading {quantity(aim.yaw, 'rad')}"
    pushes = len(plan.pushes)
    sure = f" (probability of all {pushes} pushes {_probability(plan.probability)})"
    return (
        f"It should end at x {quantity(aim.x, 'm')}, y {quantity(aim.y, 'm')}{heading}"
        f"{sure if pushes > 1 else ''}."
    )


_VERBS = {"slide": "slides", "topple": "topples", "none": "stays"}


def _prediction(push: PushAction) -> str:
    p = push.prediction
    starts = [
        f"{verb} would start at {quantity(force, 'N')}"
        for verb, force in (("sliding", p.slide_force), ("toppling", p.topple_force))
        if force is not None
    ]
    verb = {
        "turned": "turns",
        "tilted": "tilts and stands again",
        "toppled": "topples",
    }.get(push.ends_on) or _VERBS.get(p.outcome, p.outcome)
    text = f"it {verb} (probability {_probability(p.probability)}); {', '.join(starts)}."
    if p.critical_height is not None and p.critical_height_worst is not None:
        text += (
            f" Pushed above {quantity(p.critical_height, 'm')} it would topple instead of slide "
            f"({quantity(p.critical_height_worst, 'm')} in the worst case)."
        )
    elif p.topple_force is None:
        text += " It cannot topple this way."
    return text


def _safety(push: PushAction) -> str:
    """How far the push is from the outcome that it must not have."""
    margins = push.margins
    plural = "" if margins.sigmas == 1 else "s"
    case = (
        f"in the worst case of {margins.sigmas:g} standard deviation{plural}, "
        "whichever way it is pressed"
    )
    if push.prediction.critical_height is None:
        return f"no push on this face topples it; {quantity(margins.force, 'N')} to spare, {case}."
    slides = push.prediction.outcome == "slide"
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
