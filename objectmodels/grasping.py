"""What squeeze holds an object between a thumb and the fingers opposite.

Model: a grip presses on two upright sides at points that bear fixed shares of the squeeze F, the
thumb all of it and the fingers all of it together. The load (weight times 1 + acceleration, at the
centre of mass) lies in the plane across the closing direction, and Coulomb friction resists it
there: the planar friction limit (`objectmodels.limit`) of points with these loads. It holds up to

    (1 + a) G = 2 μ F ρ,    ρ = min Σ N_i |v_i| / Σ N_i

with ρ = 1 if the load goes through the middle of the contacts, less if it turns the object. Once a
contact creeps the kinetic coefficient counts, so that is μ wherever it is known.

Frame: B of the object.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.base import Array
from objectmodels.limit import friction_limit
from objectmodels.model import ObjectModel
from objectmodels.thresholds import GRAVITY

ACCELERATION = 0.1
"""Of a load that is lifted and carried slowly, with what makes it tremble, as a share of g."""

_LEAST_FRICTION = 0.05
_NODES = np.array([NormalDist().inv_cdf((i + 0.5) / 9) for i in range(9)])


@dataclass(frozen=True)
class Load:
    """What a grip must bear.

    Attributes:
        force: downwards [N].
        force_sd: its standard deviation [N].
        at: where, in B [m].
        at_sd: its standard deviation along each axis [m].
    """

    force: float
    force_sd: float
    at: tuple[float, float, float]
    at_sd: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @classmethod
    def of(cls, model: ObjectModel) -> Load:
        """The weight of an object, at its centre of mass."""
        return cls(model.weight, model.mass_sd * GRAVITY, model.com, model.com_sd)

    @classmethod
    def of_part(cls, mass: float, at: tuple[float, float, float]) -> Load:
        """The weight of a part, whose middle is known [kg, m]."""
        return cls(mass * GRAVITY, 0.0, at)


def friction(model: ObjectModel) -> float:
    """The coefficient at the fingers that a hold relies on."""
    kinetic = model.finger_friction_kinetic
    return model.finger_friction if kinetic is None else kinetic


def squeeze_needed(
    model: ObjectModel,
    p_BG: ArrayLike,
    closing: ArrayLike,
    approach: ArrayLike,
    contacts: ArrayLike,
    shares: ArrayLike,
    *,
    load: Load | None = None,
    sigmas: float = 0.0,
) -> Array:
    """Least squeezes that hold a load, shape (n,) [N].

    Args:
        model: what is held, or whose part is.
        p_BG: middles of the grips, shape (n, 3) [m].
        closing: unit directions from the fingers' side to the thumb's, shape (n, 3).
        approach: unit directions of the straight fingers, shape (n, 3).
        contacts: along the approach and along approach × closing from the middle, (k, 2) [m].
        shares: of the squeeze that each contact bears, shape (k,).
        load: what is borne; the object's weight if not given.
        sigmas: standard deviations that the worst case takes: of weight and friction together,
            and of where the weight is.
    """
    load = Load.of(model) if load is None else load
    mu = friction(model)
    share = np.hypot(load.force_sd / load.force, model.finger_friction_sd / mu)
    shifts = np.array([0.0]) if sigmas == 0.0 else np.array([-sigmas, 0.0, sigmas])
    lever = np.min([_level(p_BG, closing, approach, contacts, shares, load, s) for s in shifts], 0)
    return np.asarray((1.0 + sigmas * share) * _force(load.force) / (2.0 * mu * lever))


def holding(
    model: ObjectModel,
    p_BG: ArrayLike,
    closing: ArrayLike,
    approach: ArrayLike,
    contacts: ArrayLike,
    shares: ArrayLike,
    squeeze: ArrayLike,
    *,
    load: Load | None = None,
) -> Array:
    """Probability that squeezes hold, shape (n,); other arguments as in `squeeze_needed`."""
    load = Load.of(model) if load is None else load
    force = _force(load.force + load.force_sd * _NODES)
    mu = np.maximum(friction(model) + model.finger_friction_sd * _NODES, _LEAST_FRICTION)
    levers = np.array([_level(p_BG, closing, approach, contacts, shares, load, s) for s in _NODES])
    held = (
        2.0
        * np.asarray(squeeze, float)[:, None, None, None]
        * (mu[:, None] * levers.T[:, :, None, None])
    )
    return np.asarray((held >= force).mean(axis=(1, 2, 3)))


def _force(weight: ArrayLike) -> Array:
    return np.asarray((1.0 + ACCELERATION) * np.maximum(weight, 0.0))


def _level(
    p_BG: ArrayLike,
    closing: ArrayLike,
    approach: ArrayLike,
    contacts: ArrayLike,
    shares: ArrayLike,
    load: Load,
    sigmas: float,
) -> Array:
    """ρ with the load so many standard deviations beside its place, shape (n,)."""
    p, c, a = (np.atleast_2d(np.asarray(v, float)) for v in (p_BG, closing, approach))
    if not np.ptp(np.asarray(contacts, float), axis=0).any():
        return np.ones(len(p))  # it hangs in a pinch, and turns until its weight is below
    beside = np.cross(np.array([0.0, 0.0, 1.0]), c)  # level, in the plane of the contacts
    d, n = np.asarray(contacts, float), len(p)
    offsets = d[:, 0, None, None] * a + d[:, 1, None, None] * np.cross(a, c)
    at = np.array(load.at) + sigmas * beside * np.array(load.at_sd)
    left = ((offsets + p - at) * beside).sum(axis=-1)
    along = -(offsets[..., 2] + p[:, 2])
    loads = np.asarray(shares, float)
    weights = np.broadcast_to((loads / loads.sum())[:, None], (len(loads), n))
    return np.asarray(friction_limit(weights.copy(), along, left).ratio)
