"""Finding an object's parameters from what touches of it showed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from objectmodels.lazy_names import lazy_names

if TYPE_CHECKING:
    from objectmodels.identification.belief_update import Update, guess, update, updated
    from objectmodels.identification.closed_form_estimates import (
        Estimates,
        estimates,
        estimates_by_repetition,
        table,
    )
    from objectmodels.identification.experiment_design import (
        Candidate,
        Worth,
        precisions,
        ranked,
        reached,
    )
    from objectmodels.identification.joint_fit import Fit, fit
    from objectmodels.identification.onset_detection import Onset, detect_onset
    from objectmodels.identification.parameter_statistics import Statistics
    from objectmodels.identification.trial import Moved, Trial

__all__ = [
    "Candidate",
    "Estimates",
    "Fit",
    "Moved",
    "Onset",
    "Statistics",
    "Trial",
    "Update",
    "Worth",
    "detect_onset",
    "estimates",
    "estimates_by_repetition",
    "fit",
    "guess",
    "precisions",
    "ranked",
    "reached",
    "table",
    "update",
    "updated",
]

_HOMES = {
    "Candidate": "objectmodels.identification.experiment_design",
    "Estimates": "objectmodels.identification.closed_form_estimates",
    "Fit": "objectmodels.identification.joint_fit",
    "Moved": "objectmodels.identification.trial",
    "Onset": "objectmodels.identification.onset_detection",
    "Statistics": "objectmodels.identification.parameter_statistics",
    "Trial": "objectmodels.identification.trial",
    "Update": "objectmodels.identification.belief_update",
    "Worth": "objectmodels.identification.experiment_design",
    "detect_onset": "objectmodels.identification.onset_detection",
    "estimates": "objectmodels.identification.closed_form_estimates",
    "estimates_by_repetition": "objectmodels.identification.closed_form_estimates",
    "fit": "objectmodels.identification.joint_fit",
    "guess": "objectmodels.identification.belief_update",
    "precisions": "objectmodels.identification.experiment_design",
    "ranked": "objectmodels.identification.experiment_design",
    "reached": "objectmodels.identification.experiment_design",
    "table": "objectmodels.identification.closed_form_estimates",
    "update": "objectmodels.identification.belief_update",
    "updated": "objectmodels.identification.belief_update",
}

__getattr__ = lazy_names(__name__, _HOMES)
