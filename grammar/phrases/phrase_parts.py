"""Phrases of a sentence, one by one, before they are put together as frames.

Quantities are in SI units and radians; spans are columns of the sentence as given.
"""

from __future__ import annotations

from dataclasses import dataclass

from grammar.frames.command import (
    Bound,
    Constraint,
    Dialogue,
    Direction,
    Event,
    Method,
    NoTouch,
    ObjectRef,
    Point,
    Quality,
    Query,
    RelativeLength,
    Span,
    TableRegion,
)


@dataclass(frozen=True)
class Part:
    """A phrase of the sentence; `span` is where it stands."""

    span: Span


# --- what holds the sentence together ---------------------------------------------------------


@dataclass(frozen=True)
class SeparatorPart(Part):
    """A comma, a full stop, or a word that joins: `and`, `or`, `but`."""

    word: str


@dataclass(frozen=True)
class NextPart(Part):
    """Then; first."""

    word: str


@dataclass(frozen=True)
class FillerPart(Part):
    """Words without a meaning of their own, and whether they may stand anywhere (please)."""

    anywhere: bool


@dataclass(frozen=True)
class MePart(Part):
    """The person who speaks, as the one to whom something is handed."""


@dataclass(frozen=True)
class TherePart(Part):
    """There: a place that only the situation names."""


# --- the verb and things ----------------------------------------------------------------------


@dataclass(frozen=True)
class VerbPart(Part):
    """A verb in its base form, without its particle.

    Attributes:
        word: the verb.
        passive: whether something is said to be done.
        completed: where the rest of it stands, in "make it slide".
    """

    word: str
    passive: bool = False
    completed: Span | None = None


@dataclass(frozen=True)
class ThingPart(Part):
    """A named object, or "it"; `span` is the name's, without the article."""

    ref: ObjectRef
    contents: bool = False


@dataclass(frozen=True)
class ThatIsPart(Part):
    """Words such as "that is": a place follows that distinguishes the object."""


@dataclass(frozen=True)
class SidePart(Part):
    """On the left: tells the object from others."""

    quality: Quality


@dataclass(frozen=True)
class ParticlePart(Part):
    """A word that belongs to the verb, or means a direction: over, up, down.

    It is optional where it may as well belong to a direction: "over to the left" topples with
    "knock", and is no more than "to the left" with "push".
    """

    word: str
    optional: bool = False


@dataclass(frozen=True)
class DiagonalPart(Part):
    """Diagonally: two directions are to follow."""


# --- what should become of it -----------------------------------------------------------------


@dataclass(frozen=True)
class DirectionPart(Part):
    """A direction; `implied` if it follows from the side that is touched."""

    value: Direction
    implied: bool = False


@dataclass(frozen=True)
class HeadingPart(Part):
    """A direction as an angle, counter-clockwise from straight ahead [rad]."""

    value: float


@dataclass(frozen=True)
class TowardPart(Part):
    """A target to move towards."""

    target: ObjectRef | TableRegion


@dataclass(frozen=True)
class AwayFromPart(Part):
    """A part of the table to move away from."""

    region: TableRegion


@dataclass(frozen=True)
class PlacePart(Part):
    """A place; the relation is one of the contract's, or `from`, `away_from`, `to`."""

    relation: str
    reference: tuple[ObjectRef, ...] | Point | TableRegion


@dataclass(frozen=True)
class IntoPart(Part):
    """The object to pour into."""

    target: ObjectRef


@dataclass(frozen=True)
class LengthPart(Part):
    """A distance [m], or measured in objects; `most` is the other end of a range."""

    value: float | RelativeLength
    bound: Bound
    most: float | None = None


@dataclass(frozen=True)
class AnglePart(Part):
    """An angle [rad]."""

    value: float
    bound: Bound


@dataclass(frozen=True)
class AmountPart(Part):
    """A little, a lot."""

    value: str


@dataclass(frozen=True)
class SharePart(Part):
    """Half of the way, all the way; or, of a liquid, half of it."""

    value: float
    of_way: bool


@dataclass(frozen=True)
class VolumePart(Part):
    """A volume of a liquid [m³]."""

    value: float


@dataclass(frozen=True)
class FullPart(Part):
    """Until it is half full: a share of what can be filled, and of what this is said."""

    value: float
    subject: ThingPart | None = None


@dataclass(frozen=True)
class FilledWithPart(Part):
    """The liquid to fill with."""

    thing: ThingPart


@dataclass(frozen=True)
class LidPart(Part):
    """A part of an object that is opened or closed."""

    name: str


@dataclass(frozen=True)
class TablePart(Part):
    """On the table, of something that is put there."""


@dataclass(frozen=True)
class MethodPart(Part):
    """By lifting it: how something is found out."""

    value: Method


@dataclass(frozen=True)
class SensePart(Part):
    """Clockwise or not."""

    value: str


# --- constraints ------------------------------------------------------------------------------


@dataclass(frozen=True)
class ConstraintPart(Part):
    """A constraint, whole in itself; `subject` is what it says this of, if it names it."""

    constraint: Constraint
    subject: ThingPart | None = None


@dataclass(frozen=True)
class AvoidPart(Part):
    """An event that must not happen.

    Attributes:
        kind: kind of the constraint, "" if a particle is still needed ("knocking it over").
        word: the verb as it stands.
        thing: what it must not happen to; None if not said.
        further: whether it continues a list that an earlier part opened.
    """

    kind: str
    word: str
    thing: ThingPart | None = None
    further: bool = False


@dataclass(frozen=True)
class FurtherNoTouchPart(Part):
    """… or touching the mug; `either` if it says "or"."""

    constraint: NoTouch
    either: bool


@dataclass(frozen=True)
class ResultPart(Part):
    """A wanted event: "so that it falls over"."""

    event: str
    subject: ThingPart
    amount: str | None = None


# --- questions and remarks --------------------------------------------------------------------


@dataclass(frozen=True)
class AskPart(Part):
    """The opening of a question.

    Attributes:
        query: kind of the question; None if it is asked only with a question mark ("can you").
        event: what may happen, if the question names it.
        thing: what it is about, if the question itself names it.
        which: the parameters that are asked for.
        whole: whether it needs no action to be said.
        negated: whether it asks why something was not done.
    """

    query: Query | None
    event: Event | None = None
    thing: ThingPart | None = None
    which: tuple[str, ...] = ()
    whole: bool = False
    negated: bool = False


@dataclass(frozen=True)
class IfPart(Part):
    """If, when: the action that is asked about follows."""


@dataclass(frozen=True)
class PurposePart(Part):
    """To make it slide; `before` if it is about what must not yet happen ("before it tips")."""

    event: Event
    thing: ThingPart | None
    before: bool = False


@dataclass(frozen=True)
class ExplorePart(Part):
    """Find out how heavy it is."""

    which: tuple[str, ...]
    thing: ThingPart


@dataclass(frozen=True)
class RemarkPart(Part):
    """A remark: undo that, again, no."""

    dialogue: Dialogue


@dataclass(frozen=True)
class NotThisPart(Part):
    """Not the mug: what was not meant."""

    thing: ThingPart
