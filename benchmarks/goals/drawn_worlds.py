"""Worlds drawn by seed, what the robot believes there, and how truths differ from that.

Usual worlds are drawn as `nlcontrol.batches.drawn_scenes` says. Hard ones are so in one way each:

| setting | |
|---|---|
| narrow | one or two things, as high as a hand, stand 30 to 60 mm beside sides of the target |
| fallen | the target, a box, lies on one of its sides |
| many | nine to fourteen things stand 5 cm or more apart |
| wide | masses, frictions and forces of lids lie within 30 % of what is believed; the camera has a noise of 5 mm and 2° and a constant error of 2 mm |

But for `wide`, truths differ from beliefs as in usual worlds. All but the target have names that are
no model's. A world for a sentence about several things holds what that needs and up to two things
more; what is spoken of comes first.
"""  # noqa: E501

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import Literal, get_args

import numpy as np

from benchmarks.goals.judge import WAYS
from benchmarks.goals.wishes import Wished
from nlcontrol.batches.drawn_scenes import (
    CENTRE_OF_MASS,
    FINGER_FRICTION,
    FRICTION,
    GAP,
    MASS,
    REACHED,
    STANDING,
    Generator,
    free_place,
    pushable_models,
    scene_of,
)
from objectmodels import BoxModel, CylinderModel, ObjectModel, Registry
from objectmodels.geometry.rotations import rot_x, rot_y, rot_z
from objectmodels.models.object_parts import Lid
from planner.problem.directions import unit
from planner.problem.footprints import footprint, free_travel, gap
from planner.types.defaults import DEFAULTS as D
from planner.types.world_state import PlanarPose, SeenObject
from sim.robots.cell_description import Vision
from sim.truth.object_truth import Truth, truth_as_believed
from sim.truth.scene_file import Pose, Scene, SceneObject, VaryingTable

Setting = Literal["narrow", "fallen", "many", "wide"]
SETTINGS: tuple[Setting, ...] = get_args(Setting)

WIDE = 0.30
"""Largest relative difference of truth and belief in the setting of that name."""
VISION = Vision(position_noise_m=0.005, angle_noise_deg=2.0, position_bias_m=0.002)
"""Its camera."""
NARROW = (0.030, 0.060)
"""Gaps beside a target in the setting of that name [m]."""
TALL = 0.08
"""Least height of what stands there [m]."""
MANY, APART = (9, 14), 0.05
"""How many things stand in the setting of that name, and how far apart at least [m]."""
LIDDED = ("ice tea cup", "jar")
"""Models that are there to be opened."""
CLOSE = (0.05, 0.08)
"""Gap at which something stands that is to make room, or is in the way [m]."""
SMALL_TABLE = VaryingTable(centre_m=(0.55, 0.0), size_m=(0.9, 1.0))
"""A table whose edges are as near as those that a person at it would speak of."""

_SPREAD = ((0.36, 0.80), (-0.45, 0.45))  # where many stand: least and largest x and y [m]
_NAMES = ("vase", "lamp", "candle", "clock", "radio", "speaker", "statue", "toy", "globe", "trophy",
          "basket", "kettle", "pot")  # fmt: skip
_FAR = 1.0  # from where a neighbour comes up to its gap [m]
_TRIES = 50  # places beside a target that are tried
_TRIES_INSIDE = 200  # places in a box that are tried for a thing
_OF_LIDS = ("friction_torque", "snap_torque", "retention")

Spans = tuple[tuple[float, float], ...]


@cache
def believed(wide: bool = False) -> Registry:
    """What the robot believes: the registry's models, each as sure as the worlds' bounds make it.

    An even distribution within a bound has the standard deviation bound / √3.
    """
    bounds = {"mass": MASS, "friction": FRICTION, "finger_friction": FINGER_FRICTION}
    if wide:
        bounds = dict.fromkeys(bounds, WIDE)
    registry = Registry.built_in().copy()
    for model in Registry.built_in():
        sds = {f"{k}_sd": bound * getattr(model, k) / math.sqrt(3.0) for k, bound in bounds.items()}
        surely: dict[str, object] = {**sds, "com_sd": (CENTRE_OF_MASS / math.sqrt(3.0),) * 3}
        if wide and model.lid is not None:
            forces = {f"{k}_sd": WIDE * v / math.sqrt(3.0) for k, v in _forces_of(model.lid)}
            surely["lid"] = model.lid.model_copy(update=forces)
        registry.add(model.model_copy(update=surely), over=(model.name,))
    return registry


def drawn_truth(model: ObjectModel, wide: bool, rng: Generator) -> Truth:
    """How a thing truly is: off what is believed by `WIDE`, or by what other worlds have."""
    most = (WIDE,) * 4 if wide else (MASS, FRICTION, FINGER_FRICTION, MASS)
    mass, friction, finger, lid = (1.0 + rng.uniform(-1.0, 1.0, 4) * most).tolist()
    shift = CENTRE_OF_MASS * rng.uniform(-1.0, 1.0, 3)
    changed: dict[str, object] = {
        "mass_kg": model.mass * mass,
        "friction_table": model.friction * friction,
        "friction_finger": model.finger_friction * finger,
    }
    if model.name in LIDDED and model.container is not None and model.lid is not None:
        contents = {"contents_l": model.container.contents_l * mass}
        changed["container"] = model.container.model_copy(update=contents)
        changed["lid"] = harder(model.lid, lid)
    return Truth.model_validate(dict(truth_as_believed(model)) | changed).with_shift(shift)


def harder(lid: Lid, factor: float) -> Lid:
    """A lid whose torques and forces are so many times as large."""
    return lid.model_copy(update={name: factor * value for name, value in _forces_of(lid)})


def _forces_of(lid: Lid) -> list[tuple[str, float]]:
    return [(name, getattr(lid, name)) for name in _OF_LIDS if hasattr(lid, name)]


def standing(scene: Scene) -> dict[str, SeenObject]:
    """The objects of a world by name, as they stand, but with the models that are believed."""
    models = Registry.built_in()
    return {
        item.name: SeenObject.lying(
            item.name, _planar(item.pose), models.get(item.model), fragile=item.fragile
        )
        for item in scene.objects
    }


def _planar(pose: Pose) -> PlanarPose:
    yaw = float(np.radians(pose.yaw_deg))
    upright = pose.roll_deg == pose.pitch_deg == 0.0
    attitude = None if upright else tuple((rot_z(-yaw) @ pose.R_WB).ravel().tolist())
    return PlanarPose(pose.x_m, pose.y_m, yaw, attitude)


def hard_scene(name: str, setting: Setting, rng: Generator, among: Sequence[ObjectModel]) -> Scene:
    """A scene of a setting.

    Args:
        name: of the scene.
        setting: in what it is hard.
        rng: its generator.
        among: models, one of which is that of the first object, the target.
    """
    first = among[int(rng.integers(len(among)))]
    things: list[SeenObject] = []
    _add(things, first, rng)
    if setting == "fallen":
        things[0] = _on_a_side(things[0], rng)
    others = [model for model in pushable_models() if model.name != first.name]
    if setting == "narrow":
        _stand_beside(things, others, rng)
    else:
        many = setting == "many"
        count = int(rng.integers(MANY[0], MANY[1] + 1)) - 1 if many else int(rng.integers(4))
        for each in _NAMES[:count]:
            model = others[int(rng.integers(len(others)))]
            spans, room = (_SPREAD, APART) if many else (STANDING, GAP)
            _add(things, model, rng, spans, room, name=each)
    wide = setting == "wide"
    objects = [scene_object(seen, drawn_truth(seen.model, wide, rng)) for seen in things]
    return scene_of(name, objects, VISION if wide else Vision())


def _add(
    things: list[SeenObject],
    model: ObjectModel,
    rng: Generator,
    spans: Spans | None = None,
    room: float = GAP,
    *,
    name: str = "",
) -> None:
    """Adds a thing where there is room, apart from the others."""
    spans = spans or (STANDING if things else REACHED)
    lain = [SeenObject.lying(seen.name, seen.pose, seen.model) for seen in things]
    pose = free_place(model, spans, lain, rng, apart=room)
    if pose is not None:
        things.append(SeenObject(name or model.name, pose, model))


def _on_a_side(seen: SeenObject, rng: Generator) -> SeenObject:
    about, way = (rot_x, rot_y)[int(rng.integers(2))], int(rng.choice([-1, 1]))
    attitude = tuple(about(way * math.pi / 2.0).ravel().tolist())
    pose = PlanarPose(seen.pose.x, seen.pose.y, seen.pose.yaw, attitude)
    return SeenObject(seen.name, pose, seen.model)


def _stand_beside(
    standing: list[SeenObject], others: Sequence[ObjectModel], rng: Generator
) -> None:
    """Adds a thing or two close beside sides of the first."""
    models = [model for model in others if model.top >= TALL]
    sides = rng.permutation(4)[: int(rng.integers(1, 3))].tolist()
    for name, side in zip(_NAMES, sides, strict=False):
        model = models[int(rng.integers(len(models)))]
        for _ in range(_TRIES):
            heading = standing[0].pose.yaw + 0.5 * math.pi * side
            seen = SeenObject(name, _pose_beside(standing[0], model, heading, rng), model)
            if min(apart(seen, other) for other in standing) >= NARROW[0]:
                standing.append(seen)
                break


def _pose_beside(
    target: SeenObject, model: ObjectModel, heading: float, rng: Generator
) -> PlanarPose:
    """Pose in which a thing leaves a narrow gap on the side of that heading."""
    out, room = unit(heading)[:2], float(rng.uniform(*NARROW))
    aside = 0.03 * float(rng.uniform(-1.0, 1.0)) * np.array([-out[1], out[0]])
    x, y = (target.pose.p_WB[:2] + aside + _FAR * out).tolist()
    far = PlanarPose(x, y, target.pose.yaw + float(rng.uniform(-0.4, 0.4)))
    come = free_travel(footprint(SeenObject("", far, model)), footprint(target), -out, room)
    x, y = ([x, y] - come * out).tolist()
    return PlanarPose(x, y, far.yaw)


def scene_object(
    seen: SeenObject, truth: Truth, *, z: float = 0.0, fragile: bool = False
) -> SceneObject:
    """A thing as it truly is and stands, so high above the table [m]."""
    pose = seen.pose
    turned = np.eye(3) if pose.attitude is None else np.reshape(pose.attitude, (3, 3))
    # Quarter turns: of an upright thing both sines are 0, of one on its side one is ±1.
    roll, pitch = (90.0 * round(float(sine)) for sine in (turned[2, 1], turned[0, 2]))
    yaw = math.degrees(pose.yaw)
    where = Pose(x_m=pose.x, y_m=pose.y, z_m=z, yaw_deg=yaw, roll_deg=roll, pitch_deg=pitch)
    model = seen.standing_model.name
    return SceneObject(name=seen.name, model=model, pose=where, truth=truth, fragile=fragile)


def apart(seen: SeenObject, other: SeenObject) -> float:
    """Gap between two things, seen from above [m]."""
    return gap(footprint(seen), footprint(other))


_NEEDED: dict[Wished, int] = dict.fromkeys(("swap", "together", "clear", "facing", "all"), 2)
_NEEDED |= {"row": 3, "between": 3}
"""Things of which there must be several for a sentence."""
_FITS: dict[Wished, Callable[[ObjectModel], bool]] = {
    "facing": lambda model: not isinstance(model, CylinderModel),
    "straight": lambda model: not isinstance(model, CylinderModel),
    "stand": lambda model: isinstance(model, BoxModel),
    "lay": lambda model: isinstance(model, BoxModel),
    "asked": lambda model: model.top <= 0.2,
    "on": lambda model: model.grasp is not None or model.top <= 0.2,
    "off": lambda model: model.grasp is not None or model.top <= 0.2,
}
"""What the first thing of a sentence must be like."""


def draw_things(kind: Wished, rng: Generator) -> list[SeenObject]:
    """What stands there for a sentence of a kind, what is spoken of first."""
    match kind:
        case "asked":  # on another thing, or in an open box
            return draw_things("off" if rng.random() < 0.5 else "out of", rng)
        case "into" | "out of":
            return _with_box(kind, rng)
        case "off":
            return _stacked(rng)
    # How many more there are is drawn before what they are.
    usual = kind not in ("room", "blocked", "restore", "on", "stand")
    count = _NEEDED.get(kind, 1) + (int(rng.integers(3)) if usual else 0)
    models = _models(kind, rng)
    things: list[SeenObject] = []
    match kind:
        case "room":
            _add(things, models[0], rng)
            _stand_near(things, kind, rng)
        case "blocked" | "restore":  # one thing in the way of another
            _add(things, models[0], rng)
            u = np.array(list(WAYS.values())[int(rng.integers(4))])
            x, y = (things[0].pose.p_WB[:2] + float(rng.uniform(0.14, 0.22)) * u).tolist()
            _add(things, models[1], rng, ((x - 0.02, x + 0.02), (y - 0.02, y + 0.02)), CLOSE[0])
        case "on":  # something to hold, something on which it fits, and others
            lower = _lower(models[0], rng)
            for model in (models[0], lower, *models[1 : 1 + int(rng.integers(2))]):
                if model.name not in [seen.name for seen in things]:
                    _add(things, model, rng, room=GAP + 0.02)
        case "stand":
            beside = models[1 : 1 + int(rng.integers(1, 3))]
            _add(things, models[0], rng)
            things[0] = _on_a_side(things[0], rng)
            for model in beside:
                _add(things, model, rng)
        case _:
            for model in models[:count]:
                _add(things, model, rng)
    return things


def _models(kind: Wished, rng: Generator) -> list[ObjectModel]:
    """Different models, the first of which fits the kind."""
    found = pushable_models()
    models = [found[k] for k in rng.permutation(len(found)).tolist()]
    if kind in ("flat", "edge"):
        return [Registry.built_in().get("book"), *models]
    fits = _FITS.get(kind)
    first = next(model for model in models if fits is None or fits(model))
    return [first, *(model for model in models if model is not first)]


def _stand_near(things: list[SeenObject], kind: Wished, rng: Generator) -> None:
    """Adds one or two things near the first."""
    others = iter(_models(kind, rng))
    for _ in range(int(rng.integers(1, 3))):
        model = next(each for each in others if each.name != things[0].name)
        reach = 0.12 + 0.5 * float(np.ptp(np.array(model.outline)))
        at = things[0].pose
        spans = ((at.x - reach, at.x + reach), (at.y - reach, at.y + reach))
        _add(things, model, rng, spans, float(rng.uniform(*CLOSE)))


def _stacked(rng: Generator) -> list[SeenObject]:
    """The first stands on a book or a box."""
    first, *others = _models("off", rng)
    lower = _lower(first, rng)
    things: list[SeenObject] = []
    _add(things, lower, rng)
    at = things[0].pose
    yaw = float(rng.uniform(-math.pi, math.pi))
    on = SeenObject(first.name, PlanarPose(at.x, at.y, yaw), first, on=lower.name)
    for model in others[: int(rng.integers(2))]:
        if model.name != lower.name:
            _add(things, model, rng)
    return [on, *things]


def _lower(first: ObjectModel, rng: Generator) -> ObjectModel:
    """A book or a box on which something may stand."""
    boxes = [model for model in Registry.built_in() if isinstance(model, BoxModel)]
    low = [model for model in boxes if model.top < 0.2 and model.inside is None]
    fitting = [model for model in low if model.name != first.name]
    return fitting[int(rng.integers(len(fitting)))]


def _with_box(kind: Wished, rng: Generator) -> list[SeenObject]:
    """Something beside an open box or in it, the box, and one thing more in or beside it."""
    box = next(model for model in Registry.built_in() if model.inside is not None)
    first, other = _models(kind, rng)[:2]
    beside: list[SeenObject] = []
    _add(beside, box, rng, ((0.45, 0.60), (-0.15, 0.15)))
    inside = [first] if kind == "out of" else []
    if rng.random() < 0.3:
        inside.append(other)
    in_box: list[SeenObject] = []
    for model in inside:
        _add_inside(in_box, beside[0], model, rng)
    for model in (first, other):
        if model not in inside and (model is first or rng.random() < 0.5):
            _add(beside, model, rng, STANDING, GAP + 0.02)
    found = [*in_box, *beside[1:]]
    spoken = [seen for seen in found if seen.name == first.name]
    return [*spoken, beside[0], *(seen for seen in found if seen.name != first.name)]


def _add_inside(
    things: list[SeenObject], box: SeenObject, model: ObjectModel, rng: Generator
) -> None:
    """Adds something that stands somewhere between the walls, if there is room for it."""
    inside = box.model.inside
    assert inside is not None, "the box is open"
    R_WB, half = box.pose.R_WB[:2, :2], 0.5 * np.array(inside.size) - D.clearance
    for _ in range(_TRIES_INSIDE):
        x, y = (R_WB @ rng.uniform(-half, half) + box.pose.p_WB[:2]).tolist()
        pose = PlanarPose(x, y, float(rng.uniform(-math.pi, math.pi)))
        seen = SeenObject(model.name, pose, model, on=box.name)
        off = np.abs((footprint(seen) - box.pose.p_WB[:2]) @ R_WB)
        if (off <= half).all() and all(apart(seen, other) >= 2.0 * D.clearance for other in things):
            things.append(seen)
            return


def height_below(seen: SeenObject, things: Sequence[SeenObject]) -> float:
    """How high above the table the floor is on which it stands [m]."""
    lower = (other for other in things if other.name == seen.on)
    return next((other.model.standing_height for other in lower), 0.0)
