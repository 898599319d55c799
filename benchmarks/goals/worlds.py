"""Worlds drawn by seed: which objects stand where, and how they really are.

Each world holds one to six of the registry's objects that the hand can push. Their true parameters
lie evenly within bounds around what the registry believes (`MASS`, `FRICTION`, …), and they stand
anywhere in `REACHED`, turned by any angle, without touching each other. A world depends on its seed
and number alone.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from objectmodels import BoxModel, CylinderModel, ObjectModel, PrismModel, Registry
from planner.footprints import footprint, overlaps
from planner.state import PlanarPose, SeenObject
from sim.reach import ArmReach
from sim.scene import Pose, Robot, Scene, SceneObject, Vision, built_in_scenes, load_scene
from sim.truth import Truth

Generator = np.random.Generator

MASS, FRICTION, FINGER_FRICTION = 0.20, 0.20, 0.15
"""Largest relative difference of truth and belief."""
CENTRE_OF_MASS = 0.003
"""Largest difference of truth and belief along each axis of B [m]."""
MOST = 6
"""Objects in a world."""
REACHED = ((0.42, 0.68), (-0.32, 0.32))
"""Where objects stand: least and largest x and y [m]."""
GAP = 0.03
"""Least room between two objects [m]."""
BIAS = Vision(position_bias_m=0.003, angle_bias_deg=1.5)
"""The default camera with constant errors on top."""

_TRIES = 200  # places that are tried for an object before it is left out
_GRIP = 0.01  # an object must be so much higher than the lowest contact [m]
_COLOUR = (0.6, 0.6, 0.6)  # of what stands in no built-in scene


class Job(NamedTuple):
    """One case.

    Attributes:
        seed, number: which world and sentence.
        bias: whether the camera has constant errors too.
        oblique: largest angle between a face and the robot's directions [degrees]; 45 for any.
    """

    seed: int
    number: int
    bias: bool = False
    oblique: float = 45.0


@cache
def pushable() -> tuple[ObjectModel, ...]:
    """The built-in models that are high enough for a fingertip."""
    return tuple(m for m in Registry.built_in() if m.top > ArmReach.lowest_height + _GRIP)


def drawn(job: Job) -> tuple[Scene, Generator]:
    """The world of a case, and the generator for what is drawn next."""
    rng = np.random.default_rng((job.seed, job.number))
    count = int(rng.integers(1, MOST + 1))
    chosen = rng.permutation(len(pushable()))[:count]
    objects: list[SceneObject] = []
    standing: list[SeenObject] = []
    for index in chosen.tolist():
        model = pushable()[index]
        truth = true(model, rng)
        pose = _place(model, standing, rng, job.oblique)
        if pose is None:
            continue
        standing.append(SeenObject(model.name, pose, model))
        where = Pose(x_m=pose.x, y_m=pose.y, yaw_deg=float(np.degrees(pose.yaw)))
        objects.append(SceneObject(name=model.name, model=model.name, pose=where, truth=truth))
    return scene(f"{job.seed}-{job.number}", objects, BIAS if job.bias else Vision()), rng


def scene(name: str, objects: list[SceneObject], vision: Vision) -> Scene:
    """A scene with the default scene's robot."""
    return Scene(version=1, name=name, robot=_robot(), vision=vision, objects=tuple(objects))


@cache
def _robot() -> Robot:
    return load_scene("kitchen").robot


def _place(
    model: ObjectModel, standing: list[SeenObject], rng: Generator, oblique: float
) -> PlanarPose | None:
    """A free place for one more object; None if none is found."""
    for _ in range(_TRIES):
        x, y = (float(rng.uniform(*span)) for span in REACHED)
        quarters = int(rng.integers(4))
        yaw = np.radians(90.0 * quarters + oblique * float(rng.uniform(-1.0, 1.0)))
        pose = PlanarPose(x, y, float(np.arctan2(np.sin(yaw), np.cos(yaw))))
        covered = footprint(SeenObject(model.name, pose, model))
        if not any(overlaps(covered, footprint(other), GAP) for other in standing):
            return pose
    return None


def true(model: ObjectModel, rng: Generator) -> Truth:
    """How an object of a model really is, within the bounds."""
    mass, friction, finger, *shift = rng.uniform(-1.0, 1.0, 6).tolist()
    exact = as_believed(model)
    changed = exact.model_copy(
        update={
            "mass_kg": model.mass * (1.0 + MASS * mass),
            "friction_table": model.friction * (1.0 + FRICTION * friction),
            "friction_finger": model.finger_friction * (1.0 + FINGER_FRICTION * finger),
        }
    )
    return changed.shifted([CENTRE_OF_MASS * s for s in shift])


def as_believed(model: ObjectModel) -> Truth:
    """An object that is exactly as the registry believes.

    Raises:
        TypeError: the model is of a kind that the simulation has no shape for.
    """
    shape: dict[str, object]
    match model:
        case BoxModel():
            shape = {"size_m": model.size}
        case CylinderModel():
            shape = {
                "radius_m": model.radius,
                "height_m": model.height,
                "base_radius_m": model.base_radius,
            }
        case PrismModel():
            shape = {"corners_m": model.corners, "height_m": model.height}
        case _:
            raise TypeError(f"{model.name} is no box, cylinder or prism")
    return Truth.model_validate(
        shape
        | {
            "mass_kg": model.mass,
            "friction_table": model.friction,
            "friction_finger": model.finger_friction,
            "centre_of_mass_m": tuple(model.com),
            "colour": _colours().get(model.name, _COLOUR),
        }
    )


@cache
def _colours() -> dict[str, tuple[float, float, float]]:
    scenes = (load_scene(name) for name in built_in_scenes())
    return {item.model: item.truth.colour for each in scenes for item in each.objects}
