"""Story of a result for its replay: words in colours, what was foreseen, contacts, verdicts."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.plan_text import plan_lines
from nlcontrol.reports.result_report import asked_text, default_line, measured_text
from nlcontrol.reports.word_explanation import part_at
from nlcontrol.text_format import words
from sim.rotations import Array, axis_rotation, from_quaternion, quaternion, rot_z
from sim.views.run_story import (
    ContactMark,
    Ghost,
    RunStory,
    StoryClause,
    StoryLine,
    StoryRow,
    StoryWord,
)

if TYPE_CHECKING:
    from nlcontrol.results.result import Result, Step
    from planner.explanation.rows import Row
    from planner.types.actions import Aim, GraspAction, PushAction
    from planner.types.plan import Plan
    from planner.types.world_state import PlanarPose
    from sim.traces.trace import Trace

_BEGINS = ("touch", "grasp")  # phases with which the hand begins to touch what it was to touch


def replay_story(result: Result) -> RunStory:
    """The story of a result that has a trace or a plan."""
    rows = result.explained()
    error = (f"{result.error.code}: {result.error.message}",) if result.error else ()
    return RunStory(
        title=result.text,
        words=tuple(_words(result.text, rows)),
        understood=result.paraphrase or "",
        status=result.status.replace("_", " "),
        ok=result.ok,
        prediction=tuple(line for step in result.steps for line in _prediction(step)),
        rows=tuple(
            StoryRow(each.words, each.part, each.parameter, each.value, each.problem)
            for each in rows
            if each.parameter
        ),
        clauses=tuple(_clauses(result)),
        ghosts=tuple(_ghosts(result.steps)),
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


def _prediction(step: Step) -> Iterator[StoryLine]:
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
            ok=check.ok,
            said=words(result.text, check.spans),
            spans=check.spans,
            quantity=check.quantity,
            measured=measured_text(check),
            asked=asked_text(check),
        )


# -- poses ----------------------------------------------------------------------------------------


def _ghosts(steps: Sequence[Step]) -> Iterator[Ghost]:
    """Poses at the end of each moved object, as predicted."""
    ends = {}
    for step in steps:
        if step.plan is not None and step.before is not None:
            ends[step.plan.object] = _end_pose(step.plan, step.before)
    for name, pose in ends.items():
        if pose is not None:
            yield Ghost(name, tuple(pose.round(6).tolist()))


def _end_pose(plan: Plan, before: PlanarPose) -> Array | None:
    """The predicted pose at the end, as a row of a trace; None if none was predicted."""
    if plan.task == "topple" and plan.pushes:
        return _fallen(plan.push, before)
    if plan.aim is not None:
        return _row(_attitude(before, plan.aim), (plan.aim.x, plan.aim.y, 0.0))
    if plan.pushes and plan.push.displacement is not None:
        return _row(_attitude(before), np.add((before.x, before.y, 0.0), plan.push.displacement))
    return None


def _fallen(push: PushAction, before: PlanarPose) -> Array:
    """Tipped by a right angle about the edge of the base that is opposite of the contact."""
    R_WB, n = _attitude(before), np.array(push.normal_W)
    p_WB = np.array([before.x, before.y, 0.0])
    depth = float((R_WB @ np.array(push.p_BC)) @ n)
    edge = p_WB - depth * n
    R = axis_rotation(np.cross([0.0, 0.0, 1.0], -n), math.pi / 2.0)
    return _row(R @ R_WB, edge + R @ (p_WB - edge))


def _attitude(before: PlanarPose, aim: Aim | None = None) -> Array:
    yaw = before.yaw if aim is None or aim.yaw is None else aim.yaw
    tipped = np.eye(3) if before.attitude is None else np.reshape(before.attitude, (3, 3))
    return np.asarray(rot_z(yaw) @ tipped)


def _row(R: Array, p: Sequence[float] | Array) -> Array:
    return np.concatenate([quaternion(R), p])


# -- contacts -------------------------------------------------------------------------------------


def _contacts(result: Result) -> Iterator[ContactMark]:
    """The contact of the first action of each plan that was carried out, as the robot saw it."""
    trace = result.trace
    if trace is None:
        return
    told = [plan for step in result.steps for plan in (step.plans or (step.plan,)) if plan]
    plans = [plan for plan in told if plan.object in trace.seen]
    since = 0.0
    for plan, (touch, end) in zip(plans, _attempts(trace), strict=False):
        R_WB = from_quaternion(trace.seen[plan.object][touch, :4])
        marks = _push_marks(plan.push, R_WB) if plan.pushes else _grasp_marks(plan.grasp, R_WB)
        for place, outward in marks:
            x, y, z = place.round(5).tolist()
            yield ContactMark(since, plan.object, (x, y, z), tuple(outward.round(5).tolist()))
        since = round(float(trace.time[end] - trace.time[0]), 3)


def _attempts(trace: Trace) -> Iterator[tuple[int, int]]:
    """Samples at which the hand begins to touch, and at which it has let go, of each attempt."""
    first, touch = 0, None
    for phase, members in groupby(trace.phase.tolist()):
        last = first + len(list(members)) - 1
        if phase in _BEGINS and touch is None:
            touch = first
        if touch is not None and (phase == "retreat" or last == len(trace.phase) - 1):
            yield touch, last
            touch = None
        first = last + 1


Mark = tuple[Array, Array]  # a place and the outward normal there, in B


def _push_marks(push: PushAction, R_WB: Array) -> Iterator[Mark]:
    """Places where the fingertips push."""
    n = np.array(push.normal_W) @ R_WB
    along = np.cross([0.0, 0.0, 1.0] @ R_WB, n)
    for side in (-0.5, 0.5) if push.fingers == 2 else (0.0,):
        yield push.p_BC + side * push.spread * along, n


def _grasp_marks(grasp: GraspAction | None, R_WB: Array) -> Iterator[Mark]:
    """Places where thumb and fingers hold an object; a lid's own contacts are on no object."""
    if grasp is None or grasp.part == "lid":
        return
    closing = np.array(grasp.closing_W) @ R_WB
    for side in (-1.0, 1.0):
        yield grasp.p_BG + 0.5 * side * grasp.width * closing, side * closing
