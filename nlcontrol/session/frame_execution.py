"""Frame after frame: plan, push, look, learn, plan anew until it is there; then check.

Of each plan only the first push is made. Then the robot looks, and plans towards the same aim from
what it sees, until the aim is reached or the budget of pushes is used up (`Defaults.most_pushes`).
Where the hand does not get to that aim any more, another one that the sentence allows does as well.
What the pushing fingers felt updates the model of the object: an outcome that contradicts the
prediction (nothing moved where it should, it tilted where it should slide, it slid where it should
tilt) stops the push, and the next plan knows better. Where a push fails otherwise (nothing was
touched, the contact was lost), or no belief explains it, another contact is tried. Clauses are
checked over everything that happened for the frame.

What a whole hand does is one plan: all its steps are made. Where that fails, the hand has put back
what it held, and another plan is made, up to `Defaults.most_tries` of them
(`nlcontrol.learning.lessons`).

Where a frame has no plan because something stands in the way, or because another one named with it
should go first, other steps are looked for that bring all of it about
(`nlcontrol.session.foresight`).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import takewhile
from typing import TYPE_CHECKING

import numpy as np

from grammar.frames import command as g
from grammar.paraphrasing.command_wording import paraphrase
from nlcontrol.checks.verdicts import PLANNED_ENDS, Check
from nlcontrol.errors import ControlError, refusal_error
from nlcontrol.plan_text import plan_lines
from nlcontrol.questions.answer import Answer
from nlcontrol.references.reference_resolution import NOTHING_SAID
from nlcontrol.reports.result_report import check_line
from nlcontrol.results.result import (
    Result,
    ResultStatus,
    Step,
    result_with,
    result_with_step,
    status_of,
    stop_info,
    summary,
    unanswered_status,
)
from nlcontrol.session.corrections import LEFT_SO, Corrections, spent_text
from nlcontrol.session.events import Supervisor
from nlcontrol.session.fallen_objects import unreachable_after_fall, with_way_back
from nlcontrol.session.foresight import PlanCache, onward_plan, plan_with_foresight
from nlcontrol.session.remarks.follow_up_targets import without_spans
from nlcontrol.session.step_search import Ways, ways_around
from nlcontrol.text_format import place_text, quantity
from planner.plan_explanation import Basis
from planner.problem.directions import angle_between
from planner.types.end_reasons import END_REASONS
from planner.types.plan import Plan, PlanningResult, Reached
from planner.types.refusal import Refusal
from planner.types.robot import Failed, FailedHold, FailedPush
from planner.types.world_state import Held, WorldState
from sim.supervision import Progress, Stopped, StopToken
from sim.traces.trace import Trace, join_traces

if TYPE_CHECKING:
    from grammar.frames.command import Command
    from nlcontrol.learning.learning_reports import Lesson
    from nlcontrol.references.reference_search import Context
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.executor import Motion
    from nlcontrol.session.remarks.undo_frames import UndoEntry, UndoPlan


# Answers to the questions of a command; what can be done is planned as it would be done.
#
# A question whether something can be done is answered by one plan where that suffices. Where
# several objects are asked about at once, or where something stands in the way of one, it is yes
# if the whole command could be carried out, with what is moved aside for it.


def frames_asked_at_once(frames: Sequence[g.Frame], index: int) -> tuple[g.Frame, ...]:
    """The frame of a question, and those after it that ask by the same words what can be done."""
    first, *later = frames[index:]
    if first.query != "possible" or not first.spans:
        return (first,)
    same = takewhile(lambda f: f.query == "possible" and f.spans == first.spans, later)
    return (first, *same)


def answer_to(
    controller: Controller,
    asked: tuple[g.Frame, ...],
    state: WorldState,
    stop: StopToken,
    propose: Callable[[tuple[g.Frame, ...]], Result],
) -> Answer:
    """The answer to frames that are asked at once.

    Args:
        controller: the controller that answers single questions.
        asked: their objects resolved.
        state: what is believed.
        stop: asked whether to go on.
        propose: plans frames without carrying them out.

    Raises:
        Stopped: that was asked for.
        ControlError: why it cannot be answered.
    """
    if len(asked) == 1:
        answer = controller.answer(asked[0], state, stop=stop)
        # Reasons of refusals that other steps may change.
        hindered = answer.query == "possible" and answer.reason in ("blocked", "out_of_reach")
        known = asked[0].object is not None and asked[0].object.id in controller.models
        if not (hindered and known):
            return answer
    done = tuple(frame.model_copy(update={"query": None, "event": None}) for frame in asked)
    return _possibility(propose(done))


def _possibility(tried: Result) -> Answer:
    """The answer that something can be done, in which steps, or why it cannot."""
    if tried.error is not None:
        told = tried.error
        return Answer(
            query="possible",
            text=f"No: {told.message.removeprefix('nothing is moved: ')}.",
            numbers=told.numbers,
            yes=False,
            reason=told.code,
            suggestions=told.suggestions,
        )
    from nlcontrol.questions.question_answers import plan_answer  # not needed to execute

    several = len(tried.frames) > 1
    how = (
        f"Yes, in {len(tried.frames)} steps: {paraphrase(list(map(without_spans, tried.frames)))}."
        if several
        else ""
    )
    if tried.plan is None:  # what the first step asks is so by now
        return Answer(query="possible", text=how or "Yes: it is there already.", yes=True)
    first = plan_answer(tried.plan)
    if not several:
        return first
    begin = first.text.removeprefix("Yes: ")
    return first.model_copy(update={"text": f"{how} The first: {begin}"})


# Places in which a command that went no further leaves things, as far as the robot saw them.
#
# What was moved for a goal that was not reached does not stand where it did; a person who thinks
# so would say the wrong thing next. Frames: W.


def unfinished_notes(result: Result, held: Held | None) -> Iterator[str]:
    """Sentences on what the hand holds and what was moved, if the last step ended halfway."""
    trace, last = result.trace, result.steps[-1] if result.steps else None
    if trace is None or last is None or last.error is None:
        return
    if last.execution is not None and last.stuck is None:
        return  # it was done, though not well
    if held is not None:
        up = quantity(held.height, "m")
        yield f"the hand holds the {held.name}, {up} up; say “put it down”"
    yield from _moved_things(trace, held)


def _moved_things(trace: Trace, held: Held | None) -> Iterator[str]:
    """Sentences on what stands elsewhere than before."""
    # It is seen over the last 0.5 s.
    last = trace.time > trace.time[-1] - 0.5
    for name, poses in trace.seen.items():
        if held is not None and name == held.name:
            continue
        moved = float(np.linalg.norm(trace.seen_displacement(name)))
        # Less than 5 mm is not told: it is within what goals leave.
        if moved > 0.005:
            x, y = poses[last, 4:6].mean(axis=0).tolist()
            yield (
                f"the {name} is at {place_text(x, y)} now, {quantity(moved, 'm')} from where it "
                "was; “undo that” brings it back"
            )


def run_command(
    controller: Controller,
    command: g.Command,
    context: Context = NOTHING_SAID,
    *,
    plan_only: bool = False,
    motion: Motion | None = None,
    progress: Progress | None = None,
    approval: Approval | None = None,
) -> Result:
    """Does what a command says, frame after frame, up to the first that fails.

    Args:
        controller: the robot.
        command: its objects not yet resolved, unless its first plan was approved.
        context: what "it" and "the other one" refer to.
        plan_only: nothing is carried out, and the plan of the first frame is told.
        motion: `simulate` lets a question move the robot, too.
        progress: told what happens.
        approval: the first plan, which is carried out from where things were seen last.
    """
    result, supervisor = controller.empty_result(command.text, command), Supervisor.of(progress)
    supervisor.tell("understood", command.paraphrase, left_out=command.left_out)
    try:
        if approval is None:
            held = None if controller.held is None else controller.held.name
            command = controller.resolve(command, replace(context, held=held))
    except ControlError as raised:
        return result_with(result, status=status_of(raised.info), error=raised.info)
    return _run_frames(controller, command.frames, result, supervisor, plan_only, motion, approval)


def _run_frames(
    controller: Controller,
    frames: tuple[g.Frame, ...],
    result: Result,
    supervisor: Supervisor,
    plan_only: bool,
    motion: Motion | None = None,
    approval: Approval | None = None,
) -> Result:
    """The result of frames whose objects are resolved."""
    # Other steps are looked for twice in one command.
    left = 2
    made = {} if approval is None else {approval.frame: approval.made}
    result, index = result_with(result, frames=frames), 0
    while index < len(frames):
        supervisor.frame, frame = index, frames[index]
        touches = motion == "simulate" and not plan_only
        if frame.action == "explore" or (touches and _to_be_found_out(controller, frame)):
            from nlcontrol.session.exploration_commands import explore_frame

            result = explore_frame(controller, index, frame, result, plan_only, supervisor)
        elif frame.query is not None:
            asked = frames_asked_at_once(frames, index)
            result = _answer_question(controller, index, asked, result, supervisor)
            index += len(asked) - 1
        else:
            run = FrameRun(controller, index, frames, result, supervisor)
            tried = run.run(plan_only, made.get(index))
            around = (frames, index, run.refused, supervisor, run.cache)
            ways = ways_around(controller, *around) if left else None
            if isinstance(ways, Ways):
                frames, left = (*frames[:index], *ways.frames), left - 1
                made[index] = ways.first
                notes = (*result.notes, *ways.notes)
                aside = (*result.aside, *ways.aside)
                result = result_with(result, frames=frames, notes=notes, aside=aside)
                continue
            result = tried if ways is None else result_with(tried, error=ways)
        if result.error or result.status == "planned":
            break
        index += 1
    if result.status == "planned" and len(frames) > 1:
        note = (
            f"planned is the first of {len(frames)} steps; "
            "where the others start depends on what comes of it"
        )
        result = result_with(result, notes=(*result.notes, note))
    notes = (*result.notes, *unfinished_notes(result, controller.held))
    if result.trace is not None and result.status != "cancelled":
        look, stop = controller.look, supervisor.stop
        notes = (*notes, *unreachable_after_fall(controller, result.trace, look, stop))
    return result_with(result, notes=notes)


def _answer_question(
    controller: Controller,
    index: int,
    asked: tuple[g.Frame, ...],
    result: Result,
    supervisor: Supervisor,
) -> Result:
    """The result with the answer to one more question, which may be about several frames."""
    step, frame = Step(frame=index, status="failed"), asked[0]
    propose = partial(_proposal, controller, supervisor)
    try:
        state = controller.believed_state(frame)
        step = step.model_copy(update={"basis": Basis.of(frame, state, controller.defaults)})
        answer = answer_to(controller, asked, state, supervisor.stop, propose)
    except Stopped:
        return result_with_step(result, step, "cancelled", stop_info(controller.held, None))
    except ControlError as raised:
        return result_with_step(result, step, unanswered_status(raised.info), raised.info)
    if _to_be_found_out(controller, frame):
        from nlcontrol.session.exploration_commands import answer_with_offer

        answer = answer_with_offer(answer, frame, state, controller.robot.limits)
    step = step.model_copy(update={"answer": answer})
    return result_with_step(result_with(result, answer=answer), step, "answered")


def _to_be_found_out(controller: Controller, frame: g.Frame) -> bool:
    """True if a question asks for something not known well, of an object on the table."""
    from nlcontrol.session.exploration_commands import is_unknown

    name = frame.object.id if frame.object else None
    model = controller.models.get(name) if name else None
    return model is not None and is_unknown(frame, model, controller.defaults.known_to)


def _proposal(
    controller: Controller, supervisor: Supervisor, frames: tuple[g.Frame, ...]
) -> Result:
    """What would come of frames; nothing of it is told, and nothing moves."""
    command = g.Command(text="", frames=frames, paraphrase="")
    result, unheard = controller.empty_result("", command), Supervisor(stop=supervisor.stop)
    return _run_frames(controller, frames, result, unheard, plan_only=True)


class FrameRun:
    """One of a command's frames, by its index, on its way.

    Attributes:
        refused: why there was no first plan, and from where; None if there was one.
        cache: plans of this frame and of later ones from there.
    """

    def __init__(
        self,
        controller: Controller,
        index: int,
        frames: Sequence[g.Frame],
        result: Result,
        supervisor: Supervisor,
    ) -> None:
        self.controller = controller
        self.frame, self.ahead = frames[index], frames[index:]
        self.result = result
        self.supervisor = supervisor
        self.step = Step(frame=index, status="failed")
        self.traces: list[Trace] = []
        self.failed: list[Failed] = []
        self.refused: tuple[Refusal, WorldState] | None = None
        self.cache = PlanCache()
        self._yaw: float | None = None
        self._corrections = Corrections(controller.cell.vision, controller.defaults)

    def run(self, plan_only: bool, approved: Plan | Reached | None = None) -> Result:
        """The result with what came of the frame; its first plan may have been approved before."""
        status: ResultStatus = "cancelled"
        try:
            return self._run(plan_only, approved)
        except Stopped:
            info = stop_info(self.controller.held, self.traces[-1] if self.traces else None)
        except ControlError as raised:
            status, info = unanswered_status(raised.info), raised.info
        result = self._result_with_trace() if self.traces else self.result
        return result_with_step(result, self.step, status, info)

    def _run(self, plan_only: bool, approved: Plan | Reached | None) -> Result:
        controller = self.controller
        previous: Plan | None = None
        for attempt in itertools.count():
            self.supervisor.stop.check()
            state, made = self._look_and_plan(previous, approved if attempt == 0 else None)
            # What was approved was looked through before it was offered.
            if attempt == 0 and approved is None and not isinstance(made, Refusal):
                made = with_way_back(controller, self._plan_with_foresight(made, state), state)
            if isinstance(made, Refusal):
                if attempt == 0:
                    self.refused = made, state
                    info = refusal_error(made)
                    self._note(marks=made.marks)
                    return result_with_step(self.result, self.step, made.status, info)
                self._note(stuck=made.message)
                break
            if isinstance(made, Reached):
                if attempt == 0 and not plan_only:
                    self.traces.append(controller.watch(self._name))
                break
            if self._is_left_so(made, state, attempt):
                break
            self._note(plan=self.step.plan or made, plans=(*self.step.plans, made))
            self.supervisor.tell(
                "replanned" if attempt else "planned", " ".join(plan_lines(made)), plan=made
            )
            result = self.result = result_with(self.result, plan=self.step.plan)
            if attempt == 0:
                self.result = result_with(
                    result, planned=result.planned + 1, defaults=result.defaults + made.defaults
                )
            if plan_only:
                from sim.control.motion_guides import motion_guide  # not needed to execute

                guide = motion_guide(made, state, controller.robot)
                result = result_with(self.result, guide=guide)
                return result_with_step(result, self.step, "planned")
            if self._carried_out(made, state):
                break
            previous = made if made.pushes else None
        if plan_only:
            return result_with_step(self.result, self.step, "planned")
        return self._check_frame()

    def _is_left_so(self, made: Plan, state: WorldState, attempt: int) -> bool:
        """Check for a further plan that is not worth it, or one more than may be; noted why."""
        if attempt and not self._corrections.are_worth(made, state):
            self.result = result_with(self.result, notes=(*self.result.notes, LEFT_SO))
            return True
        if attempt == self._budget(made):
            if not self._is_quick or self.traces[-1].end not in PLANNED_ENDS:
                self._note(stuck=spent_text(made, attempt))
            return True
        return False

    def _look_and_plan(
        self, previous: Plan | None, approved: Plan | Reached | None
    ) -> tuple[WorldState, PlanningResult]:
        """The belief, and the plan from there; what was approved holds for what was seen last."""
        if approved is not None:
            with self.controller.last_look.kept():
                return self._look(), approved
        state = self._look()
        if (basis := self.step.basis) and (fallen := basis.fall(self.frame, state)):
            return state, fallen
        plan = partial(
            self.controller.plan,
            self.frame,
            state,
            failed=self.failed,
            notify=self._notify,
            stop=self.supervisor.stop,
        )
        first = previous is None and not self.failed
        onward = partial(onward_plan, plan, self.frame, state, previous)
        return state, self.cache.plan(self.frame, state, plan) if first else onward()

    def _plan_with_foresight(self, made: Plan | Reached, state: WorldState) -> PlanningResult:
        """The plan by which the later frames can be done, too, or why they cannot."""
        begun = self.result.trace is not None
        if len(self.ahead) == 1 or (begun and not (isinstance(made, Plan) and made.task == "lift")):
            return made
        stop = self.supervisor.stop
        found = plan_with_foresight(self.controller, made, state, self.ahead, stop, self.cache)
        return made if begun and isinstance(found, Refusal) else found

    def _budget(self, made: Plan) -> int:
        """Pushes, or tries of a hand, that may be made; what is to be quick is not corrected."""
        if not made.pushes:
            return self.controller.defaults.most_tries
        return 1 if self._is_quick else self.controller.defaults.most_pushes

    @property
    def _is_quick(self) -> bool:
        return any(isinstance(clause, g.MaxDuration) for clause in self.frame.constraints)

    @property
    def _name(self) -> str:
        assert self.frame.object is not None
        assert self.frame.object.id is not None, "what was planned has an object"
        return self.frame.object.id

    def _look(self) -> WorldState:
        """The belief now; the object's heading counts its turns since the first look."""
        state = self.controller.look()
        basis = Basis.of(self.frame, state, self.controller.defaults)
        if basis is None:
            return state
        pose = basis.target.pose
        if self._yaw is None:
            self._note(before=pose, basis=basis)
            self._yaw = pose.yaw
            self._corrections.begin_at(pose)
        self._yaw += angle_between(pose.yaw, self._yaw)
        here = replace(basis.target, pose=replace(pose, yaw=self._yaw))
        return replace(state, objects={**state.objects, here.name: here})

    def _carried_out(self, made: Plan, state: WorldState) -> bool:
        """Makes the first push of a plan, or all of a hand's; whether nothing is left after it."""
        trace = self.controller.execute(made, self.supervisor)
        self.traces.append(trace)
        self.supervisor.stop.check()
        if not made.pushes:
            # Learn what the hand found out; return True if all was done.
            from nlcontrol.learning.lessons import lessons_from_hand

            models, lessons = lessons_from_hand(made, self.controller.models, trace)
            self.controller.models.update(models)
            for lesson in lessons:
                self._keep_lesson(lesson)
            if END_REASONS[trace.end].once_more:
                self.failed.append(FailedHold(made, trace.detail))
                return False
            if trace.end not in PLANNED_ENDS:
                self._note(stuck=trace.detail)
            return True
        explained = self._learn(made, state, trace)
        if END_REASONS[trace.end].elsewhere or not explained:
            self.failed.append(FailedPush(made.push, trace.detail))
            return False
        if trace.end == "event":
            return True
        # A push that topples or tilts is the whole of its frame.
        return made.aim is None and trace.end in ("toppled", "returned")

    def _notify(self, text: str) -> None:
        """Say that planning takes seconds now, or half a minute for a large turn."""
        self.supervisor("plan", self.controller.executor.time, text)

    def _note(self, **changes: object) -> None:
        self.step = self.step.model_copy(update=changes)

    def _learn(self, made: Plan, state: WorldState, trace: Trace) -> bool:
        """Learn from a push; return False if no belief explains what came of it."""
        from nlcontrol.learning.lessons import lesson_from_push  # not to plan

        name = made.push.object
        found = lesson_from_push(made, state.objects[name], trace)
        if found is None:
            return END_REASONS[trace.end].contradicts is None
        model, lesson = found
        self.controller.models[name] = model
        self._keep_lesson(lesson)
        if lesson.contradicts:
            self.supervisor("learn", float(trace.time[-1]), lesson.text)
        return True

    def _keep_lesson(self, lesson: Lesson) -> None:
        self._note(lessons=(*self.step.lessons, lesson))
        self.supervisor.tell("lesson", lesson.text, lesson=lesson)

    def _result_with_trace(self) -> Result:
        """The result with everything that happened for this frame."""
        result = self.result
        execution = summary(join_traces(self.traces))
        self._note(execution=execution)
        before = [result.trace] if result.trace is not None else []
        return result_with(result, trace=join_traces([*before, *self.traces]), execution=execution)

    def _judge(self) -> tuple[Check, ...]:
        """The verdicts; where they cannot be told, the robot looks on as long as that helps."""
        checks = self.controller.check(self.frame, join_traces(self.traces))
        # Up to three looks of a second make verdicts surer that are too near to tell.
        for _ in range(3):
            before = _doubts(checks)
            if not any(before):
                break
            last, seen = self.traces[-1], self._seen_on()
            if seen is None:
                break
            way = last.direction
            self.traces.append(replace(seen, end=last.end, detail=last.detail, direction=way))
            checks = self.controller.check(self.frame, join_traces(self.traces))
            unseen, spread = _doubts(checks)
            # One more look must narrow to 0.9 what they leave open; what was on the way stays so.
            if unseen >= before[0] and spread >= 0.9 * before[1]:
                break
        return checks

    def _seen_on(self) -> Trace | None:
        """What a further look shows; None of a robot that only does what is planned."""
        try:
            return self.controller.watch(self._name)
        except ControlError as raised:
            if isinstance(raised.__cause__, NotImplementedError):
                return None
            raise

    def _check_frame(self) -> Result:
        checks = self._judge()
        result, trace = self._result_with_trace(), join_traces(self.traces)
        self._note(checks=checks)
        for check in checks:
            self.supervisor.tell("verdict", check_line(result.text, check).strip(), check=check)
        result = result_with(result, checks=result.checks + checks)
        missed = tuple(c for c in checks if c.verdict == "not_held")
        unknown = tuple(c for c in checks if c.verdict == "unknown")
        # Whatever was measured: a step that failed has not done what it was to do.
        if missed or self.step.stuck is not None:
            from nlcontrol.checks.frame_checks import not_held

            return result_with_step(
                result, self.step, "failed", not_held(missed, trace, self.step.stuck)
            )
        if unknown:
            from nlcontrol.checks.frame_checks import not_told

            return result_with_step(result, self.step, "undecided", not_told(unknown))
        return result_with_step(result, self.step, "done")


def _doubts(checks: Sequence[Check]) -> tuple[int, float]:
    """How many clauses were not perceived, and the width of those that are too near to tell."""
    near = (c for c in checks if c.why == "too_near" and c.low is not None and c.high is not None)
    spread = sum((c.high or 0.0) - (c.low or 0.0) for c in near)
    return sum(c.why == "not_perceived" for c in checks), spread


# Proposals: plans of sentences, not yet done; to be approved, then carried out as they are.


@dataclass(frozen=True)
class Approval:
    """The first plan of a command, which is carried out as it is.

    Attributes:
        frame: place in the command of the frame that it is for, from 0; only questions stand
            before it.
        made: the plan.
    """

    frame: int
    made: Plan | Reached


@dataclass(frozen=True)
class ResolvedTurn:
    """The task of a sentence, as it is meant after those before it.

    Attributes:
        command: the command, each remark replaced by the frames that it means.
        notes: remarks on how a remark was taken.
        joins: whether its objects join those of the sentence before ("and the mug too").
        corrects: whether its object takes the place of one that was not meant.
        exchange: the command before its objects were resolved, if things change places.
        undone: what was pushed, if that is undone.
        back: the way back then.
    """

    command: Command
    notes: tuple[str, ...] = ()
    joins: bool = False
    corrects: bool = False
    exchange: Command | None = None
    undone: tuple[UndoEntry, ...] = ()
    back: UndoPlan | None = None


@dataclass(frozen=True)
class Proposal:
    """A sentence that was planned.

    Attributes:
        number: place of the proposal in its conversation, from 0.
        result: result of the sentence so far.
        intention: what it is to do, its objects resolved; None if nothing is to be carried out.
    """

    number: int
    result: Result
    intention: ResolvedTurn | None

    @property
    def approval(self) -> Approval | None:
        """The plan that is carried out first; None if a touch decides what comes next."""
        frame = self.result.steps[-1].frame
        if self.result.frames[frame].action == "explore":
            return None
        return Approval(frame, self.result.plan or Reached())
