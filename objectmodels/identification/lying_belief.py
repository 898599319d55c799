"""Belief of an object on its bottom from what was learned of it as it lies on another face.

With N the frame of that face and B that of the bottom, p_BC = R_BN p_NC + p_BN for the centre of
mass C, so that Σ_B = J Σ_N Jᵀ with J = diag(1, 1, 1, 0, R_BN). Mass and coefficients are those of
the whole object; the friction radius is each face's own.
"""

from __future__ import annotations

import numpy as np

from objectmodels.identification.parameter_coordinates import (
    COM_X,
    FINGER,
    FRICTION,
    MASS,
    RADIUS,
    with_belief,
    with_values,
)
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.resting_face import Resting


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
