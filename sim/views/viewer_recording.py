"""A trace as a viewer plays it: poses, liquid, phases and forces over time, packed as plain data.

Numbers over time are rows of 16-bit integers, each the difference from the one before (which wraps
around), so that they compress well. Poses are interpolated between frames by the viewer.
"""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from html import escape
from importlib import resources
from itertools import groupby
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.geometry.rotations import Array
from sim.traces.trace import Trace
from sim.truth.scene_file import Scene
from sim.views.run_story import RunStory, StoryWord
from sim.views.trace_scene import (
    COLOUR,
    FLOOR,
    TraceScene,
    believed_shapes,
    furniture,
    object_shapes,
    parts,
    samples,
    triangles,
)
from sim.worlds.drake.drake_plant import Plant, pose_row

if TYPE_CHECKING:
    from pydrake.geometry import GeometryId, SceneGraphInspector, Shape
    from pydrake.multibody.tree import RigidBody
    from pydrake.systems.framework import Context

    from objectmodels import ObjectModel
    from sim.worlds.ports import Sample


MODULES = (
    "vendor/three.core.min.js",
    "vendor/three.module.min.js",
    "frame_track.js",
    "body_shapes.js",
    "force_markers.js",
    "orbit_camera.js",
    "render_quality.js",
    "viewer.js",
    "player.js",
    "force_chart.js",
    "timeline.js",
    "play_controls.js",
    "replay.js",
)
"""Modules of the page; each stands after those that it imports."""

_LENGTH, _FORCE = 1e-4, 1e-2  # of one step [m], [N]
_PUSHES = ("touch", "push")
_GRIPS = ("grasp", "lift", "carry", "pour", "set_down", "lid")


def viewer_scene(scene: Scene, model: Plant) -> dict[str, Any]:
    """The bodies of a scene and of its plant, in the order of `body_poses`, as a JSON object.

    A body is named by its model and by its own name there, as `mug/mug` or `lwr_arm/arm_link_1`.
    The table belongs to `WorldModelInstance/world`, which does not move. The shapes are those that
    the plant has for pictures, and what `sim.views.trace_scene` adds. A pose is a row of
    quaternion (w, x, y, z) and position [m]: of a shape in its body, of a body in W.
    """
    inspector = model.scene_graph.model_inspector()
    bodies = []
    for body in drawn_bodies(model):
        kind, owner = _kind_and_object(model, body)
        shapes = [_drawn(inspector, each) for each in _seen_geometries(model, body)]
        if kind == "object":
            shapes = object_shapes(scene.object(body.name()), shapes)
        elif kind == "world":
            shapes = furniture(scene, shapes)
        name = body_name(body)
        bodies.append({"name": name, "kind": kind, "object": owner, "shapes": shapes})
    return _document(scene.name, bodies)


def believed_scene(name: str, models: Mapping[str, ObjectModel]) -> dict[str, Any]:
    """Objects as they are believed to be, as `viewer_scene` has bodies.

    Args:
        name: of the scene.
        models: of the objects, by their names there.
    """
    bodies = [
        {"name": each, "kind": "object", "object": each, "shapes": believed_shapes(each, model)}
        for each, model in models.items()
    ]
    return _document(name, bodies)


def _document(name: str, bodies: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "format": "nlcontrol-viewer-scene/1",
        "name": name,
        "floor": FLOOR,
        "liquid": list(COLOUR),
        "bodies": bodies,
    }


class SceneBodies:
    """Robot, table and objects of a scene, apart from any world in which something happens.

    Args:
        scene: what is shown.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._stage = TraceScene(scene, lambda builder, model: None)
        self._bodies = drawn_bodies(self._stage.model)

    def document(self) -> dict[str, Any]:
        """All that is drawn; see `viewer_scene`."""
        return viewer_scene(self._scene, self._stage.model)

    def poses(self, sample: Sample, joint_names: Sequence[str]) -> dict[str, tuple[float, ...]]:
        """Poses of all bodies: quaternion (w, x, y, z) and position in W [m], by their names.

        Args:
            sample: of a world of this scene.
            joint_names: of the angles in it.
        """
        joints = dict(zip(joint_names, sample.joints.tolist(), strict=True))
        stage = self._stage
        stage.put(joints, sample.poses, sample.lids, sample.lid_poses)
        rows = body_poses(stage.model, self._bodies, stage.plant_context)
        return {
            body_name(body): tuple(rounded_values(row))
            for body, row in zip(self._bodies, rows, strict=True)
        }


def body_name(body: RigidBody) -> str:
    """Name of a body, which no other one of its plant has."""
    name: str = body.scoped_name().get_full()
    return name.replace("::", "/")


def drawn_bodies(model: Plant) -> list[RigidBody]:
    """The bodies of a plant that have something to be seen, in the order of the plant."""
    from pydrake.multibody.tree import BodyIndex

    plant = model.plant
    every = [plant.get_body(BodyIndex(i)) for i in range(plant.num_bodies())]
    return [body for body in every if _seen_geometries(model, body)]


def body_poses(model: Plant, bodies: list[RigidBody], context: Context) -> Array:
    """Poses of bodies in W, shape (n, 7), in a context of the plant."""
    return np.array([pose_row(model.plant.EvalBodyPoseInWorld(context, body)) for body in bodies])


def _kind_and_object(model: Plant, body: RigidBody) -> tuple[str, str | None]:
    """The kind of a body, and the name of the object that it is, or whose lid it is."""
    if body.index() == model.plant.world_body().index():
        return "world", None
    if body.model_instance() in (model.arm, model.hand):
        return "robot", None
    lids = {lid.body.index(): name for name, lid in model.lids.items()}
    if body.index() in lids:
        return "lid", lids[body.index()]
    bodies = {each.index(): name for name, each in model.bodies.items()}
    return "object", bodies.get(body.index())


def _seen_geometries(model: Plant, body: RigidBody) -> list[GeometryId]:
    from pydrake.geometry import Role

    frame = model.plant.GetBodyFrameIdOrThrow(body.index())
    found: list[GeometryId] = model.scene_graph.model_inspector().GetGeometries(
        frame, Role.kIllustration
    )
    return found


def _drawn(inspector: SceneGraphInspector, geometry: GeometryId) -> dict[str, Any]:
    """A geometry as a shape with its place and colour."""
    from pydrake.geometry import Rgba

    properties = inspector.GetIllustrationProperties(geometry)
    colour = properties.GetPropertyOrDefault("phong", "diffuse", Rgba(0.8, 0.8, 0.8, 1.0))
    return {
        "name": inspector.GetName(geometry).rpartition("::")[2],
        "pose": rounded_values(pose_row(inspector.GetPoseInFrame(geometry))),
        "colour": rounded_values(np.array([colour.r(), colour.g(), colour.b(), colour.a()])),
        **_form(inspector.GetShape(geometry)),
    }


def _form(shape: Shape) -> dict[str, Any]:
    """The kind and the measures of a shape [m]."""
    from pydrake.geometry import Box, Capsule, Cylinder, Sphere

    match shape:
        case Box():
            return {"kind": "box", "size": rounded_values(shape.size())}
        case Sphere():
            return {"kind": "sphere", "radius": shape.radius()}
        case Cylinder():
            return {"kind": "cylinder", "radius": shape.radius(), "length": shape.length()}
        case Capsule():
            return {"kind": "capsule", "radius": shape.radius(), "length": shape.length()}
    hull = shape.GetConvexHull()
    corners = np.array([hull.vertex(i) for i in range(hull.num_vertices())])
    corners, faces = triangles([corners])
    return {
        "kind": "mesh",
        "corners": rounded_values(corners.ravel()),
        "faces": faces.ravel().tolist(),
    }


def rounded_values(values: Array) -> list[float]:
    """Numbers as a document has them, to the hundredth of a millimetre."""
    listed: list[float] = np.round(values, 5).tolist()
    return listed


def scene_and_recording(trace: Trace, scene: Scene) -> tuple[dict[str, Any], dict[str, Any]]:
    """A scene as `viewer_scene` has it, and a trace of it as a JSON object."""
    trace = trace.shown
    stage = TraceScene(scene, lambda builder, model: None)
    bodies = drawn_bodies(stage.model)
    at = samples(trace, rate=30.0)
    rows = []
    for sample in at:
        stage.show(trace, sample)
        rows.append(body_poses(stage.model, bodies, stage.plant_context))
    poses = _continuous(np.array(rows))
    places = {
        name: bodies.index(body) for name, body in stage.model.bodies.items()
    }  # of objects among the bodies
    recording = {
        "times": [_since(trace, float(time)) for time in trace.time[at]],
        "turns": packed_series(poses[:, :, :4], 1.0 / 32767.0),  # in 16 bits
        "places": packed_series(poses[:, :, 4:], _LENGTH),
        "liquid": _liquid(trace, scene, at, places),
        "phases": _phases(trace),
        "touches": _touches(trace),
        "force": _force(trace, at),
        "fingers": _fingers(trace, at),
        "pushed": places[trace.pushed],
        "view": _view(trace),
    }
    return viewer_scene(scene, stage.model), recording


def packed_series(values: Array, step: float) -> dict[str, Any]:
    """Numbers over time, shape (n, …): for each place in the rest a row of n differences."""
    steps = np.clip(np.rint(np.asarray(values, float) / step), -32768, 32767).astype("<i2")
    rows = np.moveaxis(steps, 0, -1).reshape(-1, len(steps))
    differences = np.diff(rows, axis=1, prepend=np.zeros((len(rows), 1), "<i2"))
    return {"step": step, "rows": len(rows), "data": _base64(differences.astype("<i2"))}


def _base64(values: Any) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()


def _continuous(poses: Array) -> Array:
    """Poses (n, bodies, 7) whose quaternions are nearest to those before, not to the negative."""
    turns = poses[:, :, :4]
    flips = np.sum(turns[1:] * turns[:-1], axis=2) < 0.0
    signs = np.cumprod(np.where(flips, -1.0, 1.0), axis=0)
    turns[1:] *= signs[:, :, None]
    return poses


def _liquid(
    trace: Trace, scene: Scene, at: list[int], places: Mapping[str, int]
) -> list[dict[str, Any]]:
    """Forms that liquid takes, each with the frames from and to which it has it.

    What stands in a container is in the frame of that body, a stream in W: its body is -1.
    """
    forms: list[dict[str, Any]] = []
    corners_of: dict[int, Array] = {}
    now: dict[tuple[str, str], int] = {}
    for frame, sample in enumerate(at):
        before, now = now, {}
        for part in parts(trace, scene, sample):
            key = (part.name, part.of)
            if not part.pieces:
                continue
            last = before.get(key)
            corners, faces = triangles(part.pieces)
            # What differs by less keeps its form.
            if (
                last is not None
                and corners_of[last].shape == corners.shape
                and np.abs(corners_of[last] - corners).max() < 2e-4
            ):
                now[key] = last
                forms[last]["to"] = frame
                continue
            now[key] = len(forms)
            corners_of[len(forms)] = corners
            forms.append(
                {
                    "body": places[part.name] if part.of == "level" else -1,
                    "from": frame,
                    "to": frame,
                    "step": _LENGTH,
                    "corners": _base64(np.rint(corners / _LENGTH).astype("<i2")),
                    "faces": _base64(faces.astype("<u2")),
                }
            )
    return forms


def _phases(trace: Trace) -> list[dict[str, Any]]:
    """Phases in their order, each with the time at which it begins [s]."""
    begins = []
    sample = 0
    for phase, members in groupby(trace.phase.tolist()):
        begins.append({"phase": phase, "time": _since(trace, float(trace.time[sample]))})
        sample += len(list(members))
    return begins


def _touches(trace: Trace) -> list[dict[str, Any]]:
    """Bodies that began to touch, with the time [s]."""
    return [
        {"time": _since(trace, each.time), "bodies": [each.body_a, each.body_b]}
        for each in trace.contacts
    ]


def _since(trace: Trace, time: float) -> float:
    return round(time - float(trace.time[0]), 3)


def _averaged(trace: Trace, values: Array) -> Array:
    """Values over time, shape (n, …), each the mean over a tenth of a second."""
    step = float(np.median(np.diff(trace.time))) if len(trace.time) > 1 else 1.0
    width = min(max(1, round(0.1 / step)), len(values))
    weights = np.full(width, 1.0 / width)
    return np.apply_along_axis(np.convolve, 0, values, weights, "same")


def _force(trace: Trace, at: list[int]) -> dict[str, Any]:
    """The force that is felt at each frame, and the limit in force [N]: of pushes, or of a grip.

    A trace of several pushes has the direction of the last one alone, so the size is told.
    """
    pushed, held = np.isin(trace.phase, _PUSHES), np.isin(trace.phase, _GRIPS)
    forces = [_averaged(trace, force) for force in trace.felt.values()] or [
        np.zeros((len(trace.time), 3))
    ]
    if pushed.any():
        label, felt = "force of the push", np.where(pushed, _sizes(np.sum(forces, axis=0)), 0.0)
    elif held.any():
        label, felt = "squeeze of the hand", np.where(held, _sizes(forces).max(axis=0), 0.0)
    else:
        label, felt = "", np.zeros(len(trace.time))
    return {
        "label": label,
        "felt": packed_series(felt[at], _FORCE),
        "limit": packed_series(np.where(pushed, trace.force_limit, 0.0)[at], _FORCE),
    }


def _sizes(forces: ArrayLike) -> Array:
    return np.asarray(np.linalg.norm(forces, axis=-1))


def _fingers(trace: Trace, at: list[int]) -> list[dict[str, Any]]:
    """Per finger: place of its tip in W, and the force of it on the object, 0 if it is little."""
    told = []
    touching = np.isin(trace.phase, _PUSHES + _GRIPS)
    for name in trace.tips:
        force = np.where(touching[:, None], _averaged(trace, trace.felt[name]), 0.0)[at]
        pressing = _sizes(force) > 0.25
        told.append(
            {
                "name": name,
                "places": packed_series(trace.tips[name][at], _LENGTH),
                "forces": packed_series(np.where(pressing[:, None], force, 0.0), _FORCE),
            }
        )
    return told


def _view(trace: Trace) -> dict[str, Any]:
    """The eye from which a run is looked at: from beside a single push, a little from behind it."""
    table = (0.45, 0.0, 0.1)  # what is looked at before anything happens [m]
    pushes = sum(phase == "push" for phase, _ in groupby(trace.phase.tolist()))
    if pushes != 1:
        return {"azimuth": -2.2, "elevation": 0.42, "distance": 1.75, "at": table}
    along = np.arctan2(trace.direction[1], trace.direction[0])
    sides = along + np.array([-1.0, 1.0]) * (0.5 * np.pi + 0.45)
    # No stand is in the direction of -2.3 rad.
    azimuth = float(max(sides, key=lambda side: np.cos(side + 2.3)))
    return {"azimuth": azimuth, "elevation": 0.36, "distance": 2.0, "at": table}


def save_replay(
    trace: Trace, scene: Scene, path: Path | str, *, story: RunStory | None = None
) -> None:
    """Writes a replay of a trace and its scene to an HTML file.

    Args:
        trace: what happened.
        scene: in which.
        path: of the file.
        story: what the page tells besides; without one it shows the motion alone.
    """
    Path(path).write_text(replay_page(trace, scene, story), encoding="utf-8")


def replay_page(trace: Trace, scene: Scene, story: RunStory | None = None) -> str:
    """The replay as the text of an HTML document, which needs no network.

    The page is `page/replay.html` with its style and one small script in it. That script unpacks
    the modules of the viewer and the data, which stand in the page compressed. A content-security
    policy admits this script and what it unpacks, and no address at all.
    """
    told = story or _bare_story(trace)
    packed = _packed(
        {
            "modules": [(name.rpartition("/")[2], _page_file(name)) for name in MODULES],
            "run": _replay_content(trace, scene, told),
        }
    )
    loader = f"\n{_page_file('replay_loader.js')}"
    style = f"\n{_page_file('look.css')}{_page_file('replay.css')}"
    return Template(_page_file("replay.html")).substitute(
        policy=_policy(loader, style),
        title=escape(told.title.encode("utf-8", "replace").decode()),
        style=style,
        packed=base64.b64encode(packed).decode(),
        loader=loader,
    )


def save_recording(
    trace: Trace, scene: Scene, path: Path | str, *, story: RunStory | None = None
) -> None:
    """Writes what a replay shows, for another page with the same viewer: JSON, compressed (gzip).

    The object has a `scene` (see `sim.views.viewer_recording`), its `recording` (see
    `sim.views.viewer_recording`) and the `story`; the arguments are those of `save_replay`.
    """
    content = _replay_content(trace, scene, story or _bare_story(trace))
    Path(path).write_bytes(_packed(content))


def _replay_content(trace: Trace, scene: Scene, story: RunStory) -> dict[str, Any]:
    drawn, recording = scene_and_recording(trace, scene)
    return {"scene": drawn, "recording": recording, "story": asdict(story)}


def _packed(content: Mapping[str, Any]) -> bytes:
    text = json.dumps(content, ensure_ascii=False, separators=(",", ":"))
    return gzip.compress(text.encode("utf-8", "replace"), mtime=0)


def _bare_story(trace: Trace) -> RunStory:
    title = f"A run with the {trace.pushed}"
    return RunStory(title=title, words=(StoryWord(title, "", 0, len(title)),))


def _page_file(name: str) -> str:
    return (resources.files("sim.views") / "page" / name).read_text("utf-8")


def _policy(script: str, style: str) -> str:
    """The policy that admits one script, what it unpacks, and one style."""
    rules = {
        "default-src": "'none'",
        "script-src": f"'{_digest(script)}' blob:",
        "style-src": f"'{_digest(style)}'",
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    return "; ".join(f"{rule} {allowed}" for rule, allowed in rules.items())


def _digest(text: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode('utf-8')).digest()).decode()}"
