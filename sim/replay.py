"""A trace as one self-contained HTML file that replays in a browser, without a network."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sim.scene import Scene
from sim.stage import Stage, samples
from sim.trace import Trace

if TYPE_CHECKING:
    from pydrake.systems.framework import DiagramBuilder

    from sim.plant import Plant

FRAME_RATE = 24.0
"""Frames per second of the recording."""

_CAMERA, _LOOK_AT = (-0.45, -0.95, 0.65), (0.45, 0.0, 0.30)


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


def save_replay(trace: Trace, scene: Scene, path: Path | str) -> None:
    """Writes a replay of a trace.

    Args:
        trace: what happened.
        scene: in which it happened.
        path: of the HTML file.
    """
    from pydrake.geometry import Meshcat, MeshcatParams, MeshcatVisualizer, MeshcatVisualizerParams

    with _quiet():  # it reports an address that is gone before anybody could open it
        meshcat = Meshcat(MeshcatParams(host="localhost", show_stats_plot=False))
    meshcat.SetProperty("/Background", "top_color", [0.93, 0.95, 0.97])
    meshcat.SetProperty("/Background", "bottom_color", [0.80, 0.84, 0.88])
    for hidden in ("/Grid", "/Axes"):
        meshcat.SetProperty(hidden, "visible", value=False)
    meshcat.SetCameraPose(np.array(_CAMERA), np.array(_LOOK_AT))
    visualizers = []

    def furnish(builder: DiagramBuilder, model: Plant) -> None:
        params = MeshcatVisualizerParams(publish_period=1.0 / FRAME_RATE)
        visualizers.append(
            MeshcatVisualizer.AddToBuilder(builder, model.scene_graph, meshcat, params)
        )

    stage = Stage(scene, furnish)
    recorder = visualizers[0].StartRecording()
    recorder.set_autoplay(True)
    for sample in samples(trace, FRAME_RATE):
        stage.show(trace, sample)
        stage.diagram.ForcedPublish(stage.context)
    visualizers[0].StopRecording()
    visualizers[0].PublishRecording()
    Path(path).write_text(meshcat.StaticHtml(), encoding="utf-8")
