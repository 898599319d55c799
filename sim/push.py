"""The push itself: force and speed together, from the touch until an end or a guard.

Law: the fingertips' command advances along the movement vector at

    ṡ = v clip((F_limit(t) − F_felt) / band, −1, 1)

F_felt is the sum of the fingers' forces along the vector and F_limit rises from the touch to the
plan's force. While the object stands, v is so low that the fingers' stiffness raises the force at a
bounded rate; once it moves, v rises to the plan's speed; near the end of the stroke it falls with
what remains. The stroke is measured at the fingertips. Two fingers
keep the object's heading by themselves; one finger is steered by `sim.steering`.

Ends and guards stand in `sim.guards`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from planner.plan import Plan
from planner.state import WorldState
from sim.fingers import Touch
from sim.guards import MOVED, RAMP, Guards, band
from sim.hand import TIP_RADIUS
from sim.recorder import Recorder
from sim.stance import Stance
from sim.steering import LineKeeper, PushedBox
from sim.touch import TouchControl
from sim.trace import EndReason
from sim.way import Way

_ACCELERATION = 0.1  # [m/s²]
_FORCE_RATE = 10.0  # of an object that stands [N/s]
_FASTEST_START = 0.012  # before the object moves [m/s]
_FOLLOWS = 0.3  # share of the commanded speed with which a moving object follows
_BRAKING = 1.5  # speed per remaining distance near the end of the stroke [1/s]
_SLOWEST = 0.008  # [m/s]
_HOLD = 4.0  # rate at which deviations across the vector are corrected [1/s]
_HOLD_MOST = 0.010  # largest such correction [m]


class PushControl(TouchControl):
    """One push, from before the face to its end.

    Args:
        plan: what to do.
        recorder: through which the world is stepped.
        stance: of arm and hand.
        way: of the fingertips.
        state: what is believed.
        tell: progress.
    """

    def __init__(
        self,
        plan: Plan,
        recorder: Recorder,
        stance: Stance,
        way: Way,
        state: WorldState,
        tell: Callable[[str, float, str], None],
    ) -> None:
        super().__init__(plan.push, plan.prediction.onset, recorder, stance, way, tell)
        self.plan = plan
        self._target = state.objects[plan.push.object]

    def push(self) -> tuple[EndReason, str]:
        """Pushes until an end or a guard; returns which and why."""
        push = self.plan.push
        self.tell(
            "push", self.recorder.world.time, f"pushing with at most {push.force_limit:.1f} N"
        )
        self.recorder.phase = "push"
        started = self.recorder.world.time
        here = self._here
        origin, command = here.midpoint, self.commanded
        steering = self._steering(here) if push.fingers == 1 and push.ends_on == "stroke" else None
        correction, across, slope = np.zeros(3), np.zeros(3), 0.0
        sideways = np.array([-self._u[1], self._u[0], 0.0])
        start = min(_FASTEST_START, push.speed, _FORCE_RATE / self.stance.stiffness(self._u))
        speed, felt_first = start, float(self._forces.sum())
        guards = Guards(self.plan, self._period)
        while True:
            elapsed = self.recorder.world.time - started
            here = self._here
            travel = float((here.midpoint - origin) @ self._u)
            end = guards.end(elapsed, travel, float(self._forces.sum()), self._tilt)
            if end is not None:
                return end
            if steering is not None:
                self._inform(steering, here)
                slope = steering.slope(push.stroke - travel)
            limit = min(1.0, elapsed / RAMP) * (push.force_limit - felt_first) + felt_first
            self.recorder.force_limit = max(limit, felt_first)
            speed = self._speed(speed, start, travel, guards.speed)
            room = (limit - self._forces.sum()) / band(push)
            advance = speed * float(np.clip(room, -1.0, 1.0))
            step = advance * self._period * (self._u + slope * sideways) / np.hypot(1.0, slope)
            command = command + step
            across = across + step - (step @ self._u) * self._u
            off = (here.midpoint - origin) - travel * self._u - across
            correction = correction - _HOLD * self._period * off
            correction *= min(1.0, _HOLD_MOST / max(float(np.linalg.norm(correction)), 1e-9))
            self._step(command + correction, self._u)

    def _speed(self, before: float, start: float, travel: float, measured: float) -> float:
        """Largest speed now: slow until something moves, then up to the plan's, slow at the end.

        Args:
            before: the one of the step before [m/s].
            start: while the object stands [m/s].
            travel: of the fingertips [m].
            measured: speed of the fingertips [m/s].
        """
        push = self.plan.push
        if travel < MOVED or (measured < _FOLLOWS * before and before > 2.0 * _SLOWEST):
            return start
        allowed = min(push.speed, before + _ACCELERATION * self._period)
        if push.ends_on == "stroke":
            allowed = min(allowed, max(_SLOWEST, _BRAKING * (push.stroke - travel)))
        return allowed

    # -- steering ------------------------------------------------------------------------------

    def _steering(self, here: Touch) -> LineKeeper:
        """Steering from what is believed at the touch."""
        pose, model = self._target.pose, self._target.model
        vision = self.recorder.world.scene.vision
        frames = max(1.0, vision.rate_hz)  # of the look before, which lasted a second
        depth = (model.outline @ (pose.R_WB.T @ -self.way.inward)[:2]).max()
        inward = float(np.arctan2(self.way.inward[1], self.way.inward[0]))
        angle = np.radians(vision.angle_noise_deg)
        return LineKeeper(
            PushedBox(float(depth) + TIP_RADIUS, model.friction_radius, inward - pose.yaw),
            float(np.arctan2(self._u[1], self._u[0])),
            here.midpoint[:2],
            (pose.x, pose.y, inward),
            deviations=(
                angle / np.sqrt(frames) + 0.003,
                vision.position_noise_m / np.sqrt(frames) + 0.0005,
            ),
            camera=(vision.position_noise_m, angle),
        )

    def _inform(self, steering: LineKeeper, here: Touch) -> None:
        steering.moved(self.recorder.world.time, here.midpoint[:2])
        for frame in self.recorder.frames:
            steering.seen(frame.time, frame.poses[self.plan.push.object])
