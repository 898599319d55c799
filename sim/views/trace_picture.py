"""A trace as a picture: moments side by side (PNG) or moving (GIF), drawn without a display."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from objectmodels.geometry.rotations import Array
from sim.errors import PictureError
from sim.traces.trace import Trace
from sim.truth.scene_file import Scene
from sim.views.trace_scene import TraceScene, samples, view

if TYPE_CHECKING:
    from PIL.Image import Image
    from pydrake.systems.framework import DiagramBuilder

    from sim.worlds.drake.drake_plant import Plant

_LETTERS = 20  # height of those below a frame [pixels]
_LIBRARIES = ("libEGL.so.1", "libGL.so.1")


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


def save_picture(trace: Trace, scene: Scene, path: Path | str, *, title: str = "") -> None:
    """Writes a picture of a trace: `.png` of four moments side by side, or a moving `.gif`.

    Below each frame stands its time and the phase.

    Args:
        trace: that is shown.
        scene: in which it was recorded.
        path: of the picture.
        title: to stand above it, as the sentence that was said.

    Raises:
        PictureError: another kind, or the machine cannot draw.
    """
    path, trace = Path(path), trace.shown
    kind = path.suffix.lower()
    if kind not in {".png", ".gif"}:
        message = f"a run is drawn as .png or .gif, not as '{kind}'"
        raise PictureError("bad_picture", message, ("name it run.png",))
    missing = missing_libraries()
    if missing:
        raise PictureError(
            "no_pictures",
            f"pictures of a run need {', '.join(missing)}, which this machine lacks",
            (
                "on Debian or Ubuntu: apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri",
                "--replay needs none of it",
            ),
        )
    at, off = np.array([0.45, 0.0, 0.20]), np.array([-0.80, -1.15, 0.42])
    camera = _Camera(scene, *view(trace, at, off))
    if kind == ".png":
        frames = [
            _captioned(camera.frame(trace, sample), f"{_told(trace, sample)}: {words}")
            for words, sample in _moments(trace).items()
        ]
        _side_by_side(frames, title).save(path, format="PNG")
        return
    first, *rest = [
        _captioned(camera.frame(trace, sample), _told(trace, sample))
        for sample in samples(trace, rate=10.0)
    ]
    first.save(path, format="GIF", save_all=True, append_images=rest, duration=100, loop=0)


def _moments(trace: Trace) -> dict[str, int]:
    """Samples before, at the start of what it is about, well into that, and at the end."""
    telling = ("pour", "lid", "carry", "lift", "push")  # the most telling phase first
    about = next((phase for phase in telling if phase in trace.phase), None)
    during = np.flatnonzero(trace.phase == about)
    if not len(during):
        during = np.arange(len(trace.time))
    return {
        "before": 0,
        "it begins": int(during[0]),
        "in the midst of it": int(during[round(0.55 * (len(during) - 1))]),
        "at the end": len(trace.time) - 1,
    }


def _told(trace: Trace, sample: int) -> str:
    """Time and phase of a sample."""
    return f"{trace.time[sample] - trace.time[0]:.1f} s, {trace.phase[sample]}"


def _captioned(frame: Image, text: str) -> Image:
    """The frame with a line of text below it."""
    return _below(_line(text, frame.width, _LETTERS), frame)


def _side_by_side(frames: list[Image], title: str) -> Image:
    from PIL import Image

    width, height = frames[0].size
    sheet = Image.new("RGB", (2 * width, 2 * height))
    for i, frame in enumerate(frames):
        sheet.paste(frame, (width * (i % 2), height * (i // 2)))
    if not title:
        return sheet
    return _below(sheet, _line(f"“{title}”", sheet.width, 1.4 * _LETTERS))


def _below(lower: Image, upper: Image) -> Image:
    from PIL import Image

    sheet = Image.new("RGB", (upper.width, upper.height + lower.height))
    sheet.paste(upper, (0, 0))
    sheet.paste(lower, (0, upper.height))
    return sheet


def _line(text: str, width: int, size: float) -> Image:
    """A line of dark text on white; letters get smaller where they would not fit [pixels]."""
    import matplotlib
    from PIL import Image, ImageDraw, ImageFont

    file = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
    font = ImageFont.truetype(file, size)
    room = (width - 2 * _LETTERS) / max(font.getlength(text), 1.0)
    line = Image.new("RGB", (width, round(1.7 * size)), "white")
    ImageDraw.Draw(line).text(
        (_LETTERS, line.height / 2),
        text,
        "#222222",
        font.font_variant(size=size * min(room, 1.0)),
        anchor="lm",
    )
    return line


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
                type="directional",
                frame="world",
                direction=direction,
                intensity=intensity,
                color=Rgba(1.0, 1.0, 1.0),
            )
            for direction, intensity in (([0.4, 0.6, -1.0], 1.0), ([0.6, -0.5, -0.4], 0.5))
        ]
        model.scene_graph.AddRenderer("vtk", MakeRenderEngineVtk(params))
        core = RenderCameraCore(
            "vtk",
            CameraInfo(640, 480, np.radians(42.0)),
            ClippingRange(0.05, 10.0),
            RigidTransform(),
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
