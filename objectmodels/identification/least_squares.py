"""Weighted least squares in the parameters' coordinates, with two variances found beside them.

Model: row i shows its prediction plus noise of the stated standard deviation σ_i times a common
`noise` ≥ 1, and the friction of each slide differs from the mean by a relative `spread` τ: the
variance is (noise σ_i)² + (τ D_i)², D_i = ∂s_i/∂ log μ for slides and 0 else. Both are moment
estimates, repeated with the residuals until they stand: τ from what the slides' squares exceed the
degrees of freedom that the slides have left (Paule and Mandel 1982, with leverages as in REML), the
noise likewise from all other rows, if their squares exceed what chance gives in one case of twenty.

Parameters that are not sought stay where they are. Their errors δ shift those sought by S δ,
S = −(JᵀWJ)⁻¹ JᵀW J_kept, so their covariance enters that of the result (Schmidt 1966).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.identification.measurement_model import (
    FRICTION,
    LOGARITHMIC,
    Balance,
    Linear,
    Mask,
    coordinates_of,
    values_at,
    with_values,
)

_STEPS, _WHOLE = 60, 10  # and after how many they are halved
_SETTLED = 1e-3  # change of the variances, relative, and steps in standard deviations
_LONGEST = 0.7  # step in a logarithm, a factor of two; along the base as a share of its size
_HALVINGS = 12
_HINTS = ("check where the contacts were, and the object's size",)
_NAMED = 3  # trials that are named if they contradict each other


@dataclass(frozen=True)
class Solution:
    """Result of a fit.

    Attributes:
        at: predictions at the values found.
        free: which parameters were sought, shape (7,).
        rows: which rows counted, shape (r,).
        variance: of the rows, shape (r,).
        spread: τ, relative spread of the friction between slides.
        spread_freedom: degrees of freedom behind the spread.
        noise: factor of the stated standard deviations.
        noise_freedom: degrees of freedom behind it; infinite if the stated ones stand.
        covariance: of all parameters in their coordinates, shape (7, 7).
        own: the part that comes from the rows' noise, shape (7, 7).
        slides: which rows are forces of slides, shape (r,).
    """

    at: Linear
    free: Mask
    rows: Mask
    variance: Array
    spread: float
    spread_freedom: float
    noise: float
    noise_freedom: float
    covariance: Array
    own: Array
    slides: Mask

    @property
    def values(self) -> Array:
        """The parameters, in the order of `UNCERTAIN`, shape (7,)."""
        return self.at.values


def solve_least_squares(
    balance: Balance,
    start: Array,
    free: Mask,
    belief: Array,
    *,
    rows: Mask | None = None,
    prior: bool = False,
) -> Solution:
    """Find the parameters sought, `free` (7,), by Gauss and Newton's method.

    Args:
        balance: the trials and their model.
        start: values to start from, in the order of `UNCERTAIN`, shape (7,).
        free: which parameters are sought, shape (7,).
        belief: covariance of what was believed before, in coordinates, shape (7, 7).
        rows: which rows count; all if not given.
        prior: whether the belief of the model counts as a measurement of the parameters.

    Raises:
        ModelError: `no_fit` if no parameters explain the trials.
    """
    rows = np.ones(len(balance.observed), dtype=bool) if rows is None else rows
    believed = coordinates_of(balance.model.means)
    # Inverse covariance of the beliefs on the parameters sought, given that the others hold.
    information = (
        np.asarray(np.linalg.pinv(belief[np.ix_(free, free)], rcond=1e-12, hermitian=True))
        if prior
        else np.zeros((free.sum(), free.sum()))
    )
    now = balance.linear_predictions(start)
    require_possible(balance, now, rows)
    guess = 0.0, 1.0
    for number in range(_STEPS):
        offset = (believed - coordinates_of(now.values))[free]
        step, state = _weighted_step(balance, now, free, rows, information, offset, guess)
        guess = state.spread, state.noise
        sd = np.sqrt(np.diag(state.own))
        # Where a row bends sharply steps may swing to and fro; shorter ones settle there.
        step *= 0.5 ** (number // _WHOLE)
        # Steps that have been swinging need not be as small.
        if (np.abs(step) <= (_SETTLED if number < _WHOLE else 0.05) * sd).all():
            return _solution_at(balance, now, free, rows, belief, information, state)
        change = np.zeros(len(free))
        change[free] = step
        now = damped_step(balance, now, change, balance.linear_predictions, rows=rows, hints=_HINTS)
    raise ModelError(
        "no_fit",
        "the trials contradict each other so much that no parameters explain them",
        suggestions=(
            f"look at: {', '.join(_worst_sources(balance, now, rows))}",
            "check units, contact points and what moved",
        ),
    )


def _worst_sources(balance: Balance, at: Linear, rows: Mask) -> list[str]:
    """Names of the few trials that are predicted worst."""
    far = np.where(rows, np.abs(balance.observed - at.predicted) / at.sd, 0.0)
    worst = dict.fromkeys(balance.trial[np.argsort(-far)].tolist())
    return [balance.touches.sources[trial] for trial in list(worst)[:_NAMED]]


def require_possible(balance: Balance, at: Linear, rows: Mask | bool = True) -> None:
    """Raise an error if the model has no prediction for a row.

    Raises:
        ModelError: `impossible_trial`.
    """
    (wrong,) = np.nonzero(rows & ~np.isfinite(at.predicted))
    if wrong.size:
        raise ModelError(
            "impossible_trial",
            f"{balance.touches.sources[balance.trial[wrong[0]]]}: by the model such a push never "
            "moves the object so",
            suggestions=("check the contact point, the direction and what moved",),
        )


@dataclass(frozen=True)
class _Variances:
    """Variances of the rows, and what follows from them."""

    spread: float
    noise: float
    spread_freedom: float
    noise_freedom: float
    variance: Array
    own: Array


def _weighted_step(
    balance: Balance,
    at: Linear,
    free: Mask,
    rows: Mask,
    information: Array,
    offset: Array,
    guess: tuple[float, float],
) -> tuple[Array, _Variances]:
    """The step of linear least squares, the variances settled."""
    J, rest = at.jacobian[rows][:, free], (balance.observed - at.predicted)[rows]
    slides = balance.slides[rows]
    per_friction = np.where(slides, at.jacobian[rows, FRICTION], 0.0)
    spread, noise = guess
    for _ in range(50):
        variance = (noise * at.sd[rows]) ** 2 + (spread * per_friction) ** 2
        weighted = J.T / variance
        own: Array = np.asarray(np.linalg.inv(weighted @ J + information))
        step = own @ (weighted @ rest + information @ offset)
        left = rest - J @ step
        used = np.einsum("ij,jk,ik->i", J, own, J) / variance
        freedom = float((~slides).sum() - used[~slides].sum())
        new_noise, noise_freedom = _excess_noise((left / at.sd[rows])[~slides], freedom)
        slide_freedom = float(slides.sum() - used[slides].sum())
        new_spread = _friction_spread(
            left[slides], (new_noise * at.sd[rows])[slides], per_friction[slides], slide_freedom
        )
        change = max(abs(new_spread**2 - spread**2) / (spread**2 + 1e-6), abs(new_noise - noise))
        spread, noise = new_spread, new_noise
        if change < _SETTLED:
            break
    whole = (noise * at.sd) ** 2
    whole += (spread * np.where(balance.slides, at.jacobian[:, FRICTION], 0.0)) ** 2
    return step, _Variances(spread, noise, slide_freedom, noise_freedom, whole, own)


def _excess_noise(z: Array, freedom: float) -> tuple[float, float]:
    """Factor of the stated noise, and the degrees of freedom behind it."""
    from scipy.special import chdtrc

    squares = float(z @ z)
    # Probability by chance below which squares that are too large count as more noise than stated.
    if freedom < 0.5 or chdtrc(freedom, squares) > 0.05:
        return 1.0, np.inf
    return float(np.sqrt(squares / freedom)), freedom


def _friction_spread(left: Array, sd: Array, per_friction: Array, freedom: float) -> float:
    """τ with Σ left² / (sd² + τ² D²) equal to the degrees of freedom; 0 if noise explains it."""
    if freedom < 0.5:
        return 0.0
    square, d2, r2 = 0.0, per_friction**2, left**2
    for _ in range(40):  # convex and falling: Newton's method rises to the root from below
        variance = sd**2 + square * d2
        excess = float((r2 / variance).sum()) - freedom
        step = excess / float((r2 * d2 / variance**2).sum() + 1e-300)
        if excess <= 0.0 or step <= 1e-6 * square:
            break
        square += step
    return float(np.sqrt(square))


def damped_step(
    balance: Balance,
    at: Linear,
    step: Array,
    linear: Callable[[Array], Linear],
    *,
    rows: Mask | bool = True,
    hints: tuple[str, ...] = (),
) -> Linear:
    """Predictions after a step, shortened until there are any.

    Args:
        balance: the trials and their model.
        at: predictions before.
        step: change of the coordinates, shape (7,); parameters where it is zero stay.
        linear: predictions near some values.
        rows: which of them must be finite.
        hints: at a remedy, for the error.

    Raises:
        ModelError: `no_fit` if the object would not stand.
    """
    longest = np.where(LOGARITHMIC, _LONGEST, 0.3 * balance.model.base.size)
    share = 1.0 / max(1.0, float((np.abs(step) / longest).max()))
    for _ in range(_HALVINGS):
        values = values_at(coordinates_of(at.values) + share * step)
        values = np.where(step == 0.0, at.values, values)
        share *= 0.5
        try:
            with_values(balance.model, values)
            after = linear(values)
        except ModelError:
            continue
        if np.isfinite(after.predicted)[rows].all():
            return after
    raise ModelError(
        "no_fit",
        f"the trials lead to a {balance.model.name} that would not stand",
        suggestions=hints,
    )


def _solution_at(
    balance: Balance,
    at: Linear,
    free: Mask,
    rows: Mask,
    belief: Array,
    information: Array,
    state: _Variances,
) -> Solution:
    covariance, own = np.zeros((7, 7)), np.zeros((7, 7))
    kept = ~free
    J = at.jacobian[rows]
    given = belief[np.ix_(kept, kept)]
    shift = -state.own @ (J[:, free].T / state.variance[rows]) @ J[:, kept]
    if information.any():  # the belief ties what is sought to what is kept
        tie = belief[np.ix_(free, kept)] @ np.linalg.pinv(given, hermitian=True)
        shift = shift + state.own @ information @ tie
    own[np.ix_(free, free)] = state.own
    covariance[np.ix_(free, free)] = state.own + shift @ given @ shift.T
    covariance[np.ix_(free, kept)] = shift @ given
    covariance[np.ix_(kept, free)] = (shift @ given).T
    covariance[np.ix_(kept, kept)] = given
    return Solution(
        at,
        free,
        rows,
        state.variance,
        state.spread,
        state.spread_freedom,
        state.noise,
        state.noise_freedom,
        covariance,
        own,
        balance.slides,
    )


# Trials that the others contradict.
#
# A kind of measurement (forces of slides, of tilts, turn rates, ratios of slips) with five rows
# or more is looked at. A row whose residual lies more than `OUTLIER` robust standard deviations
# (1.4826 times the median distance from the kind's median, but no less than the stated one) from
# that median is suspected; suspects are left out, the worst first and at most a fifth of all
# trials, and stay out if the fit without them still misses them by so much.

OUTLIER = 4.0
"""Robust standard deviations from which on a residual is an outlier."""

MOST_DROPPED = 0.2
"""Share of the trials that may be left out."""


def robust_rows(balance: Balance, solution: Solution) -> Mask:
    """Rows of trials that are not suspected."""
    suspects = [i for i, _ in suspect_trials(balance, solution)]
    return ~np.isin(balance.trial, suspects)


def suspect_trials(balance: Balance, solution: Solution) -> list[tuple[int, float]]:
    """Trials that may be outliers, the worst first, with their robust deviations."""
    z = (balance.observed - solution.at.predicted) / solution.at.sd
    worst = np.zeros(len(balance.touches.size))
    for rows in balance.groups:
        if len(rows) < 5:
            continue
        apart = np.abs(z[rows] - np.median(z[rows]))
        # Standard deviations of a normal distribution for each median distance.
        apart /= max(1.4826 * float(np.median(apart)), 1.0)
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
