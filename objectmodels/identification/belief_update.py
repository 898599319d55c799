"""Update of a belief by trials: guess, touch, update.

The belief is a model's values with their covariance, normal in the `coordinates`:
logarithms of the positive parameters. Trials enter one after the other by an iterated extended
Kalman filter (Gauss and Newton's method on the posterior density; Bell and Cathey 1993). Forces are
compared by their logarithm, in which the products of mass, friction and lever arms are sums.

A model's standard deviation of friction is that of the next slide. Where friction is known to
differ from slide to slide, the relative `spread` tells that part from the mean's own: the mean
is learned, the spread stays.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log, sqrt

import numpy as np

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.mechanical import UNCERTAIN
from objectmodels.identification.least_squares import damped_step, require_possible
from objectmodels.identification.measurement_model import Balance, Linear
from objectmodels.identification.parameter_coordinates import (
    FRICTION,
    LOGARITHMIC,
    coordinate_units,
    coordinates_of,
    with_belief,
    with_values,
)
from objectmodels.identification.trial import Trial
from objectmodels.models.object_model import ObjectModel

SURPRISING = 3.0
"""Standard deviations from which on a trial contradicts what was believed."""

_STEPS, _WHOLE = 30, 8  # and after how many they are halved
_SETTLED = 1e-4  # step in standard deviations


@dataclass(frozen=True)
class Update:
    """Belief after a touch.

    Attributes:
        model: the belief with the trials taken in.
        surprise: how far the trials were from what was predicted, in standard deviations of the
            prediction: the root of the normalised innovation squared over the number of figures.
    """

    model: ObjectModel
    surprise: float

    @property
    def is_contradiction(self) -> bool:
        """Return True if the trials contradict the belief before."""
        return self.surprise > SURPRISING


def initial_belief(
    model: ObjectModel,
    factor: float = 2.0,
    names: Sequence[str] = ("mass", "friction", "finger_friction"),
) -> ObjectModel:
    """Model whose parameters are only guessed.

    Args:
        model: whose values are the guess.
        factor: by which they may be off, one standard deviation.
        names: of the guessed parameters; not `com_x` or `com_y`.

    Raises:
        ModelError: `bad_value` if the factor is not above one or a name is wrong.
    """
    allowed = [name for name, log_ in zip(UNCERTAIN, LOGARITHMIC, strict=True) if log_]
    if not 1.0 < factor < np.inf or any(name not in allowed for name in names):
        raise ModelError(
            "bad_value",
            f"no guess of {', '.join(names)} by a factor of {factor}",
            suggestions=(f"a factor above 1, and names of: {', '.join(allowed)}",),
        )
    known = np.array([name not in names for name in UNCERTAIN])
    covariance = np.where(np.outer(known, known), model.covariance, 0.0)
    guessed = np.where(known, 0.0, log(factor) * model.means)
    return with_belief(model, covariance + np.diag(guessed**2))


def belief_after_trial(
    model: ObjectModel, trial: Trial, *, exact: bool = True, spread: float = 0.0
) -> ObjectModel:
    """Belief after one more trial; see `update_belief`."""
    return update_belief(model, [trial], exact=exact, spread=spread).model


def update_belief(
    model: ObjectModel, trials: Sequence[Trial], *, exact: bool = True, spread: float = 0.0
) -> Update:
    """Return the belief after some trials.

    Args:
        model: the belief before.
        trials: what was felt.
        exact: whether slides are predicted by the exact tier.
        spread: relative standard deviation of friction from slide to slide.

    Raises:
        ModelError: `no_trials`, `bad_trial`; `impossible_trial` if by the belief no force moves
            the object so; `no_fit` if what explains it would not stand.
    """
    balance = Balance(model, trials, exact=exact)
    x, P = coordinates_of(model.means), belief_of(model, spread)
    at = _logarithmic_predictions(balance, model.means, spread)
    require_possible(balance, at)
    observed = _logarithmic_observations(balance)
    missed = observed - at.predicted
    S = at.jacobian @ P @ at.jacobian.T + np.diag(at.sd**2)
    surprise = sqrt(float(missed @ np.linalg.solve(S, missed)) / len(missed))
    for number in range(_STEPS):
        H = at.jacobian
        gain = P @ H.T @ np.linalg.inv(H @ P @ H.T + np.diag(at.sd**2))
        now = coordinates_of(at.values)
        step = x + gain @ (observed - at.predicted - H @ (x - now)) - now
        if (np.abs(step) <= _SETTLED * np.sqrt(np.diag(P))).all():
            break
        # Far from what was believed steps may swing to and fro; shorter ones settle.
        shorter = step * 0.5 ** (number // _WHOLE)
        at = damped_step(
            balance, at, shorter, lambda values: _logarithmic_predictions(balance, values, spread)
        )
    keep = np.eye(len(x)) - gain @ H
    P = keep @ P @ keep.T + gain @ np.diag(at.sd**2) @ gain.T
    P[FRICTION, FRICTION] += spread**2
    per = coordinate_units(at.values)
    believed = with_belief(with_values(model, at.values), P * np.outer(per, per))
    return Update(believed, surprise)


def belief_of(model: ObjectModel, spread: float = 0.0) -> Array:
    """Covariance of what is believed, in coordinates and without the spread, shape (7, 7)."""
    per = coordinate_units(model.means)
    P = model.covariance / np.outer(per, per)
    if spread > 0.0 and P[FRICTION, FRICTION] > 0.0:
        # Correlations stay as they are: taking the spread out may not make them impossible.
        share = max(1.0 - spread**2 / P[FRICTION, FRICTION], 1e-4)
        least = _given_others(P) / P[FRICTION, FRICTION]
        P[FRICTION, FRICTION] *= max(share, 1.0 - 0.99 * least)
    return np.asarray(P)


def _given_others(P: Array) -> float:
    """Variance of the friction if all others were known."""
    others = np.arange(len(P)) != FRICTION
    cross = P[FRICTION, others]
    inverse = np.linalg.pinv(P[np.ix_(others, others)], hermitian=True)
    return float(max(P[FRICTION, FRICTION] - cross @ inverse @ cross, 0.0))


def _logarithmic_observations(balance: Balance) -> Array:
    """Measured values, forces by their logarithm."""
    return np.where(balance.turns, balance.observed, np.log(np.abs(balance.observed)))


def _logarithmic_predictions(balance: Balance, values: Array, spread: float) -> Linear:
    """`Balance.linear_predictions` with the forces' logarithms, and the spread among the noise."""
    at, turns = balance.linear_predictions(values), balance.turns
    with np.errstate(divide="ignore", invalid="ignore"):
        predicted = np.where(turns, at.predicted, np.log(at.predicted))
        jacobian = np.where(turns[:, None], at.jacobian, at.jacobian / at.predicted[:, None])
    sd = np.where(turns, at.sd, at.sd / np.abs(balance.observed))
    sd = np.hypot(sd, np.where(balance.slides, spread * jacobian[:, FRICTION], 0.0))
    return Linear(values, predicted, jacobian, sd)
