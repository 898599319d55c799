"""The robot in its cell, and its motion in which nothing is touched: looking, changing posture.

Frames: W is the world.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.rotations import Array
from planner.types.world_state import Held, WorldState
from sim.control.object_estimate import estimate_objects
from sim.control.trace_recorder import TraceRecorder
from sim.motion.held_object_path import attractor_points
from sim.robots.cell_description import LOOK
from sim.supervision import Progress

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from sim.control.held_object_sensing import Holding
    from sim.motion.robot_reach import ArmHandReach
    from sim.robots.hand import Posture
    from sim.worlds.ports import Frame, ObserverPort, RobotPort

JOINT_SPEED, JOINT_ACCELERATION = 1.2, 3.0
"""Of the arm in free motion, over all joints together [rad/s], [rad/s²]."""

HAND_SPEED, HAND_ACCELERATION = 0.20, 0.6
"""Of the hand near objects [m/s], [m/s²]."""

_CHANGING = 0.4  # share of a way on which the hand takes another posture


@dataclass
class RobotSetup:
    """A robot in its cell.

    Attributes:
        port: its commands and sensors.
        observer: of the world in which it stands, for traces alone.
        reach: of arm and hand.
        holding: what lasts of a grasp from one execution to the next; None if nothing is held.
    """

    port: RobotPort
    observer: ObserverPort
    reach: ArmHandReach
    holding: Holding | None = None

    @property
    def held(self) -> Held | None:
        """The object in the hand, as plans know it; None if there is none."""
        return None if self.holding is None else self.holding.held

    def recorder(self, normal_W: Array, progress: Progress | None = None) -> TraceRecorder:
        """A new record from now on; see `TraceRecorder`."""
        return TraceRecorder(self.port, self.observer, self.reach.mount, normal_W, progress)


def watch(recorder: TraceRecorder, duration: float) -> list[Frame]:
    """Waits [s], longer if no frame arrives; returns the camera frames that arrive meanwhile."""
    port = recorder.port
    frames = port.frames()
    steps = round(duration / port.period)
    while steps > 0 or not frames:
        recorder.step(*port.commanded)
        frames += recorder.frames
        steps -= 1
    return frames


def look_around(
    recorder: TraceRecorder, models: Mapping[str, ObjectModel], held: Held | None = None
) -> WorldState:
    """Looks at the table and returns where everything stands, what is held with it."""
    recorder.begin("look", "looking where everything stands")
    frames = watch(recorder, LOOK)
    objects = estimate_objects(recorder.port.cell, frames, models, held)
    recorder.rests = {name: seen.rest for name, seen in objects.items() if seen.rest is not None}
    return WorldState(objects, held=held)


def transit(
    recorder: TraceRecorder, posture: Posture, way: Iterable[Array], came: list[Array]
) -> None:
    """Free motion of the arm along a way, the hand taking its posture, which pushes from then on.

    As it is made, `came` gets the arm angles at the start and on the way, without its end, shape
    (7,) each [rad].
    """
    recorder.begin("transit", f"moving the hand ({posture.name})")
    recorder.fingers = posture.pushing
    for q in way:
        came.append(recorder.port.commanded[0])
        move_joints(recorder, q, posture.joint_angles)


def return_home(recorder: TraceRecorder, came: Sequence[Array], settle: float) -> None:
    """Free motion back the way that the arm came, as `transit` returns it; then a rest [s].

    The hand closes on the last way.
    """
    rest = recorder.mount.hand.resting.joint_angles
    for q in reversed(came):
        hand = rest if q is came[0] else recorder.port.commanded[1]
        move_joints(recorder, q, hand, homeward=True)
    recorder.begin("settle", "letting everything come to rest")
    for _ in range(round(settle / recorder.port.period)):
        recorder.step(*recorder.port.commanded)


def straight_line(start: Array, goal: Array, period: float) -> Iterator[Array]:
    """Places on the way of a hand near objects, one for each control step, shape (n,) each [m]."""
    return attractor_points(
        start, goal, speed=HAND_SPEED, acceleration=HAND_ACCELERATION, period=period
    )


def move_joints(
    recorder: TraceRecorder, q_arm: Array, q_hand: Array, *, homeward: bool = False
) -> None:
    """Free motion to angles of arm, shape (7,), and hand, shape (12,) [rad].

    Ways are free for a hand that has opened: it opens on the first part of one, near home, and
    closes on the last part of one that leads there.
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
        left = float(np.linalg.norm(q_arm - q)) / length
        share = (
            1.0 - _smooth_step(left / _CHANGING)
            if homeward
            else _smooth_step((1.0 - left) / _CHANGING)
        )
        recorder.step(q, start_hand + share * (q_hand - start_hand))


def _smooth_step(share: float) -> float:
    """From 0 at 0 to 1 at 1, level at both ends and beyond."""
    x = min(max(share, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)
