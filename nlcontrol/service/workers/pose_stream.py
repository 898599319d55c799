"""Inside the process of a session: poses for viewers while somebody looks, and nothing otherwise.

Of a simulated world these are what its observer sees. The world leaves a sample of itself after
every control step; a thread of its own takes the newest one now and then, so that nothing is asked
of the world, and what happens in it does not depend on who looks; it only takes no less than real
time then. Of another robot it is what is believed since the last look.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from nlcontrol.service.live_documents import PoseFrame, SceneGeometry
from objectmodels.geometry.rotations import quaternion
from sim.simulated_executor import SimulatedExecutor

if TYPE_CHECKING:
    from nlcontrol.service.session import Session
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.executor import Executor
    from sim.worlds.ports import Sample

RATE = 30.0
"""Frames per second of the robot's time, at most."""

_LOOK_EVERY = 0.008  # a simulation may run several times faster than the clock [s]


class View(Protocol):
    """A view of a robot and its table."""

    @property
    def time(self) -> float:
        """Time of what there is to see [s]."""

    def geometry(self) -> SceneGeometry:
        """All that is drawn."""

    def frame(self) -> PoseFrame:
        """Places of all bodies now."""

    def keep_real_time(self, wanted: bool) -> None:
        """Lets nothing happen faster than it would on a real table, or ends that."""


class ObservedWorld:
    """A simulated world as its observer sees it.

    Args:
        executor: in whose world things happen.
    """

    def __init__(self, executor: SimulatedExecutor) -> None:
        from sim.views.viewer_recording import SceneBodies

        self._executor = executor
        # A viewer's own world shows how things are before anything moves: the executor's is built
        # then, and no sooner because somebody looks.
        world = executor.world if executor.is_built else copy_of(executor).world
        self._first, self._joint_names = world.sample, world.robot.joint_names
        self._bodies = SceneBodies(world.scene)

    def _sample(self) -> Sample:
        return self._executor.world.sample if self._executor.is_built else self._first

    @property
    def time(self) -> float:
        """Time of the newest sample [s]."""
        return self._sample().time

    def geometry(self) -> SceneGeometry:
        """All that is drawn."""
        return SceneGeometry(source="observer", **self._bodies.document())

    def frame(self) -> PoseFrame:
        """Places of all bodies in the newest sample."""
        sample = self._sample()
        poses = self._bodies.poses(sample, self._joint_names)
        return PoseFrame(time=sample.time, source="observer", poses=poses)

    def keep_real_time(self, wanted: bool) -> None:
        """Lets the simulation run no faster than the clock, or ends that."""
        if self._executor.is_built:
            self._executor.world.clock.runs = wanted


class BelievedTable:
    """The table of a robot that is not simulated, as it was seen last: a box for each object.

    Args:
        controller: of the robot.
    """

    def __init__(self, controller: Controller) -> None:
        self._controller = controller

    @property
    def time(self) -> float:
        """Time of the robot [s]."""
        return self._controller.executor.time

    def geometry(self) -> SceneGeometry:
        """Each object in the shape of its model."""
        from sim.views.viewer_recording import believed_scene

        name, models = self._controller.cell.name, self._controller.models
        return SceneGeometry(source="belief", **believed_scene(name, models))

    def frame(self) -> PoseFrame:
        """Places of the objects as they are believed."""
        state = self._controller.last_look.state
        objects = {} if state is None else state.objects
        poses = {
            name: (*quaternion(seen.pose.R_WB).tolist(), *seen.pose.p_WB.tolist())
            for name, seen in objects.items()
        }
        return PoseFrame(time=self.time, source="belief", poses=poses)

    def keep_real_time(self, wanted: bool) -> None:
        """Changes nothing: another robot has a time of its own."""


def copy_of(executor: SimulatedExecutor) -> SimulatedExecutor:
    """An executor of the same scene and seed, in whose world nothing was done yet."""
    return SimulatedExecutor(executor.scene, seed=executor.seed)


class PoseStream:
    """Frames of a session, told while they are wanted.

    Args:
        session: whose robot is looked at.
        tell: tells a frame, as JSON.
    """

    def __init__(self, session: Session, tell: Callable[[bytes], None]) -> None:
        self._session, self._tell = session, tell
        self._unwanted = threading.Event()
        self._unwanted.set()
        self._lock = threading.Lock()
        self._seen: tuple[Executor, View] | None = None

    def geometry(self) -> SceneGeometry:
        """All that is drawn of the session."""
        return self._view().geometry()

    def tell_frames(self, wanted: bool) -> None:
        """Begins to tell frames, or ends it."""
        if not wanted:
            self._unwanted.set()
        elif self._unwanted.is_set():
            self._unwanted = threading.Event()
            threading.Thread(target=self._tell_until, args=(self._unwanted,), daemon=True).start()

    def _view(self) -> View:
        """The view of the robot, which is another one after a reset."""
        with self._lock:
            controller = self._session.controller
            executor = controller.executor
            if self._seen is None or self._seen[0] is not executor:
                if isinstance(executor, SimulatedExecutor):
                    self._seen = executor, ObservedWorld(executor)
                else:
                    self._seen = executor, BelievedTable(controller)
            return self._seen[1]

    def _tell_until(self, unwanted: threading.Event) -> None:
        shown, due = None, -math.inf
        while not unwanted.wait(_LOOK_EVERY):
            view = self._view()
            view.keep_real_time(True)
            if view is not shown:
                shown, due = view, -math.inf
            if view.time >= due:
                frame = view.frame()
                due = max(due + 1.0 / RATE, frame.time + 0.5 / RATE)
                self._tell(frame.model_dump_json().encode())
        if shown is not None:
            shown.keep_real_time(False)
