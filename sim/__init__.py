"""The simulated robot and its world in Drake: scenes, reach, execution, replay and pictures.

Drake is imported when a world is built, not with this package.
"""

from sim.execution import execute
from sim.reach import ArmReach
from sim.scene import Scene, SceneError, load_scene
from sim.trace import Trace
from sim.vision import first_look
from sim.world import DrakeWorld

__all__ = [
    "ArmReach",
    "DrakeWorld",
    "Scene",
    "SceneError",
    "Trace",
    "execute",
    "first_look",
    "load_scene",
]
