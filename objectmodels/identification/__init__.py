"""Finding an object's parameters from what touches of it showed."""

from objectmodels.identification.fit import Fit, fit
from objectmodels.identification.onset import Onset, detect_onset
from objectmodels.identification.trials import Moved, Trial

__all__ = ["Fit", "Moved", "Onset", "Trial", "detect_onset", "fit"]
