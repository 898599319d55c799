"""Phrases of a sentence, one by one, before they are put together as frames; imported as `ph`.

Quantities are in SI units and radians; spans are columns of the sentence as given.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, dataclass_transform

from grammar.frames import command as g


@dataclass_transform(frozen_default=True)
@dataclass(frozen=True)
class Part:
    """A phrase of the sentence; `span` is where it stands. Its kinds are frozen dataclasses too."""

    span: g.Span

    def __init_subclass__(cls) -> None:
        dataclass(frozen=True)(cls)


# --- what holds the sentence together ---------------------------------------------------------


class Separator(Part):
    """A comma, a full stop, or a word that joins: `and`, `or`, `but`."""

    word: str


class Next(Part):
    """Then; first."""

    word: str


class Filler(Part):
    """Words without a meaning of their own.

    Attributes:
        anywhere: whether they may stand anywhere (please).
        goes_on: whether with an object alone they mean the same as before (now, as well).
        asks: whether they make a request of a question (please, could you).
    """

    anywhere: bool
    goes_on: bool = False
    asks: bool = False


class Me(Part):
    """The person who speaks, as the one to whom something is handed."""


class There(Part):
    """There: a place that only the situation names."""


# --- the verb and things ----------------------------------------------------------------------


class Verb(Part):
    """A verb in its base form, without its particle.

    Attributes:
        word: the verb.
        passive: whether something is said to be done.
        completed: where the rest of it stands, in "make it slide", "give it a push".
    """

    word: str
    passive: bool = False
    completed: g.Span | None = None


class Wish(Part):
    """I want: what follows is how things should be.

    Attributes:
        state: the words for where something is to be ("should be").
    """

    state: g.Span | None = None


class Stroke(Part):
    """A push, as what is given: the verb that it stands for."""

    verb: str


class Thing(Part):
    """A named object, or "it"; `span` is the name's, without the article."""

    ref: g.ObjectRef
    contents: bool = False


class Except(Part):
    """But the red one: a thing that is not meant."""

    thing: Thing


class ThatIs(Part):
    """Words such as "that is": a place follows that distinguishes the object."""


class Side(Part):
    """On the left: tells the object from others."""

    quality: g.Quality


class Particle(Part):
    """A word that belongs to the verb, or means a direction: over, up, down.

    It is optional where it may as well belong to a direction: "over to the left" topples with
    "knock", and is no more than "to the left" with "push".
    """

    word: str
    optional: bool = False


class Diagonal(Part):
    """Diagonally: two directions are to follow."""


# --- what should become of it -----------------------------------------------------------------


class Direction(Part):
    """A direction; `implied` if it follows from the side that is touched."""

    value: g.Direction
    implied: bool = False


class Heading(Part):
    """A direction as an angle, counter-clockwise from straight ahead [rad]."""

    value: float


class Toward(Part):
    """A target to move towards."""

    target: g.ObjectRef | g.TableRegion


class AwayFrom(Part):
    """A part of the table to move away from."""

    region: g.TableRegion


class Place(Part):
    """A place; the relation is one of the contract's, or `from`, `away_from`, `to`.

    `beside` tells "on its left", which may be said of what was named last.
    """

    relation: str
    reference: tuple[g.ObjectRef, ...] | g.Point | g.TableRegion
    beside: bool = False


class Into(Part):
    """The object to pour into."""

    target: g.ObjectRef


class Length(Part):
    """A distance [m], or measured in objects; `most` is the other end of a range.

    It may be said from where it is measured, if that is the table.
    """

    value: float | g.RelativeLength
    bound: g.Bound
    most: float | None = None
    above: Literal["table"] | None = None


class Angle(Part):
    """An angle [rad]."""

    value: float
    bound: g.Bound


class Amount(Part):
    """A little, a lot."""

    value: str


class Share(Part):
    """Half of the way, all the way; or, of a liquid, half of it."""

    value: float
    of_way: bool


class Volume(Part):
    """A volume of a liquid [m³]."""

    value: float


class Full(Part):
    """Until it is half full: a share of what can be filled, and of what this is said."""

    value: float
    subject: Thing | None = None


class FilledWith(Part):
    """The liquid to fill with."""

    thing: Thing


class Lid(Part):
    """A part of an object that is opened or closed, by its name."""

    value: str


class Table(Part):
    """On the table, of something that is put there."""


class FromTable(Part):
    """From the table, on which everything stands."""


class Settles(Part):
    """And let it fall back, of what is tilted."""


class LetGo(Part):
    """And let it go, which a push does anyway."""


class Method(Part):
    """By lifting it: how something is found out."""

    value: g.Method


class Sense(Part):
    """Clockwise or not."""

    value: str


class Facing(Part):
    """An object, or a direction, that a side is to face."""

    target: g.ObjectRef | g.Direction


class Parallel(Part):
    """An edge of the table, or an object, along which a side is to lie."""

    target: g.ObjectRef | g.TableRegion


class Room(Part):
    """An object for which there is to be room."""

    target: g.ObjectRef


# --- constraints ------------------------------------------------------------------------------


class Constraint(Part):
    """A constraint, whole in itself; `subject` is what it says this of, if it names it."""

    constraint: g.Constraint
    subject: Thing | None = None


class Avoid(Part):
    """An event that must not happen.

    Attributes:
        kind: kind of the constraint, "" if a particle is still needed ("knocking it over").
        word: the verb as it stands.
        thing: what it must not happen to; None if not said.
        further: whether it continues a list that an earlier part opened.
    """

    kind: str
    word: str
    thing: Thing | None = None
    further: bool = False


class FurtherNoTouch(Part):
    """… or touching the mug; `either` if it says "or"."""

    constraint: g.NoTouch
    either: bool


class Result(Part):
    """A wanted event: "so that it falls over"."""

    event: str
    subject: Thing
    amount: str | None = None


# --- questions and remarks --------------------------------------------------------------------


class Ask(Part):
    """The opening of a question.

    Attributes:
        query: kind of the question; None if it is asked only with a question mark ("can you").
        event: what may happen, if the question names it.
        thing: what it is about, if the question itself names it.
        which: the parameters that are asked for.
        than: what it is compared with.
        state: what is asked to be so: where it is, that it stands; any value told; none else.
        whole: whether it needs no action to be said.
        negated: whether it asks why something was not done.
    """

    query: g.Query | None
    event: g.Event | None = None
    thing: Thing | None = None
    which: tuple[str, ...] = ()
    than: tuple[g.ObjectRef, ...] = ()
    state: g.State | g.Parameters | None = None
    whole: bool = False
    negated: bool = False


class If(Part):
    """If, when: the action that is asked about follows."""


class Purpose(Part):
    """To make it slide; `before` if it is about what must not yet happen ("before it tips")."""

    event: g.Event
    thing: Thing | None
    before: bool = False


class Explore(Part):
    """Find out how heavy it is."""

    which: tuple[str, ...]
    thing: Thing


class Remark(Part):
    """A remark: undo that, again, no."""

    dialogue: g.Dialogue


class NotThere(Part):
    """Not to the right: emphasis beside another way."""

    value: g.Direction


class NotThis(Part):
    """Not the mug: what was not meant."""

    thing: Thing
