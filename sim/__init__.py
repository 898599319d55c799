"""The simulated robot and its world in Drake: scenes, reach, execution, replay and pictures.

Drake is imported when a world is built, not with this package.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from objectmodels.lazy import lazy_names

if TYPE_CHECKING:
    from sim.errors import PictureError as PictureError
    from sim.errors import SceneError as SceneError
    from sim.errors import SimError as SimError
    from sim.simulated_executor import SimulatedExecutor as SimulatedExecutor
    from sim.traces.trace import Trace as Trace
    from sim.truth.scene_file import Scene as Scene
    from sim.truth.scene_file import load_scene as load_scene
    from sim.views.trace_picture import save_picture as save_picture
    from sim.views.viewer_recording import save_replay as save_replay

_HOMES = {
    "errors": ["PictureError", "SceneError", "SimError"],
    "simulated_executor": ["SimulatedExecutor"],
    "traces.trace": ["Trace"],
    "truth.scene_file": ["Scene", "load_scene"],
    "views.viewer_recording": ["save_replay"],
    "views.trace_picture": ["save_picture"],
}

__all__ = [name for names in _HOMES.values() for name in names]
__getattr__ = lazy_names(__name__, _HOMES)
