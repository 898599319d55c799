"""Scene files: the simulated world, with the truth that no planner may see.

A scene is a YAML file read into strict, frozen models. It holds where things stand and how they
*really* behave (mass, friction, centre of mass), how imperfect the sensors are, and the name of
the registry model that the robot *believes* each object to be; besides, what people at this table
mean when they say no more ("a little"). Units stand in the names.

Frames: W is the world, z up, table plane z = 0; B is an object's frame at the centre of its base.
"""

from __future__ import annotations

import difflib
from importlib import resources
from pathlib import Path
from typing import Annotated, Literal

import yaml
from pydantic import BeforeValidator, Field, InstanceOf, ValidationError, model_validator

from objectmodels.yaml_reader import parse_yaml
from planner.types.default_settings import changed
from planner.types.defaults import DEFAULTS, Defaults, DefaultsError
from sim.cell.strict_model import Fraction, NonNegative, Part, Point2, Point3, Positive, Spread
from sim.errors import SceneError
from sim.truth.object_truth import Truth


class Pose(Part):
    """Planar pose X_WB of an object that stands on its base."""

    x_m: float
    y_m: float
    yaw_deg: float = 0.0


class SceneObject(Part):
    """An object on the table.

    Attributes:
        name: what it is called in this scene; unique.
        model: the registry model that the robot believes it to be.
        synonyms: further names in this scene.
        fragile: whether the robot is told to keep its hand and other objects well away from it.
        fixed: whether a holder on the table keeps it where it stands; the robot is told.
        pose: where it really stands at the start.
        truth: how it really is.
    """

    name: str
    model: str
    synonyms: tuple[str, ...] = ()
    fragile: bool = False
    fixed: bool = False
    pose: Pose
    truth: Truth


class FrictionVariation(Part):
    """How friction on the table differs from what an object's truth says; see `world_variation`.

    Attributes:
        over_table: relative standard deviation from place to place.
        length_m: over which the table's friction changes; it hardly does over a third of that.
        per_trial: relative standard deviation from touch to touch.
    """

    over_table: Fraction = 0.0
    length_m: Annotated[float, Field(ge=0.02)] = 0.10
    per_trial: Fraction = 0.0


class Table(Part):
    """The table top; its upper face is the plane z = 0 of W."""

    friction_variation: FrictionVariation = FrictionVariation()
    centre_m: Point2 = (0.5, 0.0)
    size_m: tuple[Positive, Positive] = (1.4, 1.6)
    thickness_m: Positive = 0.05


class Robot(Part):
    """How the arm is mounted, and where it waits.

    Attributes:
        base_m: position of the arm's base in W.
        base_rpy_deg: roll, pitch, yaw of the base in W; roll 180 hangs it upside down.
        home_deg: joint angles of the arm while it waits.
    """

    base_m: Point3 = (0.55, 0.0, 1.1)
    base_rpy_deg: Point3 = (180.0, 0.0, 0.0)
    home_deg: tuple[float, float, float, float, float, float, float]


class Vision(Part):
    """The port through which poses reach the robot: white noise, frames at a rate, late.

    Attributes:
        position_noise_m: standard deviation along each axis of W, in each frame.
        angle_noise_deg: the same about each axis of W.
        position_bias_m: standard deviation of the constant error of each object's x, y and z.
        angle_bias_deg: the same of its heading; the camera knows what stands level.
        rate_hz: of the frames.
        delay_s: from a frame to its arrival.
    """

    position_noise_m: NonNegative = 0.002
    angle_noise_deg: NonNegative = 1.0
    position_bias_m: NonNegative = 0.0
    angle_bias_deg: NonNegative = 0.0
    rate_hz: Positive = 30.0
    delay_s: NonNegative = 0.05


TORQUE_BIAS = 0.02
"""Standard deviation of the torque sensors' constant errors, if the scene does not say [N·m]."""


class TorqueSensor(Part):
    """The finger joints' torque sensors.

    The robot's controller reads the mean of the samples since its last step.

    Attributes:
        noise_nm: standard deviation of the white noise on each sample.
        resolution_nm: step to which each sample is rounded; 0 for none.
        bias_nm: standard deviation of the constant error of each joint.
        gain_error: relative error of the scale, common to all joints: 0.05 reads 5 % too much.
        rate_hz: of the samples.
    """

    noise_nm: NonNegative = 0.005
    resolution_nm: NonNegative = 0.002
    bias_nm: NonNegative = TORQUE_BIAS
    gain_error: Annotated[float, Field(gt=-1, lt=1)] = 0.0
    rate_hz: Positive = 1000.0


class JointSensor(Part):
    """The joints' position sensors, read once in each control step.

    The defaults are those of sensors at the motors, seen through the gears. Sensors behind the
    gears are published with 0.01° (1.7e-4 rad) for a light arm of this kind, and with 0.1°
    (1.7e-3 rad) for the joints of such a hand, whose motors turn a hundred times as far.

    Attributes:
        arm_noise_rad, finger_noise_rad: standard deviations of white noise.
        arm_resolution_rad, finger_resolution_rad: steps to which angles are rounded; 0 for none.
        arm_offset_rad, finger_offset_rad: standard deviations of the constant error of each joint.
    """

    arm_noise_rad: NonNegative = 1e-5
    arm_resolution_rad: NonNegative = 5e-6
    arm_offset_rad: NonNegative = 0.0
    finger_noise_rad: NonNegative = 1e-4
    finger_resolution_rad: NonNegative = 2e-4
    finger_offset_rad: NonNegative = 0.0


class Hidden(Part):
    """How far the truth of a world lies from what the file says, drawn from the world's seed.

    Attributes:
        mass, friction, finger_friction: relative standard deviations.
        centre_of_mass_m: standard deviation along each axis of B.
    """

    mass: Spread = 0.0
    friction: Spread = 0.0
    finger_friction: Spread = 0.0
    centre_of_mass_m: NonNegative = 0.0


def _defaults(value: object) -> object:
    """The table of defaults with what a scene file sets in it."""
    if isinstance(value, Defaults):
        return value
    if not isinstance(value, dict):
        raise DefaultsError("defaults are names and numbers, like {distance_m: 0.15}")
    return changed(DEFAULTS, value)


class Scene(Part):
    """A simulated world.

    Attributes:
        version: of the file's format.
        name: for reports.
        time_step_s: of the simulation.
        control_rate_hz: of the robot's control loop.
        hidden: how worlds of this scene differ from it and from each other.
        defaults: what a clause means when a sentence does not say more; in the file by the names of
            `planner.types.default_settings`.
        models: model files, or folders of them, that belong to the scene; relative to its file.
    """

    version: Literal[1]
    name: str
    robot: Robot
    table: Table = Table()
    vision: Vision = Vision()
    torque_sensor: TorqueSensor = TorqueSensor()
    joint_sensor: JointSensor = JointSensor()
    time_step_s: Annotated[float, Field(gt=0, le=0.005)] = 0.002
    control_rate_hz: Annotated[float, Field(ge=20, le=1000)] = 100.0
    models: tuple[str, ...] = ()
    hidden: Hidden = Hidden()
    defaults: Annotated[InstanceOf[Defaults], BeforeValidator(_defaults)] = DEFAULTS
    objects: tuple[SceneObject, ...]

    @model_validator(mode="after")
    def _unique(self) -> Scene:
        names = [o.name.casefold() for o in self.objects]
        twice = sorted({n for n in names if names.count(n) > 1})
        if twice:
            raise ValueError(f"object names must be unique, found twice: {', '.join(twice)}")
        return self

    def object(self, name: str) -> SceneObject:
        """The object of that name.

        Raises:
            KeyError: there is none.
        """
        by_name = {o.name: o for o in self.objects}
        return by_name[name]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the objects, in the order of the file."""
        return tuple(o.name for o in self.objects)


def built_in_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with the package."""
    folder = resources.files("sim") / "scenes"
    return tuple(sorted(Path(f.name).stem for f in folder.iterdir() if f.name.endswith(".yaml")))


def load_scene(name_or_path: str | Path) -> Scene:
    """Reads a scene file.

    Args:
        name_or_path: name of a built-in scene, or the path of a YAML file.

    Raises:
        SceneError: no such scene, or the file is not a valid scene.
    """
    source = Path(name_or_path)
    if source.suffix not in {".yaml", ".yml"}:
        names = built_in_scenes()
        if str(name_or_path) not in names:
            close = difflib.get_close_matches(str(name_or_path), names, n=1)
            raise SceneError(
                "unknown_scene",
                f"there is no scene '{name_or_path}'; built in: {', '.join(names)}",
                tuple(f"did you mean '{c}'?" for c in close) or ("give the path of a .yaml file",),
            )
        text = (resources.files("sim") / "scenes" / f"{name_or_path}.yaml").read_text("utf-8")
    else:
        try:
            text = source.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            message = f"cannot read scene file {source}: {error}"
            raise SceneError("unknown_scene", message) from error
    scene = parse_scene(text, source=str(name_or_path))
    beside = tuple(str(source.absolute().parent / path) for path in scene.models)
    return scene.model_copy(update={"models": beside})


def parse_scene(text: str, *, source: str = "scene") -> Scene:
    """Reads a scene from YAML text.

    Raises:
        SceneError: the text is not YAML or not a valid scene; names each key at fault.
    """
    try:
        data = parse_yaml(text)
    except (yaml.YAMLError, RecursionError) as error:
        raise SceneError("bad_scene", f"{source} is not YAML: {error}") from error
    try:
        return Scene.model_validate(_tuples(data))
    except ValidationError as error:
        faults = "; ".join(
            f"{'.'.join(str(part) for part in fault['loc']) or 'file'}: {fault['msg']}"
            f" (found {_short(fault['input'])})"
            for fault in error.errors()
        )
        raised = (fault.get("ctx", {}).get("error") for fault in error.errors())
        hints = tuple(h for e in raised if isinstance(e, DefaultsError) for h in e.suggestions)
        raise SceneError("bad_scene", f"{source}: {faults}", hints) from error


def _tuples(data: object) -> object:
    """Lists as tuples and whole numbers kept, since the models are strict."""
    if isinstance(data, dict):
        return {key: _tuples(value) for key, value in data.items()}
    return tuple(_tuples(value) for value in data) if isinstance(data, list) else data


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
