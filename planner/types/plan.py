"""A plan: actions whose predicted outcome satisfies a frame; and the other results of planning.

All of them are values. They are what `nlcontrol plan --json` prints, so their field names are part
of the public contract; every number is in SI units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from textwrap import shorten
from typing import Annotated, Literal

from pydantic import Field

from objectmodels.html_table import html_table
from planner.types.actions import Action, Aim, GraspAction, Limits, PushAction, Value, Vector3
from planner.types.end_reasons import EndReason
from planner.types.refusal import Refusal, probability_text

PlanTask = Literal["push", "topple", "tilt", "lift", "place", "stand", "pour", "open", "close"]


class DefaultUsed(Value):
    """A value that the sentence did not give, and that the table of defaults supplied.

    Attributes:
        name: of the default.
        value: of it.
        unit: of the value.
        reason: why it was needed.
    """

    name: str
    value: float
    unit: str
    reason: str


class Plan(Value):
    """Actions, one after the other, whose predicted outcome satisfies the frame.

    Of several pushes only the first is carried out; then the robot looks, and plans anew towards
    the same aim until it is reached. What a hand does is carried out to its end.

    Attributes:
        status: says that it is a plan.
        object: name of what is moved.
        task: what the actions amount to.
        actions: one after the other.
        committed: how many of them are carried out before the robot looks again.
        limits: what stops every push, or what a hand keeps of the distance to other objects.
        speed: largest speed of a hand while it holds something [m/s]; None for pushes, which have
            their own.
        aim: where the object should stand at the end; None if it falls, stays where it is or up.
        probability: least probability that all ends as predicted.
        defaults: values that the sentence left open.
        considered: how many candidates were evaluated.
        satisfying: how many of them satisfied the frame.
        notes: plain sentences on how the plan was chosen.
    """

    status: Literal["planned"] = "planned"
    object: str
    task: PlanTask
    actions: tuple[Action, ...]
    committed: int
    limits: Limits = Limits()
    speed: float | None = None
    aim: Aim | None = None
    probability: float = 1.0
    defaults: tuple[DefaultUsed, ...] = ()
    considered: int = 0
    satisfying: int = 0
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        kinds = ", ".join(action.kind for action in self.actions[:6])
        more = ", …" if len(self.actions) > 6 else ""
        name = shorten(self.object, 40, placeholder="…")
        return (
            f"<Plan to {self.task} the {name}: {kinds}{more}; probability {self.probability:.3g}>"
        )

    def _repr_html_(self) -> str:
        header = (
            "step",
            "contact in B [mm]",
            "at most [N]",
            "travel [mm]",
            "sliding from [N]",
            "toppling from [N]",
        )
        rows = [_step_texts(action) for action in self.actions]
        caption = f"{self.task} the {self.object}, probability {probability_text(self.probability)}"
        return html_table(caption, header, rows)

    @property
    def push(self) -> PushAction:
        """First push: of several the only one that is carried out before the robot looks again."""
        return self.pushes[0]

    @property
    def pushes(self) -> tuple[PushAction, ...]:
        """Pushes, in their order; none if a hand does it."""
        return tuple(action for action in self.actions if action.kind == "push")

    @property
    def grasp(self) -> GraspAction | None:
        """Grasp that holds while the other actions are carried out; None if nothing is held."""
        first = self.actions[0]
        return first if first.kind == "grasp" else None

    @property
    def steps(self) -> tuple[Action, ...]:
        """Actions after the grasp; all of them if nothing is held."""
        return self.actions if self.grasp is None else self.actions[1:]


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


def _step_texts(action: Action) -> tuple[str, ...]:
    """A row of the table of a plan; all that is no push has its kind alone."""
    if action.kind != "push":
        return (action.kind, "", "", "", "", "")
    found = action.prediction
    forces = ("never" if f is None else f"{f:.2f}" for f in (found.slide_force, found.topple_force))
    contact = ", ".join(f"{1e3 * x:z.0f}" for x in action.p_BC)
    step = f"push, {action.face}, {action.fingers} finger{'s'[: action.fingers - 1]}"
    return (step, contact, f"{action.force_limit:.2f}", f"{1e3 * action.stroke:.0f}", *forces)


PlanningResult = Plan | Reached | Refusal


# Numbers that a guarded Cartesian controller needs to carry out what is committed of a plan.
#
# Numbers are in SI units, points and directions in W. They are for fingertips of the radius that
# is stated; another hand keeps the contacts and computes its own. Places hold for the table as it
# was seen when it was planned.

StopUnit = Literal["m", "rad", "N", "m/s", "s", "N·m"]


class StopCondition(Value):
    """A condition on which a motion ends.

    Attributes:
        when: the reason to end then, as a trace names it.
        limit: number that is reached or exceeded, in SI units; None if there is none.
        unit: of the limit.
        other: name of the object that it is about, if it is another one.
        text: the same in words.
    """

    when: EndReason
    limit: float | None = None
    unit: StopUnit | None = None
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


# How fast hand and fingertips become; over a stroke evenly faster, then slower with what remains.
#
# Model: from rest v² = 2 a s after a way s, and v = b (L − s) before the end of the stroke L. So
# the largest speed v solves v² / 2a + v / b = L. A push that is to be faster than usual brakes
# later where it would not come to its speed otherwise, and speeds up as much as it takes.


@dataclass(frozen=True)
class SpeedProfile:
    """Speeding up and slowing down.

    Attributes:
        acceleration: at first [m/s²].
        braking: speed per remaining distance near the end [1/s].
    """

    acceleration: float
    braking: float

    def largest_speed(self, stroke: float) -> float:
        """Largest speed over a stroke [m], if nothing else limits it [m/s]."""
        a, per_braking = self.acceleration, 1.0 / self.braking
        return a * (math.sqrt(per_braking**2 + 2.0 * stroke / a) - per_braking)


USUAL = SpeedProfile(acceleration=0.1, braking=1.5)

FORCE_BAND = 0.2
"""Share of a push's force limit below it over which its speed falls to zero."""

LIFT_SPEED = 0.06
"""At which what is held goes up and down, at most [m/s]."""

_BRAKING = 3.0  # of a push that is to be fast [1/s]
_ACCELERATION = 0.2  # of it, at most: a fingertip's spring makes it overtake its speed [m/s²]


def speed_profile(speed: float, stroke: float) -> SpeedProfile:
    """The profile of a push with a largest speed [m/s] over a stroke [m]."""
    # Up to which short pushes may stay slower than they could be [m/s].
    if speed <= 0.05 or USUAL.largest_speed(stroke) >= speed:
        return USUAL
    speeding_up = max(stroke - speed / _BRAKING, 1e-9)
    needed = speed**2 / (2.0 * speeding_up)
    return SpeedProfile(min(max(needed, USUAL.acceleration), _ACCELERATION), _BRAKING)


def reached_speed(speed: float, stroke: float) -> float:
    """Speed to which a push comes with a largest one [m/s] over a stroke [m], in [m/s]."""
    return min(speed, speed_profile(speed, stroke).largest_speed(stroke))
