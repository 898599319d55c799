"""One trip of the hand: look, go to an object, do something there, come back home.

The robot knows what its ports tell it: joint angles, finger torques and late, noisy camera frames.
Frames: W is the world, T the midpoint of the pushing fingertips' centres.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from planner.types.actions import Push
from planner.types.robot import ReachAnswer
from planner.types.world_state import WorldState
from sim.collision.collision_scene import SPARE
from sim.control.pushing.guarded_touch import EarlyEndError
from sim.control.trace_recorder import Recorder
from sim.motion.arm_configuration import ArmConfiguration, UnreachableError
from sim.motion.robot_reach import ArmHandReach
from sim.paths.fingertip_path import BACK, FingertipPath
from sim.paths.point_attractor import attractor_points
from sim.perception.camera_port import beheld
from sim.rotations import Array, rot_z

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from sim.worlds.drake.drake_world import DrakeWorld

Progress = Callable[[str, float, str], None]
"""Told of the phase, the simulated time [s] and what happens."""

LOOK = 1.0
"""Time over which camera frames are averaged before the hand moves [s]."""

JOINT_SPEED, JOINT_ACCELERATION = 1.2, 3.0
"""Of the arm in free motion, over all joints together [rad/s], [rad/s²]."""

HAND_SPEED, HAND_ACCELERATION = 0.20, 0.6
"""Of the hand near objects [m/s], [m/s²]."""


def silent(phase: str, time: float, text: str) -> None:
    """Progress that nobody asked for."""


class Trip:
    """The hand's way to a contact and back.

    Args:
        push: where the fingertips touch and which way they go then.
        world: where; it moves on.
        models: what the robot believes of every object, by its name in the scene.
        reach: of the world's robot.
        tell: progress.

    Attributes:
        recorder: of everything from the start on.
    """

    def __init__(
        self,
        push: Push,
        world: DrakeWorld,
        models: Mapping[str, ObjectModel],
        reach: ArmHandReach,
        tell: Progress,
    ) -> None:
        self.recorder = Recorder(world, reach.mount, np.array(push.normal_W))
        self._push = push
        self._world = world
        self._models = models
        self._reach = reach
        self._tell = tell
        self._descent: list[Array] = []  # arm angles from above the start down to it
        self._way_home: list[Array] = []  # arm angles between home and there, in order

    def look(self) -> WorldState:
        """Where everything stands now."""
        return look_around(self.recorder, self._models, self._tell)

    def stance(self, state: WorldState) -> tuple[ArmConfiguration, FingertipPath]:
        """How arm and hand stand, and the fingertips' way.

        Raises:
            EarlyEndError: the hand does not get there.
        """
        for reach in (self._reach, self._reach.thorough()):
            # It was reached from where things were seen before.
            for spare in (0.0, SPARE):
                answer = reach.push_configuration(self._push, state, spare)
                if not isinstance(answer, ReachAnswer):
                    return answer[0], reach.fingertip_path(self._push, state)
                why = answer.message
        raise EarlyEndError("unreachable", why)

    def approach(self, stance: ArmConfiguration, way: FingertipPath) -> None:
        """Free motion: over the start, then down to it."""
        self._tell("transit", self._world.time, f"moving the hand ({stance.posture.name})")
        above = np.array([*way.start[:2], stance.lift])
        self.recorder.phase = "transit"
        self.recorder.fingers = stance.posture.pushing
        for q in (*stance.via, stance.joints(above)):
            self._way_home.append(self._world.commanded[0])
            move_joints(self.recorder, q, stance.posture.joints)
        self._tell("approach", self._world.time, "down to the object")
        self.recorder.phase = "approach"
        for point in self._line(above, way.start):
            self._go(stance, point)
            self._descent.append(self._world.commanded[0])

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
        self.recorder.phase = "retreat"
        self.recorder.force_limit = 0.0
        self._tell("retreat", self._world.time, "leaving the object")
        off = tip - BACK * rot_z(turned) @ way.inward
        far = max(float(np.linalg.norm(off - way.start)), 1e-9)
        try:
            for point in self._line(tip, off):
                self._go(stance, point, turned)
            for point in self._line(off, way.start):
                left = float(np.linalg.norm(point - way.start)) / far
                self._go(stance, point, left * turned)
        except UnreachableError:
            # Both ends of the way are reached, so the joints lead from one to the other.
            move_joints(self.recorder, self._descent[-1], self._world.commanded[1])

    def come_home(self, settle: float) -> None:
        """Back home, and some time for everything to come to rest [s]."""
        self.recorder.phase = "retreat"
        for q in reversed(self._descent):
            self.recorder.step(q, self._world.commanded[1])
        rest = self._reach.mount.hand.resting.joints
        for q in reversed(self._way_home):
            last = q is self._way_home[0]
            move_joints(self.recorder, q, rest if last else self._world.commanded[1])
        self._tell("settle", self._world.time, "letting everything come to rest")
        self.recorder.phase = "settle"
        for _ in range(round(settle / self._world.period)):
            self.recorder.step(*self._world.commanded)

    def _line(self, start: Array, target: Array) -> list[Array]:
        return list(
            attractor_points(
                start,
                target,
                speed=HAND_SPEED,
                acceleration=HAND_ACCELERATION,
                period=self._world.period,
            )
        )

    def _go(self, stance: ArmConfiguration, tip: Array, turned: float = 0.0) -> None:
        self.recorder.step(stance.joints(tip, turned), stance.posture.joints)


def look_around(
    recorder: Recorder, models: Mapping[str, ObjectModel], tell: Progress
) -> WorldState:
    """Where everything stands now, and what the hand holds.

    Args:
        recorder: through which the world is stepped.
        models: what the robot believes of every object, by its name in the scene.
        tell: progress.
    """
    world = recorder.world
    tell("look", world.time, "looking where everything stands")
    recorder.phase = "look"
    frames = recorder.watch(LOOK)
    return WorldState(
        beheld(world.scene, frames, models),
        held=world.holding.held if world.holding is not None else None,
    )


def move_joints(recorder: Recorder, q_arm: Array, q_hand: Array) -> None:
    """Free motion of the arm, the hand opening or closing on the way.

    Args:
        recorder: through which the world is stepped.
        q_arm: where the arm goes, shape (7,) [rad].
        q_hand: and the hand, shape (12,) [rad].
    """
    start_arm, start_hand = recorder.world.commanded
    length = float(np.linalg.norm(q_arm - start_arm))
    for q in attractor_points(
        start_arm,
        q_arm,
        speed=JOINT_SPEED,
        acceleration=JOINT_ACCELERATION,
        period=recorder.world.period,
    ):
        share = 1.0 - float(np.linalg.norm(q_arm - q)) / length
        recorder.step(q, start_hand + share * (q_hand - start_hand))
