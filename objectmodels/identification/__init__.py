"""Finding an object's parameters from what touches of it showed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from objectmodels.lazy_names import lazy_names

if TYPE_CHECKING:
    from objectmodels.identification.belief_update import (
        Update,
        belief_after_trial,
        initial_belief,
        update_belief,
    )
    from objectmodels.identification.closed_form_estimates import (
        Estimates,
        estimates_by_repetition,
        estimates_from_trials,
        repetition_table,
    )
    from objectmodels.identification.experiment_design import (
        Candidate,
        Worth,
        is_precise_enough,
        parameter_precisions,
        rank_candidates,
    )
    from objectmodels.identification.joint_fit import Fit, fit
    from objectmodels.identification.onset_detection import Onset, detect_onset
    from objectmodels.identification.trial import Moved, Statistics, Trial

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
    "belief_after_trial",
    "detect_onset",
    "estimates_by_repetition",
    "estimates_from_trials",
    "fit",
    "initial_belief",
    "is_precise_enough",
    "parameter_precisions",
    "rank_candidates",
    "repetition_table",
    "update_belief",
]

_HOMES = {
    "Candidate": "objectmodels.identification.experiment_design",
    "Estimates": "objectmodels.identification.closed_form_estimates",
    "Fit": "objectmodels.identification.joint_fit",
    "Moved": "objectmodels.identification.trial",
    "Onset": "objectmodels.identification.onset_detection",
    "Statistics": "objectmodels.identification.trial",
    "Trial": "objectmodels.identification.trial",
    "Update": "objectmodels.identification.belief_update",
    "Worth": "objectmodels.identification.experiment_design",
    "detect_onset": "objectmodels.identification.onset_detection",
    "estimates_from_trials": "objectmodels.identification.closed_form_estimates",
    "estimates_by_repetition": "objectmodels.identification.closed_form_estimates",
    "fit": "objectmodels.identification.joint_fit",
    "initial_belief": "objectmodels.identification.belief_update",
    "parameter_precisions": "objectmodels.identification.experiment_design",
    "rank_candidates": "objectmodels.identification.experiment_design",
    "is_precise_enough": "objectmodels.identification.experiment_design",
    "repetition_table": "objectmodels.identification.closed_form_estimates",
    "update_belief": "objectmodels.identification.belief_update",
    "belief_after_trial": "objectmodels.identification.belief_update",
}

__getattr__ = lazy_names(__name__, _HOMES)
