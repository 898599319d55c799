"""Update of a belief by trials: guess, touch, update.

The belief is a model's values with their covariance, normal in the `coordinates`:
logarithms of the positive parameters. Trials enter one after the other by an iterated extended
Kalman filter (Gauss and Newton's method on the posterior density; Bell and Cathey 1993). Forces are
compared by their logarithm, in which the products of mass, friction and lever arms are sums.

A model's standard deviation of friction is that of the next slide. Where friction is known to
differ from slide to slide, the relative `spread` tells that part from the mean's own: the mean
is learned, the spread stays.

A push that moved nothing says that the object takes more force than that. The logarithm of the
force that would move it is normal by what is believed, with mean m and standard deviation σ; that
it withstood F leaves the part above log F. Mean and covariance of the belief follow as those of a
normal distribution that is cut off there: with z = (log F − m)/σ and the hazard
λ = φ(z) / (1 − Φ(z)) the mean rises by λσ and the variance falls by the share λ(λ − z).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import erfc, exp, log, pi, sqrt

import numpy as np

from objectmodels.containers.lids import flip_torques
from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.identification.least_squares import damped_step, require_possible
from objectmodels.identification.measurement_model import (
    COM_X,
    FINGER,
    FRICTION,
    LOGARITHMIC,
    MASS,
    RADIUS,
    Balance,
    Linear,
    coordinate_units,
    coordinates_of,
    values_at,
    with_belief,
    with_values,
)
from objectmodels.identification.trial import Moved, Trial
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_model import ObjectModel, Resting
from objectmodels.models.object_parts import FlipLid, LiftOffLid, ScrewCap

SURPRISING = 3.0
"""Standard deviations from which on a trial contradicts what was believed."""

DOUBTED = 0.03
"""Least relative standard deviation of a mass or a friction that is contradicted, however surely it
was stated: no better is it measured in a kitchen."""

_STEPS, _WHOLE = 30, 8  # and after how many they are halved
_SETTLED = 1e-4  # step in standard deviations

_HALVINGS = 6  # of the step of the centre of mass
_WAYS: tuple[Moved, ...] = ("slide", "topple")
_FAR = 30.0  # standard deviations from which on the hazard is taken from its series


@dataclass(frozen=True)
class Update:
    """Belief after a touch.

    Attributes:
        model: the belief with the trials taken in.
        surprise: how far the trials were from what was predicted, in standard deviations of the
            prediction: the root of the normalised innovation squared over the number of figures;
            of a load that was withstood, how far it was above what was believed to resist.
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
    # Measured values, forces by their logarithm.
    observed = np.where(balance.turns, balance.observed, np.log(np.abs(balance.observed)))
    missed = observed - at.predicted
    S = at.jacobian @ P @ at.jacobian.T + np.diag(at.sd**2)
    surprise = sqrt(float(missed @ np.linalg.solve(S, missed)) / len(missed))
    for number in range(_STEPS):
        H = at.jacobian
        gain = kalman_gain(P, H, at.sd**2)
        now = coordinates_of(at.values)
        step = x + gain @ (observed - at.predicted - H @ (x - now)) - now
        if (np.abs(step) <= _SETTLED * np.sqrt(np.diag(P))).all():
            break
        # Far from what was believed steps may swing to and fro; shorter ones settle.
        shorter = step * 0.5 ** (number // _WHOLE)
        at = damped_step(
            balance, at, shorter, lambda values: _logarithmic_predictions(balance, values, spread)
        )
    P = updated_covariance(P, H, at.sd**2, gain)
    P[FRICTION, FRICTION] += spread**2
    per = coordinate_units(at.values)
    believed = with_belief(with_values(model, at.values), P * np.outer(per, per))
    return Update(believed, surprise)


def kalman_gain(P: Array, H: Array, variance: Array) -> Array:
    """Gain P Hᵀ (H P Hᵀ + R)⁻¹ of rows with Jacobian H (r, 7) and variances (r,), shape (7, r)."""
    return np.asarray(P @ H.T @ np.linalg.inv(H @ P @ H.T + np.diag(variance)))


def updated_covariance(P: Array, H: Array, variance: Array, gain: Array) -> Array:
    """Covariance (I − K H) P (I − K H)ᵀ + K R Kᵀ after the rows, shape (7, 7)."""
    keep = np.eye(len(P)) - gain @ H
    return np.asarray(keep @ P @ keep.T + gain @ np.diag(variance) @ gain.T)


def belief_of(model: ObjectModel, spread: float = 0.0) -> Array:
    """Covariance of what is believed, in coordinates and without the spread, shape (7, 7)."""
    per = coordinate_units(model.means)
    P = model.covariance / np.outer(per, per)
    if spread > 0.0 and P[FRICTION, FRICTION] > 0.0:
        # Correlations stay as they are: taking the spread out may not make them impossible.
        share = max(1.0 - spread**2 / P[FRICTION, FRICTION], 1e-4)
        # Variance of the friction if all others were known.
        others = np.arange(len(P)) != FRICTION
        cross = P[FRICTION, others]
        inverse = np.linalg.pinv(P[np.ix_(others, others)], hermitian=True)
        least = (
            float(max(P[FRICTION, FRICTION] - cross @ inverse @ cross, 0.0)) / P[FRICTION, FRICTION]
        )
        P[FRICTION, FRICTION] *= max(share, 1.0 - 0.99 * least)
    return np.asarray(P)


def _logarithmic_predictions(balance: Balance, values: Array, spread: float) -> Linear:
    """`Balance.linear_predictions` with the forces' logarithms, and the spread among the noise."""
    at, turns = balance.linear_predictions(values), balance.turns
    with np.errstate(divide="ignore", invalid="ignore"):
        predicted = np.where(turns, at.predicted, np.log(at.predicted))
        jacobian = np.where(turns[:, None], at.jacobian, at.jacobian / at.predicted[:, None])
    sd = np.where(turns, at.sd, at.sd / np.abs(balance.observed))
    sd = np.hypot(sd, np.where(balance.slides, spread * jacobian[:, FRICTION], 0.0))
    return Linear(values, predicted, jacobian, sd)


def update_without_motion(model: ObjectModel, trial: Trial) -> Update:
    """Belief after a push that moved nothing, with the force of the trial.

    A belief by which the object should have moved was too sure: what the force depends on is
    doubted, and widened, until the trial is no more than just surprising.
    """
    surprise = max(0.0, *(_force_distance(model, trial, moved)[0] for moved in _WAYS))
    for moved in _WAYS:
        model = _belief_above(model, trial, moved)
    return Update(model, surprise)


def doubt_belief(model: ObjectModel) -> ObjectModel:
    """Belief in which neither mass nor friction is surer than `DOUBTED`; correlations stay."""
    deviations = model.deviations
    doubted = np.maximum(deviations, np.where(LOGARITHMIC, DOUBTED * model.means, 0.0))
    if np.array_equal(doubted, deviations):
        return model
    return with_belief(model, model.correlation * np.outer(doubted, doubted))


def widen_belief(model: ObjectModel, surprise: float) -> ObjectModel:
    """Belief widened so far that a trial of that surprise is just surprising.

    Surprises are in standard deviations; below `SURPRISING` nothing changes.
    """
    factor = max(1.0, surprise / SURPRISING) ** 2
    return model if factor == 1.0 else with_belief(model, factor * model.covariance)


def _belief_above(model: ObjectModel, trial: Trial, moved: Moved) -> ObjectModel:
    """Belief if the force of one way to move is above that of the trial."""
    cut, gain, P, share = _force_distance(model, trial, moved)
    if cut > SURPRISING:
        model = doubt_belief(model)
        cut, gain, P, share = _force_distance(model, trial, moved)
    if not np.isfinite(cut):
        return model
    wider = max(1.0, cut / SURPRISING) ** 2
    if wider > 1.0 and share > 0.0:
        # Only what the force depends on is widened: var(hᵀx) + var(noise) by that factor.
        P = P + (wider - 1.0) / share**2 * np.outer(gain, gain)
        gain = gain * (1.0 + (wider - 1.0) / share) / np.sqrt(wider)
        cut = SURPRISING
    hazard = normal_hazard(cut)
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


def _force_distance(
    model: ObjectModel, trial: Trial, moved: Moved
) -> tuple[float, Array, Array, float]:
    """z, the gain P hᵀ / σ, the belief's covariance P in coordinates, and its share hᵀP h / σ²."""
    at = Balance(model, [replace(trial, moved=moved)]).linear_predictions(model.means)
    P, size = belief_of(model), float(np.linalg.norm(trial.force))
    predicted = float(at.predicted[0])
    if not np.isfinite(predicted):
        return -np.inf, np.zeros(len(P)), P, 0.0
    h = at.jacobian[0] / predicted
    believed = float(h @ P @ h)
    sd = sqrt(believed + (float(at.sd[0]) / size) ** 2)
    return (log(size) - log(predicted)) / sd, P @ h / sd, P, believed / sd**2


def normal_hazard(z: float) -> float:
    """λ = φ(z) / (1 − Φ(z))."""
    if z > _FAR:
        # The third term counts: without it λ(λ − z) is above one, and a variance below zero.
        return z + 1.0 / z - 2.0 / z**3
    return exp(-0.5 * z * z) / sqrt(2.0 * pi) / (0.5 * erfc(z / sqrt(2.0)))


# Belief of an object on its bottom from what was learned of it as it lies on another face.
#
# With N the frame of that face and B that of the bottom, p_BC = R_BN p_NC + p_BN for the centre
# of mass C, so that Σ_B = J Σ_N Jᵀ with J = diag(1, 1, 1, 0, R_BN). Mass and coefficients are
# those of the whole object; the friction radius is each face's own.


def standing_belief(rest: Resting, lying: ObjectModel) -> ObjectModel:
    """Belief of an object on its bottom.

    Args:
        rest: how it lies, as it was believed before.
        lying: what is believed of it in N now.

    Raises:
        ModelError: `not_possible` if it would not stand on its bottom.
    """
    standing, J = rest.standing, np.zeros((len(lying.means), len(lying.means)))
    for same in (MASS, FRICTION, FINGER):
        J[same, same] = 1.0
    J[COM_X:, COM_X:] = rest.R_BN
    values, P = J @ lying.means, J @ lying.covariance @ J.T
    values[COM_X:] += rest.p_BN
    values[RADIUS], P[RADIUS, RADIUS] = standing.friction_radius, standing.friction_radius_sd**2
    return with_belief(with_values(standing, values), P)


# Beliefs about what withstood a load: a lid that did not open, a hold that slipped.
#
# Model: what resists is a sum w·x of uncertain quantities x ≥ 0, independent and normal by what
# is believed. That it withstood a load leaves the part of the distribution where w·x is above it.
# With z = (load − w·m)/σ, σ² = Σ (w s)², and the hazard λ of a standard normal distribution at z,
# means m rise by λ w s² / σ and variances s² fall by λ(λ − z) (w s²)² / σ² (as in
# `objectmodels.identification.belief_update`). What withstood more than was thought possible was
# believed too surely: it is widened first, until the load is just surprising.

_DOUBTED = 0.1  # least relative standard deviation of what has withstood more than was believed


def belief_of_stiffer_lid(
    model: ObjectModel, load: float, *, angle: float = 0.0, opens: bool = True
) -> Update:
    """The belief of an object whose lid did not give way.

    Args:
        model: the object with its lid.
        load: force of the fingertip across a flip lid [N], pull [N], or torque about a cap [N·m].
        angle: of a flip lid then [rad].
        opens: whether a flip lid was being opened.
    """
    lid = model.lid
    assert lid is not None, "a lid withstood"
    weights, rest = np.ones(1), 0.0
    match lid:
        case FlipLid():
            names: tuple[str, ...] = ("friction_torque", "snap_torque")
            lever, snap, weight = flip_torques(model, lid, angle)
            weights, rest = np.array([1.0, snap if opens else -snap]), weight if opens else -weight
            load = lever * load
        case LiftOffLid():
            names, rest = ("retention",), lid.mass * GRAVITY
        case ScrewCap():
            names = ("friction_torque",)
    means = np.array([getattr(lid, name) for name in names])
    sds = np.array([getattr(lid, f"{name}_sd") for name in names])
    means, sds, surprise = _above(means, np.maximum(sds, _DOUBTED * means), weights, load - rest)
    values = zip(names, means.tolist(), sds.tolist(), strict=True)
    changed = {key: v for name, m, sd in values for key, v in ((name, m), (f"{name}_sd", sd))}
    return Update(model.model_copy(update={"lid": lid.model_copy(update=changed)}), surprise)


def belief_of_slipperier_object(model: ObjectModel, share: float) -> Update:
    """The belief of an object that slipped through fingers: it is more slippery than that.

    The squeeze was this `share` of the one that just holds by what is believed; the logarithm of
    1/μ lies so much higher at least.
    """
    friction = model.finger_friction
    doubt = np.array([max(model.finger_friction_sd / friction, _DOUBTED)])
    (rise,), (sd,), surprise = _above(np.zeros(1), doubt, np.ones(1), log(share))
    less = float(np.exp(-rise))
    changed = {"finger_friction": less * friction, "finger_friction_sd": less * friction * sd}
    if model.finger_friction_kinetic is not None:
        changed["finger_friction_kinetic"] = less * model.finger_friction_kinetic
    return Update(model.model_copy(update=changed), surprise)


def _above(means: Array, sds: Array, weights: Array, load: float) -> tuple[Array, Array, float]:
    """Means and standard deviations if w·x is above a load, shape (k,), and the surprise."""
    off = load - float(weights @ means)
    surprise = off / float(np.linalg.norm(weights * sds))
    sds = sds * max(1.0, surprise / SURPRISING)
    sigma = float(np.linalg.norm(weights * sds))
    z, gain = off / sigma, weights * sds**2 / sigma
    hazard = normal_hazard(z)
    variances = sds**2 - hazard * (hazard - z) * gain**2
    return means + hazard * gain, np.sqrt(np.maximum(variances, 0.0)), surprise
