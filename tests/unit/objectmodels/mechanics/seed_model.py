"""The seed's object model, one push at a time, written to be read.

It is the reference that the closed forms of `objectmodels.mechanics.push_thresholds` are tested
against, after the paper "Prediction of action outcomes using an object model". Three parts:

1. friction (its equation 1): the object slides iff the force along the table exceeds μ N;
2. contact (its pseudocode 1): for each vertex of the base, the range of torques about it that the
   table's reaction at the other vertices can balance; computed once, from the base alone;
3. static equilibrium (its equation 2): the torque of applied force and weight about each vertex
   must lie in that vertex's range, otherwise the object rotates about the axis through the two
   vertices whose ranges are missed most.

Assumptions: rigid object, convex base, no yaw, no inertia. Everything is in B, z up, SI units. A
torque is its part in the table plane, as the angle atan2(τ_y, τ_x).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from math import atan2, hypot, pi

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array, without_collinear
from objectmodels.models.object_model import ObjectModel

_DOWN = np.array([0.0, 0.0, -1.0])

# Scores closer than this count as a tie [rad].
_TIE = 1e-9


@dataclass(frozen=True)
class TorqueRange:
    """Torques about one vertex that the table can balance.

    Attributes:
        start: angle at which the range begins, counter-clockwise [rad].
        width: how far it extends, below π [rad].
    """

    start: float
    width: float

    def distance(self, torque: Array) -> float:
        """Angle between a torque and the range, 0 inside [rad]."""
        beyond = (atan2(torque[1], torque[0]) - self.start) % (2.0 * pi)
        return 0.0 if beyond <= self.width else min(beyond - self.width, 2.0 * pi - beyond)


@dataclass(frozen=True)
class RotationAxis:
    """Axis in the table plane about which the object begins to rotate.

    Attributes:
        point: a point of it, shape (2,) [m].
        direction: unit direction, shape (2,).
        vertices: the base vertices it passes through, one or two indices.
    """

    point: Array
    direction: Array
    vertices: tuple[int, ...]


class SeedModel:
    """Predicts the outcome of a single push.

    Attributes:
        base: vertices of the base polygon in B, counter-clockwise, shape (k, 2) [m].
        ranges: the torque range of each vertex.
    """

    def __init__(self, base: ArrayLike, com: ArrayLike, weight: float, friction: float) -> None:
        self.base = without_collinear(np.asarray(base, dtype=np.float64))
        self.ranges = tuple(torque_range(self.base, i) for i in range(len(self.base)))
        self.com = np.asarray(com, dtype=np.float64)
        self.weight = weight
        self.friction = friction

    @classmethod
    def of(cls, model: ObjectModel) -> SeedModel:
        """The reference model of an object; a round base becomes a polygon of 24 sides."""
        return cls(model.base.corners, model.com, model.weight, model.friction)

    def slides(self, force: ArrayLike) -> bool:
        """Whether |F_xy| > μ N."""
        f = self._checked(force)
        return hypot(f[0], f[1]) > self.friction * self._load(f)

    def rotation(self, point: ArrayLike, force: ArrayLike) -> RotationAxis | None:
        """Axis of the beginning rotation, or None if every torque can be balanced.

        Args:
            point: contact point p_BC, shape (3,) [m].
            force: applied force f_BC_B, shape (3,) [N].

        Raises:
            ModelError: `bad_value` if the force lifts the object off the table.
        """
        p, f = np.asarray(point, dtype=np.float64), self._checked(force)
        torques = [self._torque(v, p, f) for v in self.base]
        scores = np.array([r.distance(t) for r, t in zip(self.ranges, torques, strict=True)])
        if not scores.any():
            return None
        best, second, third = np.argsort(-scores, kind="stable")[:3].tolist()
        if scores[second] > 0.0 and scores[second] - scores[third] > _TIE:
            along = self.base[second] - self.base[best]
            vertices: tuple[int, ...] = (best, second)
        else:
            along, vertices = torques[best][:2], (best,)
        return RotationAxis(self.base[best], along / hypot(*along), vertices)

    def outcome(self, point: ArrayLike, force: ArrayLike) -> str:
        """What the force overcomes: `none`, `slide`, `topple` or `slide+topple` (both)."""
        topples = self.rotation(point, force) is not None
        if self.slides(force):
            return "slide+topple" if topples else "slide"
        return "topple" if topples else "none"

    def _torque(self, vertex: Array, point: Array, force: Array) -> Array:
        """Torque of weight and applied force about a base vertex, shape (3,) [N·m]."""
        v = np.append(vertex, 0.0)
        return np.cross(self.com - v, self.weight * _DOWN) + np.cross(point - v, force)

    def _checked(self, force: ArrayLike) -> Array:
        f = np.asarray(force, dtype=np.float64)
        if self._load(f) <= 0.0:
            raise ModelError(
                "bad_value",
                f"the force {f} N lifts an object of {self.weight} N",
                suggestions=("less",),
            )
        return f

    def _load(self, force: Array) -> float:
        """Normal load N on the table [N]."""
        return self.weight - float(force[2])


def torque_range(base: Array, i: int) -> TorqueRange:
    """Pseudocode 1: the widest range below π between torques of downward forces at the others."""
    torques = [np.cross(np.append(v - base[i], 0.0), _DOWN) for v in np.delete(base, i, axis=0)]
    angles = [atan2(t[1], t[0]) for t in torques]
    widest = TorqueRange(angles[0], 0.0)
    for a, b in combinations(angles, 2):
        turn = (b - a) % (2.0 * pi)
        between = TorqueRange(a, turn) if turn < pi else TorqueRange(b, 2.0 * pi - turn)
        widest = max(widest, between, key=lambda r: r.width)
    return widest
