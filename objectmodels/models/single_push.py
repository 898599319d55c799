"""A single push as plain numbers: calls of numpy to check and turn it take longer than they do.

What is not plain, such as what is to be refused, is left to those who look at arrays.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import TYPE_CHECKING, TypeGuard

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.vector_arrays import UNIT
from objectmodels.mechanics.push_outcomes import Prediction, Thresholds, closed_form_thresholds

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import Friction, PushedBody

_TINY = float(np.finfo(float).tiny)


def single_thresholds(
    model: PushedBody, points: ArrayLike, directions: ArrayLike, friction: Friction
) -> Thresholds | None:
    """Thresholds of one push by the closed form; None if arrays are to be looked at.

    Args:
        model: what is believed.
        points: contact p_BC, shape (1, 3) [m].
        directions: unit direction of the force in B, shape (1, 3).
        friction: which coefficient at the table decides.
    """
    if not (_is_on(points, model) and _is_single(directions)):
        return None
    is_unit = abs(_size(directions) - 1.0) <= UNIT
    return closed_form_thresholds(model, points, directions, friction) if is_unit else None


def single_prediction(
    model: PushedBody, points: ArrayLike, forces: ArrayLike, friction: Friction
) -> Prediction | None:
    """Outcome of one push with a force, shape (1, 3) [N]; None as for `single_thresholds`."""
    if not (_is_on(points, model) and _is_single(forces)):
        return None
    size = _size(forces)
    if not size < inf:
        return None
    u = forces / max(size, _TINY)
    return Prediction(np.array([size]), closed_form_thresholds(model, points, u, friction))


def _is_single(vectors: ArrayLike) -> TypeGuard[Array]:
    """Return True for an array of one vector."""
    return isinstance(vectors, np.ndarray) and vectors.shape == (1, 3) and vectors.dtype == float


def _is_on(points: ArrayLike, model: PushedBody) -> TypeGuard[Array]:
    """Return True for one contact on a model."""
    if not _is_single(points):
        return False
    ((x, y, z),) = points.tolist()
    low, high = (corner.tolist() for corner in model.contact_room)
    return bool(low[0] <= x <= high[0] and low[1] <= y <= high[1] and low[2] <= z <= high[2])


def _size(vectors: Array) -> float:
    ((x, y, z),) = vectors.tolist()
    return sqrt(x * x + y * y + z * z)
