"""Worst cases of an uncertain object under a fingertip's force: parameters and directions.

A fingertip transmits f = −n + η t + κ b, η² + κ² ≤ μ_f², per unit of force along the inward normal;
n is the face's outward normal, t horizontal along the face, b = n × t (ẑ on an upright face).
*Shares* are η and κ divided by the largest μ_f considered, so they fill the unit disc.

Extremes over the parameters need no search: the topple threshold falls as the centre of mass
shifts towards the edge and depends on nothing else but the weight; the slide threshold grows with
μ and c̄ and falls with the length of the arm. The centre of mass is taken at its worst for each of
the two separately, which errs on the safe side.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.base_shapes import Array, Base
from objectmodels.mechanics.push_thresholds import (
    push_moment,
    slide_threshold,
    topple_threshold,
    yaw_arm,
)

if TYPE_CHECKING:
    from objectmodels.geometry.mechanical import Mechanical

SMALLEST_SHARE = 1e-3
"""A worst case never takes a friction radius below this share of its nominal value."""

STEPS = (0.1, 0.05, 0.025, 0.0125)
"""Steps of `refined`, in shares."""


@dataclass(frozen=True)
class Case:
    """An object with its parameters at one extreme.

    Attributes:
        base: what it would topple over.
        com: centre of mass in B, nominal, shape (3,) [m].
        friction, radius: μ and c̄ [m].
        shift: by how much the centre of mass is nearer to every edge, along x and y, (2,) [m].
        weight: G, nominal [N].
    """

    base: Base
    com: Array
    friction: float
    radius: float
    shift: Array
    weight: float

    @classmethod
    def from_model(cls, model: Mechanical, sigmas: float, *, yaw: bool = True) -> Case:
        """The object that slides late and topples early (σ > 0), or the other way round (σ < 0).

        Without yaw it may only slide straight: its friction radius is infinite.
        """
        nominal = model.friction_radius
        radius = max(nominal + sigmas * model.friction_radius_sd, SMALLEST_SHARE * nominal)
        return cls(
            base=model.base,
            com=np.array(model.com),
            friction=max(model.friction + sigmas * model.friction_sd, 0.0),
            radius=radius if yaw else np.inf,
            shift=sigmas * np.array(model.com_sd[:2]),
            weight=model.weight,
        )

    def slide_force(self, p: Array, f: Array) -> Array:
        """Force along the inward normal at which it slides, shape (...) [N]."""
        arm = np.abs(yaw_arm(p, f, self.com))
        # The arms of forces along y and x are shorter where it shall slide late.
        arm = arm - self.shift[0] * np.abs(f[..., 1]) - self.shift[1] * np.abs(f[..., 0])
        return slide_threshold(f, np.maximum(arm, 0.0), self.friction, self.radius, self.weight)

    def topple_force(self, p: Array, f: Array) -> Array:
        """Force along the inward normal at which it topples, shape (...) [N]."""
        return topple_threshold(self.base, p, f, self.com, self.weight, self.shift)

    def thresholds(self, p: Array, f: Array) -> tuple[Array, Array]:
        """Slide and topple thresholds, each (...) [N]."""
        return self.slide_force(p, f), self.topple_force(p, f)

    def equal_height(self, foot: Array, f: Array, slide: Array) -> Array:
        """Contact height from which on it topples by the force that makes it slide, (...) [m].

        Args:
            foot: contact points at z = 0, shape (..., 3) [m].
            f: forces, shape (..., 3).
            slide: size at which they make it slide, shape (...) [N]; inf if they never do.
        """
        s = np.where(np.isfinite(slide), slide, 0.0)
        height = self.base.topple_height(
            self.weight * self.com[:2],
            s[..., None] * push_moment(foot, f),
            s[..., None] * f[..., :2],
            self.weight - s * f[..., 2],
            self.weight * self.shift,
        )
        return np.where(np.isfinite(slide), height, np.inf)


def contact_forces(normals: Array, tangential: Array) -> Array:
    """Forces f = −n + η t + κ b of unit normal component; shape (..., 3).

    Args:
        normals: outward unit normals, not vertical, shape (..., 3).
        tangential: η and κ, shape (..., 2).
    """
    n_x, n_y, n_z = normals[..., 0], normals[..., 1], normals[..., 2]
    eta, kappa = tangential[..., 0], tangential[..., 1]
    level = np.hypot(n_x, n_y)
    t_x, t_y = -n_y / level, n_x / level
    # b = n × t
    x = -n_x + eta * t_x - kappa * n_z * t_y
    y = -n_y + eta * t_y + kappa * n_z * t_x
    z = -n_z + kappa * level
    return np.stack(np.broadcast_arrays(x, y, z), axis=-1)


def cone_directions(p: Array, normals: Array, c: Array, reach: float, ring: int) -> Array:
    """Shares of fixed directions in the cone over each contact, shape (n, ring · 3/2 + 4, 2).

    A ring around the cone's boundary (corners of a polygon that encloses it), one half-way out, the
    axis, and three whose force passes the centre of mass, where sliding is hardest.

    Args:
        p: contact points in B, shape (n, 3) [m].
        normals: outward unit normals, shape (n, 3).
        c: centre of mass in B, shape (3,) [m].
        reach: largest friction coefficient of the finger.
        ring: number of directions on the outer ring, even.
    """
    outer = circle_corners(ring) / np.cos(np.pi / ring)
    fixed = np.vstack((outer, 0.5 * circle_corners(ring // 2), np.zeros((1, 2))))
    along = yaw_arm(p, -normals, c)
    across = yaw_arm(p, contact_forces(normals, np.array([1.0, 0.0])), c) - along
    with np.errstate(divide="ignore", invalid="ignore"):
        side = np.clip(np.nan_to_num(-along / (across * reach)), -1.0, 1.0)
    up = np.sqrt(1.0 - side**2)
    through = np.stack([np.column_stack((side, k * up)) for k in (-1.0, 0.0, 1.0)], axis=1)
    return np.concatenate((np.broadcast_to(fixed, (len(p), *fixed.shape)), through), axis=1)


def circle_corners(k: int) -> Array:
    """The corners of a regular k-gon in the unit circle, shape (k, 2)."""
    phi = 2.0 * np.pi * np.arange(k) / k
    return np.column_stack((np.cos(phi), np.sin(phi)))


def refine_directions(value: Callable[[Array], Array], shares: Array, limit: float) -> Array:
    """Smallest value near given directions, by a compass search with shrinking steps, (n,).

    Args:
        value: maps shares (n, j, 2) to what is to be small, shape (n, j).
        shares: where to begin, shape (n, 2).
        limit: radius of the disc that shares must stay in.
    """
    compass, rows = circle_corners(8), np.arange(len(shares))
    best = value(shares[:, None, :])[:, 0]
    for step in STEPS:
        tries = shares[:, None, :] + step * compass
        length = np.hypot(tries[..., :1], tries[..., 1:])
        tries = tries * np.minimum(1.0, limit / np.maximum(length, 1e-12))
        values = value(tries)
        j = values.argmin(axis=1)
        better = values[rows, j] < best
        shares = np.where(better[:, None], tries[rows, j], shares)
        best = np.where(better, values[rows, j], best)
    return best
