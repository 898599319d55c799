"""A plan for the whole hand: how an object is held, and what is done with it, step after step.

All of it is a value that `nlcontrol plan --json` prints; names are a public contract, numbers in
SI units. Directions and points are in W, except `p_BG`, which is in the object's B.

The hand holds things between its thumb and its three other fingers. `closing_W` is horizontal and
goes from the fingers' side of the object to the thumb's; `approach_W` is the direction in which the
straight fingers point: horizontal to hold something from its side, down to hold it from above.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from planner.types.plan import Aim, DefaultUsed, Value, Vector3

_UPRIGHT, _LEVEL = 0.95, 0.05  # of an approach, how much it goes down


class Grasp(Value):
    """How a hand holds an object, or its lid.

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
    """

    part: Literal["body", "lid"] = "body"
    p_BG: Vector3
    closing_W: Vector3
    approach_W: Vector3
    width: float
    squeeze: float
    needed: float
    strongest: float

    @property
    def way(self) -> str:
        """How the fingers come to it, in words."""
        down = -self.approach_W[2]
        if down > _UPRIGHT:
            return "from above"
        return "from its side" if down < _LEVEL else "askew from above"


class LiftUp(Value):
    """Straight up with what is held.

    Attributes:
        height: how far [m].
        hold: how long it is then held still [s].
    """

    kind: Literal["lift_up"] = "lift_up"
    height: float
    hold: float = 1.0


class Carry(Value):
    """Over the table with what is held, upright and at the height where it is.

    Attributes:
        to: where its B goes, or the middle of a lid; the heading is kept if none is given.
    """

    kind: Literal["carry"] = "carry"
    to: Aim


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
    """

    kind: Literal["pour_out"] = "pour_out"
    into: str
    heading: float
    lip_W: Vector3
    angle: float
    rate: float
    wait: float
    volume: float | None = None


class SetDown(Value):
    """Straight down until it stands, then lets go and draws back the way the hand came."""

    kind: Literal["set_down"] = "set_down"


class FlipOver(Value):
    """A fingertip moves a flip lid along its arc; the object stands by itself, nothing is held.

    Attributes:
        start, end: angles of the lid [rad]; a larger one is more open.
        speed: of the fingertip [m/s].
        force_limit: felt force at which it stops [N].
        heading: direction from hinge to tab, in W [rad].
    """

    kind: Literal["flip_over"] = "flip_over"
    start: float
    end: float
    speed: float
    force_limit: float
    heading: float


class TurnCap(Value):
    """Turns what is held about the vertical, letting go and gripping anew where a wrist ends.

    Attributes:
        angle: altogether, counter-clockwise [rad].
        torque_limit: at which it stops [N·m].
    """

    kind: Literal["turn_cap"] = "turn_cap"
    angle: float
    torque_limit: float


class PutOn(Value):
    """Lowers a lid that is held onto the rim it belongs to, presses it on and lets go.

    Attributes:
        onto: name of the object it belongs to.
        press: downward force [N].
    """

    kind: Literal["put_on"] = "put_on"
    onto: str
    press: float


HandStep = Annotated[
    LiftUp | Carry | PourOut | SetDown | FlipOver | TurnCap | PutOn, Field(discriminator="kind")
]


class HandlingPrediction(Value):
    """What the models say will happen; what an action has nothing to do with is None.

    Attributes:
        holds: probability that the grasp holds.
        poured, received, spilled: volumes that run out, reach the other object, and do not [m³].
        left: volume that stays in it [m³].
        level_after: share of the other object's volume that is filled afterwards.
        lid_force: largest force at the fingertip, or that pulls the lid off, over the way [N].
        nearest_angle: of the lid where the standing object comes nearest to giving way [rad].
        nearest_force: at the fingertip there [N].
        slide_force, topple_force: at which the standing object would give way there [N].
        lifting_force: at which it would come up with a lid that is pulled off [N].
        lid_torque: that turns the cap [N·m].
        turning_torque: at which the standing object would turn along [N·m].
        lid_angle: of a flip lid at the end [rad].
    """

    holds: float | None = None
    poured: float | None = None
    received: float | None = None
    spilled: float | None = None
    left: float | None = None
    level_after: float | None = None
    lid_force: float | None = None
    nearest_angle: float | None = None
    nearest_force: float | None = None
    slide_force: float | None = None
    topple_force: float | None = None
    lifting_force: float | None = None
    lid_torque: float | None = None
    turning_torque: float | None = None
    lid_angle: float | None = None


Action = Literal["lift", "place", "pour", "open", "close"]


class HandlingPlan(Value):
    """A grasp, if anything is held, and steps whose predicted outcome satisfies the frame.

    Attributes:
        action: what the steps amount to.
        object: name of what is handled.
        grasp: how it is held; None if nothing is.
        held: whether the hand holds it so already.
        steps: one after the other.
        prediction: what will come of it.
        speed: largest speed of the hand while it holds something [m/s].
        clear_of: other objects and the distance that is kept from each of them [m].
        probability: least probability that it ends as predicted.
        aim: where the object should stand at the end; None if it does not matter or stays up.
        defaults: values that the sentence left open.
        considered: how many grasps or ways were evaluated.
        satisfying: how many of them satisfied the frame.
        notes: plain sentences on how the plan was chosen.
    """

    status: Literal["planned"] = "planned"
    kind: Literal["handling"] = "handling"
    action: Action
    object: str
    grasp: Grasp | None
    held: bool = False
    steps: tuple[HandStep, ...]
    prediction: HandlingPrediction
    speed: float
    clear_of: tuple[tuple[str, float], ...] = ()
    probability: float = 1.0
    aim: Aim | None = None
    defaults: tuple[DefaultUsed, ...] = ()
    considered: int = 0
    satisfying: int = 0
    notes: tuple[str, ...] = ()
