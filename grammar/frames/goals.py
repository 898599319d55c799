"""What should become of an object: one class for each kind of goal."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from grammar.frames.vocabulary import (
    Amount,
    Bound,
    Direction,
    Method,
    ObjectRef,
    Part,
    Point,
    Positive,
    Relation,
    RelativeLength,
    Sense,
    Spans,
    TableRegion,
)


class Displace(Part):
    """Move the object over the table.

    Attributes:
        direction: a direction, or two whose bisector is meant; None if not said.
        heading: direction as an angle, counter-clockwise from +x of W [rad].
        toward: object, or part of the table, to move towards.
        away_from: object, or part of the table, to move away from.
        distance: how far [m], or measured in objects; None if not said.
        bound: whether `distance` is meant exactly or as a bound.
        fraction: share of the way to the place that is named ("halfway").
        amount: `little` or `lot`, if the sentence says no more.
    """

    kind: Literal["displace"] = "displace"
    direction: Direction | tuple[Direction, Direction] | None = None
    heading: float | None = None
    toward: ObjectRef | TableRegion | None = None
    away_from: ObjectRef | TableRegion | None = None
    distance: Positive | RelativeLength | None = None
    bound: Bound = "exact"
    fraction: Positive | None = None
    amount: Amount | None = None
    spans: Spans = ()

    @field_validator("direction")
    @classmethod
    def _two_directions_span_an_angle(
        cls, value: Direction | tuple[Direction, Direction] | None
    ) -> Direction | tuple[Direction, Direction] | None:
        if isinstance(value, tuple):
            along = [part in ("away", "toward") for part in value]
            if along != [True, False]:
                raise ValueError("two directions are one of away, toward and one of left, right")
        return value


class Place(Part):
    """Bring the object to a place.

    Attributes:
        relation: where, as seen from `reference`.
        reference: objects, a point or a part of the table.
        distance: gap between the surfaces [m]; None if not said.
        fraction: share of the way to the place ("halfway to the left edge").
    """

    kind: Literal["place"] = "place"
    relation: Relation
    reference: tuple[ObjectRef, ...] | Point | TableRegion
    distance: Annotated[float, Field(ge=0.0)] | RelativeLength | None = None
    fraction: Positive | None = None
    spans: Spans = ()


class Rotate(Part):
    """Turn the object about the vertical.

    Attributes:
        angle: how far [rad]; None if not said.
        sense: `ccw` or `cw`, as seen from above; None if not said.
        bound: whether `angle` is meant exactly or as a bound.
        amount: `little` or `lot`, if the sentence says no more.
    """

    kind: Literal["rotate"] = "rotate"
    angle: Positive | None = None
    sense: Sense | None = None
    bound: Bound = "exact"
    amount: Amount | None = None
    spans: Spans = ()


class Tilt(Part):
    """Tilt the object about an edge of its base by `angle` [rad], towards `direction`."""

    kind: Literal["tilt"] = "tilt"
    angle: Positive | None = None
    direction: Direction | None = None
    bound: Bound = "exact"
    amount: Amount | None = None
    spans: Spans = ()


class Topple(Part):
    """Make the object fall over."""

    kind: Literal["topple"] = "topple"
    direction: Direction | None = None
    spans: Spans = ()


class Upright(Part):
    """Stand the object on its base again."""

    kind: Literal["upright"] = "upright"
    spans: Spans = ()


class Lift(Part):
    """Lift the object by `height` [m], or measured in objects."""

    kind: Literal["lift"] = "lift"
    height: Positive | RelativeLength | None = None
    bound: Bound = "exact"
    amount: Amount | None = None
    spans: Spans = ()


class SetDown(Part):
    """Put what is held down where it is."""

    kind: Literal["set_down"] = "set_down"
    spans: Spans = ()


class Open(Part):
    """Open the object, or a named part of it."""

    kind: Literal["open"] = "open"
    part: str | None = None
    spans: Spans = ()


class Close(Part):
    """Close the object, or a named part of it."""

    kind: Literal["close"] = "close"
    part: str | None = None
    spans: Spans = ()


class Pour(Part):
    """Pour what the object holds into another one; everything if no amount is said.

    Attributes:
        into: what it is poured into.
        amount: `little` or `lot`, if the sentence says no more.
        fraction: share of what the object holds.
        volume: how much [m³].
        fill: share of the volume of `into` up to which that is to be filled.
    """

    kind: Literal["pour"] = "pour"
    into: ObjectRef | None = None
    amount: Amount | None = None
    fraction: Positive | None = None
    volume: Positive | None = None
    fill: Annotated[float, Field(gt=0.0, le=1.0)] | None = None
    spans: Spans = ()


class HandOver(Part):
    """Give the object to the person who speaks."""

    kind: Literal["hand_over"] = "hand_over"
    spans: Spans = ()


class Parameters(Part):
    """Find out parameters of the object's model (mass, friction, …).

    Attributes:
        which: the parameters; none named means all.
        method: how: by lifting it, or by pushing and tilting it; None if not said.
    """

    kind: Literal["parameters"] = "parameters"
    which: tuple[str, ...] = ()
    method: Method | None = None
    spans: Spans = ()


class NoGoal(Part):
    """Nothing is to become of the object."""

    kind: Literal["none"] = "none"
    spans: Spans = ()


Goal = Annotated[
    Displace | Place | Rotate | Tilt | Topple | Upright | Lift | SetDown | Open | Close | Pour
    | HandOver | Parameters | NoGoal,
    Field(discriminator="kind"),
]  # fmt: skip
