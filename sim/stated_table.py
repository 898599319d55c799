"""A table that somebody else sees: everything stands where it is stated, and nothing moves.

It is what a controller needs in order to plan for a robot that it does not drive: the reach of the
standard arm and hand, and beliefs. Frames: poses are X_WB.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, NoReturn

from planner.types.world_state import Held, PlanarPose, SeenObject, WorldState
from sim.errors import SimError
from sim.motion.robot_reach import ArmHandReach
from sim.robots.cell_description import LOOK, CellDescription
from sim.robots.robots import ARM, HAND

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from planner.touch_experiments import Experiment
    from planner.types.plan import Plan
    from sim.exploration.trial_extraction import Recording
    from sim.supervision import Progress
    from sim.traces.trace import Trace


class StatedTable:
    """An executor that only sees, implementing `nlcontrol.session.executor.Executor`.

    Args:
        cell: mount, table and the objects that stand there.
        poses: where they stand, by their names.

    Attributes:
        cell: as given.
        seed: nothing is drawn.
        time: none goes by [s].
        held: nothing.
    """

    def __init__(self, cell: CellDescription, poses: Mapping[str, PlanarPose]) -> None:
        self.cell = cell
        self.seed = 0
        self.time = 0.0
        self.held: Held | None = None
        self._poses = dict(poses)

    @cached_property
    def robot(self) -> ArmHandReach:
        """Reach of arm and hand, as the planner asks for it."""
        return ArmHandReach(self.cell, ARM, HAND)

    def look(self, models: Mapping[str, ObjectModel], duration: float = LOOK) -> WorldState:
        """The belief that was stated; see `Executor.look`."""
        objects = {
            item.name: SeenObject.lying(
                item.name,
                self._poses[item.name],
                models[item.name],
                fragile=item.fragile,
                fixed=item.fixed,
            )
            for item in self.cell.objects
        }
        return WorldState(objects, self.cell.table.extent)

    def execute(
        self,
        plan: Plan,
        models: Mapping[str, ObjectModel],
        progress: Progress | None = None,
    ) -> Trace:
        """Raises `no_robot`."""
        _refuse()

    def watch(self, name: str, duration: float = LOOK) -> Trace:
        """Raises `no_robot`."""
        _refuse()

    def touch(
        self, experiment: Experiment, state: WorldState, progress: Progress | None = None
    ) -> Recording:
        """Raises `no_robot`."""
        _refuse()


def _refuse() -> NoReturn:
    raise SimError(
        "no_robot",
        "this table was stated, so there is no robot that could move anything on it",
        ("leave out the stated objects, to have the scene's own table simulated",),
    )
