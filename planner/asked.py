"""What a frame asks of a push: goal, direction, distance, and limits on contact, force and speed.

It is the middle of the way from words to controller: names of directions, faces, regions and
degrees become headings, heights, newtons and metres per second. What this version has no
controller for is refused here, by the name of the capability.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from grammar import frames as g
from planner.directions import FACE_OF_PUSH, HEADINGS, bisector, heading_of
from planner.plan import DefaultUsed, FaceName, Refusal, StopEvent
from planner.tilts import almost_tips, meant

if TYPE_CHECKING:
    from planner.defaults import Defaults
    from planner.state import SeenObject, WorldState

_GOALS = {
    "place": "placing objects at places",
    "rotate": "turning objects",
    "upright": "standing objects up",
    "lift": "lifting objects",
    "open": "opening objects",
    "close": "closing objects",
    "pour": "pouring",
    "hand_over": "handing objects over",
    "parameters": "finding out parameters with one push",
    "none": "a command that does not say what should become of the object",
}
_CONSTRAINTS = {
    "no_slide": "keeping an object from sliding",
    "no_spill": "keeping an object from spilling",
    "no_lift": "checking that an object is not lifted",
    "min_force": "pushing with at least a force",
    "force": "pushing with exactly a force",
    "hard": "pushing hard",
    "fast": "pushing fast",
    "min_speed": "pushing with at least a speed",
    "speed": "keeping an exact speed",
    "max_duration": "limiting the duration",
    "duration": "pushing for a time",
    "max_tilt": "limiting how far an object tilts",
    "max_turn": "limiting how far an object turns",
    "until": "stopping at an event",
}


class RefusedError(Exception):
    """Planning ends with a refusal; it never leaves the planner."""

    def __init__(self, refusal: Refusal) -> None:
        super().__init__(refusal.message)
        self.refusal = refusal


def unsupported(capability: str, message: str, spans: g.Spans, *instead: str) -> RefusedError:
    """A refusal because this robot, or this version, lacks a capability."""
    return RefusedError(
        Refusal(
            reason="unsupported",
            message=message,
            capability=capability,
            spans=spans,
            suggestions=instead,
        )
    )


@dataclass(frozen=True)
class Asked:
    """What a push must do, as numbers.

    Attributes:
        outcome: wanted class at the onset.
        heading: direction of motion or of the fall in W [rad]; None if any will do.
        distance: to be moved [m]; the most if the goal is to topple.
        face: side face to be touched; None if any will do.
        low, high: contact heights allowed [m].
        region: words for the heights, if the sentence restricts them.
        max_force: largest force [N]; inf if not said.
        speed: largest speed [m/s].
        reserve: share by which the force limit exceeds the force needed.
        fingers: how many fingertips may push.
        tilt: angle by which it is tilted and then let back [rad]; None if it is not to come back.
        until: event that ends it earlier.
        contact_spans: words that restrict the contact.
        force_spans: words that restrict the force.
        defaults: what the sentence left open.
    """

    outcome: Literal["slide", "topple"]
    heading: float | None
    distance: float
    low: float
    high: float
    speed: float
    reserve: float
    face: FaceName | None = None
    region: str | None = None
    max_force: float = np.inf
    fingers: tuple[Literal[1, 2], ...] = (2, 1)
    tilt: float | None = None
    until: StopEvent | None = None
    contact_spans: g.Spans = ()
    force_spans: g.Spans = ()
    defaults: tuple[DefaultUsed, ...] = ()


def read(frame: g.Frame, state: WorldState, defaults: Defaults) -> Asked:
    """What a frame asks.

    Raises:
        RefusedError: it asks for something that this version cannot do.
    """
    if frame.query or frame.dialogue or frame.object is None or frame.object.id is None:
        raise unsupported(
            "planning what is no command", "only a command about an object is planned", frame.spans
        )
    target = state.objects[frame.object.id]
    asked = _goal(frame, target, state, defaults)
    for clause in frame.constraints:
        asked = _constrained(asked, clause, target, defaults)
    return asked


def _goal(frame: g.Frame, target: SeenObject, state: WorldState, defaults: Defaults) -> Asked:
    goal = frame.goal
    low, high = 0.0, target.model.top
    if isinstance(goal, g.Topple | g.Tilt):
        heading = HEADINGS[goal.direction] if goal.direction else None
        used = [DefaultUsed(name="speed", value=defaults.speed, unit="m/s", reason="no speed said")]
        asked = Asked(
            "topple", heading, np.inf, low, high, defaults.speed, defaults.force_reserve,
        )  # fmt: skip
        if isinstance(goal, g.Tilt):
            angle, reason = meant(goal, target.model, defaults)
            if reason:
                used.insert(0, DefaultUsed(name="tilt", value=angle, unit="rad", reason=reason))
            asked = replace(asked, tilt=angle)
        return replace(asked, defaults=tuple(used))
    if not isinstance(goal, g.Displace) or frame.action == "pull":
        what = "pulling objects" if frame.action == "pull" else _GOALS.get(goal.kind, goal.kind)
        message = f"this version of the robot has no controller for {what}"
        raise unsupported(what, message, goal.spans or frame.spans, "push, slide or topple it")
    heading, used = _heading(goal, target, state), []
    if heading is None:
        heading = HEADINGS["away"]
        used.append(
            DefaultUsed(name="direction", value=0.0, unit="rad", reason="no direction said: away")
        )
    if isinstance(goal.away_from, str) or isinstance(goal.toward, str):
        what = "moving towards or away from parts of the table"
        raise unsupported(what, f"this version of the robot is not capable of {what}", goal.spans)
    distance, reason = _distance(goal, defaults)
    if reason:
        used.append(DefaultUsed(name="distance", value=distance, unit="m", reason=reason))
    used.append(DefaultUsed(name="speed", value=defaults.speed, unit="m/s", reason="no speed said"))
    return Asked(
        "slide", heading, distance, low, high,
        defaults.speed, defaults.force_reserve, defaults=tuple(used),
    )  # fmt: skip


def _heading(goal: g.Displace, target: SeenObject, state: WorldState) -> float | None:
    if goal.heading is not None:
        return goal.heading
    for other, sign in ((goal.toward, 1.0), (goal.away_from, -1.0)):
        if not isinstance(other, g.ObjectRef) or other.id is None:
            continue
        if other.id == target.name:
            way = "towards" if other is goal.toward else "away from"
            message = f"the {target.name} cannot move {way} itself"
            raise RefusedError(Refusal(reason="impossible", message=message, spans=other.spans))
        there = state.objects[other.id].pose.p_WB
        return heading_of(sign * (there - target.pose.p_WB))
    if isinstance(goal.direction, tuple):
        return bisector(goal.direction)
    return HEADINGS[goal.direction] if goal.direction else None


def _distance(goal: g.Displace, defaults: Defaults) -> tuple[float, str | None]:
    """The distance to plan for [m], and why it is a default, if it is one."""
    if isinstance(goal.distance, g.RelativeLength) or goal.fraction is not None:
        raise unsupported(
            "distances measured in objects",
            "this version measures distances in units of length only",
            goal.spans,
            "say the distance in centimetres",
        )
    if goal.distance is not None:
        # A bound is kept with the tolerance to spare.
        spare = {"exact": 0.0, "at_least": 1.0, "at_most": -1.0}[goal.bound]
        spare *= min(defaults.distance_tolerance, 0.5 * goal.distance)
        return goal.distance + spare, None
    if goal.amount == "little":
        return defaults.distance_little, "“a little”"
    if goal.amount == "lot":
        return defaults.distance_lot, "“a lot”"
    return defaults.distance, "no distance said"


def _constrained(
    asked: Asked, clause: g.Constraint, target: SeenObject, defaults: Defaults
) -> Asked:
    match clause:
        case g.Until(event="tips" | "about_to_tip"):
            return _tilted_until(asked, clause, target, defaults)
        case g.NoTopple() | g.NoTilt() if asked.outcome == "topple" and (
            asked.tilt is None or clause.kind == "no_tilt"
        ):
            message = "it cannot topple and stay on its base"
            raise RefusedError(Refusal(reason="impossible", message=message, spans=clause.spans))
        case g.NoTouch(object=None):
            what = "keeping clear of everything, the table's edge and the hand included"
            message = f"this version of the robot is not capable of {what}"
            raise unsupported(what, message, clause.spans, "name the object not to touch")
        case g.NoTouch() if clause.clearance is not None:
            what = "keeping a distance from other objects"
            message = (
                "this version keeps clear of other objects, but not by a distance that is said"
            )
            raise unsupported(what, message, clause.spans, "leave out the distance")
        case g.NoTopple() | g.NoTilt() | g.NoTurn() | g.NoTouch():
            pass  # a push that slides straight on a free way does none of it
        case g.MaxForce():
            limit = min(asked.max_force, clause.value)
            return replace(asked, max_force=limit, force_spans=clause.spans)
        case g.MaxSpeed() | g.Slow():
            most = clause.value if isinstance(clause, g.MaxSpeed) else defaults.speed_gentle
            return _slower(asked, most)
        case g.Gentle():
            asked = replace(asked, reserve=defaults.force_reserve_gentle)
            return _slower(asked, defaults.speed_gentle)
        case g.MaxDistance():
            return _nearer(asked, clause, defaults)
        case g.ContactRegion():
            return _contact(asked, clause, target, defaults)
        case g.Effector():
            return _effector(asked, clause)
        case _:
            what = _CONSTRAINTS.get(clause.kind, clause.kind.replace("_", " "))
            message = f"this version of the robot is not capable of {what}"
            raise unsupported(what, message, clause.spans)
    return asked


def _tilted_until(asked: Asked, clause: g.Until, target: SeenObject, defaults: Defaults) -> Asked:
    """A tilt that ends where the base leaves the table, or well before the object falls."""
    used = tuple(d for d in asked.defaults if d.name != "distance")
    asked = replace(asked, outcome="topple", distance=np.inf, defaults=used)
    if clause.event == "tips":
        return replace(asked, tilt=defaults.rest_tilt, until="tips")
    return replace(asked, tilt=almost_tips(target.model, defaults))


def _slower(asked: Asked, speed: float) -> Asked:
    """A speed that the sentence gave is no default any more."""
    used = tuple(d for d in asked.defaults if d.name != "speed")
    return replace(asked, speed=min(asked.speed, speed), defaults=used)


def _nearer(asked: Asked, clause: g.MaxDistance, defaults: Defaults) -> Asked:
    """The limit is kept with the tolerance to spare, if that is still far enough."""
    if asked.outcome == "topple":
        raise unsupported(
            "limiting how far a toppling object moves",
            "this version does not limit how far an object moves while it topples",
            clause.spans,
        )
    most = clause.value - min(defaults.distance_tolerance, 0.5 * clause.value)
    if most < asked.distance - defaults.distance_tolerance:
        message = (
            f"{1e3 * asked.distance:.0f} mm are to be moved, but {1e3 * clause.value:.0f} mm "
            "are the most that is allowed"
        )
        numbers = {"distance": asked.distance, "max_distance": clause.value}
        raise RefusedError(
            Refusal(reason="impossible", message=message, numbers=numbers, spans=clause.spans)
        )
    return replace(asked, distance=min(asked.distance, most))


def _contact(
    asked: Asked, clause: g.ContactRegion, target: SeenObject, defaults: Defaults
) -> Asked:
    spans = asked.contact_spans + clause.spans
    height = target.model.top
    if clause.face == "top":
        raise unsupported(
            "pushing on the top face",
            "this robot pushes objects on their side faces; the top face is not one",
            clause.spans,
            "say “at the top” for the upper third of a side face",
        )
    if clause.face is not None:
        asked = replace(asked, face=clause.face)
        if asked.outcome == "topple" and asked.heading is None:
            push = next(d for d, face in FACE_OF_PUSH.items() if face == clause.face)
            asked = replace(asked, heading=HEADINGS[push])
    if clause.region is not None:
        third = {"bottom": 0, "middle": 1, "top": 2}[clause.region]
        asked = _between(
            asked, third * height / 3.0, (third + 1) * height / 3.0, f"at the {clause.region}"
        )
    if clause.height is not None:
        asked = _at_height(asked, clause.height, height, defaults)
    return replace(asked, contact_spans=spans)


def _at_height(asked: Asked, height: g.ContactHeight, top: float, defaults: Defaults) -> Asked:
    assert isinstance(height.value, float), "lengths measured in objects are resolved by now"
    upwards = height.origin == "table"
    at = height.value if upwards else top - height.value
    where = f"{1e3 * at:.0f} mm above the table"
    if height.bound == "exact":
        near = 0.5 * defaults.height_tolerance
        return _between(asked, at - near, at + near, where)
    if (height.bound == "at_least") == upwards:
        return _between(asked, at, top, f"at least {where}")
    return _between(asked, 0.0, at, f"at most {where}")


def _between(asked: Asked, low: float, high: float, region: str) -> Asked:
    """One more restriction of the heights; all of them hold."""
    region = f"{asked.region} and {region}" if asked.region else region
    return replace(asked, low=max(asked.low, low), high=min(asked.high, high), region=region)


def _effector(asked: Asked, clause: g.Effector) -> Asked:
    if clause.side == "left":
        raise unsupported(
            "a second (left) hand",
            "this robot has one hand, a right one",
            clause.spans,
            "leave out which hand, or say the right one",
        )
    if clause.tool == "arm" or (clause.tool == "hand" and clause.side is None):
        raise unsupported(
            f"pushing with the {clause.tool}",
            f"this robot pushes with its fingertips, not with the {clause.tool}",
            clause.spans,
            "say “with one finger” or “with two fingers”",
        )
    if clause.tool == "finger" and clause.count is not None:
        if clause.count > 2:
            raise unsupported(
                f"pushing with {clause.count} fingers",
                "this robot pushes with one or two fingertips",
                clause.spans,
            )
        return replace(asked, fingers=(2,) if clause.count == 2 else (1,))
    return asked
