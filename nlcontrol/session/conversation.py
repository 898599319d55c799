"""One sentence after another: "it", "again", "a bit more", "no, the other one", "undo that".

A conversation remembers what was spoken of, what was asked last and what came of it, and where
things stood before each push. A remark becomes frames as any sentence has them
(`nlcontrol.session.follow_up_frames`, `nlcontrol.session.undo_frames`), and these go the way of
every sentence: resolved, planned, executed, checked. So a remark may be refused as any sentence
may, with its numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Literal, NoReturn, TypedDict

import grammar
from grammar.frames import command as g
from nlcontrol.checks.verdicts import HAND_ENDS, PLANNED_ENDS, Check
from nlcontrol.errors import ControlError, error
from nlcontrol.plan_text import deciding_figures, plan_reason
from nlcontrol.questions.answer import Answer
from nlcontrol.references.reference_resolution import Context, parts_within
from nlcontrol.results.result import result_with
from nlcontrol.session import follow_up_frames as follow_up
from nlcontrol.session.corrected_sentences import result_with_corrections
from nlcontrol.session.events import FORCE_RATE, Supervisor
from nlcontrol.session.frame_documents import text_of
from nlcontrol.session.frame_execution import status_of
from nlcontrol.session.recipe import Deed
from nlcontrol.session.turns import in_turn
from nlcontrol.session.undo_frames import PastPush, undo_frames, undo_text
from nlcontrol.text_format import quantity

if TYPE_CHECKING:
    from typing import Unpack

    from nlcontrol.results.result import Result, Step
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.events import Event
    from nlcontrol.session.executor import Motion
    from nlcontrol.session.frame_documents import Frames
    from sim.supervision import Progress, StopToken


REMEMBERED = 50
"""Pushes that can be undone."""


class Options(TypedDict, total=False):
    """Options of `say` and `do`; see `nlcontrol.session.controller.Controller.say`."""

    plan_only: bool
    motion: Motion | None
    progress: Progress | None
    on_event: Callable[[Event], object] | None
    stop: StopToken | None
    force_rate: float


class Conversation:
    """Sentences said one after another to one robot.

    Attributes:
        controller: the robot.
        context: what was spoken of, for "it" and "that one".
        past: pushes that were carried out and not undone, the most recent last; no more than
            `REMEMBERED`.
    """

    def __init__(self, controller: Controller) -> None:
        self.controller = controller
        self.turn = controller.turn
        self._number = controller.journal.conversations
        controller.journal.conversations += 1
        self.context = Context()
        self.past: list[PastPush] = []
        self._last: Result | None = None  # what "why" is about
        self._said: Result | None = None  # what "no, …" is about; None if it was not understood
        self._done: Result | None = None  # the last command, what "a bit more" is about

    @in_turn
    def say(
        self,
        text: str | Frames,
        *,
        plan_only: bool = False,
        motion: Motion | None = None,
        progress: Progress | None = None,
        on_event: Callable[[Event], object] | None = None,
        stop: StopToken | None = None,
        force_rate: float = FORCE_RATE,
    ) -> Result:
        """Does what a sentence says, as it is meant after those before it.

        It may be a remark on what was said and done before; otherwise as `Controller.say`. Frames
        are taken in place of a sentence; see `do`.
        """
        supervisor = Supervisor(
            progress,
            stop,
            on_event=on_event,
            force_rate=force_rate,
            clock=lambda: self.controller.executor.time,
        )
        plan_only = plan_only or motion == "never"
        journal = self.controller.journal
        deed = Deed.of(text, self._number, "never" if plan_only else motion)
        with journal.deed(deed, self.controller.models):
            said = self._say(text, plan_only, motion, supervisor)
        said = result_with_corrections(said, self.controller.parse)
        if supervisor.stop.requested:
            journal.interrupt()
        return supervisor.end(said)

    def do(self, frames: Frames, **options: Unpack[Options]) -> Result:
        """Does what frames say, as they are meant after what was said before; as `Controller.do`.

        They may be a remark ("again", "undo that") and hold pronouns, as a sentence may.
        """
        return self.say(frames, **options)

    def _say(
        self, said: str | Frames, plan_only: bool, motion: Motion | None, progress: Progress
    ) -> Result:
        text, command = text_of(said), None
        try:
            command = self.controller.command(said)
            return self._answer(command, plan_only, motion, progress)
        except ControlError as raised:
            begun = self.controller.empty_result(text, command)
            self._last = result_with(begun, status=status_of(raised.info), error=raised.info)
            if command is None:
                self._said = None
            return self._last

    def _answer(
        self, command: g.Command, plan_only: bool, motion: Motion | None, progress: Progress
    ) -> Result:
        remark = _sole_remark(command)
        if remark == "stop":
            # Sentences are carried out before the next one is read, so there is nothing to stop.
            return self._plain_result(command, Answer(text="Nothing is being done."), "done")
        if remark == "why":
            return self._plain_result(command, self._explain_last(command), "answered")
        if remark == "undo":
            return self._undo(command, plan_only, progress)
        notes = self._notes(command)
        command = self._rewrite_remarks(command)
        result = self.controller.carry_out(
            command, self.context, plan_only=plan_only, motion=motion, progress=progress
        )
        result = result_with(result, notes=notes + result.notes)
        self._remember(result)
        return result

    def _plain_result(
        self, command: g.Command, answer: Answer, status: Literal["done", "answered"]
    ) -> Result:
        result = self.controller.empty_result(command.text, command)
        return result_with(result, ok=True, status=status, answer=answer)

    # --- memory ------------------------------------------------------------------------------

    def _remember(self, result: Result) -> None:
        # Remarks are about what was said and what came of it; a trace is megabytes.
        self._last = self._said = kept = result_with(result, trace=None)
        if any(frame.query is None for frame in kept.frames):
            self._done = kept
        self._speak_of(kept.frames)
        for step in kept.steps:
            if step.execution and step.plan and step.before:
                done, before = step.plan, step.before
                self.past.append(PastPush(kept, done.object, before, done.task))
        del self.past[:-REMEMBERED]

    def _speak_of(self, frames: Sequence[g.Frame]) -> None:
        parts = (part for frame in reversed(frames) for part in parts_within(frame))
        names = [ref.id for ref in parts if isinstance(ref, g.ObjectRef) and ref.id is not None]
        self.context = Context(tuple(dict.fromkeys((*names, *self.context.last))))

    # --- repeat, more, correct -----------------------------------------------------------------

    def _rewrite_remarks(self, command: g.Command) -> g.Command:
        """The command with each remark replaced by the frames that it means."""
        frames: list[g.Frame] = []
        for frame in command.frames:
            if frame.dialogue == "correct":
                frames += self._correct_frame(frame)
            elif frame.dialogue == "repeat":
                before = frames or _frames(self._done if frame.action else self._said or self._done)
                frames += follow_up.repeat_frames(
                    before or _nothing("there is nothing to repeat"), frame
                )
            elif frame.dialogue == "more":
                frames.append(self._continue_frame(frames, frame))
            else:
                frames.append(frame)
        if tuple(frames) == command.frames:
            return command
        return command.model_copy(
            update={"frames": tuple(frames), "paraphrase": _in_words(frames, command)}
        )

    def _continue_frame(self, frames: Sequence[g.Frame], said: g.Frame) -> g.Frame:
        before = frames or _frames(self._done) or _nothing("nothing was done that could go on")
        last, heading = follow_up.latest_matching(before, said), None
        if not frames and self._done and self._done.plan:
            heading = _goal_heading(self._done.steps[-1])
        if isinstance(last.goal, g.Place) and heading is None:
            _nothing("nothing was pushed there yet, so there is no direction to go on in")
        return follow_up.continue_frame(last, said, heading)

    def _correct_frame(self, said: g.Frame) -> tuple[g.Frame, ...]:
        last = self._said
        if last is None or not last.frames:
            _nothing("there is no sentence before that could be corrected")
        unresolved = last.error is not None and last.status == "not_understood"
        wrong = last.error.span if last.error and unresolved else None
        return follow_up.correct_frame(last.frames[_stop_index(last) :], said, wrong)

    def _notes(self, command: g.Command) -> tuple[str, ...]:
        last = self._said
        if command.frames[0].dialogue != "correct" or not any(p.of is last for p in self.past):
            return ()
        assert last is not None
        return (f"already carried out: “{last.text}”; that is left as it is",)

    # --- undo --------------------------------------------------------------------------------

    def _undo(self, command: g.Command, plan_only: bool, progress: Progress) -> Result:
        pushed = self._to_undo(command)
        text = pushed[-1].of.text
        back = undo_frames(pushed, self.controller.look(), self.controller.defaults)
        if not back.frames:
            self._forget(pushed)
            what = "Everything is" if len(pushed) > 1 else f"The {pushed[0].object} is"
            told = Answer(text=f"{what} where it was before “{text}”.")
            return result_with(self._plain_result(command, told, "done"), notes=back.notes)
        words = f"to undo “{text}”, {undo_text(back.frames)}"
        command = command.model_copy(update={"frames": back.frames, "paraphrase": words})
        result = self.controller.carry_out(command, plan_only=plan_only, progress=progress)
        self._last = result_with(result, trace=None)
        self._speak_of(result.frames)
        done = [back.undoes[step.frame] for step in result.steps if step.status == "done"]
        if len(done) < len(back.frames):
            # What takes two steps is undone when both are done.
            self._forget([push for push in done if push not in back.undoes[len(done) :]])
            return result_with(result, notes=back.notes + result.notes)
        self._forget(pushed)
        return result_with(result, notes=(f"undone: “{text}”", *back.notes, *result.notes))

    def _to_undo(self, command: g.Command) -> list[PastPush]:
        """The pushes of the last sentence, or the last push of the object that is named."""
        (frame,) = command.frames
        if frame.object is not None and not frame.object.pronoun:
            (frame,) = self.controller.resolve(command, self.context).frames
            name = frame.object.id if frame.object else None
            named = [push for push in self.past if push.object == name]
            return named[-1:] or _nothing(
                f"the {name} was not pushed yet, so there is nothing to undo"
            )
        last = (
            self.past[-1].of if self.past else _nothing("nothing was pushed that could be undone")
        )
        return [push for push in self.past if push.of is last]

    def _forget(self, undone: Sequence[PastPush]) -> None:
        self.past = [push for push in self.past if push not in undone]

    # --- why ---------------------------------------------------------------------------------

    def _explain_last(self, command: g.Command) -> Answer:
        """Why the last result is as it is; or another push would be, if that is asked about."""
        (frame,) = command.frames
        if frame.action is not None:
            asked = command.model_copy(
                update={"frames": (frame.model_copy(update={"query": None, "event": None}),)}
            )
            with suppress(ControlError):
                asked = self.controller.resolve(asked, self.context)
            last = self._last.frames if self._last else ()
            if not any(_says_all_of(frame, asked.frames[0]) for frame in last):
                return why_answer(self.controller.carry_out(asked, self.context, plan_only=True))
        return why_answer(self._last or _nothing("nothing was said or done yet"))


def _sole_remark(command: g.Command) -> str | None:
    """The remark that a whole sentence is; None if it is to be carried out as frames.

    Raises:
        ControlError: `not_alone`.
    """
    kinds = [frame.dialogue or frame.query for frame in command.frames]
    if len(kinds) == 1:
        return kinds[0] if kinds[0] in ("stop", "why", "undo") else None
    for frame, kind in zip(command.frames, kinds, strict=True):
        if kind in ("stop", "why", "undo", "correct"):
            raise error(
                "not_alone",
                f"“{kind}” is about what was said and done before, so it is a sentence of its own",
                span=frame.spans[0] if frame.spans else None,
                suggestions=("say it when the other sentence is done",),
            )
    return None


def _nothing(message: str) -> NoReturn:
    raise error(
        "nothing_before", message, suggestions=("say first what to do, as “push the box away”",)
    )


def _goal_heading(step: Step) -> float | None:
    """In which direction a step was to bring its object; None if it was to bring it nowhere."""
    if step.plan is None or step.plan.aim is None or step.before is None:
        return None
    aim, here = step.plan.aim, step.before
    return math.atan2(aim.y - here.y, aim.x - here.x)


def _frames(result: Result | None) -> list[g.Frame]:
    return list(result.frames) if result else []


def _stop_index(result: Result) -> int:
    """The frame at which a result stopped."""
    return result.steps[-1].frame if result.steps else 0


def _says_all_of(frame: g.Frame, asked: g.Frame) -> bool:
    """Check for a frame that says all that is asked about."""
    frame, asked = follow_up.without_spans(frame), follow_up.without_spans(asked)
    wanted = asked.goal.model_dump(exclude_defaults=True)
    return (
        frame.action == asked.action
        and asked.object in (None, frame.object)
        and asked.goal.kind in ("none", frame.goal.kind)
        and wanted.items() <= frame.goal.model_dump().items()
        and set(asked.constraints) <= set(frame.constraints)
    )


def _in_words(frames: Sequence[g.Frame], command: g.Command) -> str:
    try:
        return ", then ".join(grammar.paraphrase(frame) for frame in frames)
    except ValueError:
        return command.paraphrase  # not everything that a frame can say has words


# --- why -------------------------------------------------------------------------------------


def why_answer(result: Result) -> Answer:
    """Why a sentence was refused, or failed, or is done in this way and no other."""
    missed = [check for check in result.checks if not check.ok]
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
    if result.answer:
        return result.answer
    return Answer(text="There was nothing to be done.")


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
