"""Finding an object's parameters from what touches of it showed."""

from objectmodels.identification.design import Candidate, Worth, precisions, ranked, reached
from objectmodels.identification.estimates import (
    Estimates,
    Statistics,
    estimates,
    estimates_by_repetition,
    table,
)
from objectmodels.identification.fit import Fit, fit
from objectmodels.identification.onset import Onset, detect_onset
from objectmodels.identification.trials import Moved, Trial
from objectmodels.identification.update import Update, guess, update, updated

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
