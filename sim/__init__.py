"""The simulated robot and its world in Drake: scenes, reach, execution, replay and pictures.

Drake is imported when a world is built, not with this package.
"""

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
