"""The simulated robot and its world in Drake: scenes, reach, execution, replay and pictures.

Drake is imported when a world is built, not with this package.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import nlcontrol_former_names  # noqa: F401 – serves former names
from objectmodels.lazy_names import lazy_names

if TYPE_CHECKING:
    from sim.errors import PictureError, SceneError, SimError
    from sim.execution.plan_execution import execute, watch
    from sim.motion.robot_reach import ArmHandReach
    from sim.perception.camera_port import first_look, seen_colours
    from sim.traces.trace import Trace
    from sim.truth.scene_file import Scene, load_scene
    from sim.views.html_replay import save_replay
    from sim.views.trace_picture import save_picture
    from sim.worlds.drake.drake_world import DrakeWorld

__all__ = [
    "ArmHandReach",
    "DrakeWorld",
    "PictureError",
    "Scene",
    "SceneError",
    "SimError",
    "Trace",
    "execute",
    "first_look",
    "load_scene",
    "save_picture",
    "save_replay",
    "seen_colours",
    "watch",
]

_HOMES = {
    "ArmHandReach": "sim.motion.robot_reach",
    "DrakeWorld": "sim.worlds.drake.drake_world",
    "PictureError": "sim.errors",
    "Scene": "sim.truth.scene_file",
    "SceneError": "sim.errors",
    "SimError": "sim.errors",
    "Trace": "sim.traces.trace",
    "execute": "sim.execution.plan_execution",
    "first_look": "sim.perception.camera_port",
    "load_scene": "sim.truth.scene_file",
    "save_picture": "sim.views.trace_picture",
    "save_replay": "sim.views.html_replay",
    "seen_colours": "sim.perception.camera_port",
    "watch": "sim.execution.plan_execution",
}

__getattr__ = lazy_names(__name__, _HOMES)
