"""The simulated robot and its world in Drake: scenes, reach, execution, replay and pictures.

Drake is imported when a world is built, not with this package.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from objectmodels.lazy_names import lazy_names

if TYPE_CHECKING:
    from sim.errors import PictureError, SceneError, SimError
    from sim.simulated_executor import SimulatedExecutor
    from sim.traces.trace import Trace
    from sim.truth.scene_file import Scene, load_scene
    from sim.views.html_replay import save_replay
    from sim.views.trace_picture import save_picture

__all__ = [
    "PictureError",
    "Scene",
    "SceneError",
    "SimError",
    "SimulatedExecutor",
    "Trace",
    "load_scene",
    "save_picture",
    "save_replay",
]

_HOMES = {
    "PictureError": "sim.errors",
    "Scene": "sim.truth.scene_file",
    "SceneError": "sim.errors",
    "SimError": "sim.errors",
    "SimulatedExecutor": "sim.simulated_executor",
    "Trace": "sim.traces.trace",
    "load_scene": "sim.truth.scene_file",
    "save_picture": "sim.views.trace_picture",
    "save_replay": "sim.views.html_replay",
}

__getattr__ = lazy_names(__name__, _HOMES)
