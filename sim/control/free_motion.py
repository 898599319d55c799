"""Motion in which nothing is touched: looking about, and joints from one posture to another.

Frames: W is the world.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from planner.types.world_state import Held, WorldState
from sim.cell.cell_description import LOOK
from sim.paths.point_attractor import attractor_points
from sim.perception.state_estimation import estimate_objects
from sim.rotations import Array

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from sim.control.trace_recorder import TraceRecorder
    from sim.worlds.ports import Frame

Progress = Callable[[str, float, str], None]
"""Told of the phase, the simulated time [s] and what happens."""

JOINT_SPEED, JOINT_ACCELERATION = 1.2, 3.0
"""Of the arm in free motion, over all joints together [rad/s], [rad/s²]."""

HAND_SPEED, HAND_ACCELERATION = 0.20, 0.6
"""Of the hand near objects [m/s], [m/s²]."""


def silent(phase: str, time: float, text: str) -> None:
    """Progress that nobody asked for."""


def watch(recorder: TraceRecorder, duration: float) -> list[Frame]:
    """Waits and returns the camera frames that arrive meanwhile.

    Args:
        recorder: through which the robot is stepped.
        duration: how long [s]; longer if no frame arrives.
    """
    port = recorder.port
    frames = port.frames()
    steps = round(duration / port.period)
    while steps > 0 or not frames:
        recorder.step(*port.commanded)
        frames += recorder.frames
        steps -= 1
    return frames


def look_around(
    recorder: TraceRecorder,
    models: Mapping[str, ObjectModel],
    tell: Progress,
    held: Held | None = None,
) -> WorldState:
    """Looks at the table and returns where everything stands.

    Args:
        recorder: through which the robot is stepped.
        models: what the robot believes of every object, by its name in the scene.
        tell: progress.
        held: what the hand holds.
    """
    port = recorder.port
    tell("look", port.time, "looking where everything stands")
    recorder.phase = "look"
    frames = watch(recorder, LOOK)
    return WorldState(estimate_objects(port.cell, frames, models), held=held)


def move_joints(recorder: TraceRecorder, q_arm: Array, q_hand: Array) -> None:
    """Free motion of the arm, the hand opening or closing on the way.

    Args:
        recorder: through which the robot is stepped.
        q_arm: where the arm goes, shape (7,) [rad].
        q_hand: and the hand, shape (12,) [rad].
    """
    start_arm, start_hand = recorder.port.commanded
    length = float(np.linalg.norm(q_arm - start_arm))
    for q in attractor_points(
        start_arm,
        q_arm,
        speed=JOINT_SPEED,
        acceleration=JOINT_ACCELERATION,
        period=recorder.port.period,
    ):
        share = 1.0 - float(np.linalg.norm(q_arm - q)) / length
        recorder.step(q, start_hand + share * (q_hand - start_hand))
