"""Extremes over everything that a fingertip may transmit, and over the model's uncertainty.

The contact decides the direction of the force, not the plan: a fingertip may transmit any
f = s (−n + η t + κ ẑ), η² + κ² ≤ μ_f², with n the outward normal, t = ẑ × n, and s the component
along the inward normal. Forces in here are that component, for the nominal mass (slide and topple
thresholds both grow with the mass in proportion, so the class does not depend on it).

Extremes over the cone are taken over a fixed set of directions: 32 on a ring that encloses the
cone's boundary (a polygon around the circle), 16 half-way out, the axis, and the three where the
force passes the centre of mass (there sliding is hardest). Extremes over the parameters need no
search: the topple threshold falls with the centre of mass's shift towards the edge and knows no
other parameter, the slide threshold rises with μ and c̄ and falls with the arm's length. The centre
of mass is taken at its worst for each of the two separately, which errs on the safe side.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.prediction import gap
from objectmodels.probability import contact_forces, probabilities
from objectmodels.thresholds import (
    EDGE_NORMALS,
    Array,
    edge_offsets,
    slide_threshold,
    yaw_arm,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from objectmodels.box import BoxModel

RING = 32
"""Directions on the ring around the cone's boundary: adjacent ones are 11° apart."""

SMALLEST_SHARE = 1e-3
"""A worst case never takes a friction radius below this share of its nominal value."""

# Below this a face and an edge count as parallel (direction cosines; rounding is 1e-16).
_PARALLEL = 1e-12


@dataclass(frozen=True)
class ConeThresholds:
    """Extremes over a fingertip's friction cone and the parameters; arrays over n contacts.

    Forces are components along the inward normal, for the nominal mass [N]; heights are measured
    from the table at the contact's lateral position [m], and a height above the box's top is
    given as infinite, since no contact can be there.

    Attributes:
        slides: every one of the forces makes the box slide before it topples.
        topples: every one of them topples it before it slides.
        slide_margin: smallest topple threshold less slide threshold over all of them; negative if
            some topple it first, −inf if some jam.
        topple_margin: smallest slide threshold less topple threshold; −inf if some never topple it.
        slide_max: largest force needed until it slides.
        topple_max: largest force needed until it topples.
        height_below: contact height below which all of them make it slide first; inf if none on
            this face topples it, 0 if sliding is certain nowhere.
        height_above: contact height above which all topple it first; inf if there is none.
        critical_height: height that separates the two for the nominal parameters and a force along
            the inward normal (h* = b/μ for a centred contact); inf if it never topples.
        probability_slide: probability under the parameters' uncertainty that it slides first, for
            the worst direction in the cone.
        probability_topple: the same for toppling first.
    """

    slides: NDArray[np.bool_]
    topples: NDArray[np.bool_]
    slide_margin: Array
    topple_margin: Array
    slide_max: Array
    topple_max: Array
    height_below: Array
    height_above: Array
    critical_height: Array
    probability_slide: Array
    probability_topple: Array


@dataclass(frozen=True)
class _Cone:
    """What the cone over u points of the base may do, whatever the height; j directions each.

    Attributes:
        shares: sideways and upward shares of each direction in the disc, shape (u, j, 2).
        rise, rest: the lever about each base edge is p_z · rise + rest, shape (u, j, 4).
        holding_least, holding_most: moment that holds the box against each edge, shape (4,) [N·m].
        slide_least, slide_most: slide thresholds, shape (u, j) [N].
    """

    shares: Array
    rise: Array
    rest: Array
    holding_least: Array
    holding_most: Array
    slide_least: Array
    slide_most: Array

    @classmethod
    def of(cls, model: BoxModel, spots: Array, sigmas: float) -> _Cone:
        """The cone over base points with normals, rows (x, y, n_x, n_y) of `spots`."""
        c, d, weight = np.array(model.com), edge_offsets(model.size), model.weight
        shift = sigmas * np.array(model.com_sd[:2])
        reach = model.finger_friction + sigmas * model.finger_friction_sd
        foot, normals = _feet(spots)
        shares = _directions(foot, normals, c, reach)
        f = contact_forces(normals[:, None, :], reach * shares)
        n = EDGE_NORMALS
        holding, slack = weight * (d - n @ c[:2]), weight * (np.abs(n) @ shift)
        arm = np.abs(yaw_arm(foot[:, None, :], f, c))
        loose = shift[0] * np.abs(f[..., 1]) + shift[1] * np.abs(f[..., 0])
        mu, mu_sd = model.friction, sigmas * model.friction_sd
        radius, radius_sd = model.friction_radius, sigmas * model.friction_radius_sd
        shortest = max(radius - radius_sd, SMALLEST_SHARE * radius)
        return cls(
            shares=shares,
            rise=f[..., :2] @ n.T,
            rest=-f[..., 2:] * (foot[:, :2] @ n.T - d)[:, None, :],
            holding_least=np.maximum(holding - slack, 0.0),
            holding_most=holding + slack,
            slide_least=slide_threshold(f, arm + loose, max(mu - mu_sd, 0.0), shortest, weight),
            slide_most=slide_threshold(
                f, np.maximum(arm - loose, 0.0), mu + mu_sd, radius + radius_sd, weight
            ),
        )

    def height_below(self) -> Array:
        """Height below which every direction slides first, shape (u,) [m]."""
        height = self._equal_heights(self.holding_least, self.slide_most)
        below = np.where(self.rise > _PARALLEL, height, np.inf).min(axis=(1, 2))
        # Directions that jam, or that tip the box even from the lowest contact.
        floor = self.rest * self.slide_most[..., None] >= self.holding_least
        never = np.isinf(self.slide_most).any(axis=1) | floor.any(axis=(1, 2))
        return np.where(never, 0.0, below)

    def height_above(self) -> Array:
        """Height above which every direction topples first, shape (u,) [m]."""
        height = self._equal_heights(self.holding_most, self.slide_least)
        return np.asarray(np.where(self.rise > _PARALLEL, height, np.inf).min(axis=2).max(axis=1))

    def _equal_heights(self, holding: Array, slide: Array) -> Array:
        """Heights at which toppling about each edge takes the force that slides, (u, j, 4) [m]."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return (holding / slide[..., None] - self.rest) / self.rise


def cone_thresholds(model: BoxModel, p: Array, normals: Array, sigmas: float) -> ConeThresholds:
    """See `BoxModel.cone_thresholds`, which checks its arguments."""
    # All but the topple threshold is the same for every height over one point of the base.
    spots, at = np.unique(np.column_stack((p[:, :2], normals[:, :2])), axis=0, return_inverse=True)
    at = at.reshape(-1)
    cone = _Cone.of(model, spots, sigmas)
    lever = p[:, 2, None, None] * cone.rise[at] + cone.rest[at]
    topple_least, topple_most = _first(cone.holding_least, lever), _first(cone.holding_most, lever)
    slide_least, slide_most = cone.slide_least[at], cone.slide_most[at]
    slide_gap, topple_gap = gap(slide_most, topple_least), gap(topple_most, slide_least)
    slide_margin, topple_margin = slide_gap.min(axis=1), topple_gap.min(axis=1)
    return ConeThresholds(
        slides=slide_margin > 0.0,
        topples=topple_margin > 0.0,
        slide_margin=slide_margin,
        topple_margin=topple_margin,
        slide_max=slide_most.max(axis=1),
        topple_max=topple_most.max(axis=1),
        height_below=_on_box(cone.height_below(), model)[at],
        height_above=_on_box(cone.height_above(), model)[at],
        critical_height=_on_box(_critical_height(model, spots), model)[at],
        probability_slide=probabilities(
            model, p, normals, cone.shares[at, _worst(slide_gap, slide_most)]
        )[0],
        probability_topple=probabilities(
            model, p, normals, cone.shares[at, _worst(topple_gap, topple_most)]
        )[1],
    )


def _worst(margin: Array, threshold: Array) -> NDArray[np.int64]:
    """Index of the direction whose margin is the smallest part of its threshold, shape (n,)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = margin / threshold
    return np.asarray(np.where(np.isnan(share), -np.inf, share).argmin(axis=1))


def _critical_height(model: BoxModel, spots: Array) -> Array:
    """Height above which a force along the inward normal topples first, shape (u,) [m]."""
    foot, normals = _feet(spots)
    c, d, weight = np.array(model.com), edge_offsets(model.size), model.weight
    slide = slide_threshold(
        -normals, yaw_arm(foot, -normals, c), model.friction, model.friction_radius, weight
    )
    holding, rise = weight * (d - EDGE_NORMALS @ c[:2]), -normals[:, :2] @ EDGE_NORMALS.T
    with np.errstate(divide="ignore"):
        height = np.where(rise > _PARALLEL, holding / (slide[:, None] * rise), np.inf)
    return np.asarray(height.min(axis=1))


def _feet(spots: Array) -> tuple[Array, Array]:
    """Points of the base plane and horizontal normals of the rows of `spots`, each (u, 3)."""
    zero = np.zeros(len(spots))
    return np.column_stack((spots[:, :2], zero)), np.column_stack((spots[:, 2:], zero))


def _directions(foot: Array, normals: Array, c: Array, reach: float) -> Array:
    """Shares (sideways, up) of the directions over each point, shape (u, RING + RING//2 + 4, 2)."""
    ring = _circle(RING) / np.cos(np.pi / RING)
    fixed = np.vstack((ring, 0.5 * _circle(RING // 2), np.zeros((1, 2))))
    along = yaw_arm(foot, -normals, c)
    across = yaw_arm(foot, contact_forces(normals, np.array([1.0, 0.0])), c) - along
    with np.errstate(divide="ignore", invalid="ignore"):
        side = np.clip(np.nan_to_num(-along / (across * reach)), -1.0, 1.0)
    up = np.sqrt(1.0 - side**2)
    through = np.stack([np.column_stack((side, k * up)) for k in (-1.0, 0.0, 1.0)], axis=1)
    return np.concatenate((np.broadcast_to(fixed, (len(foot), *fixed.shape)), through), axis=1)


def _circle(k: int) -> Array:
    """The corners of a regular k-gon in the unit circle, shape (k, 2)."""
    phi = 2.0 * np.pi * np.arange(k) / k
    return np.column_stack((np.cos(phi), np.sin(phi)))


def _first(holding: Array, lever: Array) -> Array:
    """Smallest holding / lever over the base edges that tilt, inf if none does."""
    never = np.full(lever.shape, np.inf)
    return np.asarray(np.divide(holding, lever, out=never, where=lever > 0.0).min(axis=-1))


def _on_box(height: Array, model: BoxModel) -> Array:
    """Heights that a contact can have, inf for those above the box."""
    return np.where(height > model.size[2], np.inf, np.maximum(height, 0.0))
