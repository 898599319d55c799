"""The guarded touch: the hand before a face, closing in on it until it is felt.

Before it moves in, the hand hangs still: what its torque sensors read then is their zero. Both the
push and the touches that find an object's parameters begin so, and feel with the same filter.
"""

from __future__ import annotations

import numpy as np

from objectmodels.geometry.rotations import Array
from objectmodels.safety_figure import SafetyFigure
from planner.types.actions import Push
from sim.control.guards import Guard
from sim.control.object_estimate import Touch
from sim.control.trace_recorder import EarlyEndError, TraceRecorder
from sim.motion.fingertip_path import STANDOFF, FingertipPath
from sim.motion.inverse_kinematics import ArmConfiguration

TOUCH_SPEED: SafetyFigure = 0.015
"""Of the guarded approach [m/s]."""

PAUSE = 0.5
"""Before the touch, while the fingers hang still and feel nothing [s]."""

TOUCH_FORCE: SafetyFigure = 0.6
"""Felt force that counts as a touch, less for an object that half of it would move [N]."""

TOUCH_BEYOND: SafetyFigure = 0.015
"""Travel beyond the expected face after which there is nothing to touch [m]."""

NO_TOUCH: Guard[float] = Guard(
    "no_touch",
    float,
    STANDOFF + TOUCH_BEYOND,
    lambda travel: f"nothing was felt within {1e3 * (STANDOFF + TOUCH_BEYOND):.0f} mm",
    text=f"nothing is felt within {1e3 * (STANDOFF + TOUCH_BEYOND):.0f} mm",
    unit="m",
)
"""Ends a guarded approach by its travel [m]."""

SETTING_OFF = 0.006
"""Travel at first in which fingers set in motion feel themselves, and no face is expected [m]."""

_ACCELERATION = 0.1  # of the hand at an object [m/s²]
_FILTER: SafetyFigure = 0.04  # time constant of the felt force [s]
_NOISES: SafetyFigure = 6.0  # standard deviations of noise that do not count as a touch
_SEEN_SHARE = 0.35  # weight of a new camera frame in the seen tilt


def touch_force(onset: float) -> float:
    """Felt force that counts as the touch of an object that moves at an onset [N]."""
    return min(TOUCH_FORCE, 0.5 * onset)


class TouchControl:
    """The fingertips from before a face until they touch it, and what they feel from then on.

    Args:
        push: where and which way.
        onset: force at which the object is believed to move [N].
        recorder: through which the robot is stepped.
        stance: of arm and hand.
        way: of the fingertips.

    Attributes:
        commanded: where T was last commanded to be, in W, shape (3,) [m].
        turned: how far the palm was turned then [rad].
    """

    pause = PAUSE
    speed = TOUCH_SPEED

    def __init__(
        self,
        push: Push,
        onset: float,
        recorder: TraceRecorder,
        stance: ArmConfiguration,
        way: FingertipPath,
    ) -> None:
        self.recorder = recorder
        self.stance = stance
        self.way = way
        self.commanded = way.start
        self.turned = 0.0
        self._object = push.object
        self._touch_force = touch_force(onset)
        self._period = recorder.port.period
        self._u = np.array(push.direction_W)
        self._tip_radius = stance.mount.hand.tip_radius
        self._forces = np.zeros(push.fingers)
        self._tilt = 0.0
        self._share = min(1.0, self._period / _FILTER)

    def touch(self) -> None:
        """Approaches along the normal until the face is felt.

        Raises:
            EarlyEndError: nothing is felt where the face should be.
        """
        self.recorder.phase = "touch"
        self.recorder.force_limit = self._touch_force
        self._share = self._touch_share()
        self.recorder.take_zero(self.pause, lambda: self._step(self.way.start, self.way.inward))
        self._forces = np.zeros_like(self._forces)
        travel, speed = 0.0, 0.0
        while travel < SETTING_OFF or not self._is_touching():
            if NO_TOUCH.is_tripped(travel):
                raise EarlyEndError(*NO_TOUCH.end_of(travel))
            speed = self._faster(speed, self.speed)
            travel += speed * self._period
            self._step(self.way.start + travel * self.way.inward, self.way.inward)
        self._share = min(1.0, self._period / _FILTER)
        self.recorder.report_contact()

    def _faster(self, before: float, most: float, acceleration: float = _ACCELERATION) -> float:
        """A speed that rises to the most, a control step after it was another."""
        return min(most, before + acceleration * self._period)

    def _touch_share(self) -> float:
        """Weight of a new sample with which the noise stays well below the touch force."""
        noise = self.stance.force_noise_gain(self.way.inward) * self.recorder.port.torque_noise
        quiet = (self._touch_force / max(_NOISES * noise, 1e-9)) ** 2
        # An exponential filter of weight s lets s / (2 − s) of the variance through.
        return float(min(1.0, self._period / _FILTER, 2.0 * quiet / (1.0 + quiet)))

    def _is_touching(self) -> bool:
        """All fingers, or so much force that one of them alone would soon move the object."""
        enough = self._touch_force
        total, least = self._forces.sum(), self._forces.min()
        return bool((total > enough and least > 0.25 * enough) or total > 1.5 * enough)

    @property
    def _here(self) -> Touch:
        assert self.recorder.touch is not None, "the recorder knows the pushing fingers"
        return self.recorder.touch

    def _step(self, tip: Array, along: Array) -> None:
        """Commands T to a point and takes in what was felt along a direction, and seen.

        Raises:
            UnreachableError: the arm does not get there; the hand is left where it is.
        """
        q = self.stance.joint_angles(tip, self.turned)
        self.commanded = tip
        self.recorder.step(q, self.stance.posture.joint_angles)
        self._forces += self._share * (self._here.forces @ along - self._forces)
        for frame in self.recorder.frames:
            up = frame.poses[self._object].R_WB[:, 2]
            self._tilt += _SEEN_SHARE * (float(np.arctan2(up @ self._u, up[2])) - self._tilt)
