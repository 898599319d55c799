"""The simulated robot and its world in Drake: scenes, reach, execution, replay and pictures.

Drake is imported when a world is built, not with this package.
"""

from sim.errors import PictureError, SceneError, SimError
from sim.execution import execute, watch
from sim.picture import save_picture
from sim.reach import ArmReach
from sim.replay import save_replay
from sim.scene import Scene, load_scene
from sim.trace import Trace
from sim.vision import first_look, seen_colours
from sim.world import DrakeWorld

__all__ = [
    "ArmReach",
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
