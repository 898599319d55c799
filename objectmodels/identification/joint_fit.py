"""Joint fit of an object's parameters to all trials, by prediction error.

The parameters make the models' own thresholds fit what was felt, each row weighted by its noise
(`least_squares`); slides by the exact tier, on the support that explains them best
(`support_choice`). Trials that the others contradict are left out (`outlying_trials`).

The scale of the force sensor cannot be seen from inside: a common factor of all forces goes into
the mass alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import exp

import numpy as np

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.geometry.support_points import Support
from objectmodels.html_table import html_table
from objectmodels.identification.belief_update import belief_of
from objectmodels.identification.identifiability import identifiable_parameters
from objectmodels.identification.least_squares import (
    Solution,
    require_possible,
    solve_least_squares,
)
from objectmodels.identification.measurement_model import Balance
from objectmodels.identification.outlying_trials import solution_without_outliers
from objectmodels.identification.parameter_coordinates import (
    FRICTION,
    LOGARITHMIC,
    coordinate_units,
    correlation_of,
    with_belief,
    with_values,
)
from objectmodels.identification.support_choice import best_support
from objectmodels.identification.trial import Trial
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.parameters import Provenance

TOLD_SPREAD = 0.005
"""Spread of the friction from which on it is told."""


@dataclass(frozen=True)
class Fit:
    """A fitted model and how well it is known.

    Attributes:
        model: the model with the values found; its standard deviations say what to expect of the
            next trial, so that of the friction includes the spread.
        found: names of the parameters that were sought.
        values: all parameters, those kept included.
        deviations: standard deviations of the values.
        correlation: of the values, in the order of `UNCERTAIN`, shape (7, 7).
        spread: relative standard deviation of the friction from slide to slide.
        noise: factor by which the stated standard deviations were too small, 1 if they stand.
        residuals: measured minus predicted, in standard deviations of the row, by trial; a slide
            with a turn rate has two.
        rms: root mean square of the relative errors of the predicted forces of the trials kept.
        dropped: trials left out, by source, with the reason.
        notes: what a reader should know, in sentences.
    """

    model: ObjectModel
    found: tuple[str, ...]
    values: Mapping[str, float]
    deviations: Mapping[str, float]
    correlation: Array
    spread: float
    noise: float
    residuals: tuple[tuple[float, ...], ...]
    rms: float
    dropped: Mapping[str, str]
    notes: tuple[str, ...]
    _solution: Solution = field(repr=False)

    def _repr_html_(self) -> str:
        sd = self.deviations
        rows = [(name, f"{self.values[name]:.4g}", f"{sd[name]:.2g}") for name in self.found]
        caption = f"{self.model.name}: forces predicted within {100.0 * self.rms:.1f} %"
        return html_table(caption, ("found", "value [SI]", "± standard deviation"), rows)

    def interval(self, name: str, level: float = 0.95) -> tuple[float, float]:
        """Interval in which a parameter lies with some probability.

        Args:
            name: of the parameter, one of `UNCERTAIN`.
            level: the probability.

        Raises:
            ModelError: `bad_value` if there is no such parameter or probability.
        """
        if name not in UNCERTAIN or not 0.0 < level < 1.0:
            raise ModelError(
                "bad_value",
                f"no interval of {name!r} at the level {level}",
                suggestions=(f"a level between 0 and 1, and one of: {', '.join(UNCERTAIN)}",),
            )
        k, s = UNCERTAIN.index(name), self._solution
        half = _interval_quantile(level, _degrees_of_freedom(s, k)) * float(
            np.sqrt(s.covariance[k, k])
        )
        value = self.values[name]
        if LOGARITHMIC[k]:
            return value * exp(-half), value * exp(half)
        return value - half, value + half


def fit(
    model: ObjectModel,
    trials: Sequence[Trial],
    *,
    parameters: Sequence[str] | None = None,
    prior: bool = False,
    exact: bool = True,
    supports: Sequence[Support] | None = None,
) -> Fit:
    """Fits a model's parameters to trials.

    Args:
        model: what is believed: its shape, and the values of what is not found.
        trials: what was felt.
        parameters: names of those to find, of `UNCERTAIN`; if not given, all that the trials
            identify by themselves. What is kept adds its standard deviation to those found.
        prior: whether the model's beliefs count as measurements. The parameters are then all that
            are wanted and uncertain, and nothing is refused.
        exact: whether slides are predicted by the exact tier.
        supports: that are tried; the model's own first, then `uniform` and `corners`.

    Raises:
        ModelError: `not_identifiable` with the experiments that are missing; `no_trials`,
            `bad_trial`, `impossible_trial`; `no_fit` or `not_possible` if the trials make no sense.
    """
    coarse = Balance(model, trials)
    belief = belief_of(model)
    notes: list[str] = []
    if prior:
        wanted = UNCERTAIN if parameters is None else parameters
        free = np.array([name in wanted for name in UNCERTAIN]) & (np.diag(belief) > 0.0)
    else:
        start = coarse.linear_predictions(model.means)
        require_possible(coarse, start)
        free, lost = identifiable_parameters(coarse, start, belief, parameters)
        notes += [f"{m.name} is kept as believed: {m.reason}" for m in lost]
    first = solve_least_squares(coarse, model.means, free, belief, prior=prior)
    chosen, balance, doubt, told = best_support(
        model, trials, first, belief, prior, exact, supports
    )
    notes += told
    solution, dropped = solution_without_outliers(balance, chosen, belief, prior)
    solution = replace(solution, covariance=solution.covariance + doubt)
    return _fit_from(balance, solution, dropped, notes)


def _fit_from(
    balance: Balance, solution: Solution, dropped: Mapping[int, float], notes: list[str]
) -> Fit:
    values, sources = solution.values, balance.touches.sources
    per = coordinate_units(values)
    covariance = solution.covariance * np.outer(per, per)
    sd = np.sqrt(np.diag(covariance))
    z = (balance.observed - solution.at.predicted) / np.sqrt(solution.variance)
    forces = ~balance.turns & solution.rows
    relative = (balance.observed - solution.at.predicted)[forces] / balance.observed[forces]
    found = tuple(name for name, free in zip(UNCERTAIN, solution.free, strict=True) if free)
    if solution.noise > 1.0:
        notes.append(
            f"the residuals are {solution.noise:.1f} times as large as stated; "
            "the standard deviations are scaled by that"
        )
    if solution.spread >= TOLD_SPREAD:
        notes.append(f"the friction differs by {solution.spread:.1%} from slide to slide")
    return Fit(
        model=_fitted_model(balance, solution, covariance, found),
        found=found,
        values=dict(zip(UNCERTAIN, values.tolist(), strict=True)),
        deviations=dict(zip(UNCERTAIN, sd.tolist(), strict=True)),
        correlation=correlation_of(covariance),
        spread=solution.spread,
        noise=solution.noise,
        residuals=tuple(tuple(z[balance.trial == i].tolist()) for i in range(len(sources))),
        rms=float(np.sqrt(np.mean(relative**2))),
        dropped={
            sources[i]: f"{far:.1f} standard deviations from what the others predict"
            for i, far in dropped.items()
        },
        notes=tuple(notes),
        _solution=solution,
    )


def _fitted_model(
    balance: Balance, solution: Solution, covariance: Array, found: tuple[str, ...]
) -> ObjectModel:
    """Model with the values found; the next slide's friction differs from the mean."""
    covariance = covariance.copy()
    covariance[FRICTION, FRICTION] += (solution.spread * solution.values[FRICTION]) ** 2
    fitted = with_belief(with_values(balance.model, solution.values), covariance)
    provenance = Provenance(
        source="found by touching it",
        method=f"joint fit of {', '.join(found)}",
        trials=len(np.unique(balance.trial[solution.rows])),
    )
    return fitted.model_copy(update={"provenance": provenance})


def _degrees_of_freedom(solution: Solution, k: int) -> float:
    """Degrees of freedom behind the standard deviation of parameter k.

    Those of the spread count by the share that it has in the variance (Satterthwaite 1946).
    """
    freedom = solution.noise_freedom
    variance = solution.covariance[k, k]
    if solution.spread > 0.0 and variance > 0.0:
        rows = solution.rows
        J = solution.at.jacobian[rows]
        gain = solution.own @ (J.T / solution.variance[rows])
        slides = np.where(solution.slides[rows], J[:, FRICTION], 0.0)
        share = float((gain[k] ** 2 * (solution.spread * slides) ** 2).sum() / variance)
        if share > 1e-6:
            freedom = min(freedom, solution.spread_freedom / share**2)
    return freedom


def _interval_quantile(level: float, freedom: float) -> float:
    """Half-width of an interval in standard deviations: Student's t, or normal."""
    from scipy.special import ndtri, stdtrit

    p = 0.5 + level / 2.0
    return float(ndtri(p)) if np.isinf(freedom) else float(stdtrit(freedom, p))
