"""A trace as one self-contained HTML file that replays in a browser, without a network."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sim.rotations import Array
from sim.traces.trace import Trace
from sim.truth.scene_file import Scene
from sim.views.liquid_view import COLOUR, parts, triangles
from sim.views.trace_scene import TraceScene, rigid_transform, samples, view

if TYPE_CHECKING:
    from pydrake.geometry import Meshcat
    from pydrake.systems.framework import DiagramBuilder

    from sim.worlds.drake.drake_plant import Plant

FRAME_RATE = 24.0
"""Frames per second of the recording."""

_SAME = 2e-4  # liquid that differs by less keeps its mesh [m]
_LOOK_AT, _FROM = np.array([0.45, 0.0, 0.30]), np.array([-0.90, -0.95, 0.35])


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Drake's log without its notes."""
    log = logging.getLogger("drake")
    before = log.level
    log.setLevel(logging.WARNING)
    try:
        yield
    finally:
        log.setLevel(before)


class _Liquid:
    """Shows liquid in a recording: a mesh for each form that it takes, one of them visible."""

    def __init__(self, meshcat: Meshcat, scene: Scene) -> None:
        self._meshcat = meshcat
        self._scene = scene
        self._known: dict[str, list[Array]] = {}
        self._visible: set[str] = set()

    def show(self, trace: Trace, sample: int) -> None:
        """Puts the liquid where it was at a sample of a trace."""
        now = float(trace.time[sample] - trace.time[0])
        visible = set()
        for part in parts(trace, self._scene, sample):
            folder = f"/liquid/{part.name}/{part.of}"
            if part.of == "level":
                self._meshcat.SetTransform(
                    folder, rigid_transform(trace.poses[part.name][sample]), now
                )
            visible.add(self._form(folder, part.pieces))
        for path in visible - self._visible:
            self._meshcat.SetProperty(path, "visible", True, now)
        for path in self._visible - visible:
            self._meshcat.SetProperty(path, "visible", False, now)
        self._visible = visible

    def _form(self, folder: str, pieces: tuple[Array, ...]) -> str:
        """The path of a mesh, which is made if the last one of that folder looks otherwise."""
        from pydrake.geometry import Rgba

        corners, faces = triangles(pieces)
        known = self._known.setdefault(folder, [])
        if known and _alike(known[-1], corners):
            return f"{folder}/{len(known) - 1}"
        path = f"{folder}/{len(known)}"
        known.append(corners)
        self._meshcat.SetTriangleMesh(path, corners.T, faces.T, Rgba(*COLOUR))
        self._meshcat.SetProperty(path, "visible", False, 0.0)
        return path


def _alike(before: Array, now: Array) -> bool:
    return before.shape == now.shape and bool(np.abs(before - now).max() < _SAME)


def save_replay(trace: Trace, scene: Scene, path: Path | str) -> None:
    """Writes a replay of a trace and its scene to an HTML file."""
    from pydrake.geometry import Meshcat, MeshcatParams, MeshcatVisualizer, MeshcatVisualizerParams

    with _quiet():  # it reports an address that is gone before anybody could open it
        meshcat = Meshcat(MeshcatParams(host="localhost", show_stats_plot=False))
    meshcat.SetProperty("/Background", "top_color", [0.93, 0.95, 0.97])
    meshcat.SetProperty("/Background", "bottom_color", [0.80, 0.84, 0.88])
    for hidden in ("/Grid", "/Axes"):
        meshcat.SetProperty(hidden, "visible", value=False)
    meshcat.SetCameraPose(*view(trace, _LOOK_AT, _FROM))
    visualizers = []

    def furnish(builder: DiagramBuilder, model: Plant) -> None:
        params = MeshcatVisualizerParams(publish_period=1.0 / FRAME_RATE)
        visualizers.append(
            MeshcatVisualizer.AddToBuilder(builder, model.scene_graph, meshcat, params)
        )

    stage = TraceScene(scene, furnish)
    liquid = _Liquid(meshcat, scene)
    recorder = visualizers[0].StartRecording()
    recorder.set_autoplay(True)
    for sample in samples(trace, FRAME_RATE):
        stage.show(trace, sample)
        stage.diagram.ForcedPublish(stage.context)
        liquid.show(trace, sample)
    visualizers[0].StopRecording()
    visualizers[0].PublishRecording()
    Path(path).write_text(meshcat.StaticHtml(), encoding="utf-8")
