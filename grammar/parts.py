"""What the phrases of a sentence say, one by one, before they are put together as a frame.

Quantities are in SI units and radians; spans are columns of the sentence as given.
"""

from __future__ import annotations

from dataclasses import dataclass

from grammar.frames import Bound, Constraint, Direction, ObjectRef, Span


@dataclass(frozen=True)
class Part:
    """A phrase of the sentence; `span` is where it stands."""

    span: Span


@dataclass(frozen=True)
class VerbPart(Part):
    """A verb, without its particle."""

    word: str


@dataclass(frozen=True)
class ObjectPart(Part):
    """What is named: the name, or "it"; `span` is the name's, without the article."""

    ref: ObjectRef
    contents: bool = False

    @property
    def is_pronoun(self) -> bool:
        """Whether the object is called "it"."""
        return self.ref.text.lower() == "it"


@dataclass(frozen=True)
class DirectionPart(Part):
    """A direction; `implied` if it follows from the side that is touched."""

    value: Direction
    implied: bool = False


@dataclass(frozen=True)
class ParticlePart(Part):
    """A word that belongs to the verb, or means a direction: over, up, down.

    It is optional where it may as well belong to a direction: "over to the left" topples with
    "knock", and is no more than "to the left" with "push".
    """

    word: str
    optional: bool = False


@dataclass(frozen=True)
class LengthPart(Part):
    """A distance [m]."""

    value: float
    bound: Bound


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
class SensePart(Part):
    """Clockwise or not."""

    value: str


@dataclass(frozen=True)
class TowardPart(Part):
    """The object to move towards."""

    target: ObjectPart


@dataclass(frozen=True)
class IntoPart(Part):
    """The object to pour into."""

    target: ObjectPart


@dataclass(frozen=True)
class ConstraintPart(Part):
    """A constraint, whole in itself."""

    constraint: Constraint


@dataclass(frozen=True)
class AvoidPart(Part):
    """What must not happen.

    Attributes:
        kind: kind of the constraint, "" if a particle is still needed ("knocking it over").
        word: the verb as it stands.
        thing: what it must not happen to; None if not said.
        further: whether it continues a list that an earlier part opened.
    """

    kind: str
    word: str
    thing: ObjectPart | None = None
    further: bool = False
