"""Several objects, one of several, and which of a row: what can be counted, and where.

"All the boxes but the red one" is the object of a command; elsewhere one object is needed, or two
that something is put between. "The third tin" has to say from where.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from grammar.clauses.clause_parts import Parts, several_objects, unexpected_part
from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.frames.command import references_in
from grammar.phrases import phrase_parts as ph
from grammar.words.normalisation import Normalised

_UNCOUNTED = frozenset({"other", "same", "moved_first", "moved_last", "middle"})
"""Qualities that put nothing in a row."""


def with_listed_exceptions(parts: Sequence[ph.Part]) -> Parts:
    """The parts of a sentence, with each thing of a list of exceptions as an exception."""
    out: Parts = []
    for part in parts:
        match [*out[-2:], part]:
            case [ph.Except(), ph.Separator(word="and" | ","), ph.Thing() as thing]:
                out[-1] = ph.Except(thing.span, thing)
            case _:
                out.append(part)
    return out


def with_exception(
    things: Sequence[ph.Thing], part: ph.Except | ph.NotThis, sentence: Normalised
) -> list[ph.Thing]:
    """The objects of a clause, of which a thing is not meant.

    Raises:
        ParseError: `unexpected_words` if they are not several of some kind.
    """
    if len(things) != 1 or things[0].ref.quantifier not in ("all", "rest"):
        raise unexpected_part(part, sentence)
    ref = things[0].ref
    update = {
        "exceptions": (*ref.exceptions, part.thing.ref), "spans": (*ref.spans, part.span),
    }  # fmt: skip
    return [replace(things[0], ref=ref.model_copy(update=update))]


def without_both(things: Sequence[ph.Thing]) -> list[ph.Thing]:
    """The objects of a clause, of which "both the one and the other" names two."""
    if len(things) != 2 or things[0].ref.quantifier != "both":
        return list(things)
    ref = things[0].ref.model_copy(update={"quantifier": None})
    return [replace(things[0], ref=ref), things[1]]


def with_left_alone(frames: Sequence[g.Frame]) -> tuple[g.Frame, ...]:
    """Frames without those that leave a thing where it is, which the others do not touch then."""
    left = {id(frame): clause for frame in frames if (clause := _left_alone(frame)) is not None}
    if len(left) == len(frames):
        return tuple(frames)
    spared = tuple(left.values())
    return tuple(
        frame.model_copy(update={"constraints": (*frame.constraints, *spared)})
        for frame in frames
        if id(frame) not in left
    )


def _left_alone(frame: g.Frame) -> g.NoTouch | None:
    """A constraint for "leave the jar where it is"; None if a frame says something else."""
    goal, thing = frame.goal, frame.object
    if not isinstance(goal, g.Place) or goal.relation != "place_of" or thing is None:
        return None
    where = goal.reference
    stays = isinstance(where, tuple) and len(where) == 1 and where[0].pronoun
    if frame.action != "place" or not stays or frame.query or thing.pronoun:
        return None
    return g.NoTouch(object=thing, spans=(*frame.spans, *thing.spans, *goal.spans))


def require_no_other_meant(clause: Parts, frames: Sequence[g.Frame], sentence: Normalised) -> None:
    """Refuses "them" in a clause about one object, where the clauses before it are about others.

    Raises:
        ParseError: `several_objects`.
    """
    named = [part for part in clause if isinstance(part, ph.Thing)]
    several = len(named) > 1 or any(t.ref.quantifier or t.ref.text.endswith("s") for t in named)
    if several or len(frames) < 2:
        return
    for part in clause:
        mention = getattr(part, "thing", None) or getattr(part, "subject", None)
        if isinstance(mention, ph.Thing) and mention.ref.text.casefold() == "them":
            raise several_objects(mention, sentence)


def require_countable(frames: Sequence[g.Frame], sentence: Normalised) -> None:
    """Refuses several objects where one is needed, and a number in no row.

    Raises:
        ParseError: `several_objects` or `does_not_apply`.
    """
    for frame in frames:
        goal = frame.goal
        between = isinstance(goal, g.Place) and goal.relation == "between"
        plain = frame.action is not None and not frame.dialogue
        instead = frame.action is None and frame.dialogue in ("correct", "same", "repeat")
        done = frame.query in (None, "possible")
        apart = isinstance(goal, g.Parameters) and goal.which == ("distance",)
        allowed = [frame.object] if ((plain or instead) and done) or apart else []
        if between and isinstance(goal, g.Place) and isinstance(goal.reference, tuple):
            allowed += goal.reference
        for ref in references_in(frame):
            several = ref.quantifier not in (None, "any")
            if several and not any(ref is each for each in allowed):
                raise _error(ref, "several_objects", "is several objects", "name one", sentence)
            if ref.ordinal is not None and set(ref.qualities) <= _UNCOUNTED:
                message, hint = "does not say from where it is counted", "the third from the left"
                raise _error(ref, "does_not_apply", message, hint, sentence)


def _error(
    ref: g.ObjectRef, code: str, message: str, hint: str, sentence: Normalised
) -> ParseError:
    return sentence.error_at(ref.spans[0], code, message, hint)
