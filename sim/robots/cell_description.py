"""Description of a robot's cell: what stands there, the table, its mount and its sensors.

It holds nothing of how the objects really are; `sim.truth.scene_file` adds that. A real robot's
cell is described in the same way.

Frames: W is the world, z up, table plane z = 0.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import ConfigDict, Field, GetCoreSchemaHandler
from pydantic_core import core_schema

from objectmodels.files.yaml_documents import (
    Angle,
    Coordinate,
    Deviation,
    Name,
    TableLength,
    range_of,
)
from objectmodels.short_repr import ShortRepr
from planner.types.defaults import DEFAULTS, Defaults
from planner.types.world_state import TableState

LOOK = 1.0
"""Time over which camera frames are averaged before the hand moves [s]."""

Fraction = Annotated[float, Field(ge=0, le=1)]
Spread = Annotated[float, Field(ge=0, le=0.45)]
"""A relative standard deviation; at two of the largest, a tenth of the value is left."""

Point2 = tuple[Coordinate, Coordinate]
Point3 = tuple[Coordinate, Coordinate, Coordinate]


class AsItIs:
    """Mark of a field that takes instances of its class, and looks no further into them.

    pydantic's `InstanceOf` builds a schema of all that such a class holds, which takes a while.
    """

    def __get_pydantic_core_schema__(
        self, source: type, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.is_instance_schema(source)


class Part(ShortRepr):
    """A part of a scene file: nothing unknown, nothing converted, nothing changed later."""

    model_config = ConfigDict(
        defer_build=True, frozen=True, extra="forbid", strict=True, allow_inf_nan=False
    )


class CellObject(Part):
    """An object on the table, as the robot is told of it.

    Attributes:
        name: what it is called in this cell; unique.
        model: the registry model that the robot believes it to be.
        synonyms: further names in this cell.
        fragile: the robot keeps its hand and other objects well away from it.
        fixed: a holder on the table keeps it where it stands.
    """

    name: Name
    model: Name
    synonyms: tuple[Name, ...] = ()
    fragile: bool = False
    fixed: bool = False


class Table(Part):
    """The table top; its upper face is the plane z = 0 of W."""

    centre_m: Point2 = (0.5, 0.0)
    size_m: tuple[TableLength, TableLength] = (1.4, 1.6)
    thickness_m: TableLength = 0.05

    @property
    def extent(self) -> TableState:
        """Extent of the table top, as planners know it."""
        (x, y), (width, depth) = self.centre_m, self.size_m
        return TableState(x - width / 2, x + width / 2, y - depth / 2, y + depth / 2)


class RobotMount(Part):
    """The arm's mount, and where the arm waits.

    Attributes:
        base_m: position of the arm's base in W.
        base_rpy_deg: roll, pitch, yaw of the base in W; roll 180 hangs it upside down.
        home_deg: joint angles of the arm while it waits, one of each joint; those of the
            standard arm by default.
    """

    base_m: Point3 = (0.55, 0.0, 1.1)
    base_rpy_deg: tuple[Angle, Angle, Angle] = (180.0, 0.0, 0.0)
    home_deg: tuple[Angle, ...] = (41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0)


class Vision(Part):
    """Data sheet of the camera: white noise, frames at a rate, late.

    Attributes:
        position_noise_m: standard deviation along each axis of W, in each frame.
        angle_noise_deg: the same about each axis of W.
        position_bias_m: standard deviation of the constant error of each object's x, y and z.
        angle_bias_deg: the same of its heading; the camera knows what stands level.
        rate_hz: of the frames.
        delay_s: from a frame to its arrival.
    """

    position_noise_m: Deviation = 0.002
    angle_noise_deg: Deviation = 1.0
    position_bias_m: Deviation = 0.0
    angle_bias_deg: Deviation = 0.0
    rate_hz: Annotated[float, range_of("frames")] = 30.0
    delay_s: Annotated[float, range_of("delay")] = 0.05


class TorqueSensor(Part):
    """Data sheet of the finger joints' torque sensors.

    The robot's controller reads the mean of the samples since its last step.

    Attributes:
        noise_nm: standard deviation of the white noise on each sample.
        resolution_nm: step to which each sample is rounded; 0 for none.
        bias_nm: standard deviation of the constant error of each joint.
        rate_hz: of the samples.
    """

    noise_nm: Deviation = 0.005
    resolution_nm: Deviation = 0.002
    bias_nm: Deviation = 0.02
    rate_hz: Annotated[float, range_of("samples")] = 1000.0


class JointSensor(Part):
    """Data sheet of the joints' position sensors, read once in each control step.

    The defaults are those of sensors at the motors, seen through the gears. Sensors behind the
    gears are published with 0.01° (1.7e-4 rad) for a light arm of this kind, and with 0.1°
    (1.7e-3 rad) for the joints of such a hand, whose motors turn a hundred times as far.

    Attributes:
        arm_noise_rad, finger_noise_rad: standard deviations of white noise.
        arm_resolution_rad, finger_resolution_rad: steps to which angles are rounded; 0 for none.
        arm_offset_rad, finger_offset_rad: standard deviations of the constant error of each joint.
    """

    arm_noise_rad: Deviation = 1e-5
    arm_resolution_rad: Deviation = 5e-6
    arm_offset_rad: Deviation = 0.0
    finger_noise_rad: Deviation = 1e-4
    finger_resolution_rad: Deviation = 2e-4
    finger_offset_rad: Deviation = 0.0


class CellParts(Part):
    """The parts of a cell, which its description and its truth have alike.

    Attributes:
        name: for reports.
        objects: what stands on the table.
        robot: how the arm is mounted.
        control_rate_hz: of the robot's control loop.
        models: model files, or folders of them, that belong to the cell.
        defaults: what a clause means when a sentence does not say more.
    """

    name: Name
    objects: tuple[CellObject, ...]
    robot: RobotMount = RobotMount()
    table: Table = Table()
    vision: Vision = Vision()
    torque_sensor: TorqueSensor = TorqueSensor()
    joint_sensor: JointSensor = JointSensor()
    control_rate_hz: Annotated[float, range_of("control_rate")] = 100.0
    models: tuple[str, ...] = ()
    defaults: Annotated[Defaults, AsItIs()] = DEFAULTS

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the objects, in their order."""
        return tuple(item.name for item in self.objects)


class CellDescription(CellParts):
    """Everything that a robot is told before it looks."""
