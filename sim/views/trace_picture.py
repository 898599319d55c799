"""A trace as a picture: moments side by side (PNG) or moving (GIF), drawn without a display."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.errors import PictureError
from sim.rotations import Array
from sim.traces.trace import Trace
from sim.truth.scene_file import Scene
from sim.views.trace_scene import TraceScene, samples, view

if TYPE_CHECKING:
    from PIL.Image import Image
    from pydrake.systems.framework import DiagramBuilder

    from sim.worlds.drake.drake_plant import Plant

FRAME_RATE = 10.0
"""Frames per second of a moving picture."""

_SIZE = (640, 480)
_LOOK_AT, _FROM = np.array([0.45, 0.0, 0.20]), np.array([-0.80, -1.15, 0.42])
_CHARACTER = ("pour", "lid", "carry", "lift", "push")  # of phases, the most telling first
_WELL_INTO = 0.55  # share of it that has gone by
_LIBRARIES = ("libEGL.so.1", "libGL.so.1")
_PACKAGES = "libegl1 libegl-mesa0 libgl1-mesa-dri"


def missing_libraries() -> tuple[str, ...]:
    """Libraries without which nothing can be drawn here, by name."""
    import ctypes

    missing = []
    for name in _LIBRARIES:
        try:
            ctypes.CDLL(name)
        except OSError:
            missing.append(name)
    return tuple(missing)


def save_picture(trace: Trace, scene: Scene, path: Path | str) -> None:
    """Writes a picture of a trace: `.png` of four moments side by side, or a moving `.gif`.

    Raises:
        PictureError: another kind, or the machine cannot draw.
    """
    path = Path(path)
    kind = path.suffix.lower()
    if kind not in {".png", ".gif"}:
        message = f"a run is drawn as .png or .gif, not as '{kind}'"
        raise PictureError("bad_picture", message, ("name it run.png",))
    missing = missing_libraries()
    if missing:
        raise PictureError(
            "no_pictures",
            f"pictures of a run need {', '.join(missing)}, which this machine lacks",
            (f"on Debian or Ubuntu: apt-get install {_PACKAGES}", "--replay needs none of it"),
        )
    camera = _Camera(scene, *view(trace, _LOOK_AT, _FROM))
    if kind == ".png":
        frames = [camera.frame(trace, sample) for sample in _moments(trace)]
        _side_by_side(frames).save(path, format="PNG")
        return
    first, *rest = [camera.frame(trace, sample) for sample in samples(trace, FRAME_RATE)]
    duration = round(1e3 / FRAME_RATE)
    first.save(path, format="GIF", save_all=True, append_images=rest, duration=duration, loop=0)


def _moments(trace: Trace) -> list[int]:
    """Before, at the start of what it is about, well into that, and at the end."""
    about = next((phase for phase in _CHARACTER if phase in trace.phase), None)
    during = np.flatnonzero(trace.phase == about)
    if not len(during):
        during = np.arange(len(trace.time))
    return [
        0,
        int(during[0]),
        int(during[round(_WELL_INTO * (len(during) - 1))]),
        len(trace.time) - 1,
    ]


def _side_by_side(frames: list[Image]) -> Image:
    from PIL import Image

    width, height = frames[0].size
    sheet = Image.new("RGB", (2 * width, 2 * height))
    for i, frame in enumerate(frames):
        sheet.paste(frame, (width * (i % 2), height * (i // 2)))
    return sheet


class _Camera:
    """Draws a scene as it was at samples of a trace, from an eye that looks at a point."""

    def __init__(self, scene: Scene, eye: Array, at: Array) -> None:
        self._sensor: Any = None
        self._eye, self._at = eye, at
        self._stage = TraceScene(scene, self._furnish)

    def _furnish(self, builder: DiagramBuilder, model: Plant) -> None:
        from pydrake.geometry import (
            ClippingRange,
            ColorRenderCamera,
            DepthRange,
            DepthRenderCamera,
            LightParameter,
            MakeRenderEngineVtk,
            RenderCameraCore,
            RenderEngineVtkParams,
            Rgba,
        )
        from pydrake.math import RigidTransform, RotationMatrix
        from pydrake.systems.sensors import CameraInfo, RgbdSensor

        params = RenderEngineVtkParams()
        params.default_clear_color = np.array([0.93, 0.95, 0.97])
        params.lights = [
            LightParameter(
                type="directional", frame="world", direction=[0.4, 0.6, -1.0], intensity=1.0,
                color=Rgba(1.0, 1.0, 1.0),
            ),
            LightParameter(
                type="directional", frame="world", direction=[0.6, -0.5, -0.4], intensity=0.5,
                color=Rgba(1.0, 1.0, 1.0),
            ),
        ]  # fmt: skip
        model.scene_graph.AddRenderer("vtk", MakeRenderEngineVtk(params))
        core = RenderCameraCore(
            "vtk", CameraInfo(*_SIZE, np.radians(42.0)), ClippingRange(0.05, 10.0), RigidTransform()
        )
        self._sensor = builder.AddSystem(
            RgbdSensor(
                model.scene_graph.world_frame_id(),
                RigidTransform(RotationMatrix(_looking(self._eye, self._at)), self._eye),
                ColorRenderCamera(core),
                DepthRenderCamera(core, DepthRange(0.1, 9.0)),
            )
        )
        builder.Connect(
            model.scene_graph.get_query_output_port(), self._sensor.query_object_input_port()
        )

    def frame(self, trace: Trace, sample: int) -> Image:
        """The scene at a sample."""
        from PIL import Image

        self._stage.show(trace, sample)
        self._stage.fill(trace, sample)
        context = self._sensor.GetMyContextFromRoot(self._stage.context)
        pixels = self._sensor.color_image_output_port().Eval(context).data
        return Image.fromarray(np.array(pixels[:, :, :3]))


def _looking(eye: Array, at: Array) -> Array:
    """Orientation of a camera (z ahead, y down) at a point that looks at another."""
    z = (at - eye) / np.linalg.norm(at - eye)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])
