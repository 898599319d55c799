"""What a clause says against itself, found before anything is planned; both places are told."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, cast

from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.words.normalisation import Normalised

_FORBIDDING = {
    "topple": ("no_topple", "no_tilt", "max_tilt"),
    "tilt": ("no_tilt",),
    "rotate": ("no_turn",),
    "lift": ("no_lift",),
    "pour": ("no_tilt",),
    "displace": ("no_slide",),
    "place": ("no_slide",),
}
"""Constraints that forbid a goal."""

_EXCLUSIVE = (
    ("gentle", "hard"), ("slow", "fast"), ("effector", "effector"), ("force", "force"),
    ("speed", "speed"), ("duration", "duration"), ("until", "until"),
)  # fmt: skip
_ORDERED = (
    ("force", "max_force"), ("min_force", "force"), ("min_force", "max_force"),
    ("speed", "max_speed"), ("min_speed", "speed"), ("min_speed", "max_speed"),
    ("duration", "max_duration"),
)  # fmt: skip
"""The value of the first is at most that of the second."""

_FALLS = {"tips": ("no_topple", "no_tilt"), "about_to_tip": ("no_tilt",)}


Places = tuple[g.Spans, g.Spans]


def require_consistent(frame: g.Frame, sentence: Normalised) -> None:
    """Refuses a frame that contradicts itself.

    Raises:
        ParseError: `contradiction`, with the spans of both places.
    """
    places = contradiction(frame)
    if places is None:
        return
    quotes = [f'"{_written(spans, sentence)}"' for spans in places]
    raise ParseError(
        "contradiction",
        f"{quotes[0]} and {quotes[1]} contradict each other",
        places[1][0] if places[1] else None,
        tuple(f"say only {quote}" for quote in quotes),
        spans=tuple(span for spans in places for span in spans[:1]),
    )


def contradiction(frame: g.Frame) -> Places | None:
    """The words of the first two things that contradict each other; None if none do."""
    return next(_contradictions(frame), None)


def _written(spans: g.Spans, sentence: Normalised) -> str:
    return " … ".join(sentence.written(span) for span in spans)


def _contradictions(frame: g.Frame) -> Iterator[Places]:
    for clause in frame.constraints:
        if _forbids(clause, frame):
            yield _asks(clause, frame), clause.spans
    for i, second in enumerate(frame.constraints):
        for first in frame.constraints[:i]:
            if _exclude(first, second) or _exclude(second, first):
                yield first.spans, second.spans
    for clause in frame.constraints:
        if isinstance(clause, g.ContactRegion) and _no_such_height(clause):
            yield clause.spans[:1], clause.spans[1:] or clause.spans


def _forbids(clause: g.Constraint, frame: g.Frame) -> bool:
    """Whether a constraint forbids what the goal asks."""
    goal = frame.goal
    if clause.kind in _FORBIDDING.get(goal.kind, ()):
        slides = frame.action in ("push", "pull", "slide") or _still(frame)
        return slides or goal.kind not in ("displace", "place")
    match clause, goal:
        case g.MaxTilt(), g.Tilt(angle=float(angle)):
            return angle > clause.value and goal.bound != "at_most"
        case g.MaxTurn(), g.Rotate(angle=float(angle)):
            return angle > clause.value and goal.bound != "at_most"
        case g.MaxDistance(), g.Displace(distance=float(distance)):
            return distance > clause.value and goal.bound != "at_most"
        case g.NoTouch(object=g.ObjectRef() as other), _ if frame.object is not None:
            itself = other.text.casefold() == frame.object.text.casefold()
            itself = itself or (other.pronoun and not _others(frame))
            return itself or _brings_to(goal, other)
    return False


def _asks(clause: g.Constraint, frame: g.Frame) -> g.Spans:
    """The words that ask for what a constraint forbids: the goal's, or the verb if it says it."""
    goal = frame.goal
    limited = isinstance(clause, g.MaxTilt | g.MaxTurn) and not isinstance(goal, g.Topple)
    by_goal = limited or isinstance(goal, g.Displace | g.Place)
    return (goal.spans if by_goal else frame.spans) or frame.spans + goal.spans


def _still(frame: g.Frame) -> bool:
    """Whether the object is not to move at all."""
    return {"no_slide", "no_tilt", "no_turn"} <= {c.kind for c in frame.constraints}


def _others(frame: g.Frame) -> bool:
    """Whether the goal names another object, which "it" may stand for."""
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


def _exclude(first: g.Constraint, second: g.Constraint) -> bool:
    if (first.kind, second.kind) in _EXCLUSIVE:
        return True
    if (first.kind, second.kind) in _ORDERED:
        return bool(cast(Any, first).value > cast(Any, second).value)
    if isinstance(first, g.Until):
        if second.kind in _FALLS.get(first.event, ()):
            return True
        if isinstance(second, g.NoTouch) and first.event == "touching":
            return first.object is not None and second.object == first.object.model_copy(
                update={"spans": second.object.spans if second.object else ()}
            )
    return False


def _no_such_height(contact: g.ContactRegion) -> bool:
    """Whether a third of the face and a bound of the height leave nothing between them."""
    height = contact.height
    if height is None or contact.region is None or height.bound == "exact":
        return False
    low = (height.bound == "at_most") == (height.origin == "table")
    return contact.region == ("top" if low else "bottom")


def once(constraints: Sequence[g.Constraint]) -> list[g.Constraint]:
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
