"""Sliding of an object on its loaded points, under one finger.

Model: the support points carry what springs carry
(`objectmodels.mechanics.exact.support_springs`) and resist by Coulomb friction. The loads are those
of the centre of pressure q = c + (μ z) f, z the contact's height and f the push as a share of μ
times the weight. Friction dissipates as little as it can:

- under a force along a line the motion is that of the friction limit
  (`objectmodels.mechanics.friction_limit`);
- a contact at r that is led at d leaves the turning rate ω unknown. Σ N_i |d + ω ẑ × (x_i − r)| is
  convex in it, and where it is least the friction has no moment about the contact.

A friction radius other than the support's own scales the points' distances from the centre of
pressure.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.vector_arrays import cross, dot, left_of
from objectmodels.mechanics.exact.exact_thresholds import springs_of
from objectmodels.mechanics.exact.support_springs import Springs
from objectmodels.mechanics.friction_limit import friction_limit
from objectmodels.mechanics.sliding_law import Slide

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody

_STEPS = 60  # of Newton's method for the turning rate, bisections included
_SETTLED = 1e-12  # step of the turning rate, relative to the largest that there can be
_STILL = 1e-7  # speed of a point, of the contact's, below which its friction counts as less


@dataclass(frozen=True)
class LoadedPoints:
    """The law of loaded points, for n strokes; see `SlidingLaw`.

    Attributes:
        com: centres of mass in B, shape (n, 2) [m].
        finger_friction: shape (n,).
        springs: the points on which the object stands.
        scale: factors of the points' distances from the centre of pressure, shape (n,).
        lever: μ times the height of the contact, shape (n,) [m].
        loads: N_i as shares of the weight, shape (k, n).
        places: x_i, the points from the centre of mass, shape (k, n, 2) [m].
    """

    com: Array
    finger_friction: Array
    springs: Springs
    scale: Array
    lever: Array
    loads: Array
    places: Array

    @classmethod
    def of_model(cls, model: PushedBody, heights: Array) -> LoadedPoints:
        """The law of a model for contacts at heights (n,) [m]."""
        n, springs = len(heights), springs_of(model)
        return cls.of_draws(
            springs,
            com=np.tile(model.com[:2], (n, 1)),
            finger_friction=np.full(n, model.finger_friction),
            radius=np.full(n, model.friction_radius),
            lever=model.friction * heights,
        )

    @classmethod
    def of_draws(
        cls, springs: Springs, *, com: Array, finger_friction: Array, radius: Array, lever: Array
    ) -> LoadedPoints:
        """The law for n objects on the same points: centres of mass (n, 2), the others (n,)."""
        none = np.zeros((len(springs.points), len(com)))
        law = cls(
            com, finger_friction, springs, radius / springs.radius, lever, none, none[..., None]
        )
        return law.law_under(np.zeros_like(com))

    def law_under(self, force: Array) -> LoadedPoints:
        """The law while a push acts, a share (n, 2) of μ times the weight."""
        q = (self.com + self.lever[:, None] * force).T
        loaded = np.ones_like(self.loads, dtype=bool)
        loads, _ = self.springs.loads(q, np.zeros_like(q), loaded)
        places = q.T + self.scale[:, None] * (self.springs.points[:, None, :] - q.T) - self.com
        return replace(self, loads=loads, places=places)

    def slide_with(self, r: Array, d: Array) -> Slide:
        """Motion in which the contacts r (n, 2) move at unit velocities d (n, 2)."""
        return self.slide_at(r, d, self.turning_rate(r, d))

    def slide_at(self, r: Array, d: Array, turn: Array) -> Slide:
        """Motion in which contacts r (n, 2) move at d (n, 2) and the object turns at rates (n,)."""
        v = d - turn[:, None] * left_of(r)
        return Slide(v, turn, self._pushes(v, turn).sum(axis=0))

    def friction_moment(self, slide: Slide) -> Array:
        """Moment about the centre of mass that keeps it up, of μ times the weight, (n,) [m]."""
        return np.asarray(cross(self.places, self._pushes(slide.v, slide.turn)).sum(axis=0))

    def _pushes(self, v: Array, turn: Array) -> Array:
        """Forces against the friction of each point, shape (k, n, 2)."""
        slip = v + turn[:, None] * left_of(self.places)
        speed = np.sqrt(dot(slip, slip) + _STILL**2)
        return np.asarray((self.loads / speed)[..., None] * slip)

    def turning_rate(self, r: Array, d: Array) -> Array:
        """Turning rates (n,) at which the friction has no moment about contacts r led at d."""
        arm = left_of(self.places - r)
        square, along = dot(arm, arm), dot(arm, d)
        # What turns faster dissipates more than what does not turn.
        most = 2.0 / (self.loads * np.sqrt(square)).sum(axis=0)
        found, loads = np.zeros(len(d)), self.loads
        left_over, low, high, turn = np.arange(len(d)), -most, most, found.copy()
        for _ in range(_STEPS):
            advance = along + turn * square  # arm · slip
            inverse = 1.0 / np.sqrt(1.0 + turn * (along + advance) + _STILL**2)
            share = loads * inverse
            moment = (share * advance).sum(axis=0)
            slope = (share * (square - (advance * inverse) ** 2)).sum(axis=0)
            low, high = np.where(moment < 0.0, turn, low), np.where(moment > 0.0, turn, high)
            with np.errstate(divide="ignore", invalid="ignore"):
                ahead = turn - moment / slope
            # A point that hardly slips bends the moment sharply: then the middle is safer.
            ahead = np.where((ahead > low) & (ahead < high), ahead, 0.5 * (low + high))
            found[left_over] = ahead
            (i,) = np.nonzero(np.abs(ahead - turn) > _SETTLED * most)
            if not i.size:
                break
            turn, low, high, most = ahead[i], low[i], high[i], most[i]
            if i.size < len(left_over):
                left_over, loads = left_over[i], loads[:, i]
                square, along = square[:, i], along[:, i]
        return found

    def slide_under(self, r: Array, f: Array) -> Slide:
        """Motion under forces along f (n, 2) at contacts r, of unit speed along their line."""
        along = f / np.sqrt(dot(f, f))[:, None]
        across = left_of(along)
        left = dot(r, across)
        limit = friction_limit(self.loads, dot(self.places, along), dot(self.places, across) - left)
        v = (1.0 + limit.turn * left)[:, None] * along + limit.across[:, None] * across
        return Slide(v, limit.turn, limit.ratio[:, None] * along)

    def chosen_strokes(self, i: NDArray[np.intp]) -> LoadedPoints:
        """The law of some of the strokes."""
        return LoadedPoints(
            self.com[i], self.finger_friction[i], self.springs, self.scale[i], self.lever[i],
            self.loads[:, i], self.places[:, i],
        )  # fmt: skip
