"""What motion goes with what force as an object slides under a finger.

Model: quasi-static sliding on the table. The law here is the ellipsoidal limit surface, to which
the motion is normal: v ∝ F and ω ∝ m_z / c̄² about the centre of mass (Howe and Cutkosky 1996).
`objectmodels.mechanics.exact.loaded_points` has the law of the loaded points.

Frame: velocities and forces are in the table plane, along the axes of B; contacts r (n, 2) are
counted from the centre of mass.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.vector_arrays import cross, dot, left_of

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody


@dataclass(frozen=True)
class Slide:
    """Sliding motion of n objects.

    Attributes:
        v: velocity of the centre of mass, shape (n, 2).
        turn: turning rate, shape (n,).
        force: horizontal push that keeps it up, as a share of μ times the weight, shape (n, 2).
    """

    v: Array
    turn: Array
    force: Array

    def contact_velocity(self, r: Array) -> Array:
        """Velocity at contacts r (n, 2) from the centre of mass, shape (n, 2)."""
        return np.asarray(self.v + self.turn[:, None] * left_of(r))


class SlidingLaw(Protocol):
    """What motion goes with what force, for n strokes; contacts r (n, 2) are from the centre."""

    @property
    def com(self) -> Array:
        """Centres of mass in B, shape (n, 2) [m]."""

    @property
    def finger_friction(self) -> Array:
        """μ at the finger, shape (n,)."""

    def law_under(self, force: Array) -> Self:
        """The law while a push acts, a share (n, 2) of μ times the weight."""

    def slide_with(self, r: Array, d: Array) -> Slide:
        """Motion in which the contacts move at d (n, 2)."""

    def slide_under(self, r: Array, f: Array) -> Slide:
        """Motion under forces along f (n, 2) at the contacts, of any speed."""

    def chosen_strokes(self, i: NDArray[np.intp]) -> Self:
        """The law of some of the strokes."""


@dataclass(frozen=True)
class Ellipsoid:
    """The law of the ellipsoidal limit surface, with friction radii c̄ of shape (n,) [m]."""

    com: Array
    finger_friction: Array
    radius: Array

    @classmethod
    def of_model(cls, model: PushedBody, heights: Array) -> Ellipsoid:
        """The law of a model; the ellipsoid does not depend on the contacts' heights (n,)."""
        n = len(heights)
        com, finger, radius = model.com[:2], model.finger_friction, model.friction_radius
        return cls(np.tile(com, (n, 1)), np.full(n, finger), np.full(n, radius))

    def law_under(self, force: Array) -> Ellipsoid:
        """The same: the ellipsoid does not know where the load is."""
        return self

    def slide_with(self, r: Array, d: Array) -> Slide:
        """Motion in which the contacts move at d (n, 2)."""
        return self._slide(r, sticking_force(r, d, self.radius))

    def slide_under(self, r: Array, f: Array) -> Slide:
        """Motion v = F under forces f (n, 2) at the contacts."""
        return self._slide(r, f)

    def _slide(self, r: Array, f: Array) -> Slide:
        turn = turning_rate(r, f, self.radius)
        size = np.sqrt(dot(f, f) + (turn * self.radius) ** 2)
        return Slide(f, turn, f / size[:, None])

    def chosen_strokes(self, i: NDArray[np.intp]) -> Ellipsoid:
        """The law of some of the strokes."""
        return Ellipsoid(self.com[i], self.finger_friction[i], self.radius[i])


def turning_rate(r: Array, force: Array, radius: float | Array) -> Array:
    """Rate ω = r × F / c̄² under forces F, in units of which v = F, at contacts r (n, 2), (n,)."""
    return cross(r, force) / radius**2


def contact_velocity(r: Array, force: Array, radius: float) -> Array:
    """Velocity of the contacts under forces at them: F + ω ẑ × r, shape (n, 2)."""
    return np.asarray(force + turning_rate(r, force, radius)[:, None] * left_of(r))


def sticking_force(r: Array, d: Array, radius: float | Array) -> Array:
    """Forces under which the contacts move as the fingers do: M F = d, M = I + l lᵀ/c̄², (n, 2)."""
    left = left_of(r) / np.reshape(radius, (-1, 1))
    share = np.sum(left * d, axis=1) / (1.0 + np.sum(left * left, axis=1))
    return np.asarray(d - share[:, None] * left)
