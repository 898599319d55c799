"""One sentence after another: "it", "again", "a bit more", "no, the other one", "undo that".

A conversation remembers what was spoken of, what was asked last and what came of it, and where
things stood before each push. A remark becomes frames as any sentence has them
(`nlcontrol.session.remarks`), and these go the way of every sentence: resolved, planned, executed,
checked. So a remark may be refused as any sentence may, with its numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from grammar.frames import command as g
from grammar.part_reader import understood_part
from nlcontrol.errors import ControlError, ErrorInfo, defects_raised
from nlcontrol.questions.answer import Answer
from nlcontrol.references.reference_search import Context
from nlcontrol.reports.result_report import deed_answer, why_answer, why_not_answer
from nlcontrol.results.result import Result, result_with, status_of
from nlcontrol.session.corrected_sentences import result_with_corrections
from nlcontrol.session.events import FORCE_RATE, Event, Supervisor
from nlcontrol.session.frame_documents import Frames, text_of
from nlcontrol.session.frame_execution import Approval, Proposal, ResolvedTurn, run_command
from nlcontrol.session.recipe import JournalEntry
from nlcontrol.session.remarks import follow_up_frames as follow_up
from nlcontrol.session.remarks import follow_up_targets as aims
from nlcontrol.session.remarks.follow_up_targets import nothing_before, says_something
from nlcontrol.session.remarks.undo_frames import UndoEntry, undo_frames, undo_text
from nlcontrol.session.turns import TakesTurns, in_turn

if TYPE_CHECKING:
    from grammar.frames.command import Command
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.executor import Motion
    from objectmodels import ObjectModel
    from sim.robots.cell_description import CellDescription
    from sim.supervision import Progress, StopToken


# How sure an answer is: where the values come from that were told, and how well they are known.


def certainty_answer(
    asked: g.Frame, last: Result | None, answer: Callable[[g.Frame], Answer]
) -> Answer | None:
    """How the last answer is known; None if that is not asked, or nothing was answered.

    Args:
        asked: the question.
        last: what was said last.
        answer: gives the answer to a question for a value.
    """
    if not isinstance(asked.goal, g.Parameters):
        return None
    if last is None or last.answer is None or not last.frames:
        return None
    frame, told = last.frames[-1], last.answer
    values = [answer(each) for each in _values_asked(frame)]
    if values:
        text = " ".join(each.text for each in values)
        numbers = {k: v for each in values for k, v in each.numbers.items()}
        return Answer(query="value", text=text, numbers=numbers if len(values) == 1 else {})
    if told.query in ("value", "seen"):
        return told.model_copy(update={"text": f"That is what I see: {told.text}"})
    if told.probability is not None or told.push is not None:
        return told.model_copy(
            update={"text": f"That is worked out from the object's model: {told.text}"}
        )
    return told


def _values_asked(frame: g.Frame) -> Iterator[g.Frame]:
    """A question for the value of each object that a question was about, which a model holds."""
    goal = frame.goal
    if frame.query not in ("value", "compare") or not isinstance(goal, g.Parameters):
        return
    if goal.which == ("distance",):
        return
    for ref in (frame.object, *goal.than):
        if ref is not None and ref.id is not None:
            alone = goal.model_copy(update={"than": ()})
            yield g.Frame(query="value", object=ref, goal=alone)


REMEMBERED = 50
"""Pushes that can be undone, commands that are told of, and texts that units come from."""


class Conversation(TakesTurns):
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
        self._proposals = 0
        controller.journal.conversations += 1
        self.context = Context()
        self.past: list[UndoEntry] = []
        self._last: Result | None = None  # what "why" is about
        self._said: Result | None = None  # what "no, …" is about; None if it was not understood
        self._done: Result | None = None  # the last command, what "a bit more" is about
        self._deeds: list[Result] = []  # the commands up to the last
        self._exchange: g.Command | None = None  # what that was, if things changed places
        self._unread = UnparsedTurns()  # what was not understood since
        self._spoken: tuple[str, ...] = ()  # texts that were understood since, the last first

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

        It may be a remark on what was said and done before. A question is answered from what is
        believed, and moves nothing unless `motion` says so.

        Args:
            text: an English sentence, or frames in its place (docs/frames.md).
            plan_only: stop before anything is executed.
            motion: `never`, as `plan_only`; `simulate`: a question too may move the robot, where it
                asks for a weight or a friction that is not known well and touching would tell.
            progress: told what happens during the simulation.
            on_event: told of every event on the way (`nlcontrol.session.events`).
            stop: asked all the time whether to go on; the result is then `cancelled`.
            force_rate: events of kind `force` per second of the robot's time [Hz].

        Raises:
            ControlError: `internal`, a defect of nlcontrol.
            Exception: what a callback has raised, once the robot is at rest.

        Returns:
            A result in every other case: what is not understood or refused is a result too.
        """
        plan_only |= motion == "never"
        supervisor = self._supervisor(progress, stop, on_event, force_rate)
        deed = JournalEntry.of(text, self._number, "never" if plan_only else motion)
        return self._supervised(
            deed, supervisor, lambda: self._say(text, plan_only, motion, supervisor)[0]
        )

    @in_turn
    def plan(
        self,
        said: str | Frames,
        *,
        stop: StopToken | None = None,
        on_event: Callable[[Event], object] | None = None,
    ) -> Proposal:
        """Plans a sentence from what was seen last; what is planned does not count as done."""
        number, self._proposals = self._proposals, self._proposals + 1
        deed = JournalEntry.of(said, self._number, "never").model_copy(update={"proposes": number})
        supervisor = self._supervisor(None, stop, on_event, 0.0)
        meant: ResolvedTurn | None = None

        def say() -> Result:
            nonlocal meant
            result, meant = self._say(said, True, None, supervisor, proposed=True)
            return result

        with self.controller.last_look.kept():
            result = self._supervised(deed, supervisor, say)
        if meant is None or result.status != "planned":
            return Proposal(number, result, None)
        resolved = meant.command.model_copy(update={"frames": result.frames})
        return Proposal(number, result, replace(meant, command=resolved))

    @in_turn
    def execute(
        self,
        proposal: Proposal,
        *,
        progress: Progress | None = None,
        on_event: Callable[[Event], object] | None = None,
        stop: StopToken | None = None,
        force_rate: float = FORCE_RATE,
    ) -> Result:
        """Does what was proposed, from where things were seen last, beginning with its plan.

        After that it goes on as `say` does. The options are those of `say`.
        """
        meant, approval = proposal.intention, proposal.approval
        assert meant is not None, "nothing was proposed"
        supervisor = self._supervisor(progress, stop, on_event, force_rate)
        deed = JournalEntry(
            said=proposal.result.text, conversation=self._number, executes=proposal.number
        )
        return self._supervised(
            deed, supervisor, lambda: self._do(meant, False, None, supervisor, approval)
        )

    def _supervisor(
        self,
        progress: Progress | None,
        stop: StopToken | None,
        on_event: Callable[[Event], object] | None,
        force_rate: float,
    ) -> Supervisor:
        return Supervisor(
            progress,
            stop,
            on_event=on_event,
            force_rate=force_rate,
            clock=lambda: self.controller.executor.time,
        )

    def _supervised(
        self, deed: JournalEntry, supervisor: Supervisor, do: Callable[[], Result]
    ) -> Result:
        """The result of something that is done, which is noted."""
        journal = self.controller.journal
        with journal.deed(deed, self.controller.models), defects_raised():
            result = result_with_corrections(do(), self.controller, supervisor.stop)
        if supervisor.stop.requested:
            journal.interrupt()
        return supervisor.end(result)

    def _say(
        self,
        said: str | Frames,
        plan_only: bool,
        motion: Motion | None,
        progress: Progress,
        *,
        proposed: bool = False,
    ) -> tuple[Result, ResolvedTurn | None]:
        """The result of a sentence, and what it meant; None if there is nothing to be done."""
        text, command = text_of(said), None
        try:
            command = self.controller.command(said, self._spoken)
            command = self._unread.accepted_command(command) or command
            self._unread = replace(self._unread, offered=None)
            self._spoken = (text, *self._spoken[: REMEMBERED - 1])
            meant = self._intention(command)
            if not isinstance(meant, ResolvedTurn):
                return meant, None
            return self._do(meant, plan_only, motion, progress, proposed=proposed), meant
        except ControlError as raised:
            begun = self.controller.empty_result(text, command)
            offered = (
                None if command else understood_part(self.controller.parser, text, self._spoken)
            )
            refused = with_offer(raised.info, offered)
            self._last = result_with(begun, status=status_of(refused), error=refused)
            named = aims.names_said(text, self.controller.cell, self.controller.models)
            if command is None or named:
                self._note_unread(text, refused.code, named, offered)
            return self._last, None

    def _intention(self, command: g.Command) -> ResolvedTurn | Result:
        """The intention of a command, or what there is to say to a remark."""
        remark = follow_up.sole_remark(command)
        if (reply := aims.reply_to(command, self._said)) is not None:
            return self._plain_result(command, Answer(text=reply), "done")
        if remark == "did":
            done = self._deeds or nothing_before("nothing was done yet")
            told = deed_answer(done, first=aims.asks_first(command))
            self.context = aims.context_of(self.context, told.objects)
            return self._plain_result(command, told, "answered")
        if remark == "why":
            return self._plain_result(command, self._explain_last(command), "answered")
        if remark == "undo":
            return self._way_back(command)
        if self._unread.may_be_meant(command):
            nothing_before("what was said last was not understood, so this may be about that")
        command = follow_up.disambiguate_back(command, self._done)
        command = aims.with_near_thing(aims.without_announced(command), self._done)
        meant = follow_up.meant_command(command, self._said, self._done, self._exchange)
        return ResolvedTurn(
            meant,
            self._notes(command),
            joins=aims.joins_last(command),
            corrects=aims.corrects_object(command),
            exchange=follow_up.exchange_of(meant),
        )

    def _do(
        self,
        meant: ResolvedTurn,
        plan_only: bool,
        motion: Motion | None,
        progress: Progress,
        approval: Approval | None = None,
        *,
        proposed: bool = False,
    ) -> Result:
        """The result of an intention, which is remembered."""
        context = Context() if meant.back else self.context
        result = run_command(
            self.controller,
            meant.command,
            context,
            plan_only=plan_only,
            motion=motion,
            progress=progress,
            approval=approval,
        )
        if meant.back is not None:
            # Remembers what came of an undoing, and returns that with its notes.
            self._last = result_with(result, trace=None)
            self.context = aims.context_after(self.context, result)
            done = [meant.back.undoes[step.frame] for step in result.steps if step.status == "done"]
            if len(done) < len(meant.back.frames):
                # What takes two steps is undone when both are done.
                self._forget([push for push in done if push not in meant.back.undoes[len(done) :]])
                return result_with(result, notes=meant.back.notes + result.notes)
            self._forget(meant.undone)
            notes = (f"undone: “{meant.undone[-1].of.text}”", *meant.back.notes, *result.notes)
            return result_with(result, notes=notes)
        result = result_with(result, notes=meant.notes + result.notes)
        self._last = self._said = kept = result_with(result, trace=None)
        self._unread = UnparsedTurns()
        if not proposed and any(frame.query is None for frame in kept.frames):
            self._done = kept
            self._deeds = [*self._deeds[1 - REMEMBERED :], kept]
            self._exchange = meant.exchange
        self.context = aims.context_after(
            self.context, kept, joins=meant.joins, corrects=meant.corrects
        )
        for step in kept.steps:
            if step.execution and step.plan and step.before:
                self.past.append(UndoEntry.from_step(kept, step.plan, step.before, step.basis))
        del self.past[:-REMEMBERED]
        self.context = aims.with_moved(self.context, self.past, self._deeds)
        cell, models = self.controller.cell, self.controller.models
        self.context = context_with_refused(self.context, kept, cell, models)
        return result

    def _plain_result(
        self, command: g.Command, answer: Answer, status: Literal["done", "answered"]
    ) -> Result:
        result = self.controller.empty_result(command.text, command)
        return result_with(result, ok=True, status=status, answer=answer)

    def _note_unread(
        self, text: str, code: str, named: list[str], offered: g.Command | None
    ) -> None:
        """Remembers what was named where nothing else was understood.

        A correction would be about that, if it may have been a command: it has a verb, or names
        another object; then so would any remark that names none.
        """
        other = is_of_other(text, named, self.context)
        self._unread = self._unread.with_turn(text, offered)
        self.context = context_with_unread(self.context, text, named)
        self._spoken = self._spoken if self._unread.asked else ()
        if other or code == "unknown_verb" or follow_up.has_verb(text):
            self._said = None

    def _notes(self, command: g.Command) -> tuple[str, ...]:
        last = self._said
        if command.frames[0].dialogue != "correct" or not any(p.of is last for p in self.past):
            return ()
        assert last is not None
        return (f"already carried out: “{last.text}”; that is left as it is",)

    def _way_back(self, command: g.Command) -> ResolvedTurn | Result:
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
        return ResolvedTurn(command, undone=tuple(pushed), back=back)

    def _to_undo(self, command: g.Command) -> list[UndoEntry]:
        """The pushes of the last sentence, or the last push of the object that is named."""
        (frame,) = command.frames
        if frame.object is not None and not frame.object.pronoun:
            (frame,) = self.controller.resolve(command, self.context).frames
            name = frame.object.id if frame.object else None
            named = [push for push in self.past if push.object == name]
            return named[-1:] or nothing_before(
                f"the {name} was not pushed yet, so there is nothing to undo"
            )
        if not self.past:
            nothing_before("nothing was pushed that could be undone")
        return [push for push in self.past if push.of is self.past[-1].of]

    def _forget(self, undone: Sequence[UndoEntry]) -> None:
        self.past = [push for push in self.past if push not in undone]

    def _explain_last(self, command: g.Command) -> Answer:
        """Why the last result is as it is; or another push would be, if that is asked about."""
        (frame,) = command.frames
        if known := certainty_answer(frame, self._last, self.controller.answer):
            return known
        if frame.action is None and says_something(frame):
            command = aims.asked_of_last(command, self._said, self._done)
            (frame,) = command.frames
        if frame.action is not None:
            asked = command.model_copy(
                update={"frames": (frame.model_copy(update={"query": None, "event": None}),)}
            )
            with suppress(ControlError):
                asked = self.controller.resolve(asked, self.context)
                self.context = aims.with_objects_of(self.context, asked)
            for told in filter(None, (self._last, self._done)):
                if any(follow_up.says_all_of(each, asked.frames[0]) for each in told.frames):
                    return why_answer(told)
            return why_not_answer(run_command(self.controller, asked, self.context, plan_only=True))
        last = self._last
        if last and last.answer and last.answer.query in ("value", "seen", "did", "compare"):
            last = self._done or last  # facts have no reasons
        return why_answer(last or nothing_before("nothing was said or done yet"))


# What was said and not understood since the last sentence that was, and what it may have meant.
#
# A remark that leaves open what it is about may be about that, so it is asked back. Of a sentence
# that is not read as a whole its longest part that is a command is offered; "yes" has it done.


@dataclass(frozen=True)
class UnparsedTurns:
    """Turns that were not understood since one was.

    Attributes:
        some: whether there are any.
        asked: whether the last was a question.
        offered: the part of the last that is a command.
    """

    some: bool = False
    asked: bool = False
    offered: Command | None = None

    def may_be_meant(self, command: Command) -> bool:
        """Check for a remark, which may be about one of these turns: "slower", "and the mug?"."""
        return self.some and aims.is_remark(command)

    def accepted_command(self, command: Command) -> Command | None:
        """The part that was offered, if a remark accepts it; else None."""
        return self.offered if aims.only_agrees(command) else None

    def with_turn(self, text: str, offered: Command | None) -> UnparsedTurns:
        """These turns, and one more."""
        return UnparsedTurns(some=True, asked=aims.asks(text), offered=offered)


def is_of_other(text: str, named: list[str], context: Context) -> bool:
    """Check for a turn, not understood, about another object than the last that was."""
    other = len(named) > 1 or (bool(named) and named != [*context.latest])
    return not aims.asks(text) and other


def context_with_unread(context: Context, text: str, named: list[str]) -> Context:
    """What was spoken of after a turn that was not understood but names objects."""
    last = tuple(dict.fromkeys((*named, *context.last)))
    unnamed = aims.asks_which(text) or (not named and aims.tells_of_one(text))
    among = tuple(named) if len(named) > 1 else None  # "the mug, not the jar"
    doubt = () if unnamed else among if named else context.doubt
    return replace(context, last=last, doubt=doubt)


def context_with_refused(
    context: Context, result: Result, cell: CellDescription, models: Mapping[str, ObjectModel]
) -> Context:
    """What was spoken of after a sentence that names a place that is not there.

    "Put the mug in the bin" is about the mug, although not even that was looked for.
    """
    bound = any(frame.object and frame.object.id for frame in result.frames)
    if result.status != "not_understood" or bound or context.doubt is not None:
        return context
    named = aims.names_said(result.text, cell, models)
    return context_with_unread(context, result.text, named) if named else context


def with_offer(info: ErrorInfo, offered: Command | None) -> ErrorInfo:
    """A refusal that offers the part of a sentence that is a command."""
    if offered is None:
        return info
    told = f'to have what is understood done, say "yes": "{offered.paraphrase}"'
    kept = tuple(s for s in info.suggestions if not s.startswith("this much is understood"))
    return info.model_copy(update={"suggestions": (*kept, told)})
