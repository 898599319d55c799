"""What must hold on the way to a goal: one class for each kind of constraint."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from grammar.frames.vocabulary import ContactHeight, FaceName, ObjectRef, Part, Positive, Spans


class NoTopple(Part):
    """The object comes to rest on its base."""

    kind: Literal["no_topple"] = "no_topple"
    spans: Spans = ()


class NoTilt(Part):
    """The object's base stays on the table."""

    kind: Literal["no_tilt"] = "no_tilt"
    spans: Spans = ()


class NoTurn(Part):
    """The object does not turn about the vertical."""

    kind: Literal["no_turn"] = "no_turn"
    spans: Spans = ()


class NoSlide(Part):
    """The object does not slide."""

    kind: Literal["no_slide"] = "no_slide"
    spans: Spans = ()


class NoLift(Part):
    """The object stays on the table."""

    kind: Literal["no_lift"] = "no_lift"
    spans: Spans = ()


class NoSpill(Part):
    """Nothing leaves the object."""

    kind: Literal["no_spill"] = "no_spill"
    spans: Spans = ()


class MaxTilt(Part):
    """The object tilts by `value` at most [rad]."""

    kind: Literal["max_tilt"] = "max_tilt"
    value: Positive
    spans: Spans = ()


class MaxTurn(Part):
    """The object turns about the vertical by `value` at most [rad]."""

    kind: Literal["max_turn"] = "max_turn"
    value: Positive
    spans: Spans = ()


class NoTouch(Part):
    """The moved object keeps off another one, by `clearance` [m] if given; None: off everything."""

    kind: Literal["no_touch"] = "no_touch"
    object: ObjectRef | None
    clearance: Annotated[float, Field(ge=0.0)] | None = None
    spans: Spans = ()


class MaxForce(Part):
    """The force on the object stays below `value` [N]."""

    kind: Literal["max_force"] = "max_force"
    value: Positive
    spans: Spans = ()


class MinForce(Part):
    """The force on the object reaches `value` [N]."""

    kind: Literal["min_force"] = "min_force"
    value: Positive
    spans: Spans = ()


class Force(Part):
    """The object is pushed with `value` [N]."""

    kind: Literal["force"] = "force"
    value: Positive
    spans: Spans = ()


class MaxSpeed(Part):
    """The object moves no faster than `value` [m/s]."""

    kind: Literal["max_speed"] = "max_speed"
    value: Positive
    spans: Spans = ()


class MinSpeed(Part):
    """The object moves at least at `value` [m/s]."""

    kind: Literal["min_speed"] = "min_speed"
    value: Positive
    spans: Spans = ()


class Speed(Part):
    """The object moves at `value` [m/s]."""

    kind: Literal["speed"] = "speed"
    value: Positive
    spans: Spans = ()


class MaxDuration(Part):
    """It is done within `value` [s]."""

    kind: Literal["max_duration"] = "max_duration"
    value: Positive
    spans: Spans = ()


class Duration(Part):
    """It takes `value` [s]."""

    kind: Literal["duration"] = "duration"
    value: Positive
    spans: Spans = ()


class MaxDistance(Part):
    """The object moves no farther than `value` [m]."""

    kind: Literal["max_distance"] = "max_distance"
    value: Positive
    spans: Spans = ()


class Gentle(Part):
    """Little force and a low speed."""

    kind: Literal["gentle"] = "gentle"
    spans: Spans = ()


class Hard(Part):
    """Much force."""

    kind: Literal["hard"] = "hard"
    spans: Spans = ()


class Slow(Part):
    """A low speed."""

    kind: Literal["slow"] = "slow"
    spans: Spans = ()


class Fast(Part):
    """A high speed."""

    kind: Literal["fast"] = "fast"
    spans: Spans = ()


class ContactRegion(Part):
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


class Effector(Part):
    """What touches the object: how many of which tool, on which side of the robot."""

    kind: Literal["effector"] = "effector"
    tool: Literal["finger", "hand", "arm"]
    count: int | None = Field(default=None, ge=1)
    side: Literal["left", "right"] | None = None
    spans: Spans = ()


class Until(Part):
    """When to stop."""

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
