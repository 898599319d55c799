"""Finding an object's parameters from what touches of it showed."""

from objectmodels.identification.belief_update import Update, guess, update, updated
from objectmodels.identification.closed_form_estimates import (
    Estimates,
    Statistics,
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
