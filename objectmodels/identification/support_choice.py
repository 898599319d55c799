"""Support that explains the trials best.

How the base carries the object decides how it turns, so off-centre slides are tried with the
model's own support, `uniform`, `corners` and, where motions are known, few points that explain
these (`pressure_points`). The one that predicts best is taken; each point that was found counts
against it like a parameter (Akaike 1974).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.support_points import Support, friction_radius
from objectmodels.identification.least_squares import Solution, solve_least_squares
from objectmodels.identification.measurement_model import Balance
from objectmodels.identification.outlying_trials import robust_rows
from objectmodels.identification.parameter_coordinates import (
    COM_X,
    RADIUS,
    Mask,
    coordinates_of,
    with_values,
)
from objectmodels.identification.pressure_points import pressure_points
from objectmodels.identification.trial import Trial
from objectmodels.mechanics.push_thresholds import yaw_arm
from objectmodels.models.object_model import ObjectModel

DIFFERENT = 4.0
"""Difference of −2 log likelihood from which on one support surely predicts better than another."""

_OFF_CENTRE = 0.1  # arm as a share of c̄
_PER_POINT = 2.0  # what a point that was found must explain of −2 log likelihood


_Tried = tuple[float, Solution, Balance]
"""The misfit of a support, the solution with it, and its balance."""


def best_support(
    model: ObjectModel, trials: Sequence[Trial], first: Solution, belief: Array, prior: bool,
    exact: bool, supports: Sequence[Support] | None,
) -> tuple[Solution, Balance, Array, list[str]]:  # fmt: skip
    """The solution of the support that predicts best, what doubt of it adds, what was compared."""
    coarse = Balance(model, trials)
    if not exact or not _has_turning_slide(coarse, first.values):
        return first, coarse, np.zeros((7, 7)), []
    tried = dict.fromkeys(supports or (model.support, "uniform", "corners"), 0.0)
    if not first.free[RADIUS] and supports is None:
        tried = {model.support: 0.0}
    if supports is None:
        points = pressure_points(with_values(model, first.values), trials)
        tried |= {} if points is None else {points: _PER_POINT * len(points)}
    found: list[_Tried] = []
    for support, price in tried.items():
        balance = Balance(_standing_on(model, support), trials, exact=True)
        solution = solve_least_squares(balance, first.values, first.free, belief, prior=prior)
        rows = robust_rows(balance, solution)
        found.append((_support_misfit(balance, solution, rows) + price, solution, balance))
    best = min(found, key=lambda one: one[0])
    return best[1], best[2], _between_supports(found, best), _comparison_note(found, best[2])


def _between_supports(found: Sequence[_Tried], best: _Tried) -> Array:
    """Covariance from not being sure of the support: how far off the others are, by likelihood."""
    weights = np.exp(-0.5 * (np.array([misfit for misfit, _, _ in found]) - best[0]))
    apart = np.array(
        [coordinates_of(s.values) - coordinates_of(best[1].values) for _, s, _ in found]
    )
    return np.asarray(apart.T @ (weights / weights.sum() * apart.T).T)


def _standing_on(model: ObjectModel, support: Support) -> ObjectModel:
    """The model carried otherwise; its friction radius changes as that of the support does."""
    ratio = friction_radius(support, model.footprint) / friction_radius(
        model.support, model.footprint
    )
    return model.model_copy(
        update={"support": support, "friction_radius": model.friction_radius * ratio}
    )


def _comparison_note(found: Sequence[_Tried], taken: Balance) -> list[str]:
    """Notes on the supports that were tried."""
    if len(found) < 2:
        return []
    misfits = sorted(misfit for misfit, _, _ in found)
    said = ", ".join(f"{_support_name(b.model.support)} {misfit:.1f}" for misfit, _, b in found)
    why = "it predicts better"
    if misfits[1] - misfits[0] < DIFFERENT:
        why = "though the trials hardly tell them apart"
    name = _support_name(taken.model.support)
    return [f"the support {name} was taken, {why} (−2 log likelihood: {said})"]


def _support_name(support: Support) -> str:
    return support if isinstance(support, str) else f"of {len(support)} points"


def _has_turning_slide(balance: Balance, values: Array) -> bool:
    """Return True if a slide is so far off-centre that the object turns."""
    t = balance.touches
    i = t.kind == "slide"
    arm = yaw_arm(t.p[i], t.u[i], values[COM_X:])
    return bool((np.abs(arm) > _OFF_CENTRE * values[RADIUS]).any() or balance.turns.any())


def _support_misfit(balance: Balance, solution: Solution, rows: Mask) -> float:
    """Misfit of the rows that no support can be blamed for missing left out."""
    rest = (balance.observed - solution.at.predicted)[rows]
    return float((rest**2 / solution.variance[rows] + np.log(solution.variance[rows])).sum())
