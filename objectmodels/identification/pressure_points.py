"""Points that carry an object, found from how it moved under known pushes.

Model: a point of load N_i resists along its slip ŝ_i with μ N_i, whatever the others do. So the
friction of a motion that was seen is linear in the loads. It balances the push F felt at p:

    Σ N_i (ŝ_i, [x_i × ŝ_i]_z) = (F, [(p − c) × F]_z) / μ,    Σ N_i x_i = 0

with places x_i from the centre of mass c. Loads that are not negative solve this for many places at
once by least squares, and few of them carry (Lawson and Hanson 1974); neighbours among these stand
for one foot between them. A push that is high up shifts the loads, which is left out here.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.support_points import (
    SupportPoint,
    carrying_base,
    friction_radius,
    is_within,
    mean_distance,
    support_points,
)
from objectmodels.geometry.vector_arrays import cross, dot, left_of
from objectmodels.identification.trial import Trial
from objectmodels.models.object_model import ObjectModel

LEAST_TRIALS = 12
"""Slides of known motion from which on carrying points are sought; each has three figures."""

_NOISE = 0.02  # of a motion, as a share of it: how well the direction of a slow slip is known
_BALANCED = 10.0  # weight of the balance about the centre of mass, of that of a trial
_NEIGHBOURS = 0.5  # distance of places that stand for one foot, of that of all from their middle
_CARRIES = 0.02  # least share of the load that counts


def pressure_points(model: ObjectModel, trials: Sequence[Trial]) -> tuple[SupportPoint, ...] | None:
    """Few points (x, y, weight) that explain slides of known motion; None if there are too few.

    The model gives the footprint and the centre of mass.
    """
    known = [
        t for t in trials if t.moved == "slide" and t.turn_rate is not None and t.drift is not None
    ]
    if len(known) < LEAST_TRIALS:
        return None
    c, radius = np.array(model.com[:2]), friction_radius("uniform", model.footprint)
    places = support_points("uniform", model.footprint)[0] - c
    loads = _carried_loads(known, model.weight, c, places, radius)
    apart = _NEIGHBOURS * mean_distance(places, loads / loads.sum())
    points, share = _merged_neighbours(places, loads, apart)
    found = tuple(
        (float(x), float(y), float(w)) for (x, y), w in zip(points + c, share, strict=True)
    )
    try:
        stands = is_within(carrying_base(found, model.footprint), c[None], -1e-6 * radius)
    except ModelError:  # the points are on a line
        return None
    return found if stands else None


def _carried_loads(
    trials: Sequence[Trial], weight: float, c: Array, places: Array, radius: float
) -> Array:
    """Loads at places (k, 2) from the centre of mass, in any unit, shape (k,)."""
    from scipy.optimize import nnls  # takes a while to import

    force = np.array([t.force for t in trials])
    push = force[:, :2] / (weight - force[:, 2:])
    size = np.hypot(*push.T)
    r = np.array([t.point[:2] for t in trials]) - c
    u = push / size[:, None]
    turn = np.array([t.turn_rate for t in trials], dtype=np.float64)
    drift = np.array([t.drift for t in trials], dtype=np.float64)
    v = u + drift[:, None] * left_of(u) - turn[:, None] * left_of(r)
    speed = np.sqrt(dot(v, v) + (radius * turn) ** 2)
    slip = (v[:, None] + turn[:, None, None] * left_of(places)) / speed[:, None, None]
    slip /= np.sqrt(dot(slip, slip) + _NOISE**2)[..., None]
    balance = _BALANCED * np.sqrt(len(trials)) * places.T
    A = np.vstack((slip[..., 0], slip[..., 1], cross(places, slip) / radius, balance / radius))
    b = np.concatenate((push[:, 0], push[:, 1], cross(r, push) / radius, np.zeros(2)))
    loads, _ = nnls(A, b / size.mean())
    return np.asarray(loads)


def _merged_neighbours(places: Array, loads: Array, apart: float) -> tuple[Array, Array]:
    """Middles (k, 2) of places that carry and lie within a distance, and their shares (k,)."""
    from scipy.cluster.hierarchy import fclusterdata

    carry = loads > 1e-6 * loads.sum()
    places, loads = places[carry], loads[carry]
    group = np.zeros(len(loads), dtype=np.intp)
    if len(loads) > 1:
        group += fclusterdata(places, apart, criterion="distance", method="average") - 1
    share = np.bincount(group, weights=loads)
    middle = np.column_stack([np.bincount(group, weights=loads * x) / share for x in places.T])
    keep = share > _CARRIES * share.sum()
    return middle[keep], share[keep] / share[keep].sum()
