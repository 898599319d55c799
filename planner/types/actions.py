"""Actions of a plan: a push, a grasp, and each step of a hand that holds something.

All of them are values that `nlcontrol plan --json` prints; names are a public contract, numbers in
SI units. `kind` says which action it is, `prediction` what the models say it will do. Directions
and points are in W, except `p_BC` and `p_BG`, which are in the object's B.

The hand holds things between its thumb and its three other fingers. `closing_W` is horizontal and
goes from the fingers' side of the object to the thumb's; `approach_W` is the direction in which the
straight fingers point: horizontal to hold something from its side, down to hold it from above.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from objectmodels.safety_figure import SafetyFigure
from objectmodels.short_repr import ShortRepr


class Value(ShortRepr):
    """A value that never changes, without unknown fields and infinities."""

    model_config = ConfigDict(defer_build=True, frozen=True, extra="forbid", allow_inf_nan=False)


class StandPrediction(Value):
    """An object that is put on another one, or into it.

    Attributes:
        margin: least distance of a centre of mass from the edges within which it must be, of what
            stands on each place of the stack [m].
        stands: least probability that the whole stack stands.
    """

    margin: float
    stands: float


class SetOn(Value):
    """Straight down until it stands on another object or in it, then as `set_down`.

    Attributes:
        onto: name of that object.
        height: over the table of where it stands then [m].
        inside: whether that is the floor of an open box.
        prediction: how surely it stands there.
    """

    kind: Literal["set_on"] = "set_on"
    onto: str
    height: float
    inside: bool = False
    prediction: StandPrediction


class TurnOver(Value):
    """Turns what is held about the middle of its grasp until another of its faces is below."""

    kind: Literal["turn_over"] = "turn_over"
    axis_W: tuple[float, float, float] = Field(description="of the turn, a unit vector in W")
    angle: float = Field(description="of the turn [rad]")


Vector3 = tuple[float, float, float]
FaceName = Literal["front", "back", "left", "right", "top"]
Outcome = Literal["none", "slide", "topple", "slide+topple"]
StopEvent = Literal["moves", "touching"]
"""The object has begun to move, or has met the object that `Push.meets` names."""

FALLING: SafetyFigure = math.radians(11.0)
"""Tilt beyond the angle of no return at which a push lets a toppling object fall [rad]."""

_UPRIGHT, _LEVEL = 0.95, 0.05  # of an approach, how much it goes down


class Aim(Value):
    """Pose in which an object should stand at the end, in W.

    Attributes:
        x, y: position of B's origin [m].
        yaw: heading of B's x axis [rad]; None if it does not matter.
    """

    x: float
    y: float
    yaw: float | None = None


class Limits(Value):
    """Limits that stop a push before a constraint of the sentence breaks.

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
        face: face that is touched, named by where it looks now (front looks at the robot).
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
        press: force with which a fingertip presses on the top face and draws it along [N]; 0 of a
            push on a side face.
    """

    kind: Literal["push"] = "push"
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
    press: float = 0.0


class Prediction(Value):
    """Prediction of a push by the object model, over everything the finger may transmit.

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


def finite_or_none(value: float) -> float | None:
    """A force or a height of a prediction; None of what never happens."""
    return float(value) if math.isfinite(value) else None


class Margins(Value):
    """Distances of a push from the nearest forbidden outcome, in the worst case considered.

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


class PushAction(Push):
    """A push with what the object model says of it.

    Attributes:
        prediction: what it will do.
        margins: how safe that is.
        displacement: of the object in W, as predicted [m]; None for a topple, a tilt or a push that
            is foreseen after others.
    """

    prediction: Prediction
    margins: Margins
    displacement: Vector3 | None = None


class Grasp(Value):
    """Hold of a hand on an object, or on its lid.

    Attributes:
        part: `body`, or `lid` (its knob or cap).
        p_BG: middle between the thumb's contact and the fingers' ones, in B [m]; of a lid in the
            B of its object, as if it were on.
        closing_W: unit direction from the fingers' side to the thumb's.
        approach_W: unit direction of the straight fingers.
        width: between the touched sides [m].
        squeeze: force of the thumb, and of the other fingers together [N].
        needed: squeeze that just holds it through all steps, with everything as believed [N].
        strongest: largest squeeze that the hand has there [N].
        depth: room that the grip leaves free before the palm [m]; 0 of the usual one.
    """

    kind: Literal["grasp"] = "grasp"
    part: Literal["body", "lid"] = "body"
    p_BG: Vector3
    closing_W: Vector3
    approach_W: Vector3
    width: float
    squeeze: float
    needed: float
    strongest: float
    depth: float = 0.0

    @property
    def approach_text(self) -> str:
        """Direction in which the fingers come to it, in words."""
        down = -self.approach_W[2]
        if down > _UPRIGHT:
            return "from above"
        return "from its side" if down < _LEVEL else "askew from above"


class GraspPrediction(Value):
    """Prediction of a grasp: that it holds through all steps, and how the object leans in it."""

    holds: float = Field(description="probability that it holds through all steps")
    lean: float = Field(default=0.0, description="turn about the closing direction [rad]")
    lean_sd: float = Field(default=0.0, description="its standard deviation [rad]")


class GraspAction(Grasp):
    """A grasp that comes before other steps; `held` if the hand holds it so already."""

    held: bool = Field(default=False, description="the hand holds it so already")
    prediction: GraspPrediction = Field(description="what it will do")


class PullPrediction(Value):
    """A lid that is pulled off.

    Attributes:
        lid_force: that pulls it off [N].
        lifting_force: at which the standing object would come up with it [N]; None if it never
            does.
    """

    lid_force: float
    lifting_force: float | None


class LiftUp(Value):
    """Straight up with what is held.

    Attributes:
        height: how far [m]; less than 0 if it is held too high.
        hold: how long it is then held still [s].
        prediction: what pulls a lid off on the way; None if nothing is pulled off.
    """

    kind: Literal["lift_up"] = "lift_up"
    height: float
    hold: float = 1.0
    prediction: PullPrediction | None = None


class Carry(Value):
    """Over the table with what is held, upright and at the height where it is.

    Its B goes `to` the aim, or the middle of a lid; the heading is kept if none is given.
    """

    kind: Literal["carry"] = "carry"
    to: Aim = Field(description="where its B goes, or the middle of a lid")


class PourPrediction(Value):
    """Prediction of contents that are poured.

    Attributes:
        poured, received, spilled: volumes that run out, reach the other object, and do not [m³].
        left: volume that stays in it [m³].
        level_after: share of the other object's volume that is filled afterwards.
    """

    poured: float
    received: float
    spilled: float
    left: float
    level_after: float


class PourOut(Value):
    """Tilts what is held over another object until enough has run out, and back upright.

    Attributes:
        into: name of the object that the stream is to fall into.
        heading: horizontal direction in which it leans, in W [rad].
        lip_W: where the lowest point of its lip is kept while it pours [m].
        angle: largest tilt [rad].
        rate: of tilting while it pours [rad/s].
        wait: at the largest tilt, until nothing runs out any more [s].
        volume: that is to run out [m³]; None for everything.
        prediction: what becomes of the contents.
    """

    kind: Literal["pour_out"] = "pour_out"
    into: str
    heading: float
    lip_W: Vector3
    angle: float
    rate: float
    wait: float
    volume: float | None = None
    prediction: PourPrediction


class SetDown(Value):
    """Straight down until it stands, then lets go and draws back the way the hand came."""

    kind: Literal["set_down"] = "set_down"


class FlipPrediction(Value):
    """A flip lid on its arc, and the object that stands under it.

    Attributes:
        lid_force: largest force at the fingertip over the arc [N].
        nearest_angle: of the lid where the standing object comes nearest to giving way [rad].
        nearest_force: at the fingertip there [N].
        slide_force, topple_force: at which the object gives way there [N]; None if it never does.
        lid_angle: at the end [rad].
    """

    lid_force: float
    nearest_angle: float
    nearest_force: float
    slide_force: float | None
    topple_force: float | None
    lid_angle: float


class FlipOver(Value):
    """A fingertip moves a flip lid along its arc; the object stands by itself, nothing is held.

    Attributes:
        start, end: angles of the lid [rad]; a larger one is more open.
        speed: of the fingertip [m/s].
        force_limit: felt force at which it stops [N].
        force_limits: the same at angles evenly from start to end; empty if it is one for all.
        heading: direction from hinge to tab, in W [rad].
        prediction: what the lid takes, and what the standing object bears.
    """

    kind: Literal["flip_over"] = "flip_over"
    start: float
    end: float
    speed: float
    force_limit: float
    force_limits: tuple[float, ...] = ()
    heading: float
    prediction: FlipPrediction


class TurnPrediction(Value):
    """A cap that is turned.

    Attributes:
        lid_torque: that turns it [N·m].
        turning_torque: at which the standing object would turn along [N·m]; None if it never does.
    """

    lid_torque: float
    turning_torque: float | None


class TurnCap(Value):
    """Turns what is held about the vertical, letting go and gripping anew where a wrist ends.

    Attributes:
        angle: altogether, counter-clockwise [rad].
        torque_limit: at which it stops [N·m].
        prediction: what the cap takes, and what the standing object bears.
    """

    kind: Literal["turn_cap"] = "turn_cap"
    angle: float
    torque_limit: float
    prediction: TurnPrediction


class PutOn(Value):
    """Lowers a lid onto the rim of the object it belongs to, presses it on [N] and lets go."""

    kind: Literal["put_on"] = "put_on"
    onto: str = Field(description="name of the object to which the lid belongs")
    press: float = Field(description="force with which it is pressed on [N]")


Action = Annotated[
    PushAction
    | GraspAction
    | LiftUp
    | Carry
    | TurnOver
    | PourOut
    | SetDown
    | SetOn
    | FlipOver
    | TurnCap
    | PutOn,
    Field(discriminator="kind"),
]
