"""Where everything truly is, and what became of things between two looks at it.

Frames: W is the world, z up; B is an object's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nlcontrol.session.executor import Executor
from objectmodels import ObjectModel, Registry
from objectmodels.geometry.base_shapes import Array, Disc
from objectmodels.geometry.rotations import from_quaternion, rot_z, yaw_of
from objectmodels.models.object_model import LEVEL
from planner.problem.directions import angle_between
from planner.types.world_state import PlanarPose, SeenObject
from sim.simulated_executor import simulation

MOVED = 0.005
"""What moves less has stayed where it was [m]."""
FELL = math.radians(45.0)
"""What leans so much more than before has fallen [rad]."""
BELOW = -0.02
"""What lies lower has left the table [m]."""


@dataclass(frozen=True, eq=False)
class TruePlace:
    """An object where it truly is.

    Attributes:
        model: its shape, and what is believed of the rest.
        R_WB, p_WB: its pose, shapes (3, 3) and (3,) [m].
        lid: how far its lid is open; None without one.
    """

    model: ObjectModel
    R_WB: Array
    p_WB: Array
    lid: float | None = None

    @cached_property
    def corners(self) -> Array:
        """Corners of a prism around it in W, shape (k, 3) [m]."""
        prism = [(x, y, z) for z in (0.0, self.model.top) for x, y in self.model.outline]
        return np.asarray(np.array(prism) @ self.R_WB.T + self.p_WB)

    @property
    def middle(self) -> Array:
        """Its middle in W, shape (3,) [m]."""
        return np.asarray(self.corners.mean(axis=0))

    @property
    def is_round(self) -> bool:
        """Whether no heading can be told from its shape."""
        return isinstance(self.model.base, Disc)

    def way_to(self, other: TruePlace) -> float:
        """Distance between two middles [m]."""
        return float(np.linalg.norm(other.middle - self.middle))

    def leans_against(self, other: TruePlace) -> float:
        """Angle by which what looked up there is off the vertical here [rad]."""
        up = self.R_WB @ other.R_WB[2]
        return math.acos(float(np.clip(up[2], -1.0, 1.0)))

    def turned_against(self, other: TruePlace) -> float:
        """Angle by which it is turned about the vertical, less than half a turn [rad]."""
        R = self.R_WB @ other.R_WB.T
        return abs(angle_between(math.atan2(R[1, 0], R[0, 0]), 0.0))


def true_places(executor: Executor) -> dict[str, TruePlace]:
    """Where everything in a simulated scene truly is now, by name."""
    world, registry = simulation(executor).world, Registry.built_in()
    sample = world.sample
    return {
        item.name: TruePlace(
            registry.get(item.model),
            from_quaternion(sample.poses[item.name][:4]),
            sample.poses[item.name][4:].copy(),
            sample.lids.get(item.name),
        )
        for item in world.scene.objects
    }


def seen_objects(places: Mapping[str, TruePlace]) -> dict[str, SeenObject]:
    """Things as a camera without errors would see them."""
    return {
        name: SeenObject.lying(name, _planar(place), place.model, lid=place.lid)
        for name, place in places.items()
    }


def _planar(place: TruePlace) -> PlanarPose:
    yaw = float(yaw_of(place.R_WB))
    upright = place.R_WB[2, 2] > math.cos(LEVEL)
    attitude = None if upright else tuple((rot_z(-yaw) @ place.R_WB).ravel().tolist())
    return PlanarPose(float(place.p_WB[0]), float(place.p_WB[1]), yaw, attitude)


def fallen(before: Mapping[str, TruePlace], after: Mapping[str, TruePlace]) -> list[str]:
    """Names of what fell over, or off the table."""
    return [
        name
        for name, now in after.items()
        if now.leans_against(before[name]) > FELL or now.middle[2] < BELOW
    ]


def moved(
    before: Mapping[str, TruePlace], after: Mapping[str, TruePlace], most: float = MOVED
) -> list[str]:
    """Names of what lies elsewhere than before."""
    return [name for name, now in after.items() if now.way_to(before[name]) > most]
