"""The robot that a planner asks, until it is to stop or its time is over."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from nlcontrol.errors import error

if TYPE_CHECKING:
    from planner.types.actions import Push
    from planner.types.plan import Plan
    from planner.types.robot import Grip, ReachAnswer, ReachEffort, Robot, RobotLimits
    from planner.types.world_state import WorldState
    from sim.supervision import StopToken


class StoppableRobot:
    """Answers of a robot; none any more once a stop was asked for, or its time is over.

    Whatever a search does, it asks the robot again and again: there it ends with `Stopped`, or with
    a `ControlError` of code `time_limit`.

    Args:
        robot: that answers.
        stop: asked whether to go on.
        time_limit: for all answers, from now on, by the clock on the wall [s].
    """

    def __init__(self, robot: Robot, stop: StopToken | None, time_limit: float | None) -> None:
        self._robot, self._stop, self._time_limit = robot, stop, time_limit
        self._start = time.monotonic()

    def _check(self) -> None:
        """Ends the search if it is to end."""
        if self._stop is not None:
            self._stop.check()
        limit, spent = self._time_limit, time.monotonic() - self._start
        if limit is not None and spent > limit:
            raise error(
                "time_limit",
                f"no plan was found within {limit:g} s; a quicker machine may find one",
                suggestions=(f"--time-limit {2.0 * limit:g}", "leave out the time limit"),
                numbers={"time_limit": limit, "spent": spent},
            )

    @property
    def limits(self) -> RobotLimits:
        """Figures of arm and hand."""
        return self._robot.limits

    @property
    def max_press(self) -> float:
        """Pressing force of the robot [N]; see `planner.types.robot.Robot`."""
        return self._robot.max_press

    def reach(self, push: Push, state: WorldState, effort: ReachEffort = "usual") -> ReachAnswer:
        """Answer of the robot; see `planner.types.robot.Robot`."""
        self._check()
        return self._robot.reach(push, state, effort)

    def estimate_reach(self, push: Push, state: WorldState) -> float:
        """Estimate of the robot [rad]; see `planner.types.robot.Robot`."""
        self._check()
        return self._robot.estimate_reach(push, state)

    def grasp(self, width: float, *, pinch: bool = False, depth: float = 0.0) -> Grip | None:
        """Grip of the robot about a width [m]; see `planner.types.robot.Robot`."""
        self._check()
        return self._robot.grasp(width, pinch=pinch, depth=depth)

    def reach_plan(self, plan: Plan, state: WorldState) -> ReachAnswer:
        """Answer of the robot; see `planner.types.robot.Robot`."""
        self._check()
        return self._robot.reach_plan(plan, state)
