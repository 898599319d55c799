"""Goals: outcomes for an object, one class with its words for each kind."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, get_args

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


@dataclass(frozen=True)
class GoalWords:
    """The words by which a kind of goal is said.

    Attributes:
        verbs: action of the frame → verb that asks for this goal.
        particle: word behind the object that belongs to the verb.
        outcomes: events of the lexicon that name this goal: "so that it tips".
    """

    verbs: Mapping[str, str]
    particle: str = ""
    outcomes: tuple[str, ...] = ()


class BaseGoal(Part):
    """A goal; its class holds the words of its kind.

    Attributes:
        kind: of the goal; it says which other fields there are.
        spans: the words that say it, places in the sentence.
    """

    words: ClassVar[GoalWords]


class Displace(BaseGoal):
    """Move the object over the table.

    Attributes:
        direction: a direction, or two whose bisector is meant; None if not said.
        heading: direction as an angle, counter-clockwise from +x of W [rad]; at most one turn.
        toward: object, or part of the table, to move towards.
        away_from: object, or part of the table, to move away from.
        distance: how far [m], more than 0 and at most 10, or measured in objects; None if not
            said.
        bound: whether `distance` is meant as it is, exactly so, or as a bound.
        fraction: share of the way to `toward` ("halfway"): a quarter, a third, half, two thirds,
            three quarters.
        amount: `little` or `lot`, if the sentence says no more.
    """

    words: ClassVar[GoalWords] = GoalWords(
        verbs={"push": "push", "pull": "pull", "move": "move", "slide": "slide", "place": "put"},
        outcomes=("moves", "slides", "ends_up"),
    )
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


class Place(BaseGoal):
    """Bring the object to a place.

    Attributes:
        relation: where, as seen from `reference`; `in` and `on` it, or taken `out_of` or `off` it;
            `clear_of` it; where it stands (`place_of`); `in_row` or `together` with it, or
            `stacked`; `over` an edge of the table, so that it hangs over; or `back` to where the
            object itself stands when the sentence begins.
        reference: objects, a point or a part of the table. No object: out of the way (`clear_of`),
            or the objects that are named together, among themselves.
        distance: gap between the surfaces, or how far it hangs over [m], at most 10, or measured in
            objects; None if not said.
        fraction: share of the way to a part of the table ("halfway to the left edge"), as of
            `displace`.
    """

    words: ClassVar[GoalWords] = GoalWords(
        verbs={
            "place": "put",
            "push": "push",
            "pull": "pull",
            "move": "move",
            "slide": "slide",
            "lift": "take",
        }
    )
    kind: Literal["place"] = "place"
    relation: Relation
    reference: tuple[ObjectRef, ...] | Point | TableRegion
    distance: Annotated[float, Field(ge=0.0)] | RelativeLength | None = None
    fraction: Positive | None = None
    spans: Spans = ()


class Rotate(BaseGoal):
    """Turn the object about the vertical.

    Attributes:
        angle: how far [rad], more than 0, at most ten turns; None if not said.
        sense: `ccw` or `cw`, as seen from above; None if not said.
        bound: whether `angle` is meant as it is, exactly so, or as a bound.
        amount: `little` or `lot`, if the sentence says no more.
        facing: object, or direction, that a broad side of it faces at the end.
        parallel_to: edge of the table, or object, along which its broad sides lie at the end; any
            `edge` if it is to stand straight.
    """

    words: ClassVar[GoalWords] = GoalWords(verbs={"turn": "turn"}, outcomes=("turns",))
    kind: Literal["rotate"] = "rotate"
    angle: Positive | None = None
    sense: Sense | None = None
    bound: Bound = "exact"
    amount: Amount | None = None
    facing: ObjectRef | Direction | None = None
    parallel_to: ObjectRef | TableRegion | None = None
    spans: Spans = ()


class Tilt(BaseGoal):
    """Tilt the object about an edge of its base.

    Attributes:
        angle: how far [rad], more than 0; None if not said.
        direction: towards which it tilts; None if not said.
        bound: whether `angle` is meant as it is, exactly so, or as a bound.
        amount: `little` or `lot`, if the sentence says no more.
    """

    words: ClassVar[GoalWords] = GoalWords(verbs={"tilt": "tilt"}, outcomes=("tilts",))
    kind: Literal["tilt"] = "tilt"
    angle: Positive | None = None
    direction: Direction | None = None
    bound: Bound = "exact"
    amount: Amount | None = None
    spans: Spans = ()


class Topple(BaseGoal):
    """Make the object fall over.

    Attributes:
        direction: towards which it falls; None if not said.
    """

    words: ClassVar[GoalWords] = GoalWords(verbs={"topple": "topple"}, outcomes=("tips",))
    kind: Literal["topple"] = "topple"
    direction: Direction | None = None
    spans: Spans = ()


class Upright(BaseGoal):
    """Stand the object on its base again."""

    words: ClassVar[GoalWords] = GoalWords(verbs={"place": "stand"}, particle="upright")
    kind: Literal["upright"] = "upright"
    spans: Spans = ()


class Lift(BaseGoal):
    """Lift the object.

    Attributes:
        height: how far [m], more than 0 and at most 10, or measured in objects; None if not said.
        above: `table` if `height` is meant over the table; None if from where the object is.
        bound: whether `height` is meant as it is, exactly so, or as a bound.
        amount: `little` or `lot`, if the sentence says no more.
    """

    words: ClassVar[GoalWords] = GoalWords(verbs={"lift": "lift"})
    kind: Literal["lift"] = "lift"
    height: Positive | RelativeLength | None = None
    above: Literal["table"] | None = None
    bound: Bound = "exact"
    amount: Amount | None = None
    spans: Spans = ()


class SetDown(BaseGoal):
    """Put what is held down where it is; in a question, stand on the table itself."""

    words: ClassVar[GoalWords] = GoalWords(verbs={"place": "set"}, particle="down")
    kind: Literal["set_down"] = "set_down"
    spans: Spans = ()


class Open(BaseGoal):
    """Open the object, or a named part of it.

    Attributes:
        part: name of the part ("lid", "drawer"); None if the object itself is named.
    """

    words: ClassVar[GoalWords] = GoalWords(verbs={"open": "open"}, outcomes=("opens",))
    kind: Literal["open"] = "open"
    part: str | None = None
    spans: Spans = ()


class Close(BaseGoal):
    """Close the object, or a named part of it.

    Attributes:
        part: as of `open`.
    """

    words: ClassVar[GoalWords] = GoalWords(verbs={"close": "close"}, outcomes=("closes",))
    kind: Literal["close"] = "close"
    part: str | None = None
    spans: Spans = ()


class Pour(BaseGoal):
    """Pour what the object holds into another one; everything if no amount is said.

    Attributes:
        into: what it is poured into.
        amount: `little` or `lot`, if the sentence says no more.
        fraction: share of what the object holds: a quarter, a third, half, two thirds, three
            quarters, 1.
        volume: how much [m³], more than 0, at most 0.1.
        fill: share of the volume of `into` up to which that is to be filled.
    """

    words: ClassVar[GoalWords] = GoalWords(verbs={"pour": "pour"})
    kind: Literal["pour"] = "pour"
    into: ObjectRef | None = None
    amount: Amount | None = None
    fraction: Positive | None = None
    volume: Positive | None = None
    fill: Annotated[float, Field(gt=0.0, le=1.0)] | None = None
    spans: Spans = ()


class HandOver(BaseGoal):
    """Give the object to the person who speaks."""

    words: ClassVar[GoalWords] = GoalWords(verbs={"hand_over": "hand"}, particle="over")
    kind: Literal["hand_over"] = "hand_over"
    spans: Spans = ()


class Parameters(BaseGoal):
    """Find out parameters of the object's model (mass, friction, …).

    Attributes:
        which: the parameters; none named means all.
        method: how: by lifting it, or by pushing and tilting it; None if not said.
        than: the objects that it is compared with.
    """

    words: ClassVar[GoalWords] = GoalWords(verbs={"explore": "explore"})
    kind: Literal["parameters"] = "parameters"
    which: tuple[str, ...] = ()
    method: Method | None = None
    than: tuple[ObjectRef, ...] = ()
    spans: Spans = ()


class NoGoal(BaseGoal):
    """Nothing is to become of the object."""

    words: ClassVar[GoalWords] = GoalWords(verbs={"push": "press", "pull": "pull"})
    kind: Literal["none"] = "none"
    spans: Spans = ()


Goal = Annotated[
    Displace | Place | Rotate | Tilt | Topple | Upright | Lift | SetDown | Open | Close | Pour
    | HandOver | Parameters | NoGoal,
    Field(discriminator="kind"),
]  # fmt: skip

State = Place | Upright | SetDown | Topple | Open | Close | Displace
"""Goals of which a question may ask whether, or how far, they are so already."""

GOALS: dict[str, type[BaseGoal]] = {
    kind.model_fields["kind"].default: kind for kind in get_args(get_args(Goal)[0])
}
"""The class of each kind of goal."""
