"""Scene files: the simulated world, with the truth that no planner may see.

A scene is a YAML file read into strict, frozen models. It holds where things stand and how they
*really* behave (mass, friction, centre of mass), how imperfect the sensors are, and the name of
the registry model that the robot *believes* each object to be; besides, what people at this table
mean when they say no more ("a little"). Units stand in the names.

Frames: W is the world, z up, table plane z = 0; B is an object's frame at the centre of its base.
"""

from __future__ import annotations

import difflib
import itertools
from contextlib import suppress
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeGuard, TypeVar

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError, model_validator

from objectmodels import ObjectModel
from objectmodels.errors import ModelError, printable
from objectmodels.files.yaml_documents import (
    Angle,
    Coordinate,
    Deviation,
    first_fault,
    length_of,
    parse_yaml,
    range_of,
    read_text,
)
from objectmodels.geometry.base_shapes import hull_polygon
from objectmodels.geometry.rotations import Array, rot_x, rot_y, rot_z
from planner.problem.footprints import gap, room_to_edge
from planner.types.defaults import DEFAULTS, Defaults, DefaultsError, with_settings
from sim.errors import SceneError
from sim.random_streams import RandomStream, clipped_normal, source
from sim.robots.cell_description import (
    AsItIs,
    CellDescription,
    CellObject,
    CellParts,
    Fraction,
    Part,
    Spread,
    Table,
    TorqueSensor,
)
from sim.truth.object_truth import Truth, whole_truth

if TYPE_CHECKING:
    from objectmodels import Registry


TOUCHING = 0.001
"""Depth up to which two things that are in each other only touch: files are rounded [m]."""

Document = dict[str, Any]
"""What stands in a scene file, before it is a `Scene`.

What is not of the right form is left as it is: it is refused when the scene is made."""


def extended_document(base: Document, own: Document) -> Document:
    """A scene's own document on top of that of the scene that it extends.

    A block, such as `vision`, is changed key by key. Model files are added. An object of a new name
    is added; one of a name that is there takes its place if it names its model, else it changes
    what is there key by key.
    """
    of_itself = ("version", "name", "extends")  # what no scene takes from another
    merged = {key: value for key, value in base.items() if key not in of_itself}
    for key, value in own.items():
        old = merged.get(key)
        if key == "objects" and _are_objects(old) and _are_objects(value):
            found = {item["name"]: item for item in old}
            for item in value:
                kept = {} if "model" in item else found.get(item["name"], {})
                found[item["name"]] = kept | item
            merged[key] = list(found.values())
        elif isinstance(old, list) and isinstance(value, list):
            merged[key] = [*old, *value]
        elif isinstance(old, dict) and isinstance(value, dict):
            merged[key] = old | value
        elif key != "extends":
            merged[key] = value
    return merged


def completed_document(document: Document) -> Document:
    """The document with a truth for each object that has none: what its model says.

    Raises:
        ModelError: there is no such model, or its file is no good.
    """
    objects = document.get("objects")
    if not _are_objects(objects) or not any(map(_lacks_truth, objects)):
        return document
    from objectmodels import Registry

    registry = Registry.default()
    for path in models if _are_texts(models := document.get("models")) else ():
        registry.load(path)
    completed = [
        item | {"truth": _truth(registry, item["model"])} if _lacks_truth(item) else item
        for item in objects
    ]
    return document | {"objects": completed}


def _lacks_truth(item: Document) -> bool:
    return "truth" not in item and isinstance(item.get("model"), str)


def _truth(registry: Registry, name: str) -> Truth:
    try:
        return whole_truth(registry.find_one(name))
    except ValidationError as raised:
        message = f"the {name}: {first_fault(raised, Truth).message}"
        hint = "write its truth into the scene file"
        raise ModelError("bad_model", message, suggestions=(hint,)) from raised


def _are_texts(value: object) -> TypeGuard[list[str]]:
    return isinstance(value, list) and all(isinstance(each, str) for each in value)


def _are_objects(value: object) -> TypeGuard[list[Document]]:
    return isinstance(value, list) and all(
        isinstance(each, dict) and isinstance(each.get("name"), str) for each in value
    )


class Pose(Part):
    """Pose X_WB of an object on the table, which stands on its base unless it is turned off it.

    Attributes:
        x_m, y_m: of B's origin.
        z_m: height over the table of what it stands on: of another object's top.
        yaw_deg: turn about the vertical, after those about B's own x and y axes.
        roll_deg, pitch_deg: turn about x, then about y; 90 lays a box on its side.
    """

    x_m: Coordinate
    y_m: Coordinate
    z_m: Annotated[Coordinate, Field(ge=0.0)] = 0.0
    yaw_deg: Angle = 0.0
    roll_deg: Angle = 0.0
    pitch_deg: Angle = 0.0

    @property
    def R_WB(self) -> Array:
        """Rotation of B in W, shape (3, 3)."""
        yaw, pitch, roll = np.radians([self.yaw_deg, self.pitch_deg, self.roll_deg])
        # Adding zero turns −0.0 into 0.0, as an upright object has it.
        return rot_z(yaw) @ rot_y(pitch) @ rot_x(roll) + 0.0


class SceneObject(CellObject):
    """An object on the table, as it really is.

    Attributes:
        pose: where it really stands at the start.
        truth: how it really is.
    """

    pose: Pose
    truth: Truth

    @property
    def p_WB(self) -> Array:
        """Place of B's origin in W at the start, as high as it must be to stand there, (3,) [m]."""
        lowest = float((self.truth.shape.hull_corners @ self.pose.R_WB[2]).min())
        return np.array([self.pose.x_m, self.pose.y_m, self.pose.z_m - lowest])

    @property
    def corners_W(self) -> Array:
        """Corners of its hull in W, shape (k, 3) [m]."""
        return self.truth.shape.hull_corners @ self.pose.R_WB.T + self.p_WB

    @property
    def covered(self) -> Array:
        """Corners of what it covers of the table in W, shape (k, 2) [m]."""
        return hull_polygon(self.corners_W[:, :2]).vertices

    def depth_in(self, other: SceneObject) -> float:
        """How far it is in another one, as upright as their hulls are [m]; 0 if it is not."""
        z, other_z = self.corners_W[:, 2], other.corners_W[:, 2]
        over = float(min(z.max(), other_z.max()) - max(z.min(), other_z.min()))
        if over <= TOUCHING or self._stands_inside(other) or other._stands_inside(self):
            return 0.0
        return min(over, max(0.0, -gap(self.covered, other.covered)))

    def _stands_inside(self, box: SceneObject) -> bool:
        """Return True if it stands between the walls of an open box, over its floor."""
        inside = box.truth.shape.cavity
        if inside is None:
            return False
        in_B = (self.corners_W - box.p_WB) @ box.pose.R_WB
        walls = 0.5 * np.array(inside.size) + TOUCHING
        return bool(
            (np.abs(in_B[:, :2]) <= walls).all() and in_B[:, 2].min() > inside.floor - TOUCHING
        )


class FrictionVariation(Part):
    """Spread of the friction on the table about an object's own; see `world_variation`.

    Attributes:
        over_table: relative standard deviation from place to place.
        length_m: over which the table's friction changes; it hardly does over a third of that.
        per_trial: relative standard deviation from touch to touch.
    """

    over_table: Fraction = 0.0
    length_m: Annotated[float, range_of("variation")] = 0.10
    per_trial: Fraction = 0.0


class VaryingTable(Table):
    """The table top, with what is not told of its friction."""

    friction_variation: FrictionVariation = FrictionVariation()


class ScaledTorqueSensor(TorqueSensor):
    """The torque sensors, with an error that no data sheet tells.

    Attributes:
        gain_error: relative error of the scale, common to all joints: 0.05 reads 5 % too much.
    """

    gain_error: Annotated[float, Field(gt=-1, lt=1)] = 0.0


class Hidden(Part):
    """Spread of the truth of a world about what the file says, drawn from the world's seed.

    Attributes:
        mass, friction, finger_friction: relative standard deviations.
        centre_of_mass_m: standard deviation along each axis of B.
    """

    mass: Spread = 0.0
    friction: Spread = 0.0
    finger_friction: Spread = 0.0
    centre_of_mass_m: Deviation = 0.0


def _defaults(value: object) -> object:
    """The table of defaults with what a scene file sets in it."""
    if isinstance(value, Defaults):
        return value
    if not isinstance(value, dict):
        raise DefaultsError("defaults are names and numbers, like {distance_m: 0.15}")
    return with_settings(DEFAULTS, value)


class Scene(CellParts):
    """A simulated world; in its file `models` are relative to it.

    Attributes:
        version: of the file's format.
        time_step_s: of the simulation.
        hidden: how worlds of this scene differ from it and from each other.
        defaults: what a clause means when a sentence does not say more; in the file by the names of
            `planner.types.defaults`.
    """

    version: Literal[1]
    table: VaryingTable = VaryingTable()
    torque_sensor: ScaledTorqueSensor = ScaledTorqueSensor()
    time_step_s: Annotated[float, range_of("time_step")] = 0.002
    hidden: Hidden = Hidden()
    defaults: Annotated[Defaults, AsItIs(), BeforeValidator(_defaults)] = DEFAULTS
    objects: Annotated[tuple[SceneObject, ...], length_of("objects")]

    @model_validator(mode="after")
    def _unique(self) -> Scene:
        names = [o.name.casefold() for o in self.objects]
        twice = sorted({n for n in names if names.count(n) > 1})
        if twice:
            raise ValueError(f"object names must be unique, found twice: {', '.join(twice)}")
        return self

    @model_validator(mode="after")
    def _apart(self) -> Scene:
        corners = [each.corners_W for each in self.objects]
        boxes = [(each.min(axis=0), each.max(axis=0)) for each in corners]
        for (one, (low, high)), (other, (lowest, highest)) in itertools.combinations(
            zip(self.objects, boxes, strict=True), 2
        ):
            # Hulls take a while to load, and few things are near enough for them.
            near = (low < highest).all() and (lowest < high).all()
            if near and (depth := one.depth_in(other)) > TOUCHING:
                raise ValueError(
                    f"the {one.name} and the {other.name} stand {1e3 * depth:.0f} mm in each other"
                )
        return self

    def object(self, name: str) -> SceneObject:
        """The object of that name.

        Raises:
            KeyError: there is none.
        """
        return {each.name: each for each in self.objects}[name]

    def level(self, item: SceneObject) -> int:
        """Number of objects that stand on each other below an object, at most."""
        return len({each.pose.z_m for each in self.objects if each.pose.z_m < item.pose.z_m})

    @property
    def cell(self) -> CellDescription:
        """The part of the scene that the robot is told."""
        objects = tuple(_public(CellObject, item) for item in self.objects)
        sensor = _public(TorqueSensor, self.torque_sensor)
        return _public(
            CellDescription,
            self,
            objects=objects,
            table=_public(Table, self.table),
            torque_sensor=sensor,
        )


_PublicPart = TypeVar("_PublicPart", bound=Part)


def _public(kind: type[_PublicPart], part: Part, **parts: object) -> _PublicPart:
    """The fields of a part that its public kind has, some of them replaced by public parts."""
    return kind(**{name: getattr(part, name) for name in kind.model_fields} | parts)


def built_in_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with the package."""
    folder = resources.files("sim") / "scenes"
    return tuple(sorted(Path(f.name).stem for f in folder.iterdir() if f.name.endswith(".yaml")))


def load_scene(name_or_path: str | Path) -> Scene:
    """Reads a scene file: a built-in one by its name, or a YAML file by its path.

    Raises:
        SceneError: no such scene, or the file is not a valid scene.
    """
    text, folder = _text_and_folder(name_or_path)
    return parse_scene(text, source=str(name_or_path), folder=folder)


def _text_and_folder(name_or_path: str | Path) -> tuple[str, Path]:
    """The text of a scene, and the folder that its paths are relative to."""
    path = Path(name_or_path)
    if path.suffix in {".yaml", ".yml"}:
        try:
            return read_text(path, "scene_file"), path.absolute().parent
        except ModelError as error:
            message = f"scene file {error.path}: {error.message}"
            raise SceneError("unknown_scene", message, error.suggestions) from error
    names = built_in_scenes()
    if str(name_or_path) not in names:
        close = difflib.get_close_matches(str(name_or_path), names, n=1)
        raise SceneError(
            "unknown_scene",
            f"there is no scene '{printable(str(name_or_path))}'; built in: {', '.join(names)}",
            tuple(f"did you mean '{c}'?" for c in close) or ("give the path of a .yaml file",),
        )
    return (resources.files("sim") / "scenes" / f"{name_or_path}.yaml").read_text("utf-8"), Path()


def parse_scene(text: str, *, source: str = "scene", folder: Path | None = None) -> Scene:
    """Reads a scene from YAML text.

    Args:
        text: of the file.
        source: its name, for errors.
        folder: that the paths in it are relative to; the working folder if not given.

    Raises:
        SceneError: the text is not YAML or not a valid scene; names the key at fault.
    """
    try:
        document = _extended(text, folder or Path(), (source,))
        if isinstance(document, dict):
            document = completed_document(document)
        return Scene.model_validate(_tuples(document))
    except ModelError as error:
        where = f"{error.path}: " if error.path else ""
        raise _scene_error(source, f"{where}{error.message}", error.suggestions) from error
    except ValidationError as error:
        fault = first_fault(error, Scene)
        raise _scene_error(source, f"{fault.key}: {fault.message}", fault.suggestions) from error


def _extended(text: str, folder: Path, sources: tuple[str, ...]) -> object:
    """What stands in a scene file and in all that it extends; paths in it are relative to it."""
    document = parse_yaml(text)
    if not isinstance(document, dict):
        return document
    if _are_texts(models := document.get("models")):
        document = document | {"models": [str(folder / path) for path in models]}
    base = document.get("extends")
    if base is None:
        return document
    hint = "name another one; nlcontrol scenes list shows those that are built in"
    if not isinstance(base, str):
        message = "extends: needs the name or the path of a scene"
        raise _scene_error(sources[0], message, (hint,))
    if base not in built_in_scenes():
        base = str(folder / base)
    if base in sources:
        raise _scene_error(sources[0], f"extends: {base} extends itself", (hint,))
    below = _extended(*_text_and_folder(base), (*sources, base))
    return extended_document(below, document) if isinstance(below, dict) else below


def _scene_error(source: str, message: str, suggestions: tuple[str, ...]) -> SceneError:
    return SceneError("bad_scene", f"{printable(source)}: {message}", suggestions)


def _tuples(data: object) -> object:
    """Lists as tuples and whole numbers kept, since the models are strict."""
    if isinstance(data, dict):
        return {key: _tuples(value) for key, value in data.items()}
    return tuple(_tuples(value) for value in data) if isinstance(data, list) else data


def sample_world(scene: Scene, seed: int) -> Scene:
    """The scene as it is true in the world of a seed; the same if it hides nothing.

    Model: mass and friction coefficients are the scene's times 1 + σ z, the centre of mass is the
    scene's plus σ z along each axis of B, with z normal and clipped at two. Contents are as much
    more or less as the mass is. Six numbers are drawn for each object, in the order of the file,
    whatever their σ.
    """
    hidden = scene.hidden
    if hidden == Hidden():
        return scene
    rng = source(seed, RandomStream.HIDDEN)
    objects = []
    for item in scene.objects:
        mass, friction, finger, *shift = clipped_normal(rng, 6).tolist()
        scaled = item.truth.scaled(
            mass=1.0 + hidden.mass * mass,
            friction=1.0 + hidden.friction * friction,
            finger_friction=1.0 + hidden.finger_friction * finger,
        )
        shifted = scaled.with_shift([hidden.centre_of_mass_m * z for z in shift])
        objects.append(item.model_copy(update={"truth": shifted}))
    return scene.model_copy(update={"objects": tuple(objects), "hidden": Hidden()})


def scene_with_object(scene: Scene, model: ObjectModel, pose: Pose) -> Scene:
    """The scene with one more object, which is as its model says.

    Raises:
        SceneError: `bad_scene` if its name is taken, or it would stand beyond the table's edge or
            in something else.
    """
    truth = whole_truth(model)
    item = SceneObject(name=model.name, model=model.name, pose=pose, truth=truth)
    covered = item.covered
    if room_to_edge(covered, scene.table.extent) < 0.0:
        extent = scene.table.extent
        bounds = f"x from {extent.x_min:g} to {extent.x_max:g}, y from {extent.y_min:g} to "
        hint = f"the table has {bounds}{extent.y_max:g} m"
        raise _no_place(model, "it would stand beyond the table's edge", hint)
    for other in scene.objects:
        if other.name.casefold() == model.name.casefold():
            hint = "say its name alone: it stands there already"
            raise _no_place(model, "there is an object of that name in the scene", hint)
        if (apart := gap(covered, other.covered)) <= 0.0:
            hint = f"put it {max(1.0, -1e2 * apart):.0f} cm or more away from there"
            raise _no_place(model, f"the {other.name} stands there", hint)
    return scene.model_copy(update={"objects": (*scene.objects, item)})


def free_place(scene: Scene, model: ObjectModel) -> Pose | None:
    """A place near the robot where there is room for an object; None if there is none."""
    # Places within reach, from which a push away stays so.
    for x, y in ((0.45, 0.18), (0.45, -0.18), (0.4, 0.25), (0.4, -0.3), (0.5, 0.5)):
        place = Pose(x_m=x, y_m=y)
        with suppress(SceneError):
            scene_with_object(scene, model, place)
            return place
    return None


def _no_place(model: ObjectModel, why: str, hint: str) -> SceneError:
    return SceneError(
        "bad_scene", f"the {printable(model.name)} cannot be put there: {why}", (hint,)
    )
