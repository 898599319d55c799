"""The push itself: force and speed together, from the touch until an end or a guard.

Law: the fingertips' command advances along the movement vector at

    ṡ = v clip((F_limit(t) − F_felt) / band, −1, 1)

F_felt is the sum of the fingers' forces along the vector and F_limit rises from the touch to the
plan's force. While the object stands, v is so low that the fingers' stiffness raises the force at a
bounded rate; once it moves, v rises to the plan's speed; near the end of the stroke it falls with
what remains. The stroke is that of the object's middle. Two fingers keep the object's heading by
themselves, so that the fingertips tell it; where they square the object up to themselves its middle
swings aside, which the camera tells. One finger is steered by `sim.steering`, which knows it too.

Ends and guards stand in `sim.guards`, limits and events in `sim.limits`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from planner.plan import Plan
from planner.state import WorldState
from sim.fingers import Touch
from sim.guards import MOVED, RAMP, Guards, band
from sim.limits import Follower, LimitGuards
from sim.recorder import Recorder
from sim.rotations import Array
from sim.stance import Stance
from sim.steering import LineKeeper, Pushed
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
_SHORTEST = 0.01  # remaining way over which two fingers lead an object back to its line [m]
_LARGEST_SLOPE = 0.2  # of their path then: inside the friction cone
_STIFFER = 0.5  # deviations of the friction radius: too large a one is corrected on the way
_CENTRE_SD = 0.002  # of the centre of friction along the face, from friction that varies [m]


class _Line:
    """Where the fingertips were led across a push, and what brings them back there.

    Args:
        along: unit direction of the push in W, shape (3,).
    """

    def __init__(self, along: Array) -> None:
        self._along = along
        self._across = np.zeros(3)
        self._correction = np.zeros(3)

    def correction(self, step: Array, come: Array, period: float) -> Array:
        """What is added to the command, shape (3,) [m].

        Args:
            step: by which the command advances, shape (3,) [m].
            come: how far the fingertips have come, shape (3,) [m].
            period: since the last step [s].
        """
        self._across = self._across + step - (step @ self._along) * self._along
        off = come - (come @ self._along) * self._along - self._across
        wanted = self._correction - _HOLD * period * off
        self._correction = wanted * min(1.0, _HOLD_MOST / max(float(np.linalg.norm(wanted)), 1e-9))
        return self._correction


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
        self._state = state
        self._target = state.objects[plan.push.object]
        self._left = np.array([-self._u[1], self._u[0]])

    def push(self) -> tuple[EndReason, str]:
        """Pushes until an end or a guard; returns which and why."""
        push = self.plan.push
        self.tell(
            "push", self.recorder.world.time, f"pushing with at most {push.force_limit:.1f} N"
        )
        self.recorder.phase = "push"
        started = self.recorder.world.time
        here = self._here
        origin, command, line = here.midpoint, self.commanded, _Line(self._u)
        steering = self._steering(here) if push.fingers == 1 and push.ends_on == "stroke" else None
        limits = self._limits(origin)
        slope = 0.0
        turns = push.ends_on == "stroke" and push.turn != 0.0
        sideways = np.array([*self._left, 0.0])
        start = min(_FASTEST_START, push.speed, _FORCE_RATE / self.stance.stiffness(self._u))
        speed, felt_first = start, float(self._forces.sum())
        guards = Guards(self.plan, self._period)
        while True:
            elapsed = self.recorder.world.time - started
            here = self._here
            travel, felt = float((here.midpoint - origin) @ self._u), float(self._forces.sum())
            stopped = limits.end(
                elapsed, self.recorder.world.time, here.midpoint, felt, self.recorder.frames
            )
            come = travel
            if steering is not None:
                self._inform(steering, here)
                come, slope = steering.come, steering.slope(push.stroke - steering.come)
            elif turns:
                come, slope = self._led(limits.follower)
            end = guards.end(elapsed, come, felt, self._tilt) or stopped
            if end is not None:
                return end
            limit = min(1.0, elapsed / RAMP) * (push.force_limit - felt_first) + felt_first
            self.recorder.force_limit = max(limit, felt_first)
            speed = self._speed(speed, start, come, guards.speed)
            room = (limit - felt) / band(push)
            advance = speed * float(np.clip(room, -1.0, 1.0))
            step = advance * self._period * (self._u + slope * sideways) / np.hypot(1.0, slope)
            command = command + step
            off = line.correction(step, here.midpoint - origin, self._period)
            self._step(command + off, self._u)

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

    def _limits(self, origin: Array) -> LimitGuards:
        vision = self.recorder.world.scene.vision
        return LimitGuards(self.plan.push, self._state, vision, origin, self._period)

    def _led(self, follower: Follower) -> tuple[float, float]:
        """How far an object has come that two fingers square up [m], and their path's slope.

        Its middle swings aside while it does.
        """
        come, aside = follower.displacement @ self._u[:2], follower.displacement @ self._left
        remaining = max(self.plan.push.stroke - float(come), _SHORTEST)
        return float(come), float(np.clip(-aside / remaining, -_LARGEST_SLOPE, _LARGEST_SLOPE))

    def _steering(self, here: Touch) -> LineKeeper:
        """Steering from what is believed at the touch."""
        push, pose, model = self.plan.push, self._target.pose, self._target.model
        vision = self.recorder.world.scene.vision
        frames = max(1.0, vision.rate_hz)  # of the look before, which lasted a second
        angle = np.radians(vision.angle_noise_deg)
        inward = float(np.arctan2(-push.normal_W[1], -push.normal_W[0]))
        facing = inward - pose.yaw
        into = np.array([np.cos(facing), np.sin(facing)])
        face = max(model.faces([facing]), key=lambda face: -into @ face.normal[:2])
        left = np.array([-into[1], into[0]])
        return LineKeeper(
            Pushed(
                depth=float(-into @ push.p_BC[:2]),
                friction_radius=model.friction_radius + _STIFFER * model.friction_radius_sd,
                facing=facing,
                curvature=face.curvature,
                centre=float(left @ model.com[:2]),
            ),
            float(np.arctan2(self._u[1], self._u[0])),
            here.midpoint[:2],
            (pose.x, pose.y, inward),
            turn=push.turn,
            limit=push.limits.turn or np.inf,
            deviations=(
                angle / np.sqrt(frames) + 0.003,
                vision.position_noise_m / np.sqrt(frames) + 0.0005,
                float(np.hypot(_CENTRE_SD, np.abs(left) @ model.com_sd[:2])),
                model.friction_radius_sd,
            ),
            camera=(vision.position_noise_m, angle),
        )

    def _inform(self, steering: LineKeeper, here: Touch) -> None:
        steering.moved(self.recorder.world.time, here.midpoint[:2])
        for frame in self.recorder.frames:
            steering.seen(frame.time, frame.poses[self.plan.push.object])
