"""Pushes that the hand did not get to, which stay so while what stopped it stays where it is.

What is moved aside for a command changes little: most pushes that are asked for again are stopped
by what still stands there. An object that was moved may stop more of them, never fewer.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from nlcontrol.session.stoppable_robot import StoppableRobot

if TYPE_CHECKING:
    from planner.types.actions import Push
    from planner.types.robot import ReachAnswer, ReachEffort, Robot
    from planner.types.world_state import PlanarPose, WorldState
    from sim.supervision import StopToken

    Places = dict[str, PlanarPose]

_RECALLED = 1  # units of work of an answer that is known


class RecallingRobot(StoppableRobot):
    """A robot that is not asked again for what it could not do, while nothing matters has moved."""

    def __init__(self, robot: Robot, stop: StopToken | None, time_limit: float | None) -> None:
        super().__init__(robot, stop, time_limit)
        self._denied: dict[object, list[tuple[Places, ReachAnswer]]] = {}

    def reach(self, push: Push, state: WorldState, effort: ReachEffort = "usual") -> ReachAnswer:
        """Answer of the robot, or the one that it gave."""
        asked = push, state.objects[push.object].pose, effort
        denied = self._denied.setdefault(asked, [])
        for places, known in denied:
            if all(state.objects[name].pose == pose for name, pose in places.items()):
                return replace(known, work=_RECALLED)
        answer = super().reach(push, state, effort)
        if not answer.ok and answer.stopped_by is not None:
            places = {name: state.objects[name].pose for name in answer.stopped_by}
            denied.append((places, answer))
        return answer
