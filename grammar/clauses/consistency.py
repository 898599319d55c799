"""Contradictions within one clause, found before anything is planned, with both their places."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, cast

from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.frames.constraints import (
    EXCLUSIVE,
    FORBIDS,
    FORBIDS_BELOW,
    FORBIDS_EVENT,
    ORDERED,
    STILL,
)
from grammar.words.normalisation import Normalised

Places = tuple[g.Spans, g.Spans]


def require_consistent(frame: g.Frame, sentence: Normalised) -> None:
    """Refuses a frame that contradicts itself.

    Raises:
        ParseError: `contradiction`, with the spans of both places.
    """
    if places := first_contradiction(frame):
        raise contradiction_error(*places, sentence)


def contradiction_error(
    first: g.Spans,
    second: g.Spans,
    sentence: Normalised,
    message: str = "contradict each other",
) -> ParseError:
    """The error about the words in two places, of which only one can be meant."""
    quotes = [f'"{" … ".join(map(sentence.words_as_written, spans))}"' for spans in (first, second)]
    return ParseError(
        "contradiction",
        f"{' and '.join(quotes)} {message}",
        second[0] if second else None,
        tuple(f"say only {quote}" for quote in quotes),
        spans=(*first[:1], *second[:1]),
    )


def first_contradiction(frame: g.Frame) -> Places | None:
    """The words of the first two things that contradict each other; None if none do."""
    return next(_find_contradictions(frame), None)


def _find_contradictions(frame: g.Frame) -> Iterator[Places]:
    for clause in frame.constraints:
        if _forbids_goal(clause, frame):
            yield _goal_words(clause, frame), clause.spans
    for i, second in enumerate(frame.constraints):
        for first in frame.constraints[:i]:
            if _exclude_each_other(first, second) or _exclude_each_other(second, first):
                yield first.spans, second.spans
    for clause in frame.constraints:
        if isinstance(clause, g.ContactRegion) and _leaves_no_height(clause):
            yield clause.spans[:1], clause.spans[1:] or clause.spans


def _forbids_goal(clause: g.Constraint, frame: g.Frame) -> bool:
    """Check for a constraint that forbids what the goal asks."""
    goal = frame.goal
    if clause.kind in FORBIDS.get(goal.kind, ()):
        slides = frame.action in ("push", "pull", "slide") or is_still(frame.constraints)
        return slides or goal.kind not in ("displace", "place")
    if isinstance(clause, g.NoTouch):
        return _keeps_off_goal(clause, frame)
    field, limit = FORBIDS_BELOW.get(goal.kind, ("", ""))
    if clause.kind != limit or cast(Any, goal).bound == "at_most":
        return False
    value = getattr(goal, field)
    return isinstance(value, float) and value > cast(Any, clause).value


def _keeps_off_goal(clause: g.NoTouch, frame: g.Frame) -> bool:
    """Check for an object that must not be touched, but is moved itself or is moved to."""
    other = clause.object
    if other is None or frame.object is None:
        return False
    itself = other.text.casefold() == frame.object.text.casefold()
    itself = itself or (other.pronoun and not _names_another(frame))
    return itself or _brings_to(frame.goal, other)


def _goal_words(clause: g.Constraint, frame: g.Frame) -> g.Spans:
    """Words that ask for what a constraint forbids: the goal's, or the verb if it says it."""
    goal = frame.goal
    _, limit = FORBIDS_BELOW.get(goal.kind, ("", ""))
    by_goal = clause.kind == limit or isinstance(goal, g.Displace | g.Place)
    return (goal.spans if by_goal else frame.spans) or frame.spans + goal.spans


def is_still(constraints: Sequence[g.Constraint]) -> bool:
    """Check for constraints that keep the object where it is."""
    return set(STILL) <= {constraint.kind for constraint in constraints}


def _names_another(frame: g.Frame) -> bool:
    """Check for a goal that names another object, for which "it" may stand."""
    goal = frame.goal
    if isinstance(goal, g.Place):
        return isinstance(goal.reference, tuple)
    if isinstance(goal, g.Pour):
        return goal.into is not None
    return isinstance(goal, g.Displace) and isinstance(goal.toward, g.ObjectRef)


def _brings_to(goal: g.Goal, other: g.ObjectRef) -> bool:
    if not isinstance(goal, g.Place) or not isinstance(goal.reference, tuple):
        return False
    names = {ref.text.casefold() for ref in goal.reference}
    return goal.relation in ("touching", "on") and other.text.casefold() in names


def _exclude_each_other(first: g.Constraint, second: g.Constraint) -> bool:
    if (first.kind, second.kind) in EXCLUSIVE:
        return True
    if (first.kind, second.kind) in ORDERED:
        return bool(cast(Any, first).value > cast(Any, second).value)
    if isinstance(first, g.Until):
        if second.kind in FORBIDS_EVENT.get(first.event, ()):
            return True
        if isinstance(second, g.NoTouch) and first.event == "touching":
            return first.object is not None and second.object == first.object.model_copy(
                update={"spans": second.object.spans if second.object else ()}
            )
    return False


def _leaves_no_height(contact: g.ContactRegion) -> bool:
    """Check for a third of the face and a bound of the height with nothing between them."""
    height = contact.height
    if height is None or contact.region is None or height.bound == "exact":
        return False
    low = (height.bound == "at_most") == (height.origin == "table")
    return contact.region == ("top" if low else "bottom")


def join_equal(constraints: Sequence[g.Constraint]) -> list[g.Constraint]:
    """Joins constraints that say the same ("gently … carefully")."""
    out: list[g.Constraint] = []
    for new in constraints:
        bare = new.model_copy(update={"spans": ()})
        for i, known in enumerate(out):
            if known.model_copy(update={"spans": ()}) == bare:
                out[i] = known.model_copy(update={"spans": (*known.spans, *new.spans)})
                break
        else:
            out.append(new)
    return out
