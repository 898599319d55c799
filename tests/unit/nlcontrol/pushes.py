"""Traces made by hand, changed and put on a stage, to play a world that is not as believed."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nlcontrol import Controller
from planner.types.plan import Plan
from planner.types.world_state import PlanarPose
from sim.perception.camera_port import Frame, SeenPose
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
    return replace(trace, poses=poses, seen=poses, tips=tips)


def _headed(yaw: float, q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Quaternions (w, x, y, z) turned about the vertical, shape (n, 4)."""
    c, s = np.cos(yaw / 2), np.sin(yaw / 2)
    w, x, y, z = q.T
    return np.column_stack([c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w])


def shown(poses: Mapping[str, PlanarPose]) -> list[Frame]:
    """What a perfect camera shows of objects."""
    return [Frame(0.0, 0.0, {name: SeenPose(at.R_WB, at.p_WB) for name, at in poses.items()})]


class Stage:
    """Plays the world: what comes of a push is made up, and the object stands where that left it.

    Args:
        monkeypatch: puts it in the place of the simulator.
        controller: whose scene it plays.
        happens: what comes of each push, the last one again and again.
    """

    def __init__(
        self, monkeypatch: pytest.MonkeyPatch, controller: Controller, *happens: Happens
    ) -> None:
        self.holding = None
        self.happens = list(happens)
        self.poses = {name: seen.pose for name, seen in controller.look().objects.items()}
        self.start = self.poses[BOX]
        self.executed: list[Plan] = []
        self.traces: list[Trace] = []
        monkeypatch.setattr("sim.execute", self.execute)
        monkeypatch.setattr("sim.DrakeWorld", lambda *_, **__: self)

    def watch(self, _: float) -> list[Frame]:
        return shown(self.poses)

    def execute(self, plan: Plan, *_: object, progress: Any = None, **__: object) -> Trace:
        if progress is not None:
            progress("push", 1.0, "in contact")
        happens = self.happens.pop(0) if len(self.happens) > 1 else self.happens[0]
        here = self.poses[BOX]
        trace = seen(happens(plan), at=here)
        x, y, _z = trace.displacement(BOX).tolist()
        self.move(x, y, float(trace.yaw(BOX)[-1]))
        self.executed.append(plan)
        self.traces.append(trace)
        return trace

    def move(self, x: float, y: float, turned: float = 0.0) -> None:
        """Moves and turns the object; a camera does not count turns."""
        here = self.poses[BOX]
        yaw = math.remainder(here.yaw + turned, math.tau)
        self.poses[BOX] = replace(here, x=here.x + x, y=here.y + y, yaw=yaw)

    @property
    def moved(self) -> tuple[float, float]:
        """How far the object has come in all [m]."""
        here = self.poses[BOX]
        return here.x - self.start.x, here.y - self.start.y
