"""A drag: a fingertip presses on top of an object, under force control, and draws it along.

Law: the command goes down while less than the pressing force is felt, up while more is,

    ż = −(N − N_felt) / (k τ)

with the finger's stiffness k, and from when the force is there it also goes along the movement
vector, no faster than the plan's speed, and slower near the end. How far the object has come is
the fingertip's way and what late camera frames show it to lie behind. Where it stays behind by more
than they can be wrong, the fingertip slips over it, and the drag ends. Before the hand leaves, the
finger is let spring back, so that it does not shove what it lets go. Across the vector it gives way
while it presses, since a slanted finger drags, and then keeps to the line.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from objectmodels.geometry.rotations import Array
from objectmodels.safety_figure import SafetyFigure
from planner.types.actions import PushAction
from planner.types.end_reasons import EndReason
from planner.types.plan import StopCondition, speed_profile
from sim.control.guards import largest_tilt, longest
from sim.control.push_control import ForceController

SLIPS: SafetyFigure = 0.008
"""Way by which an object stays behind a fingertip that slips over it [m]."""

LOST: SafetyFigure = 0.1
"""Share of the pressing force below which the fingertip has left the face."""

_LOST_TIME: SafetyFigure = 0.3  # [s]


def drag_conditions(push: PushAction) -> tuple[StopCondition, ...]:
    """Conditions of the guards of a drag, as numbers."""
    tilt, least = largest_tilt(push), LOST * push.press
    return (
        StopCondition(
            when="slid",
            limit=SLIPS,
            unit="m",
            text=f"the object stays behind by more than {1e3 * SLIPS:.0f} mm: the fingertip slips "
            "over it",
        ),
        StopCondition(
            when="tilted",
            limit=tilt,
            unit="rad",
            text=f"the object is seen tilted by {np.degrees(tilt):.1f}° along the way",
        ),
        StopCondition(
            when="lost",
            limit=least,
            unit="N",
            text=f"it presses with less than {least:.1f} N for {_LOST_TIME:g} s",
        ),
        StopCondition(
            when="duration",
            limit=longest(push),
            unit="s",
            text=f"it takes longer than {longest(push):.0f} s",
        ),
    )


@dataclass(frozen=True)
class DragTuning:
    """Force and speeds of a drag."""

    force_time: float = 0.15  # in which a lack of pressing force is made up for [s]
    force_rate: float = 12.0  # of the pressing force [N/s]
    pressed_share: float = 0.9  # share of the force from which the drag begins
    press_time: float = 4.0  # for that [s]
    across_rate: float = 4.0  # rate at which deviations across the vector are corrected [1/s]
    least_speed: float = 0.008  # speed at the end [m/s]
    spring_force: float = 0.3  # force along the vector that is left [N], and time for it [s]
    spring_time: float = 1.5


class DragControl(ForceController):
    """One drag, from over the top face to its end."""

    tuning = DragTuning()

    def act(self) -> tuple[EndReason, str]:
        """Presses, and drags until an end or a guard; returns which and why."""
        push = self.plan.push
        self._begin(f"pressing on it with {push.press:.1f} N")
        self._stiffness = self.stance.push_stiffness(self.way.inward)
        self._softest = self.stance.push_stiffness(self._u)
        self._wanted = self._felt
        end = self._press() or self._drag()
        self._spring_back()
        return end

    def _press(self) -> tuple[EndReason, str] | None:
        """Presses until the force is there; returns an end if it does not come."""
        while self._felt < self.tuning.pressed_share * self.plan.push.press:
            if self._elapsed_time > self.tuning.press_time:
                return "force", f"it presses with {self._felt:.1f} N only"
            forces, touch = self._here.forces[0], self.way.inward
            along_face = forces - (forces @ touch) * touch
            self._advance(-along_face / (self._softest * self.tuning.force_time))
        return None

    def _drag(self) -> tuple[EndReason, str]:
        push, origin = self.plan.push, self._here.midpoint
        profile = speed_profile(push.speed, push.stroke)
        limits, speed, lost = self._limits(), 0.0, 0.0
        while True:
            now, here = self.recorder.port.time, self._here.midpoint
            aside = float(self._here.forces[0] @ self._u)
            stopped = limits.end(self._elapsed_time, now, here, aside, self.recorder.frames)
            travel = float((here - origin) @ self._u)
            come = travel + float(limits.follower.slipped @ self._u[:2])
            lost = lost + self._period if self._felt < LOST * push.press else 0.0
            end = self._end(travel, come, lost) or stopped
            if end is not None:
                return end
            allowed = max(self.tuning.least_speed, profile.braking * (push.stroke - come))
            speed = min(allowed, self._faster(speed, push.speed, profile.acceleration))
            off = here - origin
            off = off - (off @ self._u) * self._u - (off @ self.way.inward) * self.way.inward
            self._advance(speed * self._u - self.tuning.across_rate * off)

    def _end(self, travel: float, come: float, lost: float) -> tuple[EndReason, str] | None:
        """Why the drag ends now; None if it goes on."""
        push = self.plan.push
        if come >= push.stroke:
            return "stroke", f"it was drawn along by {1e3 * come:.0f} mm"
        if travel - come > SLIPS:
            gone = f"it went {1e3 * travel:.0f} mm, and the {push.object} stayed behind"
            return "slipped", f"the fingertip slips over it: {gone}"
        if self._tilt > largest_tilt(push):
            return "tilted", f"the object was seen to tilt by {np.degrees(self._tilt):.0f}°"
        if lost > _LOST_TIME:
            return "guard", "the fingertip lost the object"
        if self._elapsed_time > longest(push):
            return "guard", f"the drag took longer than {longest(push):.0f} s"
        return None

    def _advance(self, velocity: Array) -> None:
        """Commands one step along the face, at a velocity in W, and keeps up the pressing force."""
        self._wanted = min(
            self.plan.push.press, self._wanted + self.tuning.force_rate * self._period
        )
        # What is recorded as felt is the whole force: so is its limit.
        self.recorder.force_limit = math.hypot(self._wanted, self.plan.push.force_limit)
        lacking = (self._wanted - self._felt) / (self._stiffness * self.tuning.force_time)
        step = velocity + lacking * self.way.inward
        self._step(self.commanded + self._period * step, self.way.inward)

    def _spring_back(self) -> None:
        """Lets the finger, bent against the drag, spring back while it still presses."""
        until = self.recorder.port.time + self.tuning.spring_time
        while self.recorder.port.time < until:
            if float(self._here.forces[0] @ self._u) < self.tuning.spring_force:
                return
            self._advance(-self.tuning.least_speed * self._u)
