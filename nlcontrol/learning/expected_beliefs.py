"""What would be believed once parameters were found out: as now on average, and known better."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.learning.exploration_session import precisions_asked
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.identification.experiment_design import parameter_precisions
from objectmodels.identification.measurement_model import with_belief

if TYPE_CHECKING:
    from objectmodels import ObjectModel


def expected_belief(model: ObjectModel, parameters: Sequence[str], precision: float) -> ObjectModel:
    """The model with some parameters known to a precision.

    Args:
        model: what is believed now.
        parameters: that are found out, names of `UNCERTAIN`.
        precision: relative standard deviation; of the centre of mass, as a share of the base's
            size.
    """
    known, asked = parameter_precisions(model), precisions_asked(model, parameters, precision)
    shares = [
        min(1.0, asked.get(name, np.inf) / known[name]) if known[name] > 0.0 else 1.0
        for name in UNCERTAIN
    ]
    return with_belief(model, np.outer(shares, shares) * model.covariance)
