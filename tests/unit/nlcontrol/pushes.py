"""Traces made by hand and changed, of a world that is not as believed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from planner.types.plan import Plan
from planner.types.world_state import PlanarPose
from sim.traces.trace import Trace

TraceMaker = Callable[..., Trace]
Happens = Callable[[Plan], Trace]

BOX = "ice tea box"

FORWARDS = (0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0)
"""Attitude of what fell away from the robot, row by row."""


def stuck(trace: Trace) -> Trace:
    """The same force, but nothing moved."""
    return replace(
        trace,
        end="force",
        poses={name: np.tile(p[0], (len(p), 1)) for name, p in trace.poses.items()},
        tips={name: np.tile(p[0], (len(p), 1)) for name, p in trace.tips.items()},
    )


def seen(trace: Trace, at: PlanarPose | None = None) -> Trace:
    """A perfect camera saw everything; the object began at a pose, where another push had left it.

    Args:
        trace: in which the object begins with heading 0.
        at: where it began; as it is in the trace if not given.
    """
    poses = {name: p.copy() for name, p in trace.poses.items()}
    tips = trace.tips
    if at is not None:
        own = poses[trace.pushed]
        by = np.array([at.x, at.y]) - own[0, 4:6]
        own[:, 4:6] += by
        own[:, :4] = _headed(at.yaw, own[:, :4])
        tips = {name: p + np.array([*by, 0.0]) for name, p in tips.items()}
    return sighted(replace(trace, poses=poses, seen=poses, tips=tips))


def sighted(trace: Trace) -> Trace:
    """A camera that never errs showed all of it, 33 times a second."""
    frames = np.unique([*range(0, len(trace.time), 3), len(trace.time) - 1])
    sightings = {
        name: np.column_stack([trace.time, poses])[frames] for name, poses in trace.poses.items()
    }
    return replace(trace, sightings=sightings)


def _headed(yaw: float, q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Quaternions (w, x, y, z) turned about the vertical, shape (n, 4)."""
    c, s = np.cos(yaw / 2), np.sin(yaw / 2)
    w, x, y, z = q.T
    return np.column_stack([c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w])
