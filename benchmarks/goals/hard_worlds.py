"""Worlds drawn by seed that are harder than those of `worlds`, each in one way.

| setting | |
|---|---|
| narrow | one or two things, as high as a hand, stand 30 to 60 mm beside sides of the target |
| fallen | the target, a box, lies on one of its sides |
| many | nine to fourteen things stand 5 cm or more apart |
| wide | masses, frictions and forces of lids lie within 30 % of what is believed; the camera has a noise of 5 mm and 2° and a constant error of 2 mm |

But for `wide`, truths differ from beliefs as in `nlcontrol.batches.drawn_scenes`. Every scene
depends on its job alone. All but the target have names that are no model's.
"""  # noqa: E501

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np

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
from objectmodels import ObjectModel
from objectmodels.geometry.rotations import rot_x, rot_y
from objectmodels.models.object_parts import Lid
from planner.problem.directions import unit
from planner.problem.footprints import footprint, free_travel, gap
from planner.types.world_state import PlanarPose, SeenObject
from sim.robots.cell_description import Vision
from sim.truth.object_truth import Truth, truth_as_believed
from sim.truth.scene_file import Pose, Scene, SceneObject

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

_SPREAD = ((0.36, 0.80), (-0.45, 0.45))  # where many stand: least and largest x and y [m]
_NAMES = ("vase", "lamp", "candle", "clock", "radio", "speaker", "statue", "toy", "globe", "trophy",
          "basket", "kettle", "pot")  # fmt: skip
_FAR = 1.0  # from where a neighbour comes up to its gap [m]
_TRIES = 50


def hard_scene(name: str, setting: Setting, rng: Generator, among: Sequence[ObjectModel]) -> Scene:
    """A scene of a setting.

    Args:
        name: of the scene.
        setting: in what it is hard.
        rng: its generator.
        among: models, one of which is that of the first object, the target.
    """
    first = among[int(rng.integers(len(among)))]
    target = _target(first, setting, rng)
    standing = [target]
    match setting:
        case "narrow":
            _stand_beside(standing, rng)
        case "many":
            _stand_about(standing, int(rng.integers(MANY[0], MANY[1] + 1)) - 1, rng)
        case _:
            _stand_about(standing, int(rng.integers(4)), rng)
    wide = setting == "wide"
    objects = [_scene_object(seen, wide, rng) for seen in standing]
    vision = VISION if wide else Vision()
    return scene_of(name, objects, vision)


def _target(model: ObjectModel, setting: Setting, rng: Generator) -> SeenObject:
    pose = free_place(model, REACHED, (), rng)
    assert pose is not None, "an empty table has room"
    if setting == "fallen":
        about, way = (rot_x, rot_y)[int(rng.integers(2))], int(rng.choice([-1, 1]))
        attitude = tuple(about(way * math.pi / 2.0).ravel().tolist())
        pose = PlanarPose(pose.x, pose.y, pose.yaw, attitude)
    return SeenObject(model.name, pose, model)


def _stand_about(standing: list[SeenObject], count: int, rng: Generator) -> None:
    """Adds further things where there is room, apart from each other."""
    many = count >= MANY[0] - 1
    models, spans = _others(standing[0]), _SPREAD if many else STANDING
    for name in _NAMES[:count]:
        model = models[int(rng.integers(len(models)))]
        lain = [SeenObject.lying(seen.name, seen.pose, seen.model) for seen in standing]
        pose = free_place(model, spans, lain, rng, apart=APART if many else GAP)
        if pose is not None:
            standing.append(SeenObject(name, pose, model))


def _stand_beside(standing: list[SeenObject], rng: Generator) -> None:
    """Adds a thing or two close beside sides of the first."""
    models = [model for model in _others(standing[0]) if model.top >= TALL]
    sides = rng.permutation(4)[: int(rng.integers(1, 3))].tolist()
    for name, side in zip(_NAMES, sides, strict=False):
        model = models[int(rng.integers(len(models)))]
        for _ in range(_TRIES):
            heading = standing[0].pose.yaw + 0.5 * math.pi * side
            seen = SeenObject(name, _pose_beside(standing[0], model, heading, rng), model)
            others = [footprint(other) for other in standing]
            if min(gap(footprint(seen), other) for other in others) >= NARROW[0]:
                standing.append(seen)
                break


def _others(target: SeenObject) -> list[ObjectModel]:
    """Models that the target's name does not fit."""
    return [model for model in pushable_models() if model.name != target.name]


def _pose_beside(
    target: SeenObject, model: ObjectModel, heading: float, rng: Generator
) -> PlanarPose:
    """Pose in which a thing leaves a narrow gap on the side of that heading."""
    out, apart = unit(heading)[:2], float(rng.uniform(*NARROW))
    aside = 0.03 * float(rng.uniform(-1.0, 1.0)) * np.array([-out[1], out[0]])
    x, y = (target.pose.p_WB[:2] + aside + _FAR * out).tolist()
    far = PlanarPose(x, y, target.pose.yaw + float(rng.uniform(-0.4, 0.4)))
    come = free_travel(footprint(SeenObject("", far, model)), footprint(target), -out, apart)
    x, y = ([x, y] - come * out).tolist()
    return PlanarPose(x, y, far.yaw)


def _scene_object(seen: SeenObject, wide: bool, rng: Generator) -> SceneObject:
    """A thing as it truly is and stands."""
    pose = seen.pose
    turned = np.eye(3) if pose.attitude is None else np.reshape(pose.attitude, (3, 3))
    # Quarter turns: of an upright thing both sines are 0, of one on its side one is ±1.
    roll, pitch = (90.0 * round(float(sine)) for sine in (turned[2, 1], turned[0, 2]))
    where = Pose(
        x_m=pose.x, y_m=pose.y, yaw_deg=math.degrees(pose.yaw), roll_deg=roll, pitch_deg=pitch
    )
    truth = drawn_truth(seen.model, wide, rng)
    return SceneObject(name=seen.name, model=seen.model.name, pose=where, truth=truth)


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
        forces = {name: lid * getattr(model.lid, name) for name in _forces_of(model.lid)}
        changed["lid"] = model.lid.model_copy(update=forces)
    return Truth.model_validate(dict(truth_as_believed(model)) | changed).with_shift(shift)


def unsure_lid(lid: Lid) -> Lid:
    """A lid as it is believed in the setting `wide`."""
    sds = {f"{k}_sd": WIDE * getattr(lid, k) / math.sqrt(3.0) for k in _forces_of(lid)}
    return lid.model_copy(update=sds)


def _forces_of(lid: Lid) -> list[str]:
    names = ("friction_torque", "snap_torque", "retention")
    return [name for name in names if hasattr(lid, name)]
