"""How far models are from tracked pushes: directions of motion, and poses at the end."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.pushing_logs.triangle_logs import ARM, CONTACT_HEIGHT, TrackedPush
from objectmodels import ObjectModel
from objectmodels.geometry.base_shapes import Array, Polygon

FINGER_FRICTIONS = np.arange(0.20, 0.71, 0.05)
"""Coefficients at the finger that are tried on training pushes."""


def angle_errors(model: ObjectModel, pushes: Sequence[TrackedPush]) -> Array:
    """Angles between the twist under each mean push and the one that was seen, shape (n,) [°].

    Turns count as displacements of an `ARM`. That of what topples by the model is 90°.
    """
    p, force = (np.array(v) for v in zip(*(push.mean_push for push in pushes), strict=True))
    level = np.zeros((len(p), 1))
    u = np.column_stack((force / np.hypot(*force.T)[:, None], level))
    t = model.thresholds(np.column_stack((p, level + CONTACT_HEIGHT)), u, exact=True)
    units = [1.0, 1.0, ARM]
    seen = np.array([push.pose for push in pushes]) * units
    told = t.twist[:, [3, 4, 2]] * units
    told[t.outcome != "slide"] = np.nan
    cosine = (seen * told).sum(axis=1) / np.sqrt((seen**2).sum(axis=1) * (told**2).sum(axis=1))
    return np.asarray(np.degrees(np.arccos(np.clip(np.nan_to_num(cosine), -1.0, 1.0))))


def pose_errors(model: ObjectModel, pushes: Sequence[TrackedPush], *, exact: bool = True) -> Array:
    """Distances of predicted poses from those seen at the end, shape (n,) [m].

    A displacement's error and that of the turn times `ARM`, added, as in the source. The prediction
    knows the pose before and the straight way of the tip, a point.
    """
    ways = [_way_from_touch(model, push) for push in pushes]
    p, normal, d, travel = (np.array(v) for v in zip(*ways, strict=True))
    pose = model.stroke(p, normal, d, travel, exact=exact).pose
    return size_of_motion(pose - np.array([push.pose for push in pushes]))


def size_of_motion(change: Array) -> Array:
    """Displacement and turn times `ARM`, added, of changes x, y [m], θ [rad], shape (n,) [m]."""
    turn = (change[:, 2] + np.pi) % (2.0 * np.pi) - np.pi
    return np.asarray(np.hypot(change[:, 0], change[:, 1]) + ARM * np.abs(turn))


def finger_friction(model: ObjectModel, pushes: Sequence[TrackedPush]) -> float:
    """Coefficient at the finger, of `FINGER_FRICTIONS`, with which poses are met best."""
    tried = [
        pose_errors(model.model_copy(update={"finger_friction": float(mu)}), pushes).mean()
        for mu in FINGER_FRICTIONS
    ]
    return float(FINGER_FRICTIONS[int(np.argmin(tried))])


def _way_from_touch(model: ObjectModel, push: TrackedPush) -> tuple[Array, Array, Array, float]:
    """Contact (3,), normal (3,), direction (3,) and travel from where the tip meets the outline."""
    way = push.tip[-1] - push.tip[0]
    length = float(np.hypot(*way))
    d = way / length
    outline = Polygon.convex(model.outline)
    facing = outline.normals @ d
    with np.errstate(divide="ignore"):
        gone = (outline.offsets - outline.normals @ push.tip[0]) / facing
    # Of the sides that it enters by, the last one that it crosses.
    side = int(np.argmax(np.where(facing < 0.0, gone, -np.inf)))
    touch = push.tip[0] + gone[side] * d
    return (
        np.append(touch, CONTACT_HEIGHT),
        np.append(outline.normals[side], 0.0),
        np.append(d, 0.0),
        length - float(gone[side]),
    )
