"""Frame after frame: plan, push, learn, check; and plan anew when the object is not as believed.

Each frame is planned from a look of its own, after the one before it was carried out. What the
pushing fingers felt updates the model of the object. An outcome that contradicts the prediction
(nothing moved where it should, it tilted where it should slide, it slid where it should tilt) stops
the push; what it taught goes into the model and the rest of the frame is planned anew, a few times
at most. Clauses are checked over everything that happened for the frame.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from grammar import frames as g
from nlcontrol.checks import not_held
from nlcontrol.errors import NOT_UNDERSTOOD, ControlError, ErrorInfo, refusal_error
from nlcontrol.learning import Lesson, learned
from nlcontrol.result import Result, ResultStatus, Step, summary, with_
from planner.explain import Basis
from planner.plan import Plan, Refusal
from planner.state import WorldState
from sim.trace import Trace, joined

if TYPE_CHECKING:
    from nlcontrol.controller import Controller, Progress

MOST_PLANS = 6
"""Plans made for one frame before it is given up."""

_DONE = 0.001  # way that counts as a part of what was asked [m]
_REST = 0.005  # least way that is planned for what remains [m]


def carry_out(
    controller: Controller,
    command: g.Command,
    result: Result,
    *,
    plan_only: bool = False,
    progress: Progress | None = None,
) -> Result:
    """Does what a command says, frame after frame, up to the first that fails.

    With `plan_only` the first frame alone is planned: where the others start is not known yet.

    Args:
        controller: of the robot.
        command: what was understood, its objects resolved.
        result: that has been begun.
        plan_only: stop before anything is executed.
        progress: told what happens during the simulation.
    """
    result = with_(result, frames=command.frames)
    for index, frame in enumerate(command.frames):
        if frame.action == "explore" or (not plan_only and _to_be_found_out(controller, frame)):
            result = _explored(controller, index, frame, result, plan_only, progress)
        elif frame.query is not None:
            result = _answered(controller, index, frame, result)
        else:
            result = _Carrying(controller, index, frame, progress).out(result, plan_only)
        if result.error or result.status == "planned":
            break
    if result.status == "planned" and len(command.frames) > 1:
        note = (
            f"planned is the first of {len(command.frames)} steps; "
            "where the others start depends on what comes of it"
        )
        result = with_(result, notes=(note,))
    return result


def _answered(controller: Controller, index: int, frame: g.Frame, result: Result) -> Result:
    """The result with the answer to one more question."""
    step = Step(frame=index, status="failed")
    try:
        state = controller.about(frame)
        step = step.model_copy(update={"basis": Basis.of(frame, state, controller.defaults)})
        answer = controller.answer(frame, state)
    except ControlError as raised:
        return _ended(result, step, _unanswered(raised.info), raised.info)
    step = step.model_copy(update={"answer": answer})
    return _ended(with_(result, answer=answer), step, "answered")


def _to_be_found_out(controller: Controller, frame: g.Frame) -> bool:
    """Whether a question asks for something that is not known well, of an object within reach."""
    from nlcontrol.touching import unknown

    name = frame.object.id if frame.object else None
    model = controller.models.get(name) if name else None
    return model is not None and unknown(frame, model, controller.defaults.known_to)


def _explored(
    controller: Controller,
    index: int,
    frame: g.Frame,
    result: Result,
    plan_only: bool,
    progress: Progress | None,
) -> Result:
    """The result with what touching the object found out."""
    from nlcontrol.touching import announced, find_out

    step = Step(frame=index, status="failed")
    try:
        state = controller.about(frame)
        step = step.model_copy(update={"basis": Basis.of(frame, state, controller.defaults)})
        if plan_only:
            note = announced(controller, frame, state)
            return _ended(with_(result, notes=(*result.notes, note)), step, "planned")
        found, answer = find_out(controller, frame, progress)
    except ControlError as raised:
        return _ended(result, step, _unanswered(raised.info), raised.info)
    step = step.model_copy(update={"exploration": found and found.report, "answer": answer})
    result = with_(result, answer=answer, trace=found and found.trace)
    return _ended(result, step, "done" if frame.query is None else "answered")


class _Carrying:
    """One frame on its way.

    Args:
        controller: of the robot.
        index: of the frame in its command.
        frame: what is asked.
        progress: told what happens during the simulation.
    """

    def __init__(
        self, controller: Controller, index: int, frame: g.Frame, progress: Progress | None
    ) -> None:
        self.controller = controller
        self.frame = frame
        self.progress = progress
        self.step = Step(frame=index, status="failed")
        self.traces: list[Trace] = []

    def out(self, result: Result, plan_only: bool) -> Result:
        """The result with what came of the frame."""
        controller, rest = self.controller, self.frame
        for attempt in range(MOST_PLANS):
            state = controller.look()
            if attempt == 0:
                basis = Basis.of(self.frame, state, controller.defaults)
                before = basis.target.pose if basis else None
                self._note(before=before, basis=basis)
            try:
                made = controller.plan(rest, state)
            except ControlError as raised:
                return _ended(result, self.step, "unsupported", raised.info)
            if isinstance(made, Refusal):
                result = self._traced(result)
                return _ended(result, self.step, made.status, refusal_error(made))
            self._note(plan=made)
            result = with_(result, planned=result.planned + (attempt == 0), plan=made)
            if attempt == 0:
                result = with_(result, defaults=result.defaults + made.defaults)
            if plan_only:
                return _ended(result, self.step, "planned")
            trace = controller.execute(made, self.progress)
            self.traces.append(trace)
            lesson = self._learn(made, state, trace)
            if lesson is None or not lesson.contradicts or attempt == MOST_PLANS - 1:
                break
            rest = _remaining(rest, made, trace)
        return self._checked(self._traced(result))

    def _note(self, **changes: object) -> None:
        self.step = self.step.model_copy(update=changes)

    def _learn(self, made: Plan, state: WorldState, trace: Trace) -> Lesson | None:
        """What a push taught; the controller believes it from now on."""
        name = made.push.object
        found = learned(made, state.objects[name], trace)
        if found is None:
            return None
        model, lesson = found
        self.controller.models[name] = model
        self._note(lessons=(*self.step.lessons, lesson))
        if lesson.contradicts and self.progress is not None:
            self.progress("learn", float(trace.time[-1]), lesson.text)
        return lesson

    def _traced(self, result: Result) -> Result:
        """The result with everything that happened for this frame."""
        if not self.traces:
            return result
        trace = joined(self.traces)
        execution = summary(trace)
        self._note(execution=execution)
        return with_(result, trace=trace, execution=execution)

    def _checked(self, result: Result) -> Result:
        trace = result.trace
        assert trace is not None, "there was a push"
        checks = self.controller.check(self.frame, trace)
        self._note(checks=checks)
        result = with_(result, checks=result.checks + checks)
        missed = tuple(c for c in checks if not c.ok)
        if missed:
            return _ended(result, self.step, "failed", not_held(missed, trace))
        return _ended(result, self.step, "done")


def _remaining(frame: g.Frame, made: Plan, trace: Trace) -> g.Frame:
    """What is left of a frame after a push that ended early."""
    if made.displacement is None or not isinstance(frame.goal, g.Displace):
        return frame
    asked = np.linalg.norm(made.displacement)
    done = float(trace.seen_displacement(made.push.object) @ np.array(made.displacement) / asked)
    if done < _DONE:
        return frame
    left = max(float(asked) - done, _REST)
    goal = frame.goal.model_copy(update={"distance": left, "fraction": None, "amount": None})
    return frame.model_copy(update={"goal": goal})


def _ended(
    result: Result, step: Step, status: ResultStatus, reason: ErrorInfo | None = None
) -> Result:
    """The result with the end of one more step."""
    step = step.model_copy(update={"status": status, "error": reason})
    return with_(
        result, ok=reason is None, status=status, error=reason, steps=(*result.steps, step)
    )


def _unanswered(info: ErrorInfo) -> ResultStatus:
    """Status of a question that has no answer."""
    if info.code == "unsupported":
        return "unsupported"
    return "not_understood" if info.status.exit == NOT_UNDERSTOOD else "refused"
