"""Scene files: the simulated world, with the truth that no planner may see.

A scene is a YAML file read into strict, frozen models. It holds where things stand and how they
*really* behave (mass, friction, centre of mass), how imperfect the sensors are, and the name of
the registry model that the robot *believes* each object to be. Units stand in the names.

Frames: W is the world, z up, table plane z = 0; B is an object's frame at the centre of its base.
"""

from __future__ import annotations

import difflib
import math
from importlib import resources
from pathlib import Path
from typing import Annotated, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from objectmodels.base import Polygon
from objectmodels.yamlfile import parse_yaml
from sim.errors import SceneError

Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]
Fraction = Annotated[float, Field(ge=0, le=1)]
Point2 = tuple[float, float]
Point3 = tuple[float, float, float]

_RIM_POINTS = 16


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


class Pose(_Part):
    """Planar pose X_WB of an object that stands on its base."""

    x_m: float
    y_m: float
    yaw_deg: float = 0.0


class Truth(_Part):
    """How an object really is; only the simulated world and an observer of it may read this.

    Its shape is one of three: a box (`size_m`), an upright cylinder (`radius_m`, `height_m`) or a
    prism over a convex polygon (`corners_m`, `height_m`).

    Attributes:
        size_m: of a box along B's axes.
        radius_m: of a cylinder.
        base_radius_m: of the circle on which a cylinder stands, if that is smaller.
        corners_m: of a prism's base in B's x, y, in order.
        height_m: of a cylinder or prism.
        mass_kg: true mass.
        friction_table: the one coefficient of the contact between base and table. A discrete
            simulation has no separate static coefficient; this is the sliding one.
        friction_finger: the same between object and fingertip.
        centre_of_mass_m: in B; above the origin at half the height if not given.
        support_m: points of the base on which the object stands, in B's x, y; its corners (of a
            cylinder: points of its rim) if not given.
        colour: red, green, blue in 0…1, for the camera and for pictures.
    """

    size_m: tuple[Positive, Positive, Positive] | None = None
    radius_m: Positive | None = None
    base_radius_m: Positive | None = None
    corners_m: Annotated[tuple[Point2, ...], Field(min_length=3)] | None = None
    height_m: Positive | None = None
    mass_kg: Positive
    friction_table: Positive
    friction_finger: Positive
    centre_of_mass_m: Point3 | None = None
    support_m: tuple[Point2, ...] | None = None
    colour: tuple[Fraction, Fraction, Fraction] = (0.8, 0.7, 0.4)

    @model_validator(mode="after")
    def _one_shape(self) -> Truth:
        shapes = (self.size_m, self.radius_m, self.corners_m)
        if sum(shape is not None for shape in shapes) != 1:
            raise ValueError("needs one shape: size_m, radius_m or corners_m")
        if (self.size_m is None) == (self.height_m is None):
            raise ValueError("height_m belongs to a radius_m or corners_m, and to nothing else")
        if self.base_radius_m is not None and self.radius_m is None:
            raise ValueError("base_radius_m belongs to a radius_m")
        if self.corners_m is not None:
            Polygon.convex(self.corners_m)
        return self

    @model_validator(mode="after")
    def _inside(self) -> Truth:
        x, y, z = self.centre_of_mass
        outline = Polygon.convex(self.outline)
        if not ((outline.normals @ [x, y] < outline.offsets).all() and 0 < z < self.height):
            raise ValueError(f"centre_of_mass_m {self.centre_of_mass} lies outside the object")
        if self.support_m is not None and len(self.support_m) < 3:
            raise ValueError("support_m needs three points or more")
        return self

    @property
    def height(self) -> float:
        """Of its top above the table [m]."""
        if self.size_m is not None:
            return self.size_m[2]
        assert self.height_m is not None
        return self.height_m

    @property
    def outline(self) -> tuple[Point2, ...]:
        """Corners of its sides in B's x, y [m]; points around a round one."""
        if self.size_m is not None:
            a, b = self.size_m[0] / 2, self.size_m[1] / 2
            return ((a, b), (-a, b), (-a, -b), (a, -b))
        return self.corners_m or _circle(self.radius_m or 0.0)

    @property
    def centre_of_mass(self) -> Point3:
        """Centre of mass in B [m]."""
        return self.centre_of_mass_m or (0.0, 0.0, self.height / 2)

    @property
    def support(self) -> tuple[Point2, ...]:
        """Support points in B's x, y [m]."""
        if self.support_m is not None:
            return self.support_m
        return self.outline if self.base_radius_m is None else _circle(self.base_radius_m)


def _circle(radius: float) -> tuple[Point2, ...]:
    """Points of a rim on which a round object stands."""
    turns = (2.0 * math.pi * k / _RIM_POINTS for k in range(_RIM_POINTS))
    return tuple((radius * math.cos(phi), radius * math.sin(phi)) for phi in turns)


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
