"""A trace of a push that nobody simulated: a box slides, two fingertips press on it."""

from __future__ import annotations

import numpy as np

from sim.traces.trace import ContactEvent, Trace
from sim.truth.scene_file import Scene

SAMPLES = 200
DURATION = 4.0
"""Of the trace [s]."""

PHASES = ("look", "approach", "touch", "push", "retreat")
FORCE = 4.0
"""With which each fingertip presses during the push [N]."""


def pushed_trace(scene: Scene, name: str, *, way: float = 0.1) -> Trace:
    """A trace of a scene in which an object moves along x while the phase is `push`.

    Args:
        scene: all others of it stand still.
        name: of the object that is pushed.
        way: how far [m].
    """
    time = np.linspace(0.0, DURATION, SAMPLES, dtype=np.float64)
    phase = np.repeat(PHASES, SAMPLES // len(PHASES))
    poses = {}
    for item in scene.objects:
        half = np.radians(item.pose.yaw_deg) / 2.0
        row = [np.cos(half), 0.0, 0.0, np.sin(half), item.pose.x_m, item.pose.y_m, 0.0]
        poses[item.name] = np.tile(row, (SAMPLES, 1))
    pushing = phase == "push"
    moved = way * np.clip(np.cumsum(pushing) / pushing.sum(), 0.0, 1.0)
    poses[name][:, 4] += moved
    aside = np.array([0.0, 0.02, 0.0])
    tip = poses[name][:, 4:] + [-0.055, 0.0, 0.03]
    force = np.where(pushing[:, None], [FORCE, 0.0, 0.0], 0.0)
    return Trace(
        time=time, phase=phase, poses=poses, seen=poses, joints=np.zeros((SAMPLES, 1)),
        joint_names=("arm_joint_1",), tips={"index": tip + aside, "ring": tip - aside},
        felt={"index": force, "ring": force}, force_limit=np.where(pushing, 10.0, 0.0),
        contacts=(ContactEvent(2.4, name, "index_tip"),), pushed=name,
        direction=np.array([1.0, 0.0, 0.0]), end="stroke", detail="", seed=0,
        contents={each.name: np.full(SAMPLES, 1e-4) for each in scene.objects if each.truth.vessel},
        spilled=np.zeros(SAMPLES),
    )  # fmt: skip
