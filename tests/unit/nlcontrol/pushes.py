"""What traces made by hand are changed into, to play a world that is not as believed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from sim.trace import Trace

TraceMaker = Callable[..., Trace]


def stuck(trace: Trace) -> Trace:
    """The same force, but nothing moved."""
    return replace(
        trace,
        end="force",
        poses={name: np.tile(p[0], (len(p), 1)) for name, p in trace.poses.items()},
        tips={name: np.tile(p[0], (len(p), 1)) for name, p in trace.tips.items()},
    )


def seen(trace: Trace, moved_by: tuple[float, float] = (0.0, 0.0)) -> Trace:
    """The object began where another push had left it, and a perfect camera saw everything."""
    poses = {name: p.copy() for name, p in trace.poses.items()}
    poses[trace.pushed][:, 4:6] += moved_by
    tips = {name: p + np.array([*moved_by, 0.0]) for name, p in trace.tips.items()}
    return replace(trace, poses=poses, seen=poses, tips=tips)
