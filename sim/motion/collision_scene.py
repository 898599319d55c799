"""The table and the objects on it, as the robot sees them: hand and arm must not touch them.

Model: an object is an upright prism or cylinder, an open box five of them; the robot is spheres
(`sim.robots.collision_spheres`). From every object a clearance is kept, more from a fragile one.
The pushed object is meant to be touched: it never counts as fragile.

Frames: W is the world, B an object.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.rotations import Array, circle_around, rot_z
from objectmodels.geometry.solids import Column
from objectmodels.safety_figure import SafetyFigure
from planner.types.world_state import SeenObject, WorldState
from sim.robots.collision_spheres import (
    TABLE_CLEARANCE,
    distance_to_box,
    distance_to_cylinder,
    distance_to_prism,
    height_above_table,
)

OBJECT_CLEARANCE: SafetyFigure = 0.012
"""Least distance of hand and arm from an object that they must not touch [m]."""

LEAST_CLEARANCE: SafetyFigure = 0.006
"""The same where no other way is left: as near as look and hand are sure of [m]."""

FRAGILE_CLEARANCE: SafetyFigure = 0.030
"""The same from one that is said to be fragile, always [m]."""

SPARE: SafetyFigure = 0.002
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
        if seen.attitude is not None:
            return replace(cls.at_origin(outline, height), name=seen.name, clearance=clearance)
        return cls._of_column(seen, replace(seen.model.column, height=height), clearance)

    @classmethod
    def _of_column(cls, seen: SeenObject, column: Column, clearance: float) -> Obstacle:
        """A column of an object that stands where the robot sees it."""
        middle_B, around = circle_around(column.outline)
        R_WB, p_WB = seen.pose.R_WB, seen.pose.p_WB
        middle = p_WB[:2] + R_WB[:2, :2] @ middle_B
        form = (column.outline, column.height, middle, around, column.radius)
        return cls(seen.name, clearance, R_WB, p_WB, *form)

    @classmethod
    def parts_of(cls, seen: SeenObject, clearance: float) -> tuple[Obstacle, ...]:
        """An object that the robot sees; an open box is its floor and its walls."""
        columns = seen.model.columns
        if len(columns) == 1 or seen.attitude is not None:
            return (cls.from_seen(seen, clearance),)
        return tuple(cls._of_column(seen, column, clearance) for column in columns)

    @classmethod
    def at_origin(cls, outline: Array, height: float, radius: float = 0.0) -> Obstacle:
        """An object without a name whose frame is W's."""
        middle, around = circle_around(outline)
        return cls("", 0.0, np.eye(3), np.zeros(3), outline, height, middle, around, radius)

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

    @property
    def top(self) -> float:
        """Height of its highest point in W [m]."""
        return float(self.p_WB[2]) + self.height

    def distance_to(self, robot: Array) -> Array:
        """Signed distance of spheres in W, shape (..., 4), from it, shape (...) [m]."""
        in_B = np.empty((4, *robot.shape[:-1]))
        in_B[:3] = ((robot[..., :3] - self.p_WB) @ self.R_WB).transpose(-1, *range(robot.ndim - 1))
        in_B[3] = robot[..., 3]
        return self._distance_in_B(in_B)

    def _distance_in_B(self, in_B: Array) -> Array:
        """The same of spheres in B, shape (4, ...): numpy is faster along a row."""
        spheres = in_B.transpose(*range(1, in_B.ndim), 0)
        if self.radius > 0.0:
            return distance_to_cylinder(spheres, self.radius, self.height)
        if self._box is not None:
            return distance_to_box(spheres, *self._box)
        return distance_to_prism(spheres, self.outline, self.height)

    @functools.cached_property
    def _box(self) -> tuple[Array, Array] | None:
        """Opposite corners in B of one that is a box along B's axes."""
        low, high = self.outline.min(axis=0), self.outline.max(axis=0)
        along = len(self.outline) == 4 and ((self.outline == low) | (self.outline == high)).all()
        return (np.append(low, 0.0), np.append(high, self.height)) if along else None

    def is_clear(self, robot: Array, clearance: float | None = None) -> NDArray[np.bool_]:
        """Which poses of the robot keep the clearance, shape (...) for spheres (..., k, 4)."""
        least = self.clearance if clearance is None else clearance
        hit = np.asarray(robot[..., 2] - robot[..., 3] < least + self.top)
        if hit.any():
            hit[hit] = self.hits(robot[hit], least)
        return np.asarray(~hit.any(axis=-1))

    def hits(self, spheres: Array, clearance: float) -> NDArray[np.bool_]:
        """Which spheres in W, shape (n, 4), do not keep a clearance [m], shape (n,)."""
        x, y = spheres[:, 0] - self.middle[0], spheres[:, 1] - self.middle[1]
        # Nothing but the spheres near it is looked at closely.
        hit = np.asarray(x * x + y * y < (spheres[:, 3] + (clearance + self.around)) ** 2)
        if hit.any():
            hit[hit] = self.distance_to(spheres[hit]) <= clearance
        return hit

    def is_clear_along(
        self, robot: Array, R_WD: Array, points: Array, clearance: float
    ) -> NDArray[np.bool_]:
        """Which poses of the robot keep a clearance wherever D is.

        Args:
            robot: spheres in D, shape (n, k, 4).
            R_WD: how D is turned about the vertical, shape (w, 3, 3).
            points: where its origin is, shape (w, 3) [m].
            clearance: to be kept [m].

        Returns:
            Shape (n,).
        """
        spheres = robot.reshape(-1, 4)
        hit = np.zeros(len(spheres), dtype=bool)
        low = clearance + self.top - points[:, 2].min()
        (near,) = np.nonzero(spheres[:, 2] - spheres[:, 3] < low)
        if not len(near):
            return np.ones(len(robot), dtype=bool)
        # Seen from D the object moves: nothing but the spheres that it comes near to is looked at.
        middle = ((self.middle - points[:, :2])[:, None] @ R_WD[:, :2, :2])[:, 0]
        rows = spheres.T.take(near, axis=1)
        if len(near) > 400:  # for fewer it is not worth it
            (beside,) = np.nonzero(self._are_beside(rows, middle, clearance))
            near, rows = near[beside], rows.take(beside, axis=1)
        x, y, _, r = rows
        x_off, y_off = middle[:, :1] - x, middle[:, 1:] - y
        at, k = np.nonzero(x_off * x_off + y_off * y_off < (r + (clearance + self.around)) ** 2)
        if len(k):
            x, y, z, r = rows.take(k, axis=1)
            R_BD, p_BD = self.R_WB.T @ R_WD, ((points - self.p_WB) @ self.R_WB).T.take(at, axis=1)
            cos, sin = R_BD[at, 0, 0], R_BD[at, 1, 0]
            in_B = np.array(
                [cos * x - sin * y + p_BD[0], sin * x + cos * y + p_BD[1], z + p_BD[2], r]
            )
            hit[near[k[self._distance_in_B(in_B) <= clearance]]] = True
        return np.asarray(~hit.reshape(robot.shape[:2]).any(axis=1))

    def _are_beside(self, rows: Array, middle: Array, clearance: float) -> NDArray[np.bool_]:
        """Which spheres in D, shape (4, n), are beside the rectangle that its middle keeps to."""
        x, y, _, r = rows
        (least_x, least_y), (most_x, most_y) = middle.min(axis=0), middle.max(axis=0)
        x_off = np.maximum(np.maximum(least_x - x, x - most_x), 0.0)
        y_off = np.maximum(np.maximum(least_y - y, y - most_y), 0.0)
        return np.asarray(x_off * x_off + y_off * y_off < (r + (clearance + self.around)) ** 2)


@dataclass(frozen=True, eq=False)
class CollisionScene:
    """Everything on the table.

    Attributes:
        pushed: the object that is to be pushed.
        others: that are not, an open box as its parts.
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
            part
            for name, seen in state.objects.items()
            if name != pushed
            for part in Obstacle.parts_of(
                seen, (FRAGILE_CLEARANCE if seen.fragile else clearance) - spare
            )
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
        tops = [each.top + each.clearance for each in self.others]
        near = np.array([each.around + each.clearance for each in self.others])
        return middles, near + _ROUNDING, max(tops, default=-np.inf) + _ROUNDING

    def others_near(self, robot: Array) -> tuple[Obstacle, ...]:
        """The others that spheres in W, shape (..., 4), may come too near to; no more are hit."""
        return self._beside(robot[self._low(robot)])

    def _low(self, robot: Array) -> NDArray[np.bool_]:
        """Which spheres are not over all of the others."""
        return np.asarray(robot[..., 2] - robot[..., 3] < self._circles[2])

    def _beside(self, robot: Array) -> tuple[Obstacle, ...]:
        """The others beside which spheres in W, shape (n, 4), are."""
        middles, near, _ = self._circles
        if not len(robot):
            return ()
        at, reach = robot[:, :2], robot[:, 3:]
        low, high = (at - reach).min(axis=0), (at + reach).max(axis=0)
        apart = np.maximum(np.maximum(low - middles, middles - high), 0.0)
        chosen = np.hypot(apart[:, 0], apart[:, 1]) <= near
        return tuple(self.others[k] for k in np.flatnonzero(chosen))

    def is_free(self, robot: Array) -> NDArray[np.bool_]:
        """Which poses keep clear of table and objects, shape (...) for spheres in W (..., k, 4)."""
        free = self.is_clear_of_others(robot)
        if free.any():
            free[free] = self.pushed.is_clear(robot[free])
        return free

    def is_clear_of_others(self, robot: Array) -> NDArray[np.bool_]:
        """Which poses keep clear of the table and of all but the pushed object; see `is_free`."""
        hit = np.asarray(height_above_table(robot) < TABLE_CLEARANCE)
        low = self._low(robot)
        spheres, hit_low = robot[low], hit[low]
        for each in self._beside(spheres):
            hit_low |= each.hits(spheres, each.clearance)
        hit[low] = hit_low
        return np.asarray(~hit.any(axis=-1))

    def hit_by(self, robot: Array) -> str | None:
        """Which of the others is in the robot's way, in any of its poses; None if none is."""
        near = self.others_near(robot)
        return next((each.name for each in near if not each.is_clear(robot).all()), None)
