"""Result of a sentence: one value from the words to the verdict."""

from __future__ import annotations

import math
from textwrap import shorten
from typing import Annotated, Literal

import numpy as np
from pydantic import ConfigDict, Field
from pydantic.json_schema import SkipJsonSchema

from grammar.frames.command import Frame
from nlcontrol.checks import trace_measures as measures
from nlcontrol.checks.verdicts import Check
from nlcontrol.errors import INTERNAL, NOT_UNDERSTOOD, OK, ErrorInfo
from nlcontrol.json_document import Document, DocumentPart, document_text
from nlcontrol.learning.learning_reports import ExplorationReport, Lesson
from nlcontrol.questions.answer import Answer
from planner.plan_explanation import Basis, Row
from planner.types.actions import Vector3
from planner.types.plan import DefaultUsed, MotionGuide, Plan
from planner.types.world_state import Held, Mark, PlanarPose
from sim.robots.cell_description import AsItIs
from sim.traces.trace import Trace

ResultStatus = Literal[
    "done",
    "planned",
    "answered",
    "failed",
    "undecided",
    "refused",
    "not_understood",
    "unsupported",
    "cancelled",
]


class Execution(DocumentPart):
    """A trace in a few numbers, for those who read the result as JSON.

    Attributes:
        end: why the push ended.
        detail: the same in words.
        duration: duration of the whole execution, simulated [s].
        displacement: displacement of the pushed object in W [m].
        turned: angle by which it turned about the vertical [rad], counter-clockwise; None if it
            lies at the end, where a heading says nothing.
        largest_tilt: largest tilt on the way [rad].
        largest_force: felt along the push, averaged against the sensors' noise [N]; None if nothing
            was felt.
    """

    end: str
    detail: str
    duration: float
    displacement: Vector3
    turned: float | None
    largest_tilt: float
    largest_force: float | None


def summary(trace: Trace) -> Execution:
    """A trace in a few numbers, as an observer saw it, or else the robot's camera."""
    trace = trace.shown
    x, y, z = trace.displacement(trace.pushed).tolist()
    lies = measures.tilt_at_end(trace, trace.pushed)[1] > math.radians(45)
    return Execution(
        end=trace.end,
        detail=trace.detail,
        duration=float(trace.time[-1] - trace.time[0]),
        displacement=(x, y, z),
        turned=None if lies else float(trace.yaw(trace.pushed)[-1]),
        largest_tilt=float(np.max(trace.tilt(trace.pushed))),
        largest_force=measures.largest_push_force(trace),
    )


class Step(DocumentPart):
    """Result of one frame of a sentence.

    Attributes:
        frame: its place in `Result.frames`, from 0.
        status: status as in `Result`.
        before: pose in which the robot saw the object before it planned.
        plan: the pushes, or what the hand does, as they were planned at first.
        plans: every plan that was made; the first push of each was carried out, or all steps of
            the hand.
        stuck: why nothing more was done before the aim was reached.
        execution: the trace in a few numbers.
        checks: a verdict per clause of this frame.
        lessons: lessons of the pushes about the object, in their order.
        exploration: findings by touch, if the frame asked for them.
        answer: answer, if the frame is a question.
        error: why it went no further.
        marks: of a refusal: where its numbers are on the table; an offer bears them, the JSON
            document of a result does not.
        basis: knowledge at that time; not a part of the JSON document.
    """

    frame: int
    status: ResultStatus
    before: PlanarPose | None = None
    plan: Plan | None = None
    plans: tuple[Plan, ...] = ()
    stuck: str | None = None
    execution: Execution | None = None
    checks: tuple[Check, ...] = ()
    lessons: tuple[Lesson, ...] = ()
    exploration: ExplorationReport | None = None
    answer: Answer | None = None
    error: ErrorInfo | None = None
    marks: SkipJsonSchema[tuple[Mark, ...]] = Field(default=(), exclude=True, repr=False)
    basis: SkipJsonSchema[Annotated[Basis, AsItIs()] | None] = Field(
        default=None, exclude=True, repr=False
    )

    @property
    def heading(self) -> float | None:
        """In which direction its object was to go [rad]; None if it was to go nowhere."""
        if self.plan is None or self.plan.aim is None or self.before is None:
            return None
        aim, here = self.plan.aim, self.before
        return math.atan2(aim.y - here.y, aim.x - here.x)


class Result(Document):
    """Everything that one sentence led to; what is missing was not reached.

    Attributes:
        ok: the sentence was carried out and every clause held (planned only: a plan exists; a
            question: it was answered, be it with no).
        status: `done`, `planned` (nothing was to be executed), `answered` (a question), `failed`
            (executed, but a clause did not hold), `undecided` (executed, and a clause can be
            neither confirmed nor denied), `refused` (no plan, with the reason),
            `unsupported` (a capability that this robot lacks), `not_understood`, `cancelled`
            (told to stop).
        text: the sentence as given.
        paraphrase: the understanding in words.
        left_out: words of the sentence that set nothing: courtesy, and what was taken back.
        frames: the same as data.
        planned: number of planned frames.
        plan: the pushes or the steps of the hand, with what was predicted, of the last frame
            planned.
        guide: what is committed of the plan, for a controller that carries it out; only where it
            is not carried out here.
        execution: the trace in a few numbers.
        checks: a verdict per clause.
        steps: what came of each frame, in the order in which they were carried out; those after
            the first that failed are missing.
        answer: answer to the last question of the sentence, or to a remark.
        notes: plain sentences on how a remark was taken, and on what was left out.
        defaults: defaults for what the sentence left open.
        error: why it is not ok.
        scene: name of the scene.
        seed: seed of all randomness.
        explanation: which words became which parameters, if that was asked for.
        files: written files by kind (`replay`, `trace`, `picture`).
        aside: those of the frames that move something out of the way of others; not a part of the
            JSON document.
        trace: record over time; not a part of the JSON document.
    """

    model_config = ConfigDict(defer_build=True, frozen=True, extra="forbid", allow_inf_nan=False)

    ok: bool
    status: ResultStatus
    text: str
    paraphrase: str | None = None
    left_out: tuple[str, ...] = ()
    frames: tuple[Frame, ...] = ()
    planned: int = 0
    plan: Plan | None = None
    guide: MotionGuide | None = None
    execution: Execution | None = None
    checks: tuple[Check, ...] = ()
    steps: tuple[Step, ...] = ()
    answer: Answer | None = None
    notes: tuple[str, ...] = ()
    defaults: tuple[DefaultUsed, ...] = ()
    error: ErrorInfo | None = None
    scene: str
    seed: int
    explanation: tuple[Row, ...] | None = None
    files: dict[str, str] = Field(default_factory=dict)
    aside: SkipJsonSchema[tuple[Frame, ...]] = Field(default=(), exclude=True, repr=False)
    trace: SkipJsonSchema[Annotated[Trace, AsItIs()] | None] = Field(
        default=None, exclude=True, repr=False
    )

    @property
    def exit_status(self) -> int:
        """Exit code of the command line."""
        return self.error.status.exit if self.error else OK

    def to_json(self, indent: int | None = 2) -> str:
        """The result as one JSON document, in SI units; `nlcontrol schema` describes it."""
        return document_text(self.model_dump(mode="json"), indent)

    def explanation_rows(self) -> tuple[Row, ...]:
        """The way of each word to frame and parameter; empty if nothing was understood."""
        from nlcontrol.reports.word_explanation import word_explanation

        return word_explanation(self) if self.explanation is None else self.explanation

    def report(self) -> str:
        """The result as a text to read."""
        from nlcontrol.reports.result_report import report

        return report(self)

    def __str__(self) -> str:
        return self.report()

    def __repr__(self) -> str:
        code = f" ({self.error.code})" if self.error else ""
        told = ""
        if self.checks:
            told = f"; {sum(check.ok for check in self.checks)} of {len(self.checks)} clauses held"
        return f"<Result {self.status}{code}: “{shorten(self.text, 100, placeholder=' …')}”{told}>"

    def _repr_html_(self) -> str:
        from nlcontrol.reports.result_report import result_html

        return result_html(self)


def result_with(result: Result, **changes: object) -> Result:
    """The result with some fields changed."""
    return result.model_copy(update=changes)


# Ends of steps: the result with one more of them, its status, and what a stop has left.


def result_with_step(
    result: Result, step: Step, status: ResultStatus, reason: ErrorInfo | None = None
) -> Result:
    """The result with the end of one more step."""
    step = step.model_copy(update={"status": status, "error": reason})
    return result_with(
        result, ok=reason is None, status=status, error=reason, steps=(*result.steps, step)
    )


def status_of(info: ErrorInfo) -> ResultStatus:
    """Status of a sentence that is not even planned."""
    return "failed" if info.status.exit == INTERNAL else "not_understood"


def stop_info(held: Held | None, trace: Trace | None) -> ErrorInfo:
    """The way in which a stop has left the robot."""
    told = "it was told to stop before anything moved" if trace is None else trace.detail
    left = "the hand is empty and at rest"
    if held is not None:
        left = f"the hand holds the {held.name} and stands still"
    hint = "say it again" if held is None else "say “put it down”"
    return ErrorInfo(code="interrupted", message=f"{told}; {left}", suggestions=(hint,))


def unanswered_status(info: ErrorInfo) -> ResultStatus:
    """Status of a question without an answer, or of a frame that got no further."""
    if info.code in ("unsupported", "uncheckable"):
        return "unsupported"
    if info.status.exit == INTERNAL:
        return "failed"
    return "not_understood" if info.status.exit == NOT_UNDERSTOOD else "refused"
