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

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_serializer

Span = tuple[int, int]
Spans = tuple[Span, ...]

Action = Literal[
    "push", "pull", "move", "slide", "turn", "tilt", "topple",
    "lift", "place", "open", "close", "pour", "explore",
]  # fmt: skip
Query = Literal["predict", "possible", "how_hard", "where", "why", "value", "affordances"]
Dialogue = Literal["undo", "stop", "repeat", "correct", "more"]

Direction = Literal["away", "toward", "left", "right"]
Amount = Literal["little", "lot"]
Bound = Literal["exact", "at_least", "at_most"]
Sense = Literal["cw", "ccw"]
Side = Literal["length", "width", "height"]
FaceName = Literal["front", "back", "left", "right", "top"]
Relation = Literal[
    "next_to", "left_of", "right_of", "in_front_of", "behind", "between", "touching", "at", "on",
]  # fmt: skip
TableRegion = Literal[
    "center", "edge", "left_edge", "right_edge", "front_edge", "back_edge", "corner",
    "front_left_corner", "front_right_corner", "back_left_corner", "back_right_corner",
]  # fmt: skip

Positive = Annotated[float, Field(gt=0.0)]


class _Part(BaseModel):
    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, populate_by_name=True
    )


class ObjectRef(_Part):
    """An object as the sentence names it.

    Attributes:
        text: the name as written, without its article.
        spans: where it stands in the sentence.
        id: name of the object in the scene, filled in when the name is resolved.
    """

    text: str = Field(min_length=1)
    spans: Spans = ()
    id: str | None = None


class RelativeLength(_Part):
    """A length measured in objects ("two box widths"): `value` times a side of `of`."""

    value: Positive
    of: ObjectRef
    side: Side | None = None


class Point(_Part):
    """A point on the table, in W [m]."""

    x: float
    y: float


class ContactHeight(_Part):
    """Height of a contact [m], measured upwards from the table or downwards from the top."""

    value: float = Field(ge=0.0)
    origin: Literal["table", "top"] = Field(alias="from")

    @model_serializer
    def _with_the_contract_s_key(self) -> dict[str, float | str]:
        # `from` is a keyword of Python, so the field cannot bear the contract's name itself.
        return {"value": self.value, "from": self.origin}


# --- goals -----------------------------------------------------------------------------------


class Displace(_Part):
    """Move the object over the table.

    Attributes:
        direction: a direction, or two whose bisector is meant; None if not said.
        heading: direction as an angle, counter-clockwise from +x of W [rad].
        toward: object to move towards.
        distance: how far [m], or measured in objects; None if not said.
        bound: whether `distance` is meant exactly or as a bound.
        fraction: share of the way to the place that is named ("halfway").
        amount: `little` or `lot`, if the sentence says no more.
    """

    kind: Literal["displace"] = "displace"
    direction: Direction | tuple[Direction, Direction] | None = None
    heading: float | None = None
    toward: ObjectRef | None = None
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


class Place(_Part):
    """Bring the object to a place; `distance` is the gap between the surfaces [m]."""

    kind: Literal["place"] = "place"
    relation: Relation
    reference: tuple[ObjectRef, ...] | Point | TableRegion
    distance: Annotated[float, Field(ge=0.0)] | None = None
    spans: Spans = ()


class Rotate(_Part):
    """Turn the object about the vertical by `angle` [rad]; `ccw` as seen from above."""

    kind: Literal["rotate"] = "rotate"
    angle: Positive | None = None
    sense: Sense | None = None
    spans: Spans = ()


class Tilt(_Part):
    """Tilt the object about an edge of its base by `angle` [rad]."""

    kind: Literal["tilt"] = "tilt"
    angle: Positive | None = None
    direction: Direction | None = None
    spans: Spans = ()


class Topple(_Part):
    """Make the object fall over."""

    kind: Literal["topple"] = "topple"
    direction: Direction | None = None
    spans: Spans = ()


class Upright(_Part):
    """Stand the object on its base again."""

    kind: Literal["upright"] = "upright"
    spans: Spans = ()


class Lift(_Part):
    """Lift the object by `height` [m]."""

    kind: Literal["lift"] = "lift"
    height: Positive | None = None
    spans: Spans = ()


class Open(_Part):
    """Open the object, or a named part of it."""

    kind: Literal["open"] = "open"
    part: str | None = None
    spans: Spans = ()


class Close(_Part):
    """Close the object, or a named part of it."""

    kind: Literal["close"] = "close"
    part: str | None = None
    spans: Spans = ()


class Pour(_Part):
    """Pour what the object holds into another one."""

    kind: Literal["pour"] = "pour"
    into: ObjectRef | None = None
    amount: Amount | None = None
    spans: Spans = ()


class Parameters(_Part):
    """Find out parameters of the object's model (mass, friction, …); none named means all."""

    kind: Literal["parameters"] = "parameters"
    which: tuple[str, ...] = ()
    spans: Spans = ()


class NoGoal(_Part):
    """Nothing is to become of the object."""

    kind: Literal["none"] = "none"
    spans: Spans = ()


Goal = Annotated[
    Displace | Place | Rotate | Tilt | Topple | Upright | Lift | Open | Close | Pour
    | Parameters | NoGoal,
    Field(discriminator="kind"),
]  # fmt: skip


# --- constraints -----------------------------------------------------------------------------


class NoTopple(_Part):
    """The object comes to rest on its base."""

    kind: Literal["no_topple"] = "no_topple"
    spans: Spans = ()


class NoTilt(_Part):
    """The object's base stays on the table."""

    kind: Literal["no_tilt"] = "no_tilt"
    spans: Spans = ()


class NoTurn(_Part):
    """The object does not turn about the vertical."""

    kind: Literal["no_turn"] = "no_turn"
    spans: Spans = ()


class NoSlide(_Part):
    """The object does not slide."""

    kind: Literal["no_slide"] = "no_slide"
    spans: Spans = ()


class NoLift(_Part):
    """The object stays on the table."""

    kind: Literal["no_lift"] = "no_lift"
    spans: Spans = ()


class NoSpill(_Part):
    """Nothing leaves the object."""

    kind: Literal["no_spill"] = "no_spill"
    spans: Spans = ()


class NoTouch(_Part):
    """The moved object keeps off another one, by `clearance` [m] if given."""

    kind: Literal["no_touch"] = "no_touch"
    object: ObjectRef
    clearance: Annotated[float, Field(ge=0.0)] | None = None
    spans: Spans = ()


class MaxForce(_Part):
    """The force on the object stays below `value` [N]."""

    kind: Literal["max_force"] = "max_force"
    value: Positive
    spans: Spans = ()


class MinForce(_Part):
    """The force on the object reaches `value` [N]."""

    kind: Literal["min_force"] = "min_force"
    value: Positive
    spans: Spans = ()


class Force(_Part):
    """The object is pushed with `value` [N]."""

    kind: Literal["force"] = "force"
    value: Positive
    spans: Spans = ()


class MaxSpeed(_Part):
    """The object moves no faster than `value` [m/s]."""

    kind: Literal["max_speed"] = "max_speed"
    value: Positive
    spans: Spans = ()


class Speed(_Part):
    """The object moves at `value` [m/s]."""

    kind: Literal["speed"] = "speed"
    value: Positive
    spans: Spans = ()


class MaxDuration(_Part):
    """It is done within `value` [s]."""

    kind: Literal["max_duration"] = "max_duration"
    value: Positive
    spans: Spans = ()


class MaxDistance(_Part):
    """The object moves no farther than `value` [m]."""

    kind: Literal["max_distance"] = "max_distance"
    value: Positive
    spans: Spans = ()


class Gentle(_Part):
    """Little force and a low speed."""

    kind: Literal["gentle"] = "gentle"
    spans: Spans = ()


class Hard(_Part):
    """Much force."""

    kind: Literal["hard"] = "hard"
    spans: Spans = ()


class Slow(_Part):
    """A low speed."""

    kind: Literal["slow"] = "slow"
    spans: Spans = ()


class Fast(_Part):
    """A high speed."""

    kind: Literal["fast"] = "fast"
    spans: Spans = ()


class ContactRegion(_Part):
    """Where the object is touched.

    Attributes:
        face: by where it looks now; `front` looks at the robot.
        region: upper, middle or lower third of the face.
        height: height of the contact.
    """

    kind: Literal["contact"] = "contact"
    face: FaceName | None = None
    region: Literal["top", "middle", "bottom"] | None = None
    height: ContactHeight | None = None
    spans: Spans = ()


class Effector(_Part):
    """What touches the object: how many of which tool, on which side of the robot."""

    kind: Literal["effector"] = "effector"
    tool: Literal["finger", "hand", "arm"]
    count: int | None = Field(default=None, ge=1)
    side: Literal["left", "right"] | None = None
    spans: Spans = ()


class Until(_Part):
    """When to stop."""

    kind: Literal["until"] = "until"
    event: Literal["touching", "in_line", "edge", "about_to_tip", "tips", "moves"]
    object: ObjectRef | None = None
    spans: Spans = ()


Constraint = Annotated[
    NoTopple | NoTilt | NoTurn | NoSlide | NoLift | NoSpill | NoTouch
    | MaxForce | MinForce | Force | MaxSpeed | Speed | MaxDuration | MaxDistance
    | Gentle | Hard | Slow | Fast | ContactRegion | Effector | Until,
    Field(discriminator="kind"),
]  # fmt: skip


# --- frame and command -----------------------------------------------------------------------


class Frame(_Part):
    """What one clause of a command asks.

    Attributes:
        action: what is done; None for a question or a remark that names none.
        query: what is asked, if it is a question.
        dialogue: what the remark does, if it is one.
        object: what it is done to.
        goal: what should become of the object.
        constraints: what must hold on the way, in the order of the sentence.
        spans: the words that gave the action, the query or the dialogue.
    """

    action: Action | None = None
    query: Query | None = None
    dialogue: Dialogue | None = None
    object: ObjectRef | None = None
    goal: Goal = NoGoal()
    constraints: tuple[Constraint, ...] = ()
    spans: Spans = ()


class Command(_Part):
    """A sentence, and what was understood."""

    text: str
    frames: tuple[Frame, ...]
    paraphrase: str
