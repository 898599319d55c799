"""The executor of the simulated world: scene, robot and world put together.

Implements `nlcontrol.session.executor.Executor`. What the robot believes comes from its port alone;
`SimulatedExecutor.world` and `SimulatedExecutor.scene` are the truth, for an observer.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from planner.types.world_state import Held, WorldState
from sim.control.free_motion import RobotSetup, watch
from sim.control.object_estimate import estimate_objects
from sim.motion.robot_reach import ArmHandReach
from sim.robots.cell_description import LOOK
from sim.robots.robots import ARM, HAND
from sim.truth.scene_file import Scene, load_scene
from sim.worlds.camera import initial_frames

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from planner.touch_experiments import Experiment
    from planner.types.plan import Plan
    from sim.exploration.trial_extraction import Recording
    from sim.supervision import Progress
    from sim.traces.trace import Trace
    from sim.truth.object_truth import Truth
    from sim.worlds.drake.drake_world import DrakeWorld
    from sim.worlds.ports import Frame


class SimulatedExecutor:
    """A robot in a simulated world, which is built when something first moves.

    Attributes:
        scene: the world as it is.
        seed: of everything random; the same seed gives the same trace.
        cell: what the robot is told.
    """

    def __init__(self, scene: Scene, *, seed: int = 0) -> None:
        self.scene, self.seed = scene, seed
        self.cell = scene.cell
        self._first_frames: dict[float, list[Frame]] = {}

    @classmethod
    def open(cls, scene: str | Path | Scene, *, seed: int = 0) -> SimulatedExecutor:
        """The executor of a scene, of a built-in one by its name, or of a scene file.

        Raises:
            SceneError: the scene cannot be read.
        """
        return cls(scene if isinstance(scene, Scene) else load_scene(scene), seed=seed)

    @classmethod
    def from_document(cls, document: Mapping[str, Any], *, seed: int) -> SimulatedExecutor:
        """The executor of a scene as `scene_document` has it.

        Raises:
            ValueError: it is no scene.
        """
        return cls(Scene.model_validate_json(json.dumps(document)), seed=seed)

    def scene_document(self) -> dict[str, Any]:
        """The scene as JSON, but for defaults and models, which belong to who uses the robot."""
        return self.scene.model_dump(mode="json", by_alias=True, exclude={"defaults", "models"})

    @property
    def robot(self) -> ArmHandReach:
        """Reach of arm and hand, as the planner asks for it."""
        return self._robot

    @cached_property
    def _robot(self) -> ArmHandReach:
        # Type checkers differ about cached properties where a protocol has a property.
        return ArmHandReach(self.cell, ARM, HAND)

    @cached_property
    def world(self) -> DrakeWorld:
        """The simulated world; it keeps what was done to it."""
        from sim.worlds.drake.drake_world import DrakeWorld

        return DrakeWorld(self.scene, seed=self.seed)

    @cached_property
    def setup(self) -> RobotSetup:
        """The robot that plans are carried out with."""
        return RobotSetup(self.world.robot, self.world, self.robot)

    @property
    def is_built(self) -> bool:
        """The world exists: something was done in it."""
        return "world" in self.__dict__

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.world.time if self.is_built else 0.0

    @property
    def held(self) -> Held | None:
        """The object in the hand, as the robot knows; None if there is none."""
        return self.setup.held if self.is_built else None

    def truth(self, name: str) -> Truth:
        """The truth of an object when the world began; for an observer.

        Raises:
            KeyError: there is no object of that name.
        """
        return self.world.scene.object(name).truth

    def look(self, models: Mapping[str, ObjectModel], duration: float = LOOK) -> WorldState:
        """Looks at the table and returns what the robot believes then; see `Executor.look`."""
        if self.is_built:
            frames = watch(self.setup.recorder(np.array([0.0, 0.0, 1.0])), duration)
        else:
            # Nothing has moved, so that every look shows the same.
            if duration not in self._first_frames:
                seen = initial_frames(self.scene, duration, seed=self.seed)
                self._first_frames[duration] = seen
            frames = self._first_frames[duration]
        objects = estimate_objects(self.cell, frames, models, self.held)
        return WorldState(objects, self.cell.table.extent, self.held)

    def execute(
        self,
        plan: Plan,
        models: Mapping[str, ObjectModel],
        progress: Progress | None = None,
    ) -> Trace:
        """Carries out a plan; see `sim.control.plan_execution.execute`."""
        from sim.control.plan_execution import execute

        return execute(plan, self.setup, models, progress)

    def watch(self, name: str, duration: float = LOOK) -> Trace:
        """Looks at the table while nothing is done; see `Executor.watch`."""
        ahead = np.array([1.0, 0.0, 0.0])
        recorder = self.setup.recorder(-ahead)
        watch(recorder, duration)
        return recorder.trace(name, ahead, end="reached", detail="there was nothing to be done")

    def touch(
        self, experiment: Experiment, state: WorldState, progress: Progress | None = None
    ) -> Recording:
        """Carries out a touch experiment; see `sim.exploration.probe_control.probe`."""
        from sim.exploration.probe_control import probe

        return probe(experiment, self.setup, state, progress=progress)


def simulation(executor: object) -> SimulatedExecutor:
    """The executor as the simulation that it is, for an observer.

    Raises:
        TypeError: it is another executor, which knows no truth.
    """
    if not isinstance(executor, SimulatedExecutor):
        raise TypeError(f"{type(executor).__name__} does not simulate")
    return executor


def fresh_robot(scene: Scene, seed: int) -> RobotSetup:
    """The robot in a world of its own, in which nothing was done yet."""
    return SimulatedExecutor(scene, seed=seed).setup
