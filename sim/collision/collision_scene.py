"""The table and the objects on it, as the robot sees them: hand and arm must not touch them.

Model: an object is an upright prism or cylinder, the robot is spheres
(`sim.collision.collision_spheres`). From every object a clearance is kept, more from a fragile one.
The pushed object is meant to be touched: it never counts as fragile.

Frames: W is the world, B an object.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from objectmodels.models.upright_solids import CylinderModel
from planner.types.world_state import SeenObject, WorldState
from sim.collision.collision_spheres import (
    distance_to_cylinder,
    distance_to_prism,
    height_above_table,
    place_spheres,
)
from sim.rotations import Array, rot_z

TABLE_CLEARANCE = 0.005
"""Least distance of hand and arm from the table [m]."""

OBJECT_CLEARANCE = 0.012
"""Least distance of hand and arm from an object that they must not touch [m]."""

LEAST_CLEARANCE = 0.006
"""The same where no other way is left: as near as look and hand are sure of [m]."""

FRAGILE_CLEARANCE = 0.030
"""The same from one that is said to be fragile, always [m]."""

SPARE = 0.002
"""How much nearer the hand may get than was planned, as two looks differ by their noise [m]."""

_ROUNDING = 1e-9  # so that it leaves none out that is near [m]


@dataclass(frozen=True, eq=False)
class Obstacle:
    """An object in the hand's way.

    Attributes:
        name: in the scene.
        clearance: distance that is kept from it [m].
        R_WB: its heading, shape (3, 3).
        p_WB: where it stands, shape (3,) [m].
        outline: its convex corners in B, counter-clockwise, shape (k, 2) [m].
        height: [m].
        middle: of a circle around it in W, shape (2,) [m].
        around: the circle's radius [m].
        radius: if it is round about B's origin, else 0 [m].
    """

    name: str
    clearance: float
    R_WB: Array
    p_WB: Array
    outline: Array
    height: float
    middle: Array
    around: float
    radius: float = 0.0

    @classmethod
    def from_seen(cls, seen: SeenObject, clearance: float) -> Obstacle:
        """An object that the robot sees."""
        outline, height = seen.bulk()
        R_WB, p_WB, radius = np.eye(3), np.zeros(3), 0.0
        if seen.attitude is None:
            R_WB, p_WB, outline = seen.pose.R_WB, seen.pose.p_WB, seen.model.outline
            radius = seen.model.radius if isinstance(seen.model, CylinderModel) else 0.0
        centre = 0.5 * (outline.min(axis=0) + outline.max(axis=0))
        around = float(np.hypot(*(outline - centre).T).max())
        middle = p_WB[:2] + R_WB[:2, :2] @ centre
        return cls(seen.name, clearance, R_WB, p_WB, outline, height, middle, around, radius)

    def after_motion(self, before: Array, after: Array, turn: float) -> Obstacle:
        """The same once a point of it has moved, and it has turned about the vertical.

        Args:
            before: the point in W, shape (3,) [m].
            after: where it is then.
            turn: angle, counter-clockwise [rad].
        """
        R = rot_z(turn)
        p_WB = after + R @ (self.p_WB - before)
        middle = after[:2] + R[:2, :2] @ (self.middle - before[:2])
        return replace(self, R_WB=R @ self.R_WB, p_WB=p_WB, middle=middle)

    def distance_to(self, robot: Array) -> Array:
        """Signed distance of spheres in W, shape (..., 4), from it, shape (...) [m]."""
        in_B = place_spheres(robot, self.R_WB.T, -self.R_WB.T @ self.p_WB)
        if self.radius > 0.0:
            return distance_to_cylinder(in_B, self.radius, self.height)
        return distance_to_prism(in_B, self.outline, self.height)

    def is_clear(self, robot: Array, clearance: float | None = None) -> NDArray[np.bool_]:
        """Which poses of the robot keep the clearance, shape (...) for spheres (..., k, 4)."""
        least = self.clearance if clearance is None else clearance
        room = robot[..., 3] + least
        near = robot[..., 2] < room + self.p_WB[2] + self.height
        if near.any():
            # Nothing but the spheres near it is looked at closely.
            x, y = robot[..., 0] - self.middle[0], robot[..., 1] - self.middle[1]
            near &= x * x + y * y < (room + self.around) ** 2
        hit = np.zeros(near.shape, dtype=bool)
        if near.any():
            hit[near] = self.distance_to(robot[near]) <= least
        return np.asarray(~hit.any(axis=-1))


@dataclass(frozen=True, eq=False)
class CollisionScene:
    """Everything on the table.

    Attributes:
        pushed: the object that is to be pushed.
        others: that are not.
    """

    pushed: Obstacle
    others: tuple[Obstacle, ...]

    @classmethod
    def from_state(
        cls,
        state: WorldState,
        pushed: str,
        spare: float = 0.0,
        clearance: float = OBJECT_CLEARANCE,
    ) -> CollisionScene:
        """The scene of what the robot sees.

        Args:
            state: what it sees.
            pushed: name of the object that is to be pushed.
            spare: by how much less than its clearance each of the others may be away [m].
            clearance: from what is not fragile [m].
        """
        others = [
            Obstacle.from_seen(seen, (FRAGILE_CLEARANCE if seen.fragile else clearance) - spare)
            for name, seen in state.objects.items()
            if name != pushed
        ]
        return cls(Obstacle.from_seen(state.objects[pushed], OBJECT_CLEARANCE), tuple(others))

    def obstacles_near(self, points: Array, size: float) -> tuple[Obstacle, ...]:
        """The others that something of a size may hit on its way along points, shape (w, 3)."""
        low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
        return tuple(
            each
            for each in self.others
            if np.hypot(*(np.clip(each.middle, low, high) - each.middle))
            < size + each.around + each.clearance
        )

    @functools.cached_property
    def _circles(self) -> tuple[Array, Array, float]:
        """Middles of the others (n, 2), how near to them is near (n,), and over all of them [m]."""
        middles = np.array([each.middle for each in self.others]).reshape(-1, 2)
        tops = [each.p_WB[2] + each.height + each.clearance for each in self.others]
        near = np.array([each.around + each.clearance for each in self.others])
        return middles, near + _ROUNDING, max(tops, default=-np.inf) + _ROUNDING

    def others_near(self, robot: Array) -> tuple[Obstacle, ...]:
        """The others that spheres in W, shape (..., 4), may come too near to; no more are hit."""
        middles, near, top = self._circles
        robot = robot[robot[..., 2] - robot[..., 3] < top]
        if not len(robot):
            return ()
        at, reach = robot[:, :2], robot[:, 3:]
        low, high = (at - reach).min(axis=0), (at + reach).max(axis=0)
        apart = np.maximum(np.maximum(low - middles, middles - high), 0.0)
        chosen = np.hypot(apart[:, 0], apart[:, 1]) <= near
        return tuple(self.others[k] for k in np.flatnonzero(chosen))

    def is_free(self, robot: Array, pushed: Obstacle | None = None) -> NDArray[np.bool_]:
        """Which poses keep clear of table and objects.

        Args:
            robot: spheres in W, shape (..., k, 4).
            pushed: the pushed object where it is by then.

        Returns:
            Shape (...).
        """
        free = self.is_clear_of_others(robot)
        if free.any():
            free[free] = (pushed or self.pushed).is_clear(robot[free])
        return free

    def is_clear_of_others(self, robot: Array) -> NDArray[np.bool_]:
        """Which poses keep clear of the table and of all but the pushed object; see `is_free`."""
        free = np.asarray(height_above_table(robot).min(axis=-1) >= TABLE_CLEARANCE)
        for each in self.others_near(robot):
            if free.any():
                free[free] = each.is_clear(robot[free])
        return free

    def hit_by(self, robot: Array) -> str | None:
        """Which of the others is in the robot's way, in any of its poses; None if none is."""
        near = self.others_near(robot)
        return next((each.name for each in near if not each.is_clear(robot).all()), None)
