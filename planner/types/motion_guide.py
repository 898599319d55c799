"""Numbers that a guarded Cartesian controller needs to carry out what is committed of a plan.

Numbers are in SI units, points and directions in W. They are for fingertips of the radius that is
stated; another hand keeps the contacts and computes its own. Places hold for the table as it was
seen when it was planned.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from planner.types.actions import Vector3
from planner.types.frozen_value import Value

StopKind = Literal[
    "no_touch", "stroke", "toppled", "turned", "returned", "event", "force", "speed", "slid",
    "tilted", "turned_off", "too_close", "lost", "duration", "no_grasp", "slipped", "nudged",
]  # fmt: skip


class StopCondition(Value):
    """A condition on which a motion ends.

    Attributes:
        when: kind of it; the first six are as planned, the others guards.
        limit: number that is reached or exceeded, in SI units; None if there is none.
        unit: of the limit.
        other: name of the object that it is about, if it is another one.
        text: the same in words.
    """

    when: StopKind
    limit: float | None = None
    unit: Literal["m", "rad", "N", "m/s", "s", "N·m"] | None = None
    other: str | None = None
    text: str


class PushGuide(Value):
    """A push: come up to the face, feel it, push under limited force, leave.

    Attributes:
        object: name of what is pushed.
        contact_W: contact; with two fingers the middle between theirs [m].
        fingertips_W: centres of the fingertips at the touch [m].
        tip_radius: of the fingertips [m].
        start_W: where the middle of the fingertips' centres begins to feel for the face [m].
        inward_W: direction in which it goes from there; the hand is square to it.
        fingers_W: direction from the palm to the fingertips, as the standard hand comes; None of
            another robot.
        touch_speed: on that way [m/s].
        touch_force: felt along it, that counts as the touch [N].
        touch_travel: most way from the start on which the face must be felt [m].
        direction_W: of the push.
        stroke: travel of the fingertips from the touch on [m].
        end_W: where the middle of their centres is then, if the object follows as predicted [m].
        hand_turn: by which the hand turns with the object about the vertical [rad].
        tilt: by which the object is tilted, held and let back, if that is wanted [rad].
        press: force into the face that is kept up meanwhile, of a fingertip that draws the object
            along from above [N]; 0 if none is.
        force_limit: of all fingers together, along the direction [N].
        force_rise: time in which the limit rises from the touch on to that [s].
        first_speed: until the object moves [m/s].
        speed: largest one after that [m/s].
        retreat: way straight back from the face at the end [m].
        stop: when it ends.
    """

    kind: Literal["push"] = "push"
    object: str
    contact_W: Vector3
    fingertips_W: tuple[Vector3, ...]
    tip_radius: float
    start_W: Vector3
    inward_W: Vector3
    fingers_W: Vector3 | None = None
    touch_speed: float
    touch_force: float
    touch_travel: float
    direction_W: Vector3
    stroke: float
    end_W: Vector3
    hand_turn: float
    tilt: float
    press: float = 0.0
    force_limit: float
    force_rise: float
    first_speed: float
    speed: float
    retreat: float
    stop: tuple[StopCondition, ...]


class HandLeg(Value):
    """A leg of what is held: a point of it goes straight, while it turns evenly about an axis.

    Attributes:
        phase: what it is for, as in a trace.
        open: the hand is open, and what it held stands.
        p_BC: the point, in the B of what is held: its origin, or the lip that pours [m].
        start_W, end_W: of the point [m].
        axis_W: of the turn.
        turn: about it, altogether [rad].
        speed: largest one of the point [m/s].
        rate: largest one of the turn [rad/s].
    """

    phase: str
    open: bool
    p_BC: Vector3
    start_W: Vector3
    end_W: Vector3
    axis_W: Vector3
    turn: float
    speed: float
    rate: float


class GraspGuide(Value):
    """A grasp and all that is done with what is held.

    Attributes:
        object: name of what is held, or of what its lid belongs to.
        held: the hand holds it already.
        thumb_W: contact of the thumb [m].
        fingers_W: contacts of the other fingers that touch [m].
        middle_W: of the grasp, between them [m].
        closing_W: direction from the fingers to the thumb.
        approach_W: direction of the straight fingers, in which the open hand comes.
        start_W: where the middle of the grasp comes from, along one straight line [m].
        reach_speed: of the hand on it [m/s].
        close_speed: of each side while the hand closes [m/s].
        contact_force: on each side, that counts as contact [N].
        squeeze: force of the thumb, and of the other fingers together [N].
        legs: from there on, in their order.
        stop: when it ends early.
    """

    kind: Literal["grasp"] = "grasp"
    object: str
    held: bool
    thumb_W: Vector3
    fingers_W: tuple[Vector3, ...]
    middle_W: Vector3
    closing_W: Vector3
    approach_W: Vector3
    start_W: Vector3
    reach_speed: float
    close_speed: float
    contact_force: float
    squeeze: float
    legs: tuple[HandLeg, ...]
    stop: tuple[StopCondition, ...]


class FlipGuide(Value):
    """A fingertip that moves a flip lid along an arc.

    Attributes:
        object: name of what the lid belongs to.
        tip_radius: of the fingertip [m].
        hinge_W: middle of the hinge [m].
        path_W: centres of the fingertip along the arc, from the touch on [m].
        speed: largest one of the fingertip [m/s].
        force_limit: felt force at which it stops [N].
        force_limits: the same at each of the points.
        stop: when it ends.
    """

    kind: Literal["flip"] = "flip"
    object: str
    tip_radius: float
    hinge_W: Vector3
    path_W: tuple[Vector3, ...]
    speed: float
    force_limit: float
    force_limits: tuple[float, ...] = ()
    stop: tuple[StopCondition, ...]


MotionGuide = Annotated[PushGuide | GraspGuide | FlipGuide, Field(discriminator="kind")]
