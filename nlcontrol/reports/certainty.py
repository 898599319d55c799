"""How sure an answer is: where the values come from that were told, and how well they are known."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from grammar.frames import command as g
from nlcontrol.questions.answer import Answer

if TYPE_CHECKING:
    from nlcontrol.results.result import Result

_SEEN = ("value", "seen")


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
    if told.query in _SEEN:
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
