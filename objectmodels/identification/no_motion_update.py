"""Update of a belief by a push that moved nothing: the object takes more force than that.

The logarithm of the force that would move it is normal by what is believed, with mean m and
standard deviation σ; that it withstood F leaves the part above log F. Mean and covariance of the
belief follow as those of a normal distribution that is cut off there: with z = (log F − m)/σ and
the hazard λ = φ(z) / (1 − Φ(z)) the mean rises by λσ and the variance falls by the share λ(λ − z).
"""

from __future__ import annotations

from dataclasses import replace
from math import erfc, exp, log, pi, sqrt

import numpy as np

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.identification.belief_update import SURPRISING, Update, belief_of
from objectmodels.identification.measurement_model import Balance
from objectmodels.identification.parameter_coordinates import (
    COM_X,
    coordinate_units,
    coordinates_of,
    values_at,
    with_belief,
    with_values,
)
from objectmodels.identification.trial import Moved, Trial
from objectmodels.models.object_model import ObjectModel

_HALVINGS = 6  # of the step of the centre of mass
_WAYS: tuple[Moved, ...] = ("slide", "topple")
_FAR = 6.0  # standard deviations from which on the hazard is taken from its asymptote


def update_without_motion(model: ObjectModel, trial: Trial) -> Update:
    """Belief after a push that moved nothing.

    A belief by which the object should have moved was too sure: its covariance is widened first,
    until the trial is no more than just surprising.

    Args:
        model: the belief before.
        trial: the force that moved nothing.
    """
    surprise = max(0.0, *(_force_distance(model, trial, moved)[0] for moved in _WAYS))
    for moved in _WAYS:
        model = _belief_above(model, trial, moved)
    return Update(model, surprise)


def widen_belief(model: ObjectModel, surprise: float) -> ObjectModel:
    """Belief widened so far that a trial of that surprise is just surprising.

    Args:
        model: the belief.
        surprise: of a trial, in standard deviations; below `SURPRISING` nothing changes.
    """
    factor = max(1.0, surprise / SURPRISING) ** 2
    return model if factor == 1.0 else with_belief(model, factor * model.covariance)


def _belief_above(model: ObjectModel, trial: Trial, moved: Moved) -> ObjectModel:
    """Belief if the force of one way to move is above that of the trial."""
    z, *_ = _force_distance(model, trial, moved)
    model = widen_belief(model, z)
    cut, gain, P = _force_distance(model, trial, moved)
    if not np.isfinite(cut):
        return model
    hazard = _normal_hazard(cut)
    raised = _shift_while_standing(model, hazard * gain)
    P = P - hazard * (hazard - cut) * np.outer(gain, gain)
    per = coordinate_units(raised.means)
    return with_belief(raised, P * np.outer(per, per))


def _shift_while_standing(model: ObjectModel, step: Array) -> ObjectModel:
    """The model after a step, of which the centre of mass goes as far as the object stands."""
    x, place = coordinates_of(model.means), np.arange(len(step)) >= COM_X
    for number in range(_HALVINGS):
        try:
            return with_values(model, values_at(x + np.where(place, 0.5**number, 1.0) * step))
        except ModelError:
            continue
    return with_values(model, values_at(x + np.where(place, 0.0, step)))


def _force_distance(model: ObjectModel, trial: Trial, moved: Moved) -> tuple[float, Array, Array]:
    """z, the gain P hᵀ / σ, and the belief's covariance P in coordinates."""
    at = Balance(model, [replace(trial, moved=moved)]).linear_predictions(model.means)
    P, size = belief_of(model), float(np.linalg.norm(trial.force))
    predicted = float(at.predicted[0])
    if not np.isfinite(predicted):
        return -np.inf, np.zeros(len(P)), P
    h = at.jacobian[0] / predicted
    sd = sqrt(float(h @ P @ h) + (float(at.sd[0]) / size) ** 2)
    return (log(size) - log(predicted)) / sd, P @ h / sd, P


def _normal_hazard(z: float) -> float:
    """λ = φ(z) / (1 − Φ(z))."""
    if z > _FAR:
        return z + 1.0 / z
    return exp(-0.5 * z * z) / sqrt(2.0 * pi) / (0.5 * erfc(z / sqrt(2.0)))
