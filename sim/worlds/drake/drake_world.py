"""A simulated world in Drake, its robot's port and what an observer sees of it.

What the robot has stands behind `DrakeWorld.robot`: commands to the joints' impedance controllers
and readings of sensors. The world itself is the observer's port: true poses and who touches whom,
kept for judging and replay.

Frames: W is the world, B an object.
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Protocol
from weakref import WeakMethod

import numpy as np

from objectmodels.geometry.rotations import Array
from sim.errors import SimError
from sim.robots.arm import ArmKinematics
from sim.robots.cell_description import CellDescription
from sim.robots.hand import Angles, Hand
from sim.robots.robots import ARM, HAND
from sim.truth.object_truth import Truth
from sim.truth.scene_file import TOUCHING, Scene, sample_world
from sim.worlds.camera import camera_port
from sim.worlds.drake.contents import Lids, Liquid
from sim.worlds.drake.drake_bodies import ContactWatch
from sim.worlds.drake.drake_plant import Standing, add_plant, pose_row
from sim.worlds.drake.world_variation import ShiftingContents, VaryingFriction
from sim.worlds.ports import Frame, Sample, WallClock, WorldRecord
from sim.worlds.sensors import JointReadings, TorqueReadings

if TYPE_CHECKING:
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import ModelInstanceIndex, RevoluteJoint
    from pydrake.systems.framework import Context, DiagramBuilder, OutputPort


class DrakeRobotPort:
    """Commands and readings of the robot in a simulated world; a `RobotPort`.

    The world hands over what the sensors measure after each step. The port keeps that and nothing
    else of the world, so that what holds the port gets at no truth.

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
        # Places of each finger's independent joints among all angles and among the torques.
        self._angle_places, self._torque_places = dict[str, slice](), dict[str, slice]()
        joints = {finger: len(angles) for finger, angles in hand.resting.angles.items()}
        angle, torque = self._arm_joints, 0
        for finger, count in joints.items():
            self._angle_places[finger] = slice(angle, angle + count)
            self._torque_places[finger] = slice(torque, torque + count)
            angle, torque = angle + len(hand.model_joints(finger)), torque + count
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


class Change(Protocol):
    """Something about the objects that does not stay as it is."""

    def prepare(self, touched: Sequence[str], poses: Mapping[str, tuple[Array, Array]]) -> None:
        """Changes what must change before a step, knowing what the robot touches anew."""

    def present(self, name: str, truth: Truth) -> Truth:
        """The truth of an object, as it is now."""


class DrakeWorld:
    """A scene in Drake, that moves on when the robot's controller makes a step.

    Attributes:
        scene: what is true in this world; see `sim.truth.scene_file.sample_world`.
        seed: of everything random.
        robot: the port of its robot, which knows no truth.
        sample: the world as it is now.
        clock: holds each step back to real time while it runs; see `WallClock`.
        simulator: of the diagram; for measuring its cost, not for control.
    """

    def __init__(
        self, scene: Scene, *, seed: int = 0, arm: ArmKinematics = ARM, hand: Hand = HAND
    ) -> None:
        from pydrake.systems.analysis import Simulator
        from pydrake.systems.framework import DiagramBuilder

        scene = sample_world(scene, seed)
        self.scene = scene
        self.seed = seed
        builder = DiagramBuilder()
        self._model = add_plant(builder, scene, arm, hand)
        self._plant = self._model.plant
        self._effort = integrated_torques(builder, self._plant, self._model.hand, scene.time_step_s)
        self.simulator = Simulator(builder.Build())
        root = self.simulator.get_mutable_context()
        self._context = self._plant.GetMyMutableContextFromRoot(root)
        self._effort_context = self._effort.get_system().GetMyContextFromRoot(root)
        self._arm_joints = [self._joint(name) for name in arm.joint_names]
        self._finger_joints = {
            finger: [self._joint(name) for name in hand.model_joints(finger)]
            for finger in hand.fingers
        }
        joints = [*self._arm_joints, *(j for each in self._finger_joints.values() for j in each)]
        self._places = np.array([joint.position_start() for joint in joints])
        self._vision = camera_port(scene, seed=seed)
        self._hand = hand
        self._impulse = np.zeros(len(hand.joint_names))
        self._mean_torques = np.zeros(len(hand.joint_names))
        self._q_arm, self._q_hand = np.radians(scene.robot.home_deg), hand.resting.joint_angles
        self.robot = DrakeRobotPort(
            scene.cell,
            hand,
            tuple(joint.name() for joint in joints),
            (self._q_arm, self._q_hand),
            weakref.WeakMethod(self._move),
            seed=seed,
            gain_error=scene.torque_sensor.gain_error,
        )
        self._period = self.robot.period
        self.clock = WallClock()
        self._steps = 0
        self._records: weakref.WeakSet[WorldRecord] = weakref.WeakSet()
        self._watch = ContactWatch(
            self._plant,
            self._model.bodies,
            {each.body.name(): name for name, each in self._model.lids.items()},
        )
        self._lids = Lids(self._model, root)
        self._liquid = Liquid(self._model, root, scene, self._lids.is_open)
        self._changes: tuple[Change, ...] = (
            self._lids,
            self._liquid,
            *world_changes(self._model, root, scene, seed),
        )
        self._poses: dict[str, tuple[Array, Array]] = {}
        self._touched: list[str] = []
        self._start()

    def _joint(self, name: str) -> RevoluteJoint:
        return self._plant.GetJointByName(name)

    def _start(self) -> None:
        for joint, angle in zip(self._arm_joints, self._q_arm, strict=True):
            joint.set_angle(self._context, angle)
        for finger, resting in self._hand.resting.angles.items():
            angles = self._hand.model_angles(resting)
            for joint, angle in zip(self._finger_joints[finger], angles, strict=True):
                joint.set_angle(self._context, angle)
        self._command(self._q_arm, self._q_hand)
        self.simulator.Initialize()
        # What stands in the robot would be pressed away.
        for name, depth in self._watch.in_robot(self._context):
            if depth > TOUCHING:
                raise _broken(f"the {name} stands {1e3 * depth:.0f} mm in the robot as that waits")
        self._observe()
        self._prepare()

    def record(self) -> WorldRecord:
        """Begins a record of what happens from now on; see `ObserverPort`."""
        record = WorldRecord([self.sample])
        self._records.add(record)
        return record

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._steps * self._period

    def _move(self, q_arm: Array, q_hand: Array) -> None:
        """Commands joint angles and lets one control period pass; see `RobotPort.step`."""
        self._command(q_arm, q_hand)
        self._steps += 1
        self._prepare()
        try:
            self.simulator.AdvanceTo(self.time, interruptible=False)
        except RuntimeError as raised:
            raise _broken("the engine found no motion that obeys its laws") from raised
        self.clock.wait(self._period)
        # Time integrals of the hand's drive torques, shape (12,) [N·m·s].
        impulse = np.array(self._effort.Eval(self._effort_context))
        self._mean_torques, self._impulse = (impulse - self._impulse) / self._period, impulse
        self._observe()

    def _prepare(self) -> None:
        for change in self._changes:
            change.prepare(self._touched, self._poses)

    def _command(self, q_arm: Array, q_hand: Array) -> None:
        """Desired angles for the impedance controllers, and rates that lead there."""
        for model, q, before in (
            (self._model.arm, q_arm, self._q_arm),
            (self._model.hand, q_hand, self._q_hand),
        ):
            port = self._plant.get_desired_state_input_port(model)
            port.FixValue(self._context, np.concatenate([q, (q - before) / self._period]))
        self._q_arm, self._q_hand = q_arm, q_hand

    def truth_now(self, name: str) -> Truth:
        """The truth of an object at this time; for an observer, never for the robot.

        It differs from `scene` by the place where it stands and by the touch that began last.
        """
        truth = self.scene.object(name).truth
        for change in self._changes:
            truth = change.present(name, truth)
        return truth

    def _observe(self) -> None:
        poses, top = {}, self.scene.table.extent
        for name, body in self._model.bodies.items():
            X_WB = self._plant.EvalBodyPoseInWorld(self._context, body)
            p_WB = X_WB.translation()
            poses[name] = pose_row(X_WB)
            # However it lies or is pressed, the middle of its base is on the table or over it.
            if (
                p_WB[2] < -0.005
                and top.x_min <= p_WB[0] <= top.x_max
                and top.y_min <= p_WB[1] <= top.y_max
            ):
                raise _broken(f"the {name} is {-1e3 * p_WB[2]:.0f} mm deep in the table")
            self._poses[name] = (X_WB.rotation().matrix(), p_WB)
        joints = self._plant.GetPositions(self._context)[self._places]
        lids = self._lids.lid_openings()
        self.sample = Sample(
            self.time,
            poses,
            joints,
            dict(self._liquid.contents),
            self._liquid.spilled,
            lids,
            self._lids.poses(),
        )
        levels = self._liquid.levels(self._poses)
        self._vision.observe(self.time, self._poses, lids, self._lids.loose(), levels)
        frames = self._vision.take_arrived_frames(self.time)
        self.robot.update(self.time, joints, self._mean_torques, frames)
        self._touched = self._watch.note(self.time, self._context)
        for record in self._records:
            record.samples.append(self.sample)
            record.contacts += self._watch.begun


def _broken(what: str) -> SimError:
    """The simulation shows nothing any more that could happen."""
    hints = ("let nothing stand in anything else, nor where the robot waits (robot.home_deg)",)
    return SimError("simulation_broke", f"the simulation broke down: {what}", hints)


def integrated_torques(
    builder: DiagramBuilder, plant: MultibodyPlant, model: ModelInstanceIndex, time_step: float
) -> OutputPort:
    """The drives' torques of a model, integrated over time: samples alone would alias.

    Under a control loop the torques repeat with its period, so that a sample at the end of each
    step is not their mean.
    """
    from pydrake.systems.primitives import DiscreteTimeIntegrator

    torques = plant.get_net_actuation_output_port(model)
    integrator = builder.AddSystem(DiscreteTimeIntegrator(torques.size(), time_step))
    builder.Connect(torques, integrator.get_input_port())
    return integrator.get_output_port()


def world_changes(model: Standing, root: Context, scene: Scene, seed: int) -> Iterable[Change]:
    """The changes in a true scene; they cost no time where nothing changes."""
    variation = scene.table.friction_variation
    if variation.over_table > 0.0 or variation.per_trial > 0.0:
        yield VaryingFriction(model, root, scene, seed)
    if any(item.truth.contents_shift_m > 0.0 for item in scene.objects):
        yield ShiftingContents(model, root, scene, seed)
