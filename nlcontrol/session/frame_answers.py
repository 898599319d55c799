"""Answers to the questions of a command; what can be done is planned as it would be done.

A question whether something can be done is answered by one plan where that suffices. Where several
objects are asked about at once, or where something stands in the way of one, it is yes if the whole
command could be carried out, with what is moved aside for it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import takewhile
from typing import TYPE_CHECKING, Protocol

from grammar.frames import command as g
from grammar.paraphrasing.command_wording import paraphrase
from nlcontrol.questions.answer import Answer
from nlcontrol.session.remarks.merged_frames import without_spans

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from objectmodels.models.object_model import ObjectModel
    from planner.types.world_state import WorldState
    from sim.supervision import StopToken

_IN_THE_WAY = ("blocked", "out_of_reach")
"""Reasons of refusals that other steps may change."""


class Answerer(Protocol):
    """Robot that answers single questions: a `nlcontrol.session.controller.Controller`."""

    @property
    def models(self) -> Mapping[str, ObjectModel]:
        """Models of what stands on the table, by name."""

    def answer(
        self, frame: g.Frame, state: WorldState | None = None, *, stop: StopToken | None = None
    ) -> Answer:
        """The answer to a question; raises `ControlError` where there is none."""


def frames_asked_at_once(frames: Sequence[g.Frame], index: int) -> tuple[g.Frame, ...]:
    """The frame of a question, and those after it that ask by the same words what can be done."""
    first, *later = frames[index:]
    if first.query != "possible" or not first.spans:
        return (first,)
    same = takewhile(lambda f: f.query == "possible" and f.spans == first.spans, later)
    return (first, *same)


def answer_to(
    controller: Answerer,
    asked: tuple[g.Frame, ...],
    state: WorldState,
    stop: StopToken,
    propose: Callable[[tuple[g.Frame, ...]], Result],
) -> Answer:
    """The answer to frames that are asked at once.

    Args:
        controller: that answers single questions.
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
        hindered = answer.query == "possible" and answer.reason in _IN_THE_WAY
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
