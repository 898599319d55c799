"""A push carried out: look, go to an object, do something there, come back home.

The robot knows what its ports tell it: joint angles, finger torques and late, noisy camera frames.
Frames: W is the world, T the midpoint of the pushing fingertips' centres.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from planner.types.actions import Push
from planner.types.robot import ReachAnswer
from planner.types.world_state import WorldState
from sim.collision.collision_scene import SPARE
from sim.control.free_motion import (
    look_around,
    move_joints,
    return_home,
    straight_line,
    transit,
)
from sim.control.trace_recorder import EarlyEndError
from sim.motion.arm_configuration import ArmConfiguration, UnreachableError
from sim.paths.fingertip_path import BACK, FingertipPath
from sim.rotations import Array, rot_z

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from sim.control.free_motion import RobotSetup
    from sim.supervision import Progress


class PushExecution:
    """The hand's way to the contact of a push and back; `recorder` records all of it."""

    def __init__(
        self,
        push: Push,
        setup: RobotSetup,
        models: Mapping[str, ObjectModel],
        progress: Progress | None = None,
    ) -> None:
        self.recorder = setup.recorder(np.array(push.normal_W), progress)
        self._push = push
        self._setup = setup
        self._port = setup.port
        self._models = models
        self._descent: list[Array] = []  # arm angles from above the start down to it
        self._came: list[Array] = []  # arm angles between home and there, in order

    def look(self) -> WorldState:
        """Looks at the table and returns where everything stands."""
        return look_around(self.recorder, self._models, self._setup.held)

    def stance(self, state: WorldState) -> tuple[ArmConfiguration, FingertipPath]:
        """Configuration of arm and hand, and the path of the fingertips.

        Raises:
            EarlyEndError: the hand does not get there.
        """
        for reach in (self._setup.reach, self._setup.reach.thorough_reach):
            # It was reached from where things were seen before.
            for spare in (0.0, SPARE):
                answer = reach.push_configuration(self._push, state, spare)
                if not isinstance(answer, ReachAnswer):
                    return answer[0], reach.fingertip_path(self._push, state)
                why = answer.message
        raise EarlyEndError("unreachable", why)

    def approach(self, stance: ArmConfiguration, way: FingertipPath) -> None:
        """Free motion: over the start, then down to it."""
        above = np.array([*way.start[:2], stance.lift])
        way_there = (*stance.via, stance.joint_angles(above))
        transit(self.recorder, stance.posture, way_there, self._came)
        self.recorder.begin("approach", "down to the object")
        for point in straight_line(above, way.start, self._port.period):
            self._go(stance, point)
            self._descent.append(self._port.commanded[0])

    def leave(
        self, stance: ArmConfiguration, tip: Array, way: FingertipPath, turned: float = 0.0
    ) -> None:
        """Off the face, and back along the way that was free.

        Args:
            stance: of arm and hand.
            tip: where T is commanded to be, shape (3,) [m].
            way: on which it came.
            turned: how far the palm has turned [rad]; it turns back once it is off the face.
        """
        self.recorder.begin("retreat", "leaving the object")
        self.recorder.force_limit = 0.0
        off = tip - BACK * rot_z(turned) @ way.inward
        far = max(float(np.linalg.norm(off - way.start)), 1e-9)
        try:
            for point in straight_line(tip, off, self._port.period):
                self._go(stance, point, turned)
            for point in straight_line(off, way.start, self._port.period):
                left = float(np.linalg.norm(point - way.start)) / far
                self._go(stance, point, left * turned)
        except UnreachableError:
            # Both ends of the way are reached, so the joints lead from one to the other.
            move_joints(self.recorder, self._descent[-1], self._port.commanded[1])

    def come_home(self, settle: float) -> None:
        """Back home, and some time for everything to come to rest [s]."""
        self.recorder.phase = "retreat"
        for q in reversed(self._descent):
            self.recorder.step(q, self._port.commanded[1])
        return_home(self.recorder, self._came, settle)

    def _go(self, stance: ArmConfiguration, tip: Array, turned: float = 0.0) -> None:
        self.recorder.step(stance.joint_angles(tip, turned), stance.posture.joint_angles)
