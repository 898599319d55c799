"""A trace as a viewer plays it: poses, liquid, phases and forces over time, packed as plain data.

Numbers over time are rows of 16-bit integers, each the difference from the one before (which wraps
around), so that they compress well. Poses are interpolated between frames by the viewer.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sim.rotations import Array
from sim.traces.trace import Trace
from sim.truth.scene_file import Scene
from sim.views.liquid_view import parts, triangles
from sim.views.trace_scene import TraceScene, samples
from sim.views.viewer_scene import body_poses, drawn_bodies, viewer_scene

FRAME_RATE = 30.0
"""Frames per second of a recording."""

_LENGTH, _PART, _FORCE = 1e-4, 1.0 / 32767.0, 1e-2  # of one step [m], of a quaternion, [N]
_SAME = 2e-4  # liquid that differs by less keeps its form [m]
_FELT = 0.25  # force from which a finger is shown to press [N]
_MEAN_OVER = 0.1  # time over which a force is averaged [s]
_PUSHES = ("touch", "push")
_GRIPS = ("grasp", "lift", "carry", "pour", "set_down", "lid")
_TABLE = (0.45, 0.0, 0.1)  # what is looked at before anything happens [m]
_OPEN_SIDE, _FROM_BEHIND = -2.3, 0.45  # direction in which no stand is; of a view of a push [rad]


def scene_and_recording(trace: Trace, scene: Scene) -> tuple[dict[str, Any], dict[str, Any]]:
    """A scene as `viewer_scene` has it, and a trace of it as a JSON object."""
    trace = trace.shown
    stage = TraceScene(scene, lambda builder, model: None)
    bodies = drawn_bodies(stage.model)
    at = samples(trace, FRAME_RATE)
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
        "turns": packed_series(poses[:, :, :4], _PART),
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
            if last is not None and _alike(corners_of[last], corners):
                now[key] = last
                forms[last]["to"] = frame
                continue
            now[key] = len(forms)
            corners_of[len(forms)] = corners
            forms.append({
                "body": places[part.name] if part.of == "level" else -1,
                "from": frame,
                "to": frame,
                "step": _LENGTH,
                "corners": _base64(np.rint(corners / _LENGTH).astype("<i2")),
                "faces": _base64(faces.astype("<u2")),
            })  # fmt: skip
    return forms


def _alike(before: Array, now: Array) -> bool:
    return before.shape == now.shape and bool(np.abs(before - now).max() < _SAME)


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
    """Values over time, shape (n, …), each the mean over a short while."""
    step = float(np.median(np.diff(trace.time))) if len(trace.time) > 1 else 1.0
    width = min(max(1, round(_MEAN_OVER / step)), len(values))
    weights = np.full(width, 1.0 / width)
    return np.apply_along_axis(np.convolve, 0, values, weights, "same")


def _force(trace: Trace, at: list[int]) -> dict[str, Any]:
    """The force that is felt at each frame, and the limit in force [N]: of pushes, or of a grip.

    A trace of several pushes has the direction of the last one alone, so the size is told.
    """
    pushed, held = np.isin(trace.phase, _PUSHES), np.isin(trace.phase, _GRIPS)
    forces = [_averaged(trace, force) for force in trace.felt.values()] or [_nothing(trace)]
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


def _nothing(trace: Trace) -> Array:
    return np.zeros((len(trace.time), 3))


def _sizes(forces: ArrayLike) -> Array:
    return np.asarray(np.linalg.norm(forces, axis=-1))


def _fingers(trace: Trace, at: list[int]) -> list[dict[str, Any]]:
    """Per finger: place of its tip in W, and the force of it on the object, 0 if it is little."""
    told = []
    touching = np.isin(trace.phase, _PUSHES + _GRIPS)
    for name in trace.tips:
        force = np.where(touching[:, None], _averaged(trace, trace.felt[name]), 0.0)[at]
        pressing = _sizes(force) > _FELT
        told.append({
            "name": name,
            "places": packed_series(trace.tips[name][at], _LENGTH),
            "forces": packed_series(np.where(pressing[:, None], force, 0.0), _FORCE),
        })  # fmt: skip
    return told


def _view(trace: Trace) -> dict[str, Any]:
    """The eye from which a run is looked at: from beside a single push, a little from behind it."""
    pushes = sum(phase == "push" for phase, _ in groupby(trace.phase.tolist()))
    if pushes != 1:
        return {"azimuth": -2.2, "elevation": 0.42, "distance": 1.75, "at": _TABLE}
    along = np.arctan2(trace.direction[1], trace.direction[0])
    sides = along + np.array([-1.0, 1.0]) * (0.5 * np.pi + _FROM_BEHIND)
    azimuth = float(max(sides, key=lambda side: np.cos(side - _OPEN_SIDE)))
    return {"azimuth": azimuth, "elevation": 0.36, "distance": 2.0, "at": _TABLE}
