"""Finding an object's parameters from what touches of it showed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from objectmodels.lazy import lazy_names

if TYPE_CHECKING:
    from objectmodels.identification.belief_update import Update as Update
    from objectmodels.identification.belief_update import belief_after_trial as belief_after_trial
    from objectmodels.identification.belief_update import initial_belief as initial_belief
    from objectmodels.identification.belief_update import update_belief as update_belief
    from objectmodels.identification.experiment_design import Candidate as Candidate
    from objectmodels.identification.experiment_design import Worth as Worth
    from objectmodels.identification.experiment_design import is_precise_enough as is_precise_enough
    from objectmodels.identification.experiment_design import (
        parameter_precisions as parameter_precisions,
    )
    from objectmodels.identification.experiment_design import rank_candidates as rank_candidates
    from objectmodels.identification.joint_fit import Estimates as Estimates
    from objectmodels.identification.joint_fit import Fit as Fit
    from objectmodels.identification.joint_fit import (
        estimates_by_repetition as estimates_by_repetition,
    )
    from objectmodels.identification.joint_fit import (
        estimates_from_trials as estimates_from_trials,
    )
    from objectmodels.identification.joint_fit import fit as fit
    from objectmodels.identification.joint_fit import (
        repetition_table as repetition_table,
    )
    from objectmodels.identification.onset_detection import Onset as Onset
    from objectmodels.identification.onset_detection import detect_onset as detect_onset
    from objectmodels.identification.trial import Moved as Moved
    from objectmodels.identification.trial import Statistics as Statistics
    from objectmodels.identification.trial import Trial as Trial

_HOMES = {
    "belief_update": ["Update", "belief_after_trial", "initial_belief", "update_belief"],
    "joint_fit": [
        "Estimates",
        "estimates_by_repetition",
        "estimates_from_trials",
        "repetition_table",
        "Fit",
        "fit",
    ],
    "experiment_design": [
        "Candidate",
        "Worth",
        "is_precise_enough",
        "parameter_precisions",
        "rank_candidates",
    ],
    "onset_detection": ["Onset", "detect_onset"],
    "trial": ["Moved", "Statistics", "Trial"],
}

__all__ = [name for names in _HOMES.values() for name in names]
__getattr__ = lazy_names(__name__, _HOMES)
