"""Constraints: what must hold on the way to a goal, one class with its words for each kind.

A new kind stands here, in its class and in the tables of what contradicts it, and in the lexicon;
`planner` and `nlcontrol.checks` hold a row for it each.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal, cast, get_args

from pydantic import Field

from grammar.frames.vocabulary import (
    ContactHeight,
    FaceName,
    ObjectRef,
    Part,
    Positive,
    Spans,
    Unit,
)


@dataclass(frozen=True)
class Words:
    """The words by which a kind of constraint is said.

    Attributes:
        terminal: terminal of the lexicon that says the kind.
        phrase: phrase that says the kind with its value, which stands for `{}`.
        unit: SI unit of the value; "" if the kind has none.
        event: event of the lexicon that the kind forbids: "so that it does not tip".
        limit: kind that is meant if "more than" and a quantity follow: "without tilting it more
            than 5 degrees".
    """

    terminal: str = ""
    phrase: str = ""
    unit: Unit = ""
    event: str = ""
    limit: str = ""


class BaseConstraint(Part):
    """A constraint; its class holds the words of its kind.

    Attributes:
        kind: of the constraint; it says which other fields there are.
        spans: the words that say it, places in the sentence.
    """

    words: ClassVar[Words]


class PlainConstraint(BaseConstraint):
    """A constraint without a value."""

    kind: str
    spans: Spans = ()


class Limit(BaseConstraint):
    """A constraint by a quantity, in the unit of its words.

    Attributes:
        value: the quantity in SI units and radians; more than 0, at most 1000 N, 10 m, 10 m/s, an
            hour, ten turns.
    """

    kind: str
    value: Positive
    spans: Spans = ()


class NoTopple(PlainConstraint):
    """The object comes to rest on its base."""

    words: ClassVar[Words] = Words("AVOIDING", event="tips", limit="max_tilt")
    kind: Literal["no_topple"] = "no_topple"


class NoTilt(PlainConstraint):
    """The object's base stays on the table."""

    words: ClassVar[Words] = Words("AVOIDING", event="tilts", limit="max_tilt")
    kind: Literal["no_tilt"] = "no_tilt"


class NoTurn(PlainConstraint):
    """The object does not turn about the vertical."""

    words: ClassVar[Words] = Words("AVOIDING", event="turns", limit="max_turn")
    kind: Literal["no_turn"] = "no_turn"


class NoSlide(PlainConstraint):
    """The object does not slide."""

    words: ClassVar[Words] = Words("AVOIDING", event="slides", limit="max_distance")
    kind: Literal["no_slide"] = "no_slide"


class NoLift(PlainConstraint):
    """The object stays on the table."""

    words: ClassVar[Words] = Words("AVOIDING")
    kind: Literal["no_lift"] = "no_lift"


class NoSpill(PlainConstraint):
    """Nothing leaves the object."""

    words: ClassVar[Words] = Words("AVOIDING")
    kind: Literal["no_spill"] = "no_spill"


class MaxTilt(Limit):
    """The object tilts by `value` at most [rad]."""

    words: ClassVar[Words] = Words(phrase="without tilting it more than {}", unit="rad")
    kind: Literal["max_tilt"] = "max_tilt"


class MaxTurn(Limit):
    """The object turns about the vertical by `value` at most [rad]."""

    words: ClassVar[Words] = Words(phrase="without turning it more than {}", unit="rad")
    kind: Literal["max_turn"] = "max_turn"


class NoTouch(BaseConstraint):
    """The moved object keeps off another one, or off everything.

    Attributes:
        object: that is not touched; None for everything.
        clearance: how far it keeps off `object` [m]; None if touching it is all that is forbidden.
    """

    words: ClassVar[Words] = Words("TOUCHING")
    kind: Literal["no_touch"] = "no_touch"
    object: ObjectRef | None
    clearance: Annotated[float, Field(ge=0.0)] | None = None
    spans: Spans = ()


class MaxForce(Limit):
    """The force on the object stays below `value` [N]."""

    words: ClassVar[Words] = Words(phrase="with at most {}", unit="N")
    kind: Literal["max_force"] = "max_force"


class MinForce(Limit):
    """The force on the object reaches `value` [N]."""

    words: ClassVar[Words] = Words(phrase="with at least {}", unit="N")
    kind: Literal["min_force"] = "min_force"


class Force(Limit):
    """The object is pushed with `value` [N]."""

    words: ClassVar[Words] = Words(phrase="with {}", unit="N")
    kind: Literal["force"] = "force"


class MaxSpeed(Limit):
    """The object moves no faster than `value` [m/s]."""

    words: ClassVar[Words] = Words(phrase="at most {}", unit="m/s")
    kind: Literal["max_speed"] = "max_speed"


class MinSpeed(Limit):
    """The object moves at least at `value` [m/s]."""

    words: ClassVar[Words] = Words(phrase="at least {}", unit="m/s")
    kind: Literal["min_speed"] = "min_speed"


class Speed(Limit):
    """The object moves at `value` [m/s]."""

    words: ClassVar[Words] = Words(phrase="at {}", unit="m/s")
    kind: Literal["speed"] = "speed"


class MaxDuration(Limit):
    """It is done within `value` [s]."""

    words: ClassVar[Words] = Words(phrase="in at most {}", unit="s")
    kind: Literal["max_duration"] = "max_duration"


class Duration(Limit):
    """It takes `value` [s]."""

    words: ClassVar[Words] = Words(phrase="for {}", unit="s")
    kind: Literal["duration"] = "duration"


class MaxDistance(Limit):
    """The object moves no farther than `value` [m]."""

    words: ClassVar[Words] = Words(phrase="without moving it more than {}", unit="m")
    kind: Literal["max_distance"] = "max_distance"


class Gentle(PlainConstraint):
    """Little force and a low speed."""

    words: ClassVar[Words] = Words("MANNER")
    kind: Literal["gentle"] = "gentle"


class Hard(PlainConstraint):
    """Much force."""

    words: ClassVar[Words] = Words("MANNER")
    kind: Literal["hard"] = "hard"


class Slow(PlainConstraint):
    """A low speed."""

    words: ClassVar[Words] = Words("MANNER")
    kind: Literal["slow"] = "slow"


class Fast(PlainConstraint):
    """A high speed."""

    words: ClassVar[Words] = Words("MANNER")
    kind: Literal["fast"] = "fast"


class ContactRegion(BaseConstraint):
    """Place where the object is touched.

    Attributes:
        face: by where it looks now; `front` looks at the robot.
        region: upper, middle or lower third of the face.
        height: height of the contact.
    """

    words: ClassVar[Words] = Words("REGION")
    kind: Literal["contact"] = "contact"
    face: FaceName | None = None
    region: Literal["top", "middle", "bottom"] | None = None
    height: ContactHeight | None = None
    spans: Spans = ()


class Effector(BaseConstraint):
    """Tool that touches the object.

    Attributes:
        tool: that touches it.
        count: how many of it; None for "your hand".
        side: of the robot, on which the tool is.
    """

    words: ClassVar[Words] = Words("TOOL")
    kind: Literal["effector"] = "effector"
    tool: Literal["finger", "hand", "arm"]
    count: int | None = Field(default=None, ge=1)
    side: Literal["left", "right"] | None = None
    spans: Spans = ()


class Until(BaseConstraint):
    """Event at which to stop.

    Attributes:
        event: that ends it.
        object: that is touched, or that it comes in line with or next to; None for other events.
    """

    words: ClassVar[Words] = Words("UNTIL")
    kind: Literal["until"] = "until"
    event: Literal["touching", "in_line", "next_to", "edge", "about_to_tip", "tips", "moves"]
    object: ObjectRef | None = None
    spans: Spans = ()


Constraint = Annotated[
    NoTopple | NoTilt | NoTurn | NoSlide | NoLift | NoSpill | NoTouch | MaxTilt | MaxTurn
    | MaxForce | MinForce | Force | MaxSpeed | MinSpeed | Speed | MaxDuration | Duration
    | MaxDistance
    | Gentle | Hard | Slow | Fast | ContactRegion | Effector | Until,
    Field(discriminator="kind"),
]  # fmt: skip

CONSTRAINTS: dict[str, type[BaseConstraint]] = {
    kind.model_fields["kind"].default: kind for kind in get_args(get_args(Constraint)[0])
}
"""The class of each kind of constraint."""

STILL = ("no_slide", "no_tilt", "no_turn")
"""Kinds that together keep an object where it is."""

# Goals and constraints that cannot be had together. The tables have two readers: a sentence that
# contradicts itself is refused, and a remark ("no, gently") takes the place of the constraints that
# it cannot stand beside.

FORBIDS: dict[str, frozenset[str]] = {
    "topple": frozenset({"no_topple", "no_tilt", "max_tilt"}),
    "tilt": frozenset({"no_tilt"}),
    "rotate": frozenset({"no_turn"}),
    "lift": frozenset({"no_lift"}),
    "pour": frozenset({"no_tilt"}),
    "upright": frozenset({"no_tilt", "max_tilt"}),
    "displace": frozenset({"no_slide"}),
    "place": frozenset({"no_slide"}),
}
"""Goal → constraints that forbid it, whatever their values are."""

FORBIDS_BELOW: dict[str, tuple[str, str]] = {
    "tilt": ("angle", "max_tilt"),
    "rotate": ("angle", "max_turn"),
    "displace": ("distance", "max_distance"),
}
"""Goal → the field that says how much of it, and the constraint that forbids it below that."""

FORBIDS_EVENT: dict[str, frozenset[str]] = {
    "tips": frozenset({"no_topple", "no_tilt"}),
    "about_to_tip": frozenset({"no_tilt"}),
}
"""Event to stop at → constraints that forbid it."""

EXCLUSIVE: frozenset[tuple[str, str]] = frozenset({
    ("gentle", "hard"), ("slow", "fast"), ("effector", "effector"), ("force", "force"),
    ("speed", "speed"), ("duration", "duration"), ("until", "until"),
})  # fmt: skip
"""Pairs of constraints that exclude each other; a kind beside itself is said with two values."""

ORDERED: frozenset[tuple[str, str]] = frozenset({
    ("force", "max_force"), ("min_force", "force"), ("min_force", "max_force"),
    ("speed", "max_speed"), ("min_speed", "speed"), ("min_speed", "max_speed"),
    ("duration", "max_duration"),
})  # fmt: skip
"""Pairs of constraints of which the first value is at most the second."""

SAME_MATTER: tuple[frozenset[str], ...] = (
    frozenset({"gentle", "hard"}),
    frozenset({"force", "min_force", "max_force", "hard"}),
    frozenset({"speed", "min_speed", "max_speed", "slow", "fast"}),
    frozenset({"duration", "max_duration"}),
)
"""Constraints of one matter: in a remark a new one takes the place of those said before."""

HOW_FAR = frozenset({"max_distance", "until"})
"""Constraints that say how far; in a remark a new distance takes their place."""


def new_constraint(kind: str, **fields: Any) -> Constraint:
    """Make a constraint of a kind with its fields.

    Raises:
        KeyError: no constraint is of this kind.
    """
    return cast("Constraint", CONSTRAINTS[kind](**fields))
