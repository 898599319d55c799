"""The robot's port of a world in Drake.

The world hands over what the sensors measure after each step. The port keeps that and nothing
else of the world, so that what holds the port gets at no truth.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from weakref import WeakMethod

import numpy as np

from sim.cell.cell_description import CellDescription
from sim.hands.hand_model import Angles, Hand
from sim.rotations import Array
from sim.worlds.joint_noise import JointReadings, TorqueReadings
from sim.worlds.ports import Frame


class DrakeRobotPort:
    """Commands and readings of the robot in a simulated world; a `RobotPort`.

    Args:
        cell: what the robot is told.
        hand: on the arm.
        joint_names: of all joints, the arm's first.
        commanded: angles of arm and hand at the start, shapes (7,) and (12,) [rad].
        move: commands angles in the world and lets a control period pass there; referred to weakly,
            so that the world is freed with its last user.
        seed: of the world.
        gain_error: of the torque sensors.
    """

    def __init__(
        self,
        cell: CellDescription,
        hand: Hand,
        joint_names: tuple[str, ...],
        commanded: tuple[Array, Array],
        move: WeakMethod[Callable[[Array, Array], None]],
        *,
        seed: int,
        gain_error: float,
    ) -> None:
        self.cell = cell
        self.joint_names = joint_names
        self.period = 1.0 / cell.control_rate_hz
        self.time = 0.0
        self.commanded = commanded
        self._move = move
        self._arm_joints = len(commanded[0])
        self._angle_places, self._torque_places = _finger_places(hand, self._arm_joints)
        joints = {finger: len(angles) for finger, angles in hand.resting.angles.items()}
        self._torque_sensor = TorqueReadings(
            cell.torque_sensor, joints, self.period, seed, gain_error=gain_error
        )
        self._angle_sensor = JointReadings(
            cell.joint_sensor, self._arm_joints, len(joint_names), seed
        )
        self._measured = np.zeros(len(joint_names))
        self._torques = np.zeros(len(hand.joint_names))
        self._frames: list[Frame] = []

    def update(self, time: float, joints: Array, torques: Array, frames: Iterable[Frame]) -> None:
        """Takes what the sensors are exposed to in one step; for the world alone.

        Args:
            time: at the end of the step [s].
            joints: angles of all joints then, shape (n,) [rad].
            torques: means over the step of the hand's drive torques, shape (12,) [N·m].
            frames: that arrived in the step.
        """
        self.time = time
        self._measured = self._angle_sensor.read(joints)
        self._torques = torques
        self._frames += frames

    @property
    def torque_noise(self) -> float:
        """Standard deviation of a torque sensor's reading in a control step [N·m]."""
        sensor = self.cell.torque_sensor
        return sensor.noise_nm / math.sqrt(max(1.0, sensor.rate_hz * self.period))

    def step(self, q_arm: Array, q_hand: Array) -> None:
        """Commands joint angles and lets one control period pass; see `RobotPort`."""
        move = self._move()
        assert move is not None, "the world is kept as long as its robot moves"
        self.commanded = np.array(q_arm), np.array(q_hand)
        move(*self.commanded)

    def arm_angles(self) -> Array:
        """Measured angles of the arm's joints, shape (7,) [rad]."""
        return np.array(self._measured[: self._arm_joints])

    def finger_angles(self, finger: str) -> Angles:
        """Measured angles of a finger's independent joints [rad]."""
        return tuple(self._measured[self._angle_places[finger]].tolist())

    def finger_torques(self, finger: str) -> Array:
        """Measured torques of a finger's joints, shape (3,) [N·m]; see `RobotPort`."""
        return self._torque_sensor.read(finger, self._torques[self._torque_places[finger]])

    def frames(self) -> list[Frame]:
        """Camera frames that arrived since the last call."""
        frames, self._frames = self._frames, []
        return frames


def _finger_places(hand: Hand, arm_joints: int) -> tuple[dict[str, slice], dict[str, slice]]:
    """Places of each finger's independent joints among all angles and among the torques."""
    angles, torques = {}, {}
    angle, torque = arm_joints, 0
    for finger, resting in hand.resting.angles.items():
        angles[finger] = slice(angle, angle + len(resting))
        torques[finger] = slice(torque, torque + len(resting))
        angle, torque = angle + len(hand.model_joints(finger)), torque + len(resting)
    return angles, torques
