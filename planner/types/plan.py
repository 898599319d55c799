"""Results of planning: a plan, or a refusal with the numbers behind it.

Both are values. They are what `nlcontrol plan --json` prints, so their field names are part of
the public contract; every number is in SI units.
"""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict

Vector3 = tuple[float, float, float]
FaceName = Literal["front", "back", "left", "right"]
Outcome = Literal["none", "slide", "topple", "slide+topple"]
StopEvent = Literal[
    "moves",  # the object has begun to move
    "touching",  # it has met the object that `Push.meets` names
]


class Value(BaseModel):
    """Base of what planning results are made of."""

    model_config = ConfigDict(defer_build=True, frozen=True, extra="forbid", allow_inf_nan=False)


class Limits(Value):
    """What stops a push before a constraint of the sentence breaks.

    Attributes:
        tilt: largest tilt of the object [rad]; None if only its staying on the base matters.
        turn: largest turn of the object from where it stood at first [rad]; None for no limit.
        duration: longest time from the touch to the end [s]; None for no limit.
        clear_of: other objects and the distance that is kept from each of them [m].
    """

    tilt: float | None = None
    turn: float | None = None
    duration: float | None = None
    clear_of: tuple[tuple[str, float], ...] = ()


class Push(Value):
    """One push, as the executor's contract needs it.

    Attributes:
        object: name of the pushed object in the scene.
        face: side face that is touched, named by where it looks now (front looks at the robot).
        p_BC: contact point in B [m]; with two fingers the midpoint between the fingertips.
        normal_W: outward unit normal of the touched face in W.
        direction_W: unit direction in which the fingertips move, in W (horizontal).
        force_limit: largest force along the direction, all fingers together [N].
        speed: largest speed of the fingertips [m/s].
        stroke: travel of the fingertips after touching [m].
        fingers: how many fingertips push.
        spread: distance between the two outer fingertips along the face [m]; 0 for one finger.
        ends_on: `stroke` (come to rest there), `toppled` (push until the object falls by itself),
            `turned` (push off the middle until it has turned by `turn`) or `tilted` (tilt it by
            `tilt`, hold it a moment, let it back onto its base); where it is not `stroke`, the
            stroke is the most that may be travelled.
        turn: angle by which the object turns during the push [rad], counter-clockwise. With
            `stroke` it is small: the fingers end square to the face as it should then look.
        tilt: angle of a push that ends on `tilted` [rad].
        until: event that ends the push earlier; None if there is none.
        meets: name of the object that is to be touched, if that is the event.
        limits: what stops it.
    """

    object: str
    face: FaceName
    p_BC: Vector3
    normal_W: Vector3
    direction_W: Vector3
    force_limit: float
    speed: float
    stroke: float
    fingers: Literal[1, 2]
    spread: float
    ends_on: Literal["stroke", "toppled", "turned", "tilted"]
    turn: float = 0.0
    tilt: float = 0.0
    until: StopEvent | None = None
    meets: str | None = None
    limits: Limits = Limits()


class Prediction(Value):
    """What the object model says the push will do, over everything the finger may transmit.

    Attributes:
        outcome: class at the onset of motion.
        onset: force at which the object starts to move, nominal [N].
        slide_force: force at which it would slide, nominal [N]; None if it never slides.
        topple_force: force at which it would topple, nominal [N]; None if it never topples.
        critical_height: contact height that separates sliding from toppling for this face and
            direction, nominal parameters, force along the direction [m]; None if it never
            topples.
        critical_height_worst: the same for the worst force direction in the friction cone and
            the parameters at the stated number of standard deviations [m]; None if it never
            topples.
        probability: probability of the outcome under the model's uncertainty, the worst force
            direction taken.
        stay_on_base_angle: angle of no return [rad].
        tier: what the forces come from.
        friction: which coefficient at the table decided.
    """

    outcome: Outcome
    onset: float
    slide_force: float | None
    topple_force: float | None
    critical_height: float | None
    critical_height_worst: float | None
    probability: float
    stay_on_base_angle: float
    tier: Literal["closed form", "exact"]
    friction: Literal["static", "kinetic"]


class Margins(Value):
    """How far the push is from the nearest forbidden outcome, in the worst case considered.

    Attributes:
        force: distance in force between the wanted and the nearest forbidden threshold [N].
        height: distance of the contact height from the critical height [m].
        lateral: distance of the contact from the nearest edge of its face [m].
        sigmas: the number of standard deviations that the worst case takes.
        force_limit: force limit less the largest force that the motion needs [N].
    """

    force: float
    height: float
    lateral: float
    sigmas: float
    force_limit: float


class DefaultUsed(Value):
    """A value that the sentence did not give, and that the table of defaults supplied."""

    name: str
    value: float
    unit: str
    reason: str


class Aim(Value):
    """Where an object should stand at the end, in W.

    Attributes:
        x, y: position of B's origin [m].
        yaw: heading of B's x axis [rad]; None if it does not matter.
    """

    x: float
    y: float
    yaw: float | None = None


class Move(Value):
    """A push that is foreseen after others, from where they are predicted to leave the object.

    Attributes:
        push: the push; its contact is in the B of the object as it stands then.
        prediction: what it will do.
        margins: how safe that is.
    """

    push: Push
    prediction: Prediction
    margins: Margins


class Plan(Value):
    """A push, and the pushes foreseen after it, whose predicted outcome satisfies the frame.

    What is carried out is the first push; then the robot looks, and plans anew towards the same aim
    until it is reached.

    Attributes:
        push: what is carried out.
        prediction: what it will do.
        margins: how safe that is.
        displacement: of the object in W by this push, as predicted [m]; None for a topple or tilt.
        aim: where the object should stand when everything is done; None for a topple or tilt.
        later: the pushes that are foreseen after this one.
        probability: least probability that all of them end as predicted.
        defaults: values that the sentence left open.
        considered: how many candidates were evaluated.
        satisfying: how many of them satisfied the frame.
        notes: plain sentences on how the plan was chosen.
    """

    status: Literal["planned"] = "planned"
    push: Push
    prediction: Prediction
    margins: Margins
    displacement: Vector3 | None
    aim: Aim | None = None
    later: tuple[Move, ...] = ()
    probability: float = 1.0
    defaults: tuple[DefaultUsed, ...] = ()
    considered: int = 0
    satisfying: int = 0
    notes: tuple[str, ...] = ()


class Reached(Value):
    """Nothing is left to be done: the object is seen where it should be, or as it should be.

    Attributes:
        aim: where it should be; None if the goal is no place.
        off: distance from there [m].
        turned_off: angle from the wanted heading [rad]; 0 if none is wanted.
        lid: how far its lid is seen to be open, if that is the goal; see `SeenObject.lid`.
    """

    status: Literal["reached"] = "reached"
    aim: Aim | None = None
    off: float = 0.0
    turned_off: float = 0.0
    lid: float | None = None


RefusalReason = Literal[
    "impossible",  # no push on this object does it, whoever pushes
    "out_of_reach",  # pushes exist, but the hand does not get there
    "blocked",  # pushes exist, but something stands in the way
    "too_uncertain",  # the model's uncertainty leaves the outcome open
    "out_of_time",  # it would take longer than allowed
    "unsupported",  # this robot, or this version, lacks a named capability
]


class Refusal(Value):
    """Why no plan is made, with the numbers that decide.

    Attributes:
        reason: the kind of obstacle.
        message: one plain sentence with the deciding numbers in it, units in mm, N or degrees.
        numbers: the same numbers by name [SI].
        capability: what is missing, if the reason is `unsupported`.
        spans: the words that cannot be satisfied, `[start, end)` in the sentence.
        suggestions: what would be possible instead, as plain phrases.
    """

    reason: RefusalReason
    message: str
    numbers: dict[str, float] = {}
    capability: str | None = None
    spans: tuple[tuple[int, int], ...] = ()
    suggestions: tuple[str, ...] = ()

    @property
    def status(self) -> Literal["refused", "unsupported"]:
        """Whether the sentence cannot be done, or this robot lacks a capability."""
        return "unsupported" if self.reason == "unsupported" else "refused"
