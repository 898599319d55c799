"""A tilt and back: leans an object on the far edge of its base, holds it, lets it back.

After the touch the fingertips go along the arc on which the contact turns about that edge, a
`TiltArc`, sticking to the face, no faster than the force limit allows (the law of
`sim.control.pushing.force_control`), and slower as the asked tilt comes near, so that they stop on
it. They hold still for a moment, then go back the same way and carry the object down until its base
stands and presses on them no more. Where they cannot go on (it slides, it leans too far, the force
does not suffice), they let it back at once.

Frames: W is the world, T the midpoint of the pushing fingertips' centres.
"""

from __future__ import annotations

import numpy as np

from objectmodels.mechanics.push_thresholds import length_along
from sim.control.pushing.force_control import ExecutionContext, ForceController
from sim.control.pushing.push_guards import MOVED, TiltEstimator, TiltGuards
from sim.control.trace_recorder import EarlyEndError
from sim.paths.fingertip_path import TiltArc
from sim.traces.trace import EndReason

HOLD = 0.5
"""Time for which the tilt is held [s]."""

_SPEED = 0.8  # share of the plan's speed that is commanded; the fingertip overtakes it in jerks
_RATE, _BACK_RATE = np.radians([6.0, 5.0])  # of tilting and of letting back [rad/s]
_SLOWEST = np.radians(1.0)  # where it ends and where the base meets the table [rad/s]
_BRAKING = 2.0  # rate per remaining tilt [1/s]
_ACCELERATION = np.radians(12.0)  # [rad/s²]
_STANDS = np.radians(1.0)  # tilt of an object that stands, as far as is seen
_GONE = 0.15  # share of the largest force that a standing object no longer exceeds
_BEHIND = 0.02  # most way back behind the touch [m]
_STEPS = 8  # places of the arc that the arm is asked for beforehand


class TiltControl(ForceController):
    """One tilt, from before the face until the object stands again."""

    def __init__(self, errand: ExecutionContext) -> None:
        super().__init__(errand)
        self._length = length_along(self._target.model, self._target.pose.R_WB.T @ self._u)
        self._arc = TiltArc(self.way.touch, self._u, self._length, self._tip_radius)
        self._view = TiltEstimator(self._camera[1])
        self._angle = 0.0  # of the arc, as commanded
        self._most = 0.0  # the largest tilt
        self._most_force = 0.0

    def act(self) -> tuple[EndReason, str]:
        """Tilts, holds and lets back; returns how that ended and why."""
        push = self.plan.push
        self._arc = TiltArc(self._here.midpoint, self._u, self._length, self._tip_radius)
        self._angle = float(self._arc.tilt_angles(self.commanded[None])[0])
        for angle in np.linspace(0.0, push.tilt, _STEPS):
            self.stance.joint_angles(self._arc.tip_at(angle))
        self._begin(f"tilting it by {np.degrees(push.tilt):.1f}°")
        try:
            early = self._raise()
            if early is None:
                for _ in range(round(HOLD / self._period)):
                    self._lean(0.0)
        except EarlyEndError as stopped:
            early = stopped.end, stopped.detail
            self.recorder.phase = "retreat"
        self.recorder.report("push", "letting it back")
        back = self._let_back()
        if early is not None or not back:
            return early or ("guard", "it did not come back onto its base")
        told = f"it was tilted by {np.degrees(self._most):.1f}° and stands on its base again"
        return "returned", told

    def _raise(self) -> tuple[EndReason, str] | None:
        """Tilts it; why that ended early, or None."""
        push = self.plan.push
        guards = TiltGuards(self.plan, self._period, self._view)
        fastest = min(_RATE, _SPEED * push.speed / self._arc.arc_radius)
        standing = self._loading() / self._arc.arc_radius
        wanted = push.tilt
        rate = min(fastest, standing)
        while self._view.tilt < wanted:
            travel = float((self._here.midpoint - self._arc.origin) @ self._u)
            end = guards.end(self._elapsed_time, travel, self._felt, self._view.tilt)
            if end is not None:
                return end
            rate = self._faster(rate, fastest, _ACCELERATION)
            if travel < MOVED:
                rate = min(rate, standing)
            allowed = min(rate, max(_SLOWEST, _BRAKING * (wanted - self._view.tilt)))
            self._lean(allowed * self._room())
        return None

    def _let_back(self) -> bool:
        """Carries it down; whether it stands."""
        behind = -_BEHIND / self._arc.arc_radius
        while self._angle > behind and not self._stands():
            near = max(_SLOWEST, _BRAKING * self._view.own)
            self._lean(-min(_BACK_RATE, _SPEED * self.plan.push.speed / self._arc.arc_radius, near))
        return self._stands()

    def _stands(self) -> bool:
        gone = self._felt < _GONE * self._most_force
        return bool(gone and self._view.tilt < _STANDS)

    def _lean(self, rate: float) -> None:
        """Goes on along the arc at a rate [rad/s] for a control step."""
        self._angle += rate * self._period
        lean = self._view.own
        # Where the fingertip touches goes round on it as the face leans.
        self.recorder.inward = np.cos(lean) * self._u - [0.0, 0.0, np.sin(lean)]
        self._step(self._arc.tip_at(self._angle), self._u)
        now = self.recorder.port.time
        self._view.update_from_tip(now, float(self._arc.tilt_angles(self._here.midpoint[None])[0]))
        for frame in self.recorder.frames:
            up = frame.poses[self._object].R_WB[:, 2]
            self._view.update_from_camera(frame.time, float(np.arctan2(up @ self._u, up[2])))
        self._most = max(self._most, self._view.tilt)
        self._most_force = max(self._most_force, self._felt)
