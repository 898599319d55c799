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

from objectmodels.geometry.rotations import Array
from planner.types.end_reasons import Ended
from planner.types.plan import speed_profile
from sim.control.guards import Sample
from sim.control.push_control import ForceController


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

    def act(self) -> Ended:
        """Presses, and drags until an end or a guard; returns which and why."""
        push = self.plan.push
        self._begin(f"pressing on it with {push.press:.1f} N")
        self._stiffness = self.stance.push_stiffness(self.way.inward)
        self._softest = self.stance.push_stiffness(self._u)
        self._wanted = self._felt
        self._speed = 0.0
        ended = self._press() or self._advance_until(self._guards())
        self._spring_back()
        return ended

    def _press(self) -> Ended | None:
        """Presses until the force is there; returns an end if it does not come."""
        while self._felt < self.tuning.pressed_share * self.plan.push.press:
            if self._elapsed_time > self.tuning.press_time:
                return Ended("force", f"it presses with {self._felt:.1f} N only")
            forces, touch = self._here.forces[0], self.way.inward
            along_face = forces - (forces @ touch) * touch
            self._move_along(-along_face / (self._softest * self.tuning.force_time))
        return None

    @property
    def _travel(self) -> float:
        return super()._travel + float(self._estimate.slipped @ self._u[:2])

    @property
    def _felt_along(self) -> float:
        return float(self._here.forces[0] @ self._u)

    def _advance(self, sample: Sample) -> None:
        push = self.plan.push
        profile = speed_profile(push.speed, push.stroke)
        allowed = max(self.tuning.least_speed, profile.braking * (push.stroke - sample.travel))
        self._speed = min(allowed, self._faster(self._speed, push.speed, profile.acceleration))
        off = self._here.midpoint - self._origin
        off = off - (off @ self._u) * self._u - (off @ self.way.inward) * self.way.inward
        self._move_along(self._speed * self._u - self.tuning.across_rate * off)

    def _move_along(self, velocity: Array) -> None:
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
            if self._felt_along < self.tuning.spring_force:
                return
            self._move_along(-self.tuning.least_speed * self._u)
