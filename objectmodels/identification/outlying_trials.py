"""Trials that the others contradict.

A kind of measurement (forces of slides, of tilts, turn rates, ratios of slips) with five rows or
more is looked at. A row whose residual lies more than `OUTLIER` robust standard deviations (1.4826
times the median distance from the kind's median, but no less than the stated one) from that median
is suspected; suspects are left out, the worst first and at most a fifth of all trials, and stay out
if the fit without them still misses them by so much.
"""

from __future__ import annotations

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.identification.least_squares import Solution, solve_least_squares
from objectmodels.identification.measurement_model import Balance
from objectmodels.identification.parameter_coordinates import Mask

OUTLIER = 4.0
"""Robust standard deviations from which on a residual is an outlier."""

MOST_DROPPED = 0.2
"""Share of the trials that may be left out."""

_LEAST_ROWS = 5
_TO_SD = 1.4826  # standard deviations of a normal distribution for each median distance


def robust_rows(balance: Balance, solution: Solution) -> Mask:
    """Rows of trials that are not suspected."""
    suspects = [i for i, _ in suspect_trials(balance, solution)]
    return ~np.isin(balance.trial, suspects)


def suspect_trials(balance: Balance, solution: Solution) -> list[tuple[int, float]]:
    """Trials that may be outliers, the worst first, with their robust deviations."""
    z = (balance.observed - solution.at.predicted) / solution.at.sd
    worst = np.zeros(len(balance.touches.size))
    for rows in balance.groups:
        if len(rows) < _LEAST_ROWS:
            continue
        apart = np.abs(z[rows] - np.median(z[rows]))
        apart /= max(_TO_SD * float(np.median(apart)), 1.0)
        np.maximum.at(worst, balance.trial[rows], apart)
    order = np.argsort(-worst)
    most = int(MOST_DROPPED * len(worst))
    return [(int(i), float(worst[i])) for i in order[:most] if worst[i] > OUTLIER]


def solution_without_outliers(
    balance: Balance, solution: Solution, belief: Array, prior: bool
) -> tuple[Solution, dict[int, float]]:
    """The fit without trials that the others contradict, and by how many deviations they do."""
    suspects = dict(suspect_trials(balance, solution))
    if not suspects:
        return solution, {}
    rows = ~np.isin(balance.trial, list(suspects))
    without = solve_least_squares(
        balance, solution.values, solution.free, belief, rows=rows, prior=prior
    )
    z = np.abs(_studentised_residuals(balance, without))
    dropped = {i: far for i in suspects if (far := float(z[balance.trial == i].max())) > OUTLIER}
    if len(dropped) == len(suspects):
        return without, dropped
    rows = ~np.isin(balance.trial, list(dropped))
    again = solve_least_squares(
        balance, without.values, without.free, belief, rows=rows, prior=prior
    )
    return again, dropped


def _studentised_residuals(balance: Balance, solution: Solution) -> Array:
    """Residuals over their standard deviation, those of rows left out including the fit's own."""
    J = solution.at.jacobian
    of_fit = np.einsum("ij,jk,ik->i", J, solution.own, J)
    sign = np.where(solution.rows, -1.0, 1.0)
    variance = np.maximum(solution.variance + sign * of_fit, 1e-6 * solution.variance)
    return np.asarray((balance.observed - solution.at.predicted) / np.sqrt(variance))
