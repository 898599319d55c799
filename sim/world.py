"""The simulated world behind the robot's ports.

What the robot has: commands to the joints' impedance controllers, what the joints' position
sensors and the finger joints' torque sensors read, and the vision port. What an observer of the
world has besides: the true poses and who touches whom, kept in `history` for judging and replay.

Frames: W is the world, B an object.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from planner.state import PlanarPose
from sim import arm, hand
from sim.hand import FINGERS, RESTING, Angles
from sim.plant import add_plant
from sim.rotations import Array
from sim.scene import Scene
from sim.sensors import JointReadings, TorqueReadings
from sim.trace import ContactEvent
from sim.vision import Frame, VisionPort, averaged

if TYPE_CHECKING:
    from pydrake.multibody.tree import BodyIndex, RevoluteJoint

_SEPARATED = 0.1
"""Two bodies that were apart for less are taken as having touched all the time [s]."""


@dataclass(frozen=True)
class Sample:
    """The world at one time.

    Attributes:
        time: [s].
        poses: per object, quaternion (w, x, y, z) and position p_WB [m], shape (7,).
        joints: angles of all robot joints, shape (23,) [rad].
    """

    time: float
    poses: Mapping[str, Array]
    joints: Array


class DrakeWorld:
    """A scene in Drake, that moves on when the robot's controller makes a step.

    Args:
        scene: what is true.
        seed: of everything random.

    Attributes:
        scene, seed: as given.
        period: time of a control step [s].
        time: simulated time [s].
        history: what happened, a sample per control step.
        contacts: touches, in order of time.
        joint_names: of `Sample.joints`.
        simulator: of the diagram; for measuring its cost, not for control.
    """

    def __init__(self, scene: Scene, *, seed: int = 0) -> None:
        from pydrake.systems.analysis import Simulator
        from pydrake.systems.framework import DiagramBuilder

        self.scene = scene
        self.seed = seed
        self.period = 1.0 / scene.control_rate_hz
        builder = DiagramBuilder()
        self._model = add_plant(builder, scene)
        self._plant = self._model.plant
        self.simulator = Simulator(builder.Build())
        self._context = self._plant.GetMyMutableContextFromRoot(
            self.simulator.get_mutable_context()
        )
        self._arm_joints = [self._joint(name) for name in arm.JOINT_NAMES]
        self._finger_joints = {
            finger: [self._joint(f"{finger}_{name}") for name in hand.FINGER_JOINTS]
            for finger in FINGERS
        }
        joints = [*self._arm_joints, *(j for f in FINGERS for j in self._finger_joints[f])]
        self._joints = joints
        self.joint_names = tuple(joint.name() for joint in joints)
        self._names = ["table", *(self._plant.get_body(i).name() for i in self._bodies()[1:])]
        self._vision = VisionPort(scene.vision, scene.names, seed=seed)
        self._torques = TorqueReadings(scene.torque_sensor, self.period, seed)
        self._angles = JointReadings(
            scene.joint_sensor, len(self._arm_joints), len(self._joints), seed
        )
        self._measured = np.zeros(len(self._joints))
        self._steps = 0
        self.history: list[Sample] = []
        self.contacts: list[ContactEvent] = []
        self._touching: dict[tuple[str, str], float] = {}
        self._frames: list[Frame] = []
        self._start()

    def _bodies(self) -> list[BodyIndex]:
        """All bodies; the first is the world, which is the table."""
        from pydrake.multibody.tree import BodyIndex

        return [BodyIndex(i) for i in range(self._plant.num_bodies())]

    def _joint(self, name: str) -> RevoluteJoint:
        return self._plant.GetJointByName(name)

    def _start(self) -> None:
        self._q_arm = np.radians(self.scene.robot.home_deg)
        self._q_hand = RESTING.joints
        for joint, angle in zip(self._arm_joints, self._q_arm, strict=True):
            joint.set_angle(self._context, angle)
        for finger in FINGERS:
            abduction, proximal, middle = RESTING.angles[finger]
            angles = (abduction, proximal, middle, middle)
            for joint, angle in zip(self._finger_joints[finger], angles, strict=True):
                joint.set_angle(self._context, angle)
        self._command(self._q_arm, self._q_hand)
        self.simulator.Initialize()
        self._observe()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._steps * self.period

    @property
    def commanded(self) -> tuple[Array, Array]:
        """Angles that arm and hand were last told to take, shapes (7,) and (12,) [rad]."""
        return self._q_arm, self._q_hand

    def step(self, q_arm: Array, q_hand: Array) -> None:
        """Commands joint angles and lets one control period pass.

        Args:
            q_arm: of the arm's joints, shape (7,) [rad].
            q_hand: of the fingers' independent joints, in the order of `hand.JOINT_NAMES`,
                shape (12,) [rad].
        """
        self._command(q_arm, q_hand)
        self._steps += 1
        self.simulator.AdvanceTo(self.time)
        self._observe()

    def _command(self, q_arm: Array, q_hand: Array) -> None:
        """Desired angles for the impedance controllers, and rates that lead there."""
        for model, q, before in (
            (self._model.arm, q_arm, self._q_arm),
            (self._model.hand, q_hand, self._q_hand),
        ):
            port = self._plant.get_desired_state_input_port(model)
            port.FixValue(self._context, np.concatenate([q, (q - before) / self.period]))
        self._q_arm, self._q_hand = np.array(q_arm), np.array(q_hand)

    def arm_angles(self) -> Array:
        """Measured angles of the arm's joints, shape (7,) [rad]."""
        return np.array(self._measured[: len(self._arm_joints)])

    def finger_angles(self, finger: str) -> Angles:
        """Measured abduction, proximal and middle flexion [rad]."""
        first = len(self._arm_joints) + len(hand.FINGER_JOINTS) * FINGERS.index(finger)
        abduction, proximal, middle = self._measured[first : first + 3].tolist()
        return abduction, proximal, middle

    def finger_torques(self, finger: str) -> Array:
        """What a finger's joint torque sensors read, shape (3,) [N·m].

        The moment that the joint transmits to the link beyond it, about the joint's axis: the mean
        of the samples since the last control step.
        """
        reactions = self._plant.get_reaction_forces_output_port().Eval(self._context)
        torques = np.array(
            [
                reactions[int(joint.index())].rotational() @ joint.revolute_axis()
                for joint in self._finger_joints[finger][:3]
            ]
        )
        return self._torques.read(finger, torques)

    @property
    def torque_noise(self) -> float:
        """Standard deviation of what a torque sensor reads in a control step [N·m]."""
        sensor = self.scene.torque_sensor
        return sensor.noise_nm / math.sqrt(max(1.0, sensor.rate_hz * self.period))

    def frames(self) -> list[Frame]:
        """Camera frames that arrived since the last call."""
        frames, self._frames = self._frames, []
        return frames

    def look(self, seconds: float) -> dict[str, PlanarPose]:
        """Waits and averages the camera frames that arrive meanwhile; nothing may move.

        Args:
            seconds: how long [s]; longer if no frame arrives.
        """
        frames = self.frames()
        until = self._steps + round(seconds / self.period)
        while self._steps < until or not frames:
            self.step(self._q_arm, self._q_hand)
            frames += self.frames()
        return averaged(frames)

    def _observe(self) -> None:
        poses, seen = {}, {}
        for name, body in self._model.bodies.items():
            X_WB = self._plant.EvalBodyPoseInWorld(self._context, body)
            p_WB = X_WB.translation()
            poses[name] = np.concatenate([X_WB.rotation().ToQuaternion().wxyz(), p_WB])
            seen[name] = (X_WB.rotation().matrix(), p_WB)
        joints = np.array([joint.get_angle(self._context) for joint in self._joints])
        self._measured = self._angles.read(joints)
        self.history.append(Sample(self.time, poses, joints))
        self._vision.observe(self.time, seen)
        self._frames += self._vision.arrived(self.time)
        self._note_contacts()

    def _note_contacts(self) -> None:
        """Adds touches that began; objects standing on the table are not told."""
        results = self._plant.get_contact_results_output_port().Eval(self._context)
        for i in range(results.num_point_pair_contacts()):
            info = results.point_pair_contact_info(i)
            a, b = self._names[int(info.bodyA_index())], self._names[int(info.bodyB_index())]
            if (a == "table" and b in self._model.bodies) or (
                b == "table" and a in self._model.bodies
            ):
                continue
            touching = (a, b) if a < b else (b, a)
            if self.time - self._touching.get(touching, -np.inf) > _SEPARATED:
                self.contacts.append(ContactEvent(self.time, *touching))
            self._touching[touching] = self.time
