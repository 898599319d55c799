"""Scene files: the simulated world, with the truth that no planner may see.

A scene is a YAML file read into strict, frozen models. It holds where things stand and how they
*really* behave (mass, friction, centre of mass), how imperfect the sensors are, and the name of
the registry model that the robot *believes* each object to be. Units stand in the names.

Frames: W is the world, z up, table plane z = 0; B is an object's frame at the centre of its base.
"""

from __future__ import annotations

import difflib
from importlib import resources
from pathlib import Path
from typing import Annotated, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from objectmodels.yamlfile import parse_yaml
from sim.errors import SceneError

Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]
Fraction = Annotated[float, Field(ge=0, le=1)]
Point2 = tuple[float, float]
Point3 = tuple[float, float, float]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


class Pose(_Part):
    """Planar pose X_WB of an object that stands on its base."""

    x_m: float
    y_m: float
    yaw_deg: float = 0.0


class Truth(_Part):
    """How an object really is; only the simulated world and an observer of it may read this.

    Attributes:
        size_m: of the box along B's axes.
        mass_kg: true mass.
        friction_table: the one coefficient of the contact between base and table. A discrete
            simulation has no separate static coefficient; this is the sliding one.
        friction_finger: the same between object and fingertip.
        centre_of_mass_m: in B; the middle of the box if not given.
        support_m: points of the base on which the object stands, in B's x, y; the four corners
            if not given.
        colour: red, green, blue in 0…1, for pictures.
    """

    size_m: tuple[Positive, Positive, Positive]
    mass_kg: Positive
    friction_table: Positive
    friction_finger: Positive
    centre_of_mass_m: Point3 | None = None
    support_m: tuple[Point2, ...] | None = None
    colour: tuple[Fraction, Fraction, Fraction] = (0.8, 0.7, 0.4)

    @model_validator(mode="after")
    def _inside(self) -> Truth:
        x, y, z = self.centre_of_mass
        width, depth, height = self.size_m
        if not (abs(x) < width / 2 and abs(y) < depth / 2 and 0 < z < height):
            raise ValueError(f"centre_of_mass_m {self.centre_of_mass} lies outside the box")
        if self.support_m is not None and len(self.support_m) < 3:
            raise ValueError("support_m needs three points or more")
        return self

    @property
    def centre_of_mass(self) -> Point3:
        """Centre of mass in B [m]."""
        return self.centre_of_mass_m or (0.0, 0.0, self.size_m[2] / 2)

    @property
    def support(self) -> tuple[Point2, ...]:
        """Support points in B's x, y [m]."""
        a, b = self.size_m[0] / 2, self.size_m[1] / 2
        return self.support_m or ((a, b), (-a, b), (-a, -b), (a, -b))


class SceneObject(_Part):
    """An object on the table.

    Attributes:
        name: what it is called in this scene; unique.
        model: the registry model that the robot believes it to be.
        synonyms: further names in this scene.
        pose: where it really stands at the start.
        truth: how it really is.
    """

    name: str
    model: str
    synonyms: tuple[str, ...] = ()
    pose: Pose
    truth: Truth


class Table(_Part):
    """The table top; its upper face is the plane z = 0 of W."""

    centre_m: Point2 = (0.5, 0.0)
    size_m: tuple[Positive, Positive] = (1.4, 1.6)
    thickness_m: Positive = 0.05


class Robot(_Part):
    """How the arm is mounted, and where it waits.

    Attributes:
        base_m: position of the arm's base in W.
        base_rpy_deg: roll, pitch, yaw of the base in W; roll 180 hangs it upside down.
        home_deg: joint angles of the arm while it waits.
    """

    base_m: Point3 = (0.55, 0.0, 1.1)
    base_rpy_deg: Point3 = (180.0, 0.0, 0.0)
    home_deg: tuple[float, float, float, float, float, float, float]


class Vision(_Part):
    """The port through which poses reach the robot: white noise, frames at a rate, late."""

    position_noise_m: NonNegative = 0.002
    angle_noise_deg: NonNegative = 1.0
    rate_hz: Positive = 30.0
    delay_s: NonNegative = 0.05


class TorqueSensor(_Part):
    """The finger joints' torque sensors: white noise on every sample.

    The robot's controller reads the mean of the samples since its last step.
    """

    noise_nm: NonNegative = 0.005
    rate_hz: Positive = 1000.0


class Scene(_Part):
    """A simulated world.

    Attributes:
        version: of the file's format.
        name: for reports.
        time_step_s: of the simulation.
        control_rate_hz: of the robot's control loop.
        models: model files, or folders of them, that belong to the scene; relative to its file.
    """

    version: Literal[1]
    name: str
    robot: Robot
    table: Table = Table()
    vision: Vision = Vision()
    torque_sensor: TorqueSensor = TorqueSensor()
    time_step_s: Annotated[float, Field(gt=0, le=0.005)] = 0.002
    control_rate_hz: Annotated[float, Field(ge=20, le=1000)] = 100.0
    models: tuple[str, ...] = ()
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
        raise SceneError("bad_scene", f"{source}: {faults}") from error


def _tuples(data: object) -> object:
    """Lists as tuples and whole numbers kept, since the models are strict."""
    if isinstance(data, dict):
        return {key: _tuples(value) for key, value in data.items()}
    return tuple(_tuples(value) for value in data) if isinstance(data, list) else data


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
