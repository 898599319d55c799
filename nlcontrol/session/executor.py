"""Protocols of the robot and of the planner that a controller needs.

`sim.simulated_executor.SimulatedExecutor` is the executor of the simulated world. The driver of a
real robot is another one: it has the members of `Executor`, and derives from nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Literal, Protocol

from nlcontrol.errors import error
from sim.robots.cell_description import LOOK, CellDescription

if TYPE_CHECKING:
    from grammar.frames.command import Frame
    from objectmodels import ObjectModel
    from planner.touch_experiments import Experiment
    from planner.types.actions import Push
    from planner.types.defaults import Defaults
    from planner.types.plan import Plan, PlanningResult
    from planner.types.robot import Failed, Grip, ReachAnswer, ReachEffort, Robot, RobotLimits
    from planner.types.world_state import Held, WorldState
    from sim.exploration.trial_extraction import Recording
    from sim.supervision import Progress, StopToken
    from sim.traces.trace import Trace


Motion = Literal["never", "simulate"]
"""Whether a sentence may move the robot: never, or a question too, to know the answer better."""


class Perception(Protocol):
    """Beliefs about where everything stands."""

    def look(self, models: Mapping[str, ObjectModel], duration: float = LOOK) -> WorldState:
        """Looks at the table and returns what the robot believes then.

        Args:
            models: believed model of every object, by its name in the cell.
            duration: over which camera frames are averaged [s].
        """


class Executor(Perception, Protocol):
    """A robot in its cell.

    Attributes:
        cell: what the robot is told: objects by name, table, mount, data sheets of the sensors.
        seed: seed of all randomness; 0 where nothing is drawn.
    """

    cell: CellDescription
    seed: int

    @property
    def robot(self) -> Robot:
        """Arm and hand, as the planner asks for them."""

    @property
    def time(self) -> float:
        """The robot's time [s]."""

    @property
    def held(self) -> Held | None:
        """The object in the hand, as the robot knows; None if it holds nothing."""

    def execute(
        self,
        plan: Plan,
        models: Mapping[str, ObjectModel],
        progress: Progress | None = None,
    ) -> Trace:
        """Carries out a plan and returns the trace, also if it ended early.

        Args:
            plan: plan to carry out.
            models: believed model of every object, by its name in the cell.
            progress: called while something happens; a `Monitor`, whose `stop` is to be asked at
                least every 0.2 s whether to let go and come to rest.
        """

    def watch(self, name: str, duration: float = LOOK) -> Trace:
        """Looks at the table while nothing is done.

        Args:
            name: name of the object that the trace is about.
            duration: duration of the look [s].
        """

    def touch(
        self, experiment: Experiment, state: WorldState, progress: Progress | None = None
    ) -> Recording:
        """Carries out a touch experiment and returns what the robot felt and saw.

        Args:
            experiment: which.
            state: believed state, from a look since which nothing has moved.
            progress: called while something happens; a `Monitor`, whose `stop` is to be asked at
                least every 0.2 s whether to let go and come to rest.
        """


class Planner(Protocol):
    """A way from frames to plans; `planner.plan` is one."""

    def __call__(
        self,
        frame: Frame,
        state: WorldState,
        robot: Robot,
        *,
        defaults: Defaults,
        previous: Plan | None = None,
        failed: Sequence[Failed] = (),
        notify: Callable[[str], None] = lambda _: None,
    ) -> PlanningResult:
        """A plan that satisfies a frame, or why there is none; see `planner.plan`."""


class CancellableRobot:
    """Answers of a robot; none any more once a stop was asked for, or its time is over.

    Whatever a search does, it asks the robot again and again: there it ends with `Stopped`, or with
    a `ControlError` of code `time_limit`.

    Args:
        robot: robot that answers.
        stop: asked whether to go on.
        time_limit: wall-clock time for all answers from now on [s].
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
