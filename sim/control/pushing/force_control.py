"""Planned motions under force: their plan, beliefs, and the law of their advance.

Law: from the touch on, the command advances at

    ṡ = v clip((F_limit(t) − F_felt) / band, −1, 1)

F_felt is the sum of the fingers' forces along the movement vector and F_limit rises from the touch
to the plan's force. While the object stands, v is so low that the fingers' stiffness raises the
force at a bounded rate; v rises at a bounded rate after. What v is then and where the command goes
is each motion's own: `sim.control.pushing.push_control`, `sim.control.pushing.turn_control`,
`sim.control.pushing.tilt_control`.

Frames: W is the world, T the midpoint of the pushing fingertips' centres.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from planner.types.plan import Plan
from planner.types.world_state import WorldState
from sim.control.pushing.clause_guards import LimitGuards
from sim.control.pushing.guarded_touch import TouchControl
from sim.control.pushing.push_guards import RAMP, band
from sim.control.trace_recorder import TraceRecorder
from sim.motion.arm_configuration import ArmConfiguration
from sim.paths.fingertip_path import FingertipPath
from sim.rotations import Array
from sim.traces.trace import EndReason
from sim.worlds.ports import SeenPose

_FORCE_RATE = 10.0  # of an object that stands [N/s]

FASTEST_START = 0.012
"""Speed of the command before the object moves, at most [m/s]."""

_LOOK_ANGLE, _LOOK_PLACE = 0.003, 0.0005  # doubt that averaging leaves [rad], [m]


class MotionEstimator(Protocol):
    """An estimate of how the object moves, from the fingertips and from late camera frames."""

    def update_from_tip(self, time: float, tip: Array) -> None:
        """Takes T in W, shape (2,) [m], at a time [s]."""

    def update_from_camera(self, time: float, pose: SeenPose) -> None:
        """Takes what a camera frame of an earlier time [s] shows."""


@dataclass(frozen=True)
class ExecutionContext:
    """A planned motion: the stance of arm and hand, the fingertips' way, what is believed."""

    plan: Plan
    recorder: TraceRecorder
    stance: ArmConfiguration
    way: FingertipPath
    state: WorldState


class ForceController(TouchControl, ABC):
    """One planned motion, from before a face to its end: first `touch`, then `act`."""

    def __init__(self, errand: ExecutionContext) -> None:
        self.plan = plan = errand.plan
        super().__init__(
            plan.push,
            plan.push.prediction.onset,
            errand.recorder,
            errand.stance,
            errand.way,
        )
        self._state = errand.state
        self._target = errand.state.objects[plan.push.object]
        self._started = 0.0
        self._felt_first = 0.0

    @abstractmethod
    def act(self) -> tuple[EndReason, str]:
        """Does what is planned from the touch on; returns how that ended and why."""

    # -- force and speed -----------------------------------------------------------------------

    def _begin(self, asked: str) -> None:
        """Reports what is asked; from now on the force limit rises."""
        self.recorder.begin("push", asked)
        self._started = self.recorder.port.time
        self._felt_first = self._felt

    @property
    def _elapsed_time(self) -> float:
        """Time since it began [s]."""
        return self.recorder.port.time - self._started

    @property
    def _felt(self) -> float:
        """Force along the movement vector, filtered [N]."""
        return float(self._forces.sum())

    def _room(self) -> float:
        """Share of its speed with which the command advances now, −1 to 1."""
        push, first = self.plan.push, self._felt_first
        limit = min(1.0, self._elapsed_time / RAMP) * (push.force_limit - first) + first
        self.recorder.force_limit = max(limit, first)
        return float(np.clip((limit - self._felt) / band(push), -1.0, 1.0))

    def _loading(self) -> float:
        """Speed of the command that raises the force of an object that stands [m/s]."""
        return _FORCE_RATE / self.stance.push_stiffness(self._u)

    def _start(self) -> float:
        """Speed until the object moves [m/s]."""
        return min(FASTEST_START, self.plan.push.speed, self._loading())

    # -- what is known -------------------------------------------------------------------------

    def _limits(self) -> LimitGuards:
        """Limits and event of the sentence, from the touch on."""
        vision, here = self.recorder.port.cell.vision, self._here.midpoint
        return LimitGuards(self.plan.push, self._state, vision, here, self._period)

    def _inform(self, keeper: MotionEstimator) -> None:
        keeper.update_from_tip(self.recorder.port.time, self._here.midpoint[:2])
        for frame in self.recorder.frames:
            keeper.update_from_camera(frame.time, frame.poses[self._object])

    @property
    def _camera(self) -> tuple[float, float]:
        """Standard deviations of a frame's position [m] and heading [rad]."""
        vision = self.recorder.port.cell.vision
        return vision.position_noise_m, float(np.radians(vision.angle_noise_deg))

    @property
    def _look(self) -> tuple[float, float]:
        """Standard deviations of heading [rad] and place [m] in the look before."""
        place, angle = self._camera
        frames = max(1.0, self.recorder.port.cell.vision.rate_hz)  # the look lasted a second
        return (
            float(angle / np.sqrt(frames)) + _LOOK_ANGLE,
            float(place / np.sqrt(frames)) + _LOOK_PLACE,
        )
