"""Story of a result for its replay: words in colours, what was foreseen, contacts, verdicts."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING

from nlcontrol.plan_text import plan_lines
from nlcontrol.reports.plan_drawing import end_poses, plan_contacts
from nlcontrol.reports.result_report import asked_text, default_line, value_text
from nlcontrol.reports.word_explanation import part_at
from nlcontrol.text_format import words
from objectmodels.geometry.rotations import from_quaternion
from sim.views.run_story import (
    ContactMark,
    RunStory,
    StoryClause,
    StoryLine,
    StoryRow,
    StoryWord,
)

if TYPE_CHECKING:
    from nlcontrol.results.result import Result, Step
    from planner.plan_explanation import Row
    from sim.traces.trace import Trace


def replay_story(result: Result) -> RunStory:
    """The story of a result that has a trace or a plan."""
    rows = result.explanation_rows()
    error = (f"{result.error.code}: {result.error.message}",) if result.error else ()
    return RunStory(
        title=result.text,
        words=tuple(_words(result.text, rows)),
        understood=result.paraphrase or "",
        left_out=result.left_out,
        status=result.status.replace("_", " "),
        ok=result.ok,
        prediction=tuple(line for step in result.steps for line in prediction_lines(step)),
        rows=tuple(
            StoryRow(each.words, each.part, each.parameter, each.value, each.problem)
            for each in rows
            if each.parameter
        ),
        clauses=tuple(_clauses(result)),
        ghosts=tuple(end_poses(result.steps)),
        contacts=tuple(_contacts(result)),
        notes=(
            *error,
            *result.notes,
            *(default_line(used).strip() for used in result.defaults),
            *(lesson.text for step in result.steps for lesson in step.lessons),
        ),
    )


def _words(text: str, rows: Sequence[Row]) -> Iterator[StoryWord]:
    """The words of a sentence and what is between them."""
    for found in re.finditer(r"\s+|\S+", text):
        part = "" if found[0].isspace() else part_at(rows, *found.span())
        yield StoryWord(found[0], "" if part == "filler" else part, *found.span())


def prediction_lines(step: Step) -> Iterator[StoryLine]:
    """The lines on a plan, each with what it is about as heading."""
    if step.plan is None:
        return
    for line in plan_lines(step.plan):
        heading, colon, rest = line.strip().partition(": ")
        short = colon and len(heading) < 25
        yield StoryLine(f"{heading}:" if short else "", rest if short else line.strip())


def _clauses(result: Result) -> Iterator[StoryClause]:
    checks = [check for step in result.steps for check in step.checks] or result.checks
    for check in checks:
        yield StoryClause(
            verdict=check.verdict,
            said=words(result.text, check.spans),
            spans=check.spans,
            quantity=check.quantity,
            measured=value_text(check.measured, check),
            asked=asked_text(check),
        )


def _contacts(result: Result) -> Iterator[ContactMark]:
    """The contact of the first action of each plan that was carried out, as the robot saw it."""
    trace = result.trace
    if trace is None:
        return
    told = [
        (plan, step.basis.target.rest if step.basis is not None else None)
        for step in result.steps
        for plan in (step.plans or (step.plan,))
        if plan is not None and plan.object in trace.seen
    ]
    since = 0.0
    for (plan, rest), (touch, end) in zip(told, _attempts(trace), strict=False):
        R_WB = from_quaternion(trace.seen[plan.object][touch, :4])
        yield from plan_contacts(plan, R_WB, rest, since)
        since = round(float(trace.time[end] - trace.time[0]), 3)


def _attempts(trace: Trace) -> Iterator[tuple[int, int]]:
    """Samples at which the hand begins to touch, and at which it has let go, of each attempt."""
    first, touch = 0, None
    for phase, members in groupby(trace.phase.tolist()):
        last = first + len(list(members)) - 1
        # With these phases the hand begins to touch what it was to touch.
        if phase in ("touch", "grasp") and touch is None:
            touch = first
        if touch is not None and (phase == "retreat" or last == len(trace.phase) - 1):
            yield touch, last
            touch = None
        first = last + 1
