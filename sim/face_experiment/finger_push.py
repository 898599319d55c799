"""One push by the robot's finger, in a fresh world: what it felt, and what an observer saw.

This is the robot's half of the paper's Fig. 7. The robot looks, goes where it believes the contact
to be, presses straight in and feels when the object begins to move. Along the face the fingertip
gives way, so that the force stays normal to it. The robot knows nothing else: what moved is judged
by the observer of the simulated world, as a person did it for the paper. The hand stays where it is
then: a press is the last thing done in its world.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from planner.touch_experiments import Experiment
from planner.touch_experiments import press as press_at
from planner.types.world_state import SeenObject, WorldState
from sim.cell.cell_description import LOOK
from sim.control.free_motion import RobotSetup
from sim.control.pushing.guarded_touch import PAUSE
from sim.control.trace_recorder import EarlyEndError
from sim.execution.push_execution import PushExecution
from sim.exploration.probe_control import ProbeControl
from sim.exploration.trial_extraction import Recording, force_curve
from sim.face_experiment.face_contact import Contact, TouchResult
from sim.motion.arm_configuration import UnreachableError
from sim.perception.state_estimation import mean_poses
from sim.traces.trace import EndReason
from sim.truth.observer import Observer
from sim.truth.scene_file import Scene, sample_world
from sim.worlds.drake.camera_port import initial_frames

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel

_SQUARE = np.radians(1.0)  # from straight in; more is another push [rad]


@dataclass(frozen=True)
class FingerTouch:
    """Pushes with the robot's finger; a `sim.face_experiment.face_contact.Touch`.

    Attributes:
        believed: the robot's models of all objects, by their names in the scene.
        build: the robot in a fresh world of a scene and a seed.
    """

    believed: Mapping[str, ObjectModel]
    build: Callable[[Scene, int], RobotSetup]

    def __call__(self, scene: Scene, contact: Contact, *, seed: int = 0) -> TouchResult:
        """Pushes once in a fresh world; see `Touch`."""
        normal = np.array(contact.normal)
        if abs(normal[2]) > np.sin(_SQUARE) or -normal @ contact.direction < np.cos(_SQUARE):
            return TouchResult(None, None, "the finger presses upright faces straight in only")
        setup, state = self.build(scene, seed), self._believed_state(scene, seed)
        experiment = press_at(
            state.objects[contact.object], np.array(contact.point), normal, setup.reach.limits
        )
        record = setup.observer.record()
        recording = _press(experiment, setup, state)
        if not len(recording.time):
            return TouchResult(None, None, recording.detail)
        poses = np.array([sample.poses[contact.object] for sample in record.samples])
        seen = Observer(sample_world(scene, seed)).judge(contact.object, poses)
        if seen.outcome == "none":
            return TouchResult(None, None, recording.detail)
        onset = force_curve(recording).onset
        felt = onset.force if onset is not None and onset.moved else None
        return TouchResult(seen.outcome, felt, recording.detail)

    def _believed_state(self, scene: Scene, seed: int) -> WorldState:
        """The robot's beliefs after its first look."""
        poses = mean_poses(initial_frames(scene, LOOK, seed=seed))
        return WorldState(
            {n: SeenObject.lying(n, pose, self.believed[n]) for n, pose in poses.items()}
        )


def _press(experiment: Experiment, setup: RobotSetup, state: WorldState) -> Recording:
    """Carries out one press, after which the hand stays at the object."""
    models = {name: seen.model for name, seen in state.objects.items()}
    execution = PushExecution(experiment.push, setup, models)
    before = state.objects[experiment.push.object].pose
    try:
        stance, way = execution.stance(state)
        execution.approach(stance, way)
        control = _PressControl(experiment, execution.recorder, stance, way)
        return control.recording(*control.run(), before)
    except EarlyEndError as early:
        return Recording.nothing(experiment, early.end, early.detail, before)
    except UnreachableError as error:
        return Recording.nothing(experiment, "unreachable", str(error), before)


class _PressControl(ProbeControl):
    """One press, from before the face until something has moved."""

    pause = PAUSE
    # What a sticking fingertip drags along the face would add to the force: percents of it.
    gives_way = 0.03

    def run(self) -> tuple[EndReason, str]:
        self._begin()
        command, step = self.commanded, self.experiment.push.speed * self._period
        while True:
            command = command + step * self._u
            self._press(command)
            ended = self._way_end()
            if ended is not None:
                return ended
