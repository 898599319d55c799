"""An executor without a world: what comes of each push is made up."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from nlcontrol.session.controller import Controller
from objectmodels import ObjectModel
from planner.touch_experiments import Experiment
from planner.types.world_state import Held, PlanarPose, WorldState
from sim.control.object_estimate import estimate_objects
from sim.exploration.trial_extraction import Recording
from sim.robots.cell_description import CellDescription
from sim.traces.trace import Trace
from sim.worlds.ports import Frame, SeenPose
from tests.unit.nlcontrol.pushes import BOX, Happens, seen, sighted


class PlayedExecutor:
    """A robot whose camera is perfect and whose pushes do what the test says.

    The object stands where a push left it. Nothing else moves.

    Args:
        cell: what the robot is told.
        poses: where everything stands.
        robot: its reach.
        happens: what comes of each push, the last one again and again.
    """

    def __init__(
        self, cell: CellDescription, poses: Mapping[str, PlanarPose], robot: Any, *happens: Happens
    ) -> None:
        self.cell = cell
        self.seed = 0
        self.robot = robot
        self.time = 0.0
        self.held: Held | None = None
        self.happens = list(happens)
        self.poses = dict(poses)
        self.colours: dict[str, Any] = {}
        self.start = self.poses[BOX]
        self.executed: list[Any] = []
        self.touched: list[Experiment] = []
        self.traces: list[Trace] = []

    def seen_poses(self) -> Mapping[str, PlanarPose]:
        """What the camera shows."""
        return self.poses

    def look(self, models: Mapping[str, ObjectModel], duration: float = 1.0) -> WorldState:
        poses = {name: SeenPose(at.R_WB, at.p_WB) for name, at in self.seen_poses().items()}
        frame = Frame(0.0, duration, poses, colours=self.colours)
        objects = estimate_objects(self.cell, [frame], models)
        return WorldState(objects, self.cell.table.extent, self.held)

    def execute(self, plan: Any, models: Mapping[str, ObjectModel], progress: Any = None) -> Trace:
        if progress is not None:
            progress("push", 1.0, "in contact")
        happens = self.happens.pop(0) if len(self.happens) > 1 else self.happens[0]
        trace = self._now(seen(happens(plan), at=self.poses[BOX]))
        x, y, _z = trace.displacement(BOX).tolist()
        self.move(x, y, float(trace.yaw(BOX)[-1]))
        self.executed.append(plan)
        self.traces.append(trace)
        return trace

    def watch(self, name: str, duration: float = 1.0) -> Trace:
        """A look in which nothing moves, after the last trace."""
        last, n = self.traces[-1], round(duration / 0.01)
        still = {each: np.tile(p[-1], (n, 1)) for each, p in last.poses.items()}
        none = np.zeros((n, 3))
        return self._now(
            replace(
                last, time=np.arange(n, dtype=np.float64) * 0.01,
                phase=np.full(n, "look"), poses=still, seen=still,
                joints=np.zeros((n, last.joints.shape[1])), contacts=(),
                tips={each: none + p[-1] for each, p in last.tips.items()},
                felt=dict.fromkeys(last.felt, none), force_limit=np.zeros(n),
                end="reached", detail="there was nothing to be done",
            )
        )  # fmt: skip

    def touch(self, experiment: Experiment, state: WorldState, progress: Any = None) -> Recording:
        """No touch gets there."""
        self.touched.append(experiment)
        pose = state.objects[experiment.push.object].pose
        return Recording(experiment, "unreachable", "the arm does not reach", pose)

    def _now(self, trace: Trace) -> Trace:
        """The trace on the robot's clock, which goes on, as the camera saw it."""
        self.time += 0.01
        time = trace.time + (self.time - float(trace.time[0]))
        trace = replace(trace, time=time)
        self.time = float(trace.time[-1])
        return sighted(trace)

    def move(self, x: float, y: float, turned: float = 0.0) -> None:
        """Moves and turns the object; a camera does not count turns."""
        here = self.poses[BOX]
        yaw = math.remainder(here.yaw + turned, math.tau)
        self.poses[BOX] = replace(here, x=here.x + x, y=here.y + y, yaw=yaw)

    @property
    def moved(self) -> tuple[float, float]:
        """How far the object has come in all [m]."""
        here = self.poses[BOX]
        return here.x - self.start.x, here.y - self.start.y


def played(controller: Controller, *happens: Happens) -> PlayedExecutor:
    """The controller's robot from now on: the cell as it is seen, what comes of pushes made up."""
    objects = controller.look().objects
    poses = {name: seen_object.pose for name, seen_object in objects.items()}
    executor = PlayedExecutor(controller.cell, poses, controller.robot, *happens)
    executor.colours = {name: seen_object.colour for name, seen_object in objects.items()}
    controller.executor = executor
    return executor
