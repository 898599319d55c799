"""Worst cases over all that a fingertip may transmit, and over the model's uncertainty.

The contact decides the direction of the force, not the plan. A fingertip transmits
f = −n + η t + κ b, η² + κ² ≤ μ_f², per unit of force along the inward normal; n is the face's
outward normal, t horizontal along the face, b = n × t (ẑ on an upright face). *Shares* are η and κ
divided by the largest μ_f considered, so they fill the unit disc. Forces in here are components
along the inward normal, for the nominal mass: slide and topple thresholds both grow with the mass
in proportion, so the class does not depend on it.

Extremes over the parameters need no search: the topple threshold falls as the centre of mass
shifts towards the edge and depends on nothing else but the weight; the slide threshold grows with
μ and c̄ and falls with the length of the arm. The centre of mass is taken at its worst for each of
the two separately, which errs on the safe side.

A margin is the least over a fixed set of directions; where it is positive, so that certainty is
claimed, it is refined by a search from the worst ones; no random direction or parameter then
undercuts it by 0.1 % of the weight.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from objectmodels.geometry.base_shapes import Array, Base
from objectmodels.geometry.rotations import unique_rows
from objectmodels.lazy import remember_answers
from objectmodels.mechanics.outcome_probability import (
    BLOCK,
    NODES,
    Draws,
    class_probabilities,
    draw_parameters,
    normal_nodes,
)
from objectmodels.mechanics.push_outcomes import MarginSearch, circle_corners, force_gap
from objectmodels.mechanics.push_thresholds import (
    push_moment,
    slide_threshold,
    topple_threshold,
    yaw_arm,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from objectmodels.geometry.pushed_body import PushedBody

    Index = NDArray[np.int64]

SMALLEST_SHARE = 1e-3
"""A worst case never takes a friction radius below this share of its nominal value."""

NEAR = 0.03
"""A direction is searched from if its margin exceeds the least one by at most so much weight."""

RING = 32
"""Directions on the outer ring for a margin: adjacent ones are 11° apart."""

SEARCH_NODES, SEARCH_RING = 8, 16
"""Points of the sequence and directions on the outer ring, for finding the least probable one."""


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
    def from_model(cls, model: PushedBody, sigmas: float, *, yaw: bool = True) -> Case:
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

        Contacts at z = 0 and forces are (..., 3); they slide at sizes (...) [N], inf if never.
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

    Outward unit normals n are (..., 3), not vertical; η and κ are (..., 2).
    """
    n_x, n_y, n_z = normals[..., 0], normals[..., 1], normals[..., 2]
    eta, kappa = tangential[..., 0], tangential[..., 1]
    level = np.hypot(n_x, n_y)
    t_x, t_y = -n_y / level, n_x / level
    # b = n × t
    x = -n_x + eta * t_x - kappa * n_z * t_y
    y = -n_y + eta * t_y + kappa * n_z * t_x
    z = -n_z + kappa * level
    # One component after the other: numpy is much faster on arrays that lie in a row.
    return np.moveaxis(np.stack([x, y, z]), 0, -1)


def cone_directions(p: Array, normals: Array, c: Array, reach: float, ring: int) -> Array:
    """Shares of fixed directions in the cone over each contact, shape (n, ring · 3/2 + 4, 2).

    A ring around the cone's boundary (corners of a polygon that encloses it), one half-way out, the
    axis, and three whose force passes the centre of mass c (3,) [m], where sliding is hardest. The
    ring has an even number of directions, `reach` is the finger's largest friction coefficient;
    contacts p [m] and outward unit normals are (n, 3).
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


class _Sliding(NamedTuple):
    """The part of `ConeThresholds` that a search for contacts asks for at the chosen one only."""

    most: Array
    height_below: Array
    critical_height: Array


class _Toppling(NamedTuple):
    """The part of `ConeThresholds` that only who wants to topple asks for."""

    most: Array
    height_above: Array
    search: MarginSearch


@dataclass(frozen=True)
class ConeThresholds:
    """Extremes over a fingertip's friction cone and the parameters; arrays over n contacts.

    Forces are components along the inward normal, for the nominal mass [N]; heights are measured
    from the table at the contact's lateral position [m], and a height above the object's top is
    given as infinite, since no contact can be there.
    """

    _slide_search: MarginSearch = field(repr=False)
    _sliding: Callable[[], _Sliding] = field(repr=False)
    _toppling: Callable[[], _Toppling] = field(repr=False)
    _contacts: tuple[PushedBody, Array, Array, bool] = field(repr=False)

    @property
    def slides(self) -> NDArray[np.bool_]:
        """Every one of the forces makes the object slide before it topples, shape (n,)."""
        return self.slide_margin > 0.0

    @property
    def topples(self) -> NDArray[np.bool_]:
        """Every one of the forces topples the object before it slides, shape (n,)."""
        return self.topple_margin > 0.0

    @cached_property
    def _slides(self) -> _Sliding:
        return self._sliding()

    @property
    def slide_max(self) -> Array:
        """Largest force needed until it slides, shape (n,)."""
        return self._slides.most

    @property
    def height_below(self) -> Array:
        """Contact height below which all of the forces make it slide first, shape (n,) [m].

        Infinite if none on this face topples it, 0 if sliding is certain nowhere.
        """
        return self._slides.height_below

    @property
    def critical_height(self) -> Array:
        """Contact height that separates sliding and toppling, shape (n,) [m].

        For the nominal parameters and a force along the inward normal (h* = b/μ for a centred
        contact); inf if it never topples.
        """
        return self._slides.critical_height

    @cached_property
    def _topples(self) -> _Toppling:
        return self._toppling()

    @property
    def topple_max(self) -> Array:
        """Largest force needed until it topples, shape (n,)."""
        return self._topples.most

    @property
    def height_above(self) -> Array:
        """Contact height above which all topple it first; inf if there is none, shape (n,)."""
        return self._topples.height_above

    @cached_property
    def slide_margin(self) -> Array:
        """Smallest topple threshold less slide threshold over all forces, shape (n,) [N].

        Negative if some topple it first, −inf if some jam. Refined when first read.
        """
        return self._slide_search.least_margin()

    @cached_property
    def topple_margin(self) -> Array:
        """Smallest slide threshold less topple threshold over all forces, shape (n,) [N].

        −inf if some never topple it. Refined when first read.
        """
        return self._topples.search.least_margin()

    @cached_property
    def probability_slide(self) -> Array:
        """Probability of sliding first, for the worst direction in the cone, shape (n,).

        Under the parameters' uncertainty, whatever `sigmas` was; computed when first read.
        """
        return worst_probability(*self._contacts, "slide")

    @cached_property
    def probability_topple(self) -> Array:
        """The same for toppling first."""
        return worst_probability(*self._contacts, "topple")


def cone_thresholds(
    model: PushedBody, p: Array, normals: Array, sigmas: float, yaw: bool
) -> ConeThresholds:
    """See `ObjectModel.cone_thresholds`, which checks its arguments."""
    # All but the topple threshold is the same for every height over one point of the base.
    first, at = unique_rows(np.column_stack((p[:, :2], normals)))
    foot, facing = np.column_stack((p[first, :2], np.zeros(len(first)))), normals[first]
    reach = model.finger_friction + sigmas * model.finger_friction_sd
    tippy, slippery = (
        Case.from_model(model, sigmas, yaw=yaw),
        Case.from_model(model, -sigmas, yaw=yaw),
    )

    def all_round() -> Array:
        # Finer, since heights have no refinement but depend on the lateral position only.
        shares = cone_directions(foot, facing, tippy.com, reach, 128)
        return contact_forces(facing[:, None, :], reach * shares)

    shares = cone_directions(foot, facing, tippy.com, reach, RING)
    f = contact_forces(facing[:, None, :], reach * shares)
    slide_gap = force_gap(
        tippy.slide_force(foot[:, None, :], f)[at], tippy.topple_force(p[:, None, :], f[at])
    )
    near, radius = NEAR * model.weight, 1.0 / np.cos(np.pi / RING)

    def slide_margin(i: Index, x: Array) -> Array:
        slide, topple = tippy.thresholds(p[i, None], contact_forces(normals[i, None], reach * x))
        return force_gap(slide, topple)

    def topple_margin(i: Index, x: Array) -> Array:
        slide, topple = slippery.thresholds(p[i, None], contact_forces(normals[i, None], reach * x))
        return force_gap(topple, slide)

    def sliding() -> _Sliding:
        force = all_round()
        most = tippy.slide_force(foot[:, None, :], force)
        below = _height_below(tippy, foot[:, None, :], force, most)
        nominal = Case.from_model(model, 0.0, yaw=yaw)
        critical = nominal.equal_height(foot, -facing, nominal.slide_force(foot, -facing))
        heights = (_contact_height(height, model.top)[at] for height in (below, critical))
        return _Sliding(most.max(axis=1)[at], *heights)

    def toppling() -> _Toppling:
        force = all_round()
        slide_least = slippery.slide_force(foot[:, None, :], force)
        above = slippery.equal_height(foot[:, None, :], force, slide_least).max(axis=1)
        most = slippery.topple_force(p[:, None, :], f[at])
        gap = force_gap(most, slippery.slide_force(foot[:, None, :], f)[at])
        return _Toppling(
            most.max(axis=1),
            _contact_height(above, model.top)[at],
            MarginSearch.begin(gap, shares[at], topple_margin, near, radius),
        )

    return ConeThresholds(
        _slide_search=MarginSearch.begin(slide_gap, shares[at], slide_margin, near, radius),
        _sliding=sliding,
        _toppling=toppling,
        _contacts=(model, p, normals, yaw),
    )


def _height_below(case: Case, foot: Array, f: Array, slide: Array) -> Array:
    """Height below which every direction slides first, shape (u,) [m]."""
    height = case.equal_height(foot, f, slide).min(axis=1)
    # Directions that jam, or that tip the object even with the contact on the table.
    jams, tips = np.isinf(slide).any(axis=1), (case.topple_force(foot, f) <= slide).any(axis=1)
    return np.where(jams | tips, 0.0, height)


def _contact_height(height: Array, top: float) -> Array:
    """Heights that a contact can have, inf for those above the object."""
    return np.where(height > top, np.inf, np.maximum(height, 0.0))


def worst_probability(
    model: PushedBody, p: Array, normals: Array, yaw: bool, outcome: Literal["slide", "topple"]
) -> Array:
    """Probability of an outcome at onset for the worst direction in the finger's cone, (n,).

    Contact points p_BC [m] and the faces' outward unit normals are (n, 3); it turns only if `yaw`.
    """
    shares = cone_directions(p, normals, np.array(model.com), model.finger_friction, SEARCH_RING)
    few, many = (_drawn_at_nodes(model, k, yaw) for k in (SEARCH_NODES, NODES))
    worst = np.empty(len(p))
    for i in range(0, len(p), BLOCK):
        block = slice(i, i + BLOCK)
        q, n, tried = p[block], normals[block], shares[block]
        rough = _direction_probability(model, q, n, tried, outcome, few)
        chosen = tried[np.arange(len(q)), rough.argmin(axis=1)]
        worst[block] = _direction_probability(model, q, n, chosen[:, None, :], outcome, many)[:, 0]
    return worst


@remember_answers(64)
def _drawn_at_nodes(model: PushedBody, count: int, yaw: bool) -> Draws:
    """Parameters at so many normal nodes, kept, since models never change."""
    return draw_parameters(model, normal_nodes(count), yaw=yaw)


def _direction_probability(
    model: PushedBody, p: Array, normals: Array, shares: Array, outcome: str, draw: Draws
) -> Array:
    """Probability of an outcome for the directions of given shares (n, j, 2), shape (n, j)."""
    tangential = shares[:, :, None, :] * draw.finger_friction[:, None]
    f = contact_forces(normals[:, None, None, :], tangential)  # (n, j, k, 3)
    slide, topple = class_probabilities(model, p[:, None, None, :], f, draw)
    return np.asarray((slide if outcome == "slide" else topple).mean(axis=-1))
