"""Finding an object's parameters from what touches of it showed."""

from objectmodels.identification.trials import Moved, Trial

__all__ = ["Moved", "Trial"]
