"""The robot that plans are carried out with: its port, its reach, and what it holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sim.control.trace_recorder import TraceRecorder

if TYPE_CHECKING:
    from planner.types.world_state import Held
    from sim.control.grasping.held_object_sensing import Holding
    from sim.motion.robot_reach import ArmHandReach
    from sim.rotations import Array
    from sim.worlds.ports import ObserverPort, RobotPort


@dataclass
class RobotSetup:
    """A robot in its cell.

    Attributes:
        port: its commands and sensors.
        observer: of the world in which it stands, for traces alone.
        reach: of arm and hand.
        holding: what lasts of a grasp from one execution to the next; None if nothing is held.
    """

    port: RobotPort
    observer: ObserverPort
    reach: ArmHandReach
    holding: Holding | None = None

    @property
    def held(self) -> Held | None:
        """What the hand holds, as plans know it; None if nothing."""
        return None if self.holding is None else self.holding.held

    def recorder(self, normal_W: Array) -> TraceRecorder:
        """A new record, from now on.

        Args:
            normal_W: outward normal of the face to be touched in W, shape (3,).
        """
        return TraceRecorder(self.port, self.observer, self.reach.mount, normal_W)
