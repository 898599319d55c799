"""How an explored object really is, told by the observer of the simulated world after all."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.exploring import CENTRE_OF_MASS, ExplorationReport
from objectmodels.support import mean_distance
from sim.observer import Observer

if TYPE_CHECKING:
    from sim.world import DrakeWorld


def with_truth(report: ExplorationReport, world: DrakeWorld) -> ExplorationReport:
    """The report with how the object really is; an observer of the simulated world tells it.

    Args:
        report: of the exploration, which is over.
        world: in which it was made.
    """
    truth = Observer(world.scene).truth(report.object)
    feet = np.array(truth.support)
    figures = {
        "mass": truth.mass_kg,
        "friction": truth.friction_table,
        "finger_friction": truth.friction_finger,
        "friction_radius": mean_distance(feet, np.full(len(feet), 1.0 / len(feet))),
        **dict(zip(CENTRE_OF_MASS, truth.centre_of_mass, strict=True)),
    }
    return report.model_copy(update={"truth": figures})
