"""The two sides of a world: what a robot may command and sense, and what an observer may see.

A controller gets a `RobotPort` and nothing else of a world; hardware could stand behind it. An
`ObserverPort` knows the truth; it is for judging, replay and reports, never for control.

Frames: W is the world, B an object.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np

from objectmodels.geometry.rotations import Array

if TYPE_CHECKING:
    from planner.types.world_state import Colour
    from sim.robots.cell_description import CellDescription
    from sim.robots.hand import Angles
    from sim.truth.object_truth import Truth


@dataclass(frozen=True)
class SeenPose:
    """A pose as seen: R_WB, shape (3, 3), and p_WB, shape (3,) [m]."""

    R_WB: Array
    p_WB: Array

    @property
    def tilt(self) -> float:
        """Angle between B's z axis and the vertical [rad]."""
        return float(np.arccos(np.clip(self.R_WB[2, 2], -1.0, 1.0)))


@dataclass(frozen=True)
class Frame:
    """One camera frame of `time` [s]; it can be read from `arrival` [s] on.

    Attributes:
        poses: of all objects, and of lids that are off by their own names.
        lids: how far each lid is open, as in `sim.traces.trace.Trace.lids`.
        colours: of the objects, sRGB in 0…1; light and noise do not count.
        levels: height of what is in each open container that stands, over its cavity's bottom [m].
    """

    time: float
    arrival: float
    poses: Mapping[str, SeenPose]
    lids: Mapping[str, float] = field(default_factory=dict)
    colours: Mapping[str, Colour] = field(default_factory=dict)
    levels: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Sample:
    """The world at one time, as it truly is.

    Attributes:
        time: [s].
        poses: per object, quaternion (w, x, y, z) and position p_WB [m], shape (7,).
        joints: angles of all robot joints, shape (23,) [rad].
        contents: per container, volume in it [m³].
        spilled: volume that ran out and into none of them [m³].
        lids: how far each lid is open, as in `sim.traces.trace.Trace.lids`.
        lid_poses: as in `sim.traces.trace.Trace.lid_poses`, shape (7,) each.
    """

    time: float
    poses: Mapping[str, Array]
    joints: Array
    contents: Mapping[str, float] = field(default_factory=dict)
    spilled: float = 0.0
    lids: Mapping[str, float] = field(default_factory=dict)
    lid_poses: Mapping[str, Array] = field(default_factory=dict)


@dataclass(frozen=True)
class BodyContact:
    """Two bodies that began to touch at `time` [s], by their names."""

    time: float
    body_a: str
    body_b: str


@dataclass(eq=False)
class WorldRecord:
    """A record of a world, from when it was begun for as long as somebody keeps it.

    Attributes:
        samples: the world when it was begun, and after every control step since.
        contacts: touches that began since, in order of time.
    """

    samples: list[Sample]
    contacts: list[BodyContact] = field(default_factory=list)


class RobotPort(Protocol):
    """Commands to a robot and the readings of its sensors.

    Attributes:
        cell: what the robot is told; data sheets of its sensors among it.
        joint_names: of all joints, the arm's first.
        period: time of a control step [s].
    """

    cell: CellDescription
    joint_names: tuple[str, ...]
    period: float

    @property
    def time(self) -> float:
        """Time since the start [s]."""

    @property
    def commanded(self) -> tuple[Array, Array]:
        """Angles last commanded to arm and hand, shapes (7,) and (12,) [rad]."""

    @property
    def torque_noise(self) -> float:
        """Standard deviation of a torque sensor's reading in a control step [N·m]."""

    def step(self, q_arm: Array, q_hand: Array) -> None:
        """Commands joint angles and lets one control period pass.

        Args:
            q_arm: of the arm's joints, shape (7,) [rad].
            q_hand: of the fingers' independent joints, shape (12,) [rad].
        """

    def arm_angles(self) -> Array:
        """Measured angles of the arm's joints, shape (7,) [rad]."""

    def finger_angles(self, finger: str) -> Angles:
        """Measured angles of a finger's independent joints [rad]."""

    def finger_torques(self, finger: str) -> Array:
        """Measured torques of a finger's joints, shape (3,) [N·m].

        They are means of the samples since the last control step. The torque of the middle joint
        drives the distal joint too.
        """

    def frames(self) -> list[Frame]:
        """Camera frames that arrived since the last call."""


class ObserverPort(Protocol):
    """The truth of a world.

    Attributes:
        seed: of everything random in it.
    """

    seed: int

    def record(self) -> WorldRecord:
        """Begins a record; the world itself keeps nothing of what was."""

    def truth_now(self, name: str) -> Truth:
        """The truth of an object at this time."""


class WallClock:
    """The clock on the wall, to which a simulated world is held back while somebody looks.

    What happens in a world does not depend on it, but when it happens does.

    Args:
        now: the time [s].
        sleep: waits for so long [s].

    Attributes:
        runs: steps are held back.
    """

    def __init__(
        self,
        now: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], object] = time.sleep,
    ) -> None:
        self._now, self._sleep = now, sleep
        self.runs = False
        self._due = -math.inf

    def wait(self, period: float) -> None:
        """Waits until a step of a period [s] is over by the clock on the wall."""
        if not self.runs:
            return
        now = self._now()
        # Of a delay so much is made up for; what came before that is let go.
        self._due = max(self._due + period, now - 0.1)
        if self._due > now:
            self._sleep(self._due - now)
