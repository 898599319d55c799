"""The robot that a planner asks, until it is to stop."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from planner.types.actions import Push
    from planner.types.plan import Plan
    from planner.types.robot import Grip, ReachAnswer, ReachEffort, Robot, RobotLimits
    from planner.types.world_state import WorldState
    from sim.supervision import StopToken


class StoppableRobot:
    """Answers of a robot; none any more once a stop was asked for.

    Whatever a search does, it asks the robot again and again: there it ends with `Stopped`.
    """

    def __init__(self, robot: Robot, stop: StopToken) -> None:
        self._robot, self._stop = robot, stop

    @property
    def limits(self) -> RobotLimits:
        """Figures of arm and hand."""
        return self._robot.limits

    def reach(self, push: Push, state: WorldState, effort: ReachEffort = "usual") -> ReachAnswer:
        """Answer of the robot; see `planner.types.robot.Robot`."""
        self._stop.check()
        return self._robot.reach(push, state, effort)

    def estimate_reach(self, push: Push, state: WorldState) -> float:
        """Estimate of the robot [rad]; see `planner.types.robot.Robot`."""
        self._stop.check()
        return self._robot.estimate_reach(push, state)

    def grasp(self, width: float, *, pinch: bool = False) -> Grip | None:
        """Grip of the robot about a width [m]; see `planner.types.robot.Robot`."""
        self._stop.check()
        return self._robot.grasp(width, pinch=pinch)

    def reach_plan(self, plan: Plan, state: WorldState) -> ReachAnswer:
        """Answer of the robot; see `planner.types.robot.Robot`."""
        self._stop.check()
        return self._robot.reach_plan(plan, state)
