"""Ways back: "put it back" alone undoes, behind something else it is a place.

"Push the mug to the left, then back" ends where the mug was.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from grammar.clauses.counted_objects import with_left_alone
from grammar.frames import command as g
from grammar.words.normalisation import Normalised

_TO_AND_FRO = re.compile("(?<= )and back again(?= |$)")


def with_ways_back(frames: Sequence[g.Frame], sentence: Normalised) -> tuple[g.Frame, ...]:
    """Takes "put it back" alone for an undoing, and behind something else for a place.

    Raises:
        ParseError: `does_not_apply`, for "back" that may mean two ways.
    """
    if len(frames) == 1:
        if again := _TO_AND_FRO.search(sentence.text):
            message = "may be the way back, or a way to go"
            span = sentence.original_span(*again.span())
            raise sentence.error_at(span, "does_not_apply", message, "then put it back")
        (frame,) = frames
        goal, thing = frame.goal, frame.object
        back = isinstance(goal, g.Place) and goal.relation == "back" and not frame.query
        alone = thing.quantifier is None if thing else frame.dialogue == "correct"
        if back and alone and not frame.constraints:
            spans = tuple(sorted((*frame.spans, *goal.spans)))
            return (g.Frame(dialogue="undo", object=thing, spans=spans),)
        return tuple(frames)
    then = [_as_return(frame, before, sentence) for before, frame in pairwise(frames)]
    return with_left_alone([_as_way_back(frame, sentence) for frame in (frames[0], *then)])


def _as_return(frame: g.Frame, before: g.Frame, sentence: Normalised) -> g.Frame:
    """Takes "then back" behind a way for the way back to where it was.

    Raises:
        ParseError: if it says how far, which may be on that way, or toward the robot.
    """
    goal, way = frame.goal, before.goal
    if not isinstance(goal, g.Displace) or not isinstance(way, g.Displace) or frame.query:
        return frame
    said = [span for span in goal.spans if _is_back(sentence, span)]
    own_verb = frame.spans != before.spans  # "…, then pull it back" goes toward the robot
    if not said or own_verb or frame.object != before.object or way.direction == "toward":
        return frame
    if goal.distance or goal.amount or goal.fraction:
        message = "may be on its way, or toward the robot"
        hints = "then put it back", "then toward me"
        raise sentence.error_at(said[0], "does_not_apply", message, *hints)
    back = g.Place(relation="back", reference=(), spans=tuple(said))
    return frame.model_copy(update={"action": "place", "goal": back})


def _as_way_back(frame: g.Frame, sentence: Normalised) -> g.Frame:
    said = [sentence.words_as_written(span).casefold().split() for span in frame.spans]
    if frame.dialogue != "undo" or not any("back" in words for words in said):
        return frame
    several = any("them" in words for words in said)
    it = g.ObjectRef(text="them" if several else "it", spans=frame.spans, pronoun=True)
    goal = g.Place(relation="back", reference=())
    return g.Frame(action="place", object=frame.object or it, goal=goal, spans=frame.spans)


def _is_back(sentence: Normalised, span: g.Span) -> bool:
    return sentence.words_as_written(span).casefold().split()[-1:] == ["back"]
