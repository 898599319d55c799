"""Worlds drawn by seed, and what the robot believes there.

A world is drawn as `nlcontrol.batches.drawn_scenes` says, and depends on its seed and number alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from benchmarks.goals.hard_worlds import WIDE, unsure_lid
from nlcontrol.batches.drawn_scenes import (
    CENTRE_OF_MASS,
    FINGER_FRICTION,
    FRICTION,
    MASS,
    Generator,
    draw_scene_with,
)
from objectmodels import ObjectModel, Registry
from objectmodels.geometry.rotations import rot_z
from planner.types.world_state import PlanarPose, SeenObject
from sim.truth.scene_file import Pose, Scene


class Job(NamedTuple):
    """One case.

    Attributes:
        seed, number: which world and sentence.
        hard: whether its world is one of `hard_worlds`.
        executed: whether it is carried out; else it is planned only.
    """

    seed: int
    number: int
    hard: bool = False
    executed: bool = True


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
            surely["lid"] = unsure_lid(model.lid)
        registry.add(model.model_copy(update=surely), over=(model.name,))
    return registry


def generator(job: Job) -> Generator:
    """Draws everything of a case."""
    return np.random.default_rng((job.seed, job.number))


def drawn(job: Job, rng: Generator, among: Sequence[ObjectModel]) -> Scene:
    """The world of a case.

    Args:
        job: the case.
        rng: its generator.
        among: models, one of which is that of the first object.
    """
    return draw_scene_with(f"{job.seed}-{job.number}", rng, among, alone=False)


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
