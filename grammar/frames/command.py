"""Frames: what a sentence says, as data.

A command is a tuple of frames. A frame says what should become of one object: an action, a goal
(a discriminated union on `kind`) and constraints (likewise). Names of kinds and fields are a
public contract; kinds may be added, none is renamed.

Frames and units: directions are the robot's, which stands at the table's −x edge of W and looks
along +x: `away` is +x, `toward` −x, `left` +y, `right` −y. Everything is in SI units and radians.
Every part that came from words carries `spans`, a tuple of `[start, end)` in code points of the
sentence as it was given.
"""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import BaseModel

from grammar.frames.constraints import (
    Constraint,
    ContactRegion,
    Duration,
    Effector,
    Fast,
    Force,
    Gentle,
    Hard,
    MaxDistance,
    MaxDuration,
    MaxForce,
    MaxSpeed,
    MaxTilt,
    MaxTurn,
    MinForce,
    MinSpeed,
    NoLift,
    NoSlide,
    NoSpill,
    NoTilt,
    NoTopple,
    NoTouch,
    NoTurn,
    Slow,
    Speed,
    Until,
)
from grammar.frames.goals import (
    Close,
    Displace,
    Goal,
    HandOver,
    Lift,
    NoGoal,
    Open,
    Parameters,
    Place,
    Pour,
    Rotate,
    SetDown,
    State,
    Tilt,
    Topple,
    Upright,
)
from grammar.frames.vocabulary import (
    Action,
    Amount,
    Bound,
    ContactHeight,
    Dialogue,
    Direction,
    Event,
    FaceName,
    Method,
    ObjectRef,
    Part,
    Point,
    Quality,
    Quantifier,
    Query,
    Relation,
    RelativeLength,
    Sense,
    Side,
    Span,
    Spans,
    TableRegion,
)

__all__ = [
    "Action", "Amount", "Bound", "Close", "Command", "Constraint", "ContactHeight",
    "ContactRegion", "Dialogue", "Direction", "Displace", "Duration", "Effector", "Event",
    "FaceName", "Fast", "Force", "Frame", "Gentle", "Goal", "HandOver", "Hard", "Lift",
    "MaxDistance", "MaxDuration", "MaxForce", "MaxSpeed", "MaxTilt", "MaxTurn", "Method",
    "MinForce", "MinSpeed", "NoGoal", "NoLift", "NoSlide", "NoSpill", "NoTilt", "NoTopple",
    "NoTouch", "NoTurn", "ObjectRef", "Open", "Parameters", "Place", "Point", "Pour", "Quality",
    "Quantifier", "Query", "Relation", "RelativeLength", "Rotate", "Sense", "SetDown", "Side",
    "Slow", "Span", "Spans", "Speed", "State", "TableRegion", "Tilt", "Topple", "Until", "Upright",
]  # fmt: skip


class Frame(Part):
    """One clause of a command: action, object, goal and constraints; or a question or remark.

    Attributes:
        action: what is done; None for a question or a remark that names none.
        query: what is asked, if it is a question.
        dialogue: what the remark does, if it is one.
        object: what it is done to.
        goal: what should become of the object.
        constraints: what must hold on the way, in the order of the sentence.
        event: what a question asks about ("will it topple if…", "… to make it slide").
        negated: whether a question asks why it was *not* done.
        spans: the words that gave the action, the query or the dialogue.
    """

    action: Action | None = None
    query: Query | None = None
    dialogue: Dialogue | None = None
    object: ObjectRef | None = None
    goal: Goal = NoGoal()
    constraints: tuple[Constraint, ...] = ()
    event: Event | None = None
    negated: bool = False
    spans: Spans = ()


class Command(Part):
    """A sentence, and what was understood.

    Attributes:
        text: the sentence as given; of frames that came without one, the paraphrase.
        frames: what is to be done, one after the other.
        paraphrase: the frames in plain words, which are read as the same frames.
        asides: words of the text that set nothing: courtesy, and what was taken back.
    """

    text: str
    frames: tuple[Frame, ...]
    paraphrase: str
    asides: Spans = ()

    @property
    def left_out(self) -> tuple[str, ...]:
        """The words of the text that set nothing, as they were said."""
        return tuple(self.text[start:end] for start, end in self.asides)


def references_in(part: BaseModel) -> Iterator[ObjectRef]:
    """Each reference within a part of a frame."""
    if isinstance(part, ObjectRef):
        yield part
    for value in filter(None, vars(part).values()):
        if isinstance(value, BaseModel):
            yield from references_in(value)
        elif isinstance(value, tuple) and isinstance(value[0], BaseModel):
            for inner in value:
                yield from references_in(inner)
