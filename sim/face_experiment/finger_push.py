"""One push by the robot's finger, in a fresh world: what it felt, and what an observer saw.

The robot looks, goes where it believes the contact to be, presses and feels when the object begins
to move. It knows nothing else. What moved is judged by the observer of the simulated world, as a
person did it for the paper; nothing of that reaches the robot.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from planner.touch_experiments import press as press_at
from planner.types.world_state import SeenObject, WorldState
from sim.execution.push_execution import LOOK
from sim.exploration.trial_extraction import curve
from sim.face_experiment.face_contact import Contact, TouchResult
from sim.face_experiment.pressing import press
from sim.motion.robot_reach import ArmHandReach
from sim.perception.camera_port import first_look
from sim.standard_robot import ARM, HAND
from sim.truth.observer import Observer
from sim.worlds.drake.drake_world import DrakeWorld

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from sim.truth.scene_file import Scene

_SQUARE = np.radians(1.0)  # from straight in; more is another push [rad]


@dataclass(frozen=True)
class FingerTouch:
    """Pushes with the robot's finger; a `sim.face_experiment.face_contact.Touch`.

    Attributes:
        believed: the robot's models of all objects, by their names in the scene.
    """

    believed: Mapping[str, ObjectModel]

    def __call__(self, scene: Scene, contact: Contact, *, seed: int = 0) -> TouchResult:
        """Pushes once in a fresh world; see `Touch`."""
        normal = np.array(contact.normal)
        if abs(normal[2]) > np.sin(_SQUARE) or -normal @ contact.direction < np.cos(_SQUARE):
            return TouchResult(None, None, "the finger presses upright faces straight in only")
        world, reach, state = (
            DrakeWorld(scene, seed=seed),
            ArmHandReach(scene.cell, ARM, HAND),
            self._seen(scene, seed),
        )
        experiment = press_at(state.objects[contact.object], np.array(contact.point), normal, reach)
        recording = press(experiment, world, state, reach=reach)
        if not len(recording.time):
            return TouchResult(None, None, recording.detail)
        poses = np.array([sample.poses[contact.object] for sample in world.history])
        seen = Observer(world.scene).judge(contact.object, poses)
        if seen.outcome == "none":
            return TouchResult(None, None, recording.detail)
        onset = curve(recording).onset
        felt = onset.force if onset is not None and onset.moved else None
        return TouchResult(seen.outcome, felt, recording.detail)

    def _seen(self, scene: Scene, seed: int) -> WorldState:
        """What the robot believes after its first look."""
        poses = first_look(scene, LOOK, seed=seed)
        return WorldState(
            {n: SeenObject.lying(n, pose, self.believed[n]) for n, pose in poses.items()}
        )
