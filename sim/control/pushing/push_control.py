"""The push itself: force and speed together, from the touch until an end or a guard.

Law: the fingertips' command advances along the movement vector as in
`sim.control.pushing.force_control`. Once the object moves, the speed rises to the plan's; near the
end of the stroke it falls with what remains (`planner.types.plan`). The stroke is that of
the object's middle. Two fingers keep the object's heading by themselves, so that the fingertips
tell it; where they square the object up to themselves its middle swings aside, which the camera
tells. One finger is steered by `sim.control.pushing.lateral_control`, which knows it too.

Ends and guards stand in `sim.control.pushing.push_guards`, limits and events in
`sim.control.pushing.clause_guards`.
"""

from __future__ import annotations

import numpy as np

from planner.types.plan import USUAL, speed_profile
from sim.control.pushing.clause_guards import Follower
from sim.control.pushing.force_control import ForceController
from sim.control.pushing.hand_guard import HandGuard
from sim.control.pushing.lateral_control import LateralController, Pushed
from sim.control.pushing.push_guards import MOVED, Guards
from sim.rotations import Array
from sim.traces.trace import EndReason

_FOLLOWS = 0.3  # share of the commanded speed with which a moving object follows
_SLOWEST = 0.008  # [m/s]
_HOLD = 4.0  # rate at which deviations across the vector are corrected [1/s]
_HOLD_MOST = 0.010  # largest such correction [m]
_SHORTEST = 0.01  # remaining way over which two fingers lead an object back to its line [m]
_LARGEST_SLOPE = 0.2  # of their path then: inside the friction cone
_STIFFER = 0.5  # deviations of the friction radius: too large a one is corrected on the way
_CENTRE_SD = 0.002  # of the centre of friction along the face, from friction that varies [m]


class _Line:
    """The line of fingertips led across a push along a unit direction in W, and back onto it."""

    def __init__(self, along: Array) -> None:
        self._along = along
        self._across = np.zeros(3)
        self._correction = np.zeros(3)

    def correction(self, step: Array, come: Array, period: float) -> Array:
        """Correction of a command that advances by a step; T has come so far, shape (3,) [m]."""
        self._across = self._across + step - (step @ self._along) * self._along
        off = come - (come @ self._along) * self._along - self._across
        wanted = self._correction - _HOLD * period * off
        self._correction = wanted * min(1.0, _HOLD_MOST / max(float(np.linalg.norm(wanted)), 1e-9))
        return self._correction


class PushControl(ForceController):
    """One push, from before the face to its end."""

    def act(self) -> tuple[EndReason, str]:
        """Pushes until an end or a guard; returns which and why."""
        push = self.plan.push
        self._begin(f"pushing with at most {push.force_limit:.1f} N")
        origin, command, line = self._here.midpoint, self.commanded, _Line(self._u)
        steering = self._steering() if push.fingers == 1 and push.ends_on == "stroke" else None
        limits = self._limits()
        slope = 0.0
        turns = push.ends_on == "stroke" and push.turn != 0.0
        sideways = np.array([*self._leftwards, 0.0])
        speed = start = self._start()
        guards = Guards(self.plan, self._period)
        hand = HandGuard(self.stance, self._state, push.object)
        while True:
            now, elapsed, felt = self.recorder.port.time, self._elapsed_time, self._felt
            here = self._here.midpoint
            come = float((here - origin) @ self._u)
            stopped = limits.end(elapsed, now, here, felt, self.recorder.frames)
            if steering is not None:
                self._inform(steering)
                come, slope = (
                    steering.travelled_distance,
                    steering.slope(push.stroke - steering.travelled_distance),
                )
            elif turns:
                come, slope = self._led_way(limits.follower)
            aside = float((here - origin) @ sideways)
            stopped = stopped or hand.end(self.recorder.port.commanded[0], aside)
            end = guards.end(elapsed, come, felt, self._tilt) or stopped
            if end is not None:
                return end
            speed = self._speed(speed, start, come, guards.speed)
            advance = speed * self._room()
            step = advance * self._period * (self._u + slope * sideways) / np.hypot(1.0, slope)
            command = command + step
            off = line.correction(step, here - origin, self._period)
            self._step(command + off, self._u)

    def _speed(self, before: float, start: float, travel: float, measured: float) -> float:
        """Largest speed now: slow until something moves, then up to the plan's, slow at the end."""
        push, profile = self.plan.push, USUAL
        if push.ends_on == "stroke":
            profile = speed_profile(push.speed, push.stroke)
        if travel < MOVED or (measured < _FOLLOWS * before and before > 2.0 * _SLOWEST):
            return start
        allowed = self._faster(before, push.speed, profile.acceleration)
        if push.ends_on == "stroke":
            allowed = min(allowed, max(_SLOWEST, profile.braking * (push.stroke - travel)))
        return allowed

    # -- steering ------------------------------------------------------------------------------

    @property
    def _leftwards(self) -> Array:
        """Unit vector to the left of the push in W, shape (2,)."""
        return np.array([-self._u[1], self._u[0]])

    def _led_way(self, follower: Follower) -> tuple[float, float]:
        """Way of an object that two fingers square up [m], and their path's slope.

        Its middle swings aside while it does.
        """
        come, aside = follower.displacement @ self._u[:2], follower.displacement @ self._leftwards
        remaining = max(self.plan.push.stroke - float(come), _SHORTEST)
        return float(come), float(np.clip(-aside / remaining, -_LARGEST_SLOPE, _LARGEST_SLOPE))

    def _steering(self) -> LateralController:
        """Steering from what is believed at the touch."""
        push, pose, model = self.plan.push, self._target.pose, self._target.model
        inward = float(np.arctan2(-push.normal_W[1], -push.normal_W[0]))
        facing = inward - pose.yaw
        into = np.array([np.cos(facing), np.sin(facing)])
        face = max(model.faces([facing]), key=lambda face: -into @ face.normal[:2])
        left = np.array([-into[1], into[0]])
        return LateralController(
            Pushed(
                depth=float(-into @ push.p_BC[:2]),
                tip_radius=self._tip_radius,
                friction_radius=model.friction_radius + _STIFFER * model.friction_radius_sd,
                facing=facing,
                curvature=face.curvature,
                centre=float(left @ model.com[:2]),
            ),
            float(np.arctan2(self._u[1], self._u[0])),
            self._here.midpoint[:2],
            (pose.x, pose.y, inward),
            turn=push.turn,
            limit=push.limits.turn or np.inf,
            deviations=(
                *self._look,
                float(np.hypot(_CENTRE_SD, np.abs(left) @ model.com_sd[:2])),
                model.friction_radius_sd,
            ),
            camera=self._camera,
        )
