"""Thresholds over everything that a fingertip may transmit, and over the model's uncertainty.

The contact decides the direction of the force, not the plan. Forces in here are components along
the inward normal of the touched face, for the nominal mass: slide and topple thresholds both grow
with the mass in proportion, so the class does not depend on it. See
`objectmodels.mechanics.worst_cases` for the directions and the worst cases of the parameters.

A margin is the least over a fixed set of directions; where it is positive, so that certainty is
claimed, it is refined by a search from the worst ones; no random direction or parameter then
undercuts it by 0.1 % of the weight.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.base_shapes import Array, unique_rows
from objectmodels.mechanics.outcome_probability import worst_probability
from objectmodels.mechanics.push_outcomes import force_gap
from objectmodels.mechanics.worst_cases import (
    Case,
    cone_directions,
    contact_forces,
    refine_directions,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from objectmodels.geometry.mechanical import Mechanical

    Index = NDArray[np.int64]

RING = 32
"""Directions on the outer ring for a margin: adjacent ones are 11° apart."""

FINE_RING = 128
"""The same for heights, which have no refinement but depend on the lateral position only."""

NEAR = 0.03
"""A direction is searched from if its margin exceeds the least one by at most so much weight."""


@dataclass(frozen=True)
class ConeThresholds:
    """Extremes over a fingertip's friction cone and the parameters; arrays over n contacts.

    Forces are components along the inward normal, for the nominal mass [N]; heights are measured
    from the table at the contact's lateral position [m], and a height above the object's top is
    given as infinite, since no contact can be there.

    Attributes:
        slides: every one of the forces makes the object slide before it topples.
        topples: every one of them topples it before it slides.
        slide_margin: smallest topple threshold less slide threshold over all of them; negative if
            some topple it first, −inf if some jam.
        topple_margin: smallest slide threshold less topple threshold; −inf if some never topple it.
        slide_max: largest force needed until it slides.
        topple_max: largest force needed until it topples.
        height_below: contact height below which all of them make it slide first; inf if none on
            this face topples it, 0 if sliding is certain nowhere.
        height_above: contact height above which all topple it first; inf if there is none.
        slides_most, topples_most: unit directions in the cone, shape (n, 3), in which sliding comes
            longest before toppling, and the other way round: the best and the worst one for who
            wants it to slide. Of the fixed directions, with parameters at `sigmas`.
        critical_height: height that separates the two for the nominal parameters and a force along
            the inward normal (h* = b/μ for a centred contact); inf if it never topples.
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
    slides_most: Array
    topples_most: Array
    _contacts: tuple[Mechanical, Array, Array, bool] = field(repr=False)

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
    model: Mechanical, p: Array, normals: Array, sigmas: float, yaw: bool
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

    shares = cone_directions(foot, facing, tippy.com, reach, FINE_RING)
    f = contact_forces(facing[:, None, :], reach * shares)
    slide_most = tippy.slide_force(foot[:, None, :], f)
    below = _height_below(tippy, foot[:, None, :], f, slide_most)
    slide_least = slippery.slide_force(foot[:, None, :], f)
    above = slippery.equal_height(foot[:, None, :], f, slide_least).max(axis=1)

    shares = cone_directions(foot, facing, tippy.com, reach, RING)
    f = contact_forces(facing[:, None, :], reach * shares)
    slide_gap = force_gap(
        tippy.slide_force(foot[:, None, :], f)[at], tippy.topple_force(p[:, None, :], f[at])
    )
    topple_most = slippery.topple_force(p[:, None, :], f[at])
    topple_gap = force_gap(topple_most, slippery.slide_force(foot[:, None, :], f)[at])

    def slide_margin(i: Index, x: Array) -> Array:
        slide, topple = tippy.thresholds(p[i, None], contact_forces(normals[i, None], reach * x))
        return force_gap(slide, topple)

    def topple_margin(i: Index, x: Array) -> Array:
        slide, topple = slippery.thresholds(p[i, None], contact_forces(normals[i, None], reach * x))
        return force_gap(topple, slide)

    slides_by = _refined_margins(slide_gap, shares[at], slide_margin, model.weight)
    topples_by = _refined_margins(topple_gap, shares[at], topple_margin, model.weight)
    nominal = Case.from_model(model, 0.0, yaw=yaw)
    critical = nominal.equal_height(foot, -facing, nominal.slide_force(foot, -facing))
    return ConeThresholds(
        slides=slides_by > 0.0,
        topples=topples_by > 0.0,
        slide_margin=slides_by,
        topple_margin=topples_by,
        slide_max=slide_most.max(axis=1)[at],
        topple_max=topple_most.max(axis=1),
        height_below=_contact_height(below, model.top)[at],
        height_above=_contact_height(above, model.top)[at],
        critical_height=_contact_height(critical, model.top)[at],
        slides_most=_chosen_directions(f[at], slide_gap.argmax(axis=1)),
        topples_most=_chosen_directions(f[at], slide_gap.argmin(axis=1)),
        _contacts=(model, p, normals, yaw),
    )


def _chosen_directions(f: Array, chosen: Index) -> Array:
    """The chosen ones of forces (n, j, 3) as unit directions, shape (n, 3)."""
    picked = f[np.arange(len(f)), chosen]
    return np.asarray(picked / np.linalg.norm(picked, axis=1, keepdims=True))


def _refined_margins(
    margins: Array, shares: Array, value: Callable[[Index, Array], Array], weight: float
) -> Array:
    """Least of the margins (n, j) of each contact, refined where it is positive, shape (n,).

    The search starts from the worst direction of each quadrant of the cone that comes near the
    worst of all, since there may be several minima.
    """
    least: Array = margins.min(axis=1)
    near = least + NEAR * weight
    quadrant = 2 * (shares[..., 0] > 0.0) + (shares[..., 1] > 0.0)
    for q in range(4):
        inside = np.where(quadrant == q, margins, np.inf)
        j = inside.argmin(axis=1)
        start = inside[np.arange(len(inside)), j]
        (i,) = np.nonzero((least > 0.0) & (start <= near))
        found = refine_directions(partial(value, i), shares[i, j[i]], 1.0 / np.cos(np.pi / RING))
        least[i] = np.minimum(least[i], found)
    return least


def _height_below(case: Case, foot: Array, f: Array, slide: Array) -> Array:
    """Height below which every direction slides first, shape (u,) [m]."""
    height = case.equal_height(foot, f, slide).min(axis=1)
    # Directions that jam, or that tip the object even with the contact on the table.
    jams, tips = np.isinf(slide).any(axis=1), (case.topple_force(foot, f) <= slide).any(axis=1)
    return np.where(jams | tips, 0.0, height)


def _contact_height(height: Array, top: float) -> Array:
    """Heights that a contact can have, inf for those above the object."""
    return np.where(height > top, np.inf, np.maximum(height, 0.0))
