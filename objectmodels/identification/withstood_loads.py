"""Beliefs about what withstood a load: a lid that did not open, a hold that slipped.

Model: what resists is a sum w·x of uncertain quantities x ≥ 0, independent and normal by what is
believed. That it withstood a load leaves the part of the distribution where w·x is above it. With
z = (load − w·m)/σ, σ² = Σ (w s)², and the hazard λ of a standard normal distribution at z, means m
rise by λ w s² / σ and variances s² fall by λ(λ − z) (w s²)² / σ² (as in
`objectmodels.identification.belief_update`). What withstood more than was thought possible was
believed too surely: it is widened first, until the load is just surprising.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log

import numpy as np

from objectmodels.containers.lid_forces import flip_torques
from objectmodels.geometry.base_shapes import Array
from objectmodels.identification.belief_update import SURPRISING, normal_hazard
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.object_parts import FlipLid, LiftOffLid, ScrewCap

_DOUBTED = 0.1  # least relative standard deviation of what has withstood more than was believed


@dataclass(frozen=True)
class RevisedBelief:
    """Belief after something withstood a load.

    Attributes:
        model: the belief.
        surprise: how far the load was above what was believed to resist, in standard deviations.
    """

    model: ObjectModel
    surprise: float


def belief_of_stiffer_lid(
    model: ObjectModel, load: float, *, angle: float = 0.0, opens: bool = True
) -> RevisedBelief:
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
    return RevisedBelief(model.model_copy(update={"lid": lid.model_copy(update=changed)}), surprise)


def belief_of_slipperier_object(model: ObjectModel, share: float) -> RevisedBelief:
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
    return RevisedBelief(model.model_copy(update=changed), surprise)


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
