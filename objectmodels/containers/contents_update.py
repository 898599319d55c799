"""Contents of a container that holds another volume, or weighs otherwise, than believed.

Contents and shell are believed independently of each other. So what all of it weighs otherwise than
believed is put down to the contents by their share of the variance, and what is known better of the
whole is known better of them by that share.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from objectmodels.models.object_parts import Container

_ROUNDING = 1e-9


def container_with_volume(model: ObjectModel, volume: float, sd: float) -> Container:
    """The container of a model with a volume in it, or with as much of that as it holds.

    Args:
        model: of something hollow.
        volume: of the contents [m³].
        sd: its standard deviation [m³].
    """
    container, vessel = model.container, model.vessel
    assert container is not None, "what holds something is a container"
    assert vessel is not None
    most = (1.0 - _ROUNDING) * vessel.capacity  # litres and cubic metres differ in the last digit
    volume = min(max(volume, 0.0), most)
    return container.model_copy(update={"contents_l": 1e3 * volume, "contents_l_sd": 1e3 * sd})


def container_with_mass(model: ObjectModel, mass: float, mass_sd: float) -> Container | None:
    """The container of a model of which all is known to weigh otherwise; None if it has none.

    Args:
        model: what was believed.
        mass: of container and contents [kg].
        mass_sd: its standard deviation [kg].
    """
    container = model.container
    if container is None:
        return None
    uncertain = container.density * container.contents_sd
    share = min((uncertain / model.mass_sd) ** 2, 1.0) if model.mass_sd > 0.0 else 0.0
    liquid = container.mass + share * (mass - model.mass)
    if mass < model.mass:  # the shell keeps at least its part
        liquid = min(liquid, mass * container.mass / model.mass)
    known = 1.0 - share * (1.0 - (mass_sd / model.mass_sd) ** 2) if share > 0.0 else 1.0
    return container_with_volume(
        model, liquid / container.density, math.sqrt(known) * container.contents_sd
    )
