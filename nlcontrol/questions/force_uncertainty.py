"""How well the forces that move an object are known.

Model: a threshold is taken as linear in the uncertain parameters over one standard deviation, so
its variance is dᵀ C d with C the correlations of the parameters and d_i half the difference of the
threshold at ±1 standard deviation of parameter i (closed form). Frame B.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.mechanical import UNCERTAIN
from objectmodels.mechanics.outcome_probability import SMALLEST_SHARE

if TYPE_CHECKING:
    from objectmodels import ObjectModel

Array = NDArray[np.float64]

CERTAIN = 1.959964
"""Standard deviations to either side that hold 95 % of a normal distribution."""


def deviations(model: ObjectModel, p: Array, u: Array) -> tuple[float | None, float | None]:
    """Standard deviations of the forces that slide and that topple an object [N].

    Args:
        model: what is believed.
        p: contact point in B, shape (3,) [m].
        u: unit direction of the force in B, shape (3,).

    Returns:
        Of sliding and of toppling; None for what does not happen all over the parameters' range.
    """
    d = np.zeros((2, len(UNCERTAIN)))
    for i in np.flatnonzero(model.deviations):
        low, high = (_thresholds(_shifted_pair(model, int(i), sign), p, u) for sign in (-1.0, 1.0))
        with np.errstate(invalid="ignore"):
            d[:, i] = (high - low) / 2.0
    slide, topple = (_root(row, model.correlation) for row in d)
    never = np.isinf(_thresholds(model, p, u))
    return None if never[0] else slide, None if never[1] else topple


def _root(d: Array, correlation: Array) -> float | None:
    """The root of dᵀ C d."""
    return float(np.sqrt(max(float(d @ correlation @ d), 0.0))) if np.isfinite(d).all() else None


def _thresholds(model: ObjectModel, p: Array, u: Array) -> Array:
    """Forces that slide and that topple it, shape (2,) [N]."""
    t = model.thresholds(p[None], u[None])
    return np.array([t.slide[0], t.topple[0]])


def _shifted_pair(model: ObjectModel, i: int, sign: float) -> ObjectModel:
    """The model with its i-th uncertain parameter one standard deviation off."""
    value = float(model.means[i] + sign * model.deviations[i])
    name = UNCERTAIN[i]
    if name.startswith("com_"):
        com = list(model.com)
        com["xyz".index(name[-1])] = value
        return model.model_copy(update={"com": tuple(com)})
    # A coefficient, a mass or a radius below zero means nothing.
    return model.model_copy(update={name: max(value, SMALLEST_SHARE * float(model.means[i]))})
