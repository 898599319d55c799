"""What a frame asks of the hand: outcome, aims, and limits on contact, force and speed.

It is the middle of the way from words to controller: names of directions, faces, regions and
degrees become headings, heights, newtons and metres per second. What this version has no
controller for is refused here, by the name of the capability.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from grammar.frames import command as g
from planner.geometry.directions import HEADINGS
from planner.problem.constraint_limits import Setting, restricted
from planner.problem.goal_poses import aimed
from planner.problem.tilt_goals import meant
from planner.refusals.push_refusals import unsupported
from planner.types.actions import Aim, FaceName, Limits, StopEvent
from planner.types.plan import DefaultUsed

if TYPE_CHECKING:
    from planner.types.defaults import Defaults
    from planner.types.world_state import SeenObject, WorldState

NO_LIMITS = Limits()

_GOALS = {
    "upright": "standing objects up",
    "lift": "lifting objects",
    "open": "opening objects",
    "close": "closing objects",
    "pour": "pouring",
    "hand_over": "handing objects over",
    "parameters": "finding out parameters with one push",
}


@dataclass(frozen=True)
class Asked:
    """What the hand must do with an object, as numbers: all pushes of a frame, or one of them.

    Attributes:
        outcome: wanted class at the onset.
        heading: direction of motion or of the fall in W [rad]; None if any will do.
        distance: to be moved [m]; the most if the goal is to topple.
        aims: poses of which one should be reached, the nearest first; empty if it is to topple.
        turn: by which one push turns the object [rad], counter-clockwise.
        swing: angle by which one push off the middle of a side turns it [rad]; 0 for any other.
        lateral: where along its face that push touches, from the middle [m].
        rotates: whether it is to turn about the vertical.
        tilt: angle by which it is tilted and then let back [rad]; None if it is not to come back.
        face: side face to be touched; None if any will do.
        low, high: contact heights allowed [m].
        region: words for the heights, if the sentence restricts them.
        max_force: largest force [N]; inf if not said.
        min_force: force that it must take to move it [N].
        speed: largest speed [m/s].
        reserve: share by which the force limit exceeds the force needed.
        least_limit: what the force limit is at least [N].
        fingers: how many fingertips may push.
        steep: whether two fingertips may push farther from square to a face than they usually do.
        direct: whether ways around what stands there are left out.
        until: event that ends the last push earlier; `meets` names what is to be touched then.
        near: objects that it is to stand close to, and how close [m].
        limits: what stops every push.
        contact_spans: words that restrict the contact.
        force_spans: words that restrict the force.
        time_spans: words that restrict the duration.
        defaults: what the sentence left open.
    """

    outcome: Literal["slide", "topple"]
    heading: float | None
    distance: float
    low: float
    high: float
    speed: float
    reserve: float
    aims: tuple[Aim, ...] = ()
    turn: float = 0.0
    swing: float = 0.0
    lateral: float = 0.0
    rotates: bool = False
    tilt: float | None = None
    face: FaceName | None = None
    region: str | None = None
    least_limit: float = 0.0
    max_force: float = np.inf
    min_force: float = 0.0
    fingers: tuple[Literal[1, 2], ...] = (2, 1)
    steep: bool = False
    direct: bool = False
    until: StopEvent | None = None
    meets: str | None = None
    near: tuple[tuple[str, float], ...] = ()
    limits: Limits = NO_LIMITS
    contact_spans: g.Spans = ()
    force_spans: g.Spans = ()
    time_spans: g.Spans = ()
    defaults: tuple[DefaultUsed, ...] = ()


def read(frame: g.Frame, state: WorldState, defaults: Defaults) -> Asked:
    """What a frame asks.

    Raises:
        NoPlanError: it asks for something that this version cannot do.
    """
    if frame.query or frame.dialogue or frame.object is None or frame.object.id is None:
        raise unsupported(
            "planning what is no command", "only a command about an object is planned", frame.spans
        )
    target = state.objects[frame.object.id]
    asked = _goal(frame, target, state, defaults)
    setting = Setting(target, state, defaults)
    # How far it will tilt is known when all others are read.
    for clause in sorted(frame.constraints, key=lambda c: c.kind == "no_spill"):
        asked = restricted(asked, clause, setting)
    return asked


def _goal(frame: g.Frame, target: SeenObject, state: WorldState, defaults: Defaults) -> Asked:
    goal = frame.goal
    plain = Asked(
        "slide", None, np.inf, 0.0, target.model.top,
        defaults.speed, defaults.force_reserve,
        defaults=(
            DefaultUsed(name="speed", value=defaults.speed, unit="m/s", reason="no speed said"),
        ),
    )  # fmt: skip
    if isinstance(goal, g.Topple):
        heading = HEADINGS[goal.direction] if goal.direction else None
        return replace(plain, outcome="topple", heading=heading)
    if isinstance(goal, g.Tilt):
        angle, reason = meant(goal, target.model, defaults)
        used = DefaultUsed(name="tilt", value=angle, unit="rad", reason=reason or "")
        return replace(
            plain,
            outcome="topple",
            heading=HEADINGS[goal.direction] if goal.direction else None,
            tilt=angle,
            defaults=((used,) if reason else ()) + plain.defaults,
        )
    if not isinstance(goal, g.Displace | g.Place | g.Rotate | g.NoGoal):
        what = _GOALS.get(goal.kind, goal.kind)
        message = f"this version of the robot has no controller for {what}"
        raise unsupported(what, message, goal.spans or frame.spans, "push, turn, tilt or topple it")
    found = aimed(frame, target, state, defaults)
    return replace(
        plain,
        aims=found.aims,
        rotates=isinstance(goal, g.Rotate),
        heading=found.heading,
        distance=np.inf if found.distance is None else found.distance,
        until=found.until,
        meets=found.meets,
        near=found.near,
        defaults=found.defaults + plain.defaults,
    )
