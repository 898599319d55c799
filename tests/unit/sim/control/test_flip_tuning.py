"""Figures of a flip that protect: when the finger lets go of a lid that does not move as it should.

The cup and its lid are scripted, seen without noise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import pytest

from objectmodels import Registry
from objectmodels.geometry.rotations import Array, rot_y
from planner.types.actions import FlipOver
from planner.types.robot import ReachAnswer
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim.control.grasp_control import FlipControl
from sim.control.trace_recorder import TraceRecorder
from sim.motion.motion_planner import FlipConfiguration
from sim.worlds.ports import SeenPose
from tests.plans import EASY_FLIP
from tests.unit.sim.control.scripted_robot import REACH, ScriptedRobot

CUP = "ice tea cup"
AT = np.array([0.24, 0.20, 0.0])
OPEN = math.radians(100.0)
LIMIT = 1.5  # of the force [N]


@dataclass
class Cup:
    """A cup whose lid goes with the fingertip, or is stuck.

    Attributes:
        configuration: of arm and hand at the lid.
        stuck: the lid does not move.
        leaning, moving: rates of the cup from the touch on [rad/s], [m/s].
    """

    configuration: FlipConfiguration
    stuck: bool = False
    leaning: float = 0.0
    moving: float = 0.0
    angle: float = 0.0
    touched: float = np.inf
    time: float = 0.0
    pressed: list[tuple[float, float]] = field(default_factory=list)

    def press(self, tips: dict[str, Array], time: float) -> dict[str, Array]:
        found, self.time = self.configuration, time
        (finger,) = found.stance.posture.pushing
        p_ET = found.R_WE.T @ (tips[finger] - found.p_WE)
        reached = max(0.0, found.lid.angle_at_tip(p_ET)) if self.touched < np.inf else 0.0
        sphere = np.append(p_ET, REACH.mount.hand.tip_radius)
        gap = float(found.lid.distance_to_lid(sphere[None], np.array(self.angle))[0])
        if gap < 0.0:
            self.touched = min(self.touched, time)
        into = found.R_WE @ found.lid.lid_normals(np.array([self.angle]))[0]
        if self.stuck:
            stiffness = found.stance.push_stiffness(into)
            force = stiffness * max(0.0, -gap)
        else:
            self.angle, force = max(self.angle, reached), 0.2
        self.pressed.append((time, force))
        return {finger: force * into} if self.touched < np.inf else {}

    @property
    def _since(self) -> float:
        return max(0.0, self.time - self.touched)

    @property
    def tilt(self) -> float:
        return self.leaning * self._since

    @property
    def way(self) -> float:
        return self.moving * self._since

    def seen(self) -> dict[str, SeenPose]:
        return {CUP: SeenPose(rot_y(self.tilt), AT + np.array([self.way, 0.0, 0.0]))}

    def lids(self) -> dict[str, float]:
        return {CUP: self.angle}


def _flip(**script: float | bool) -> tuple[str, Cup]:
    seen = SeenObject(CUP, PlanarPose(0.24, 0.20, 0.0), Registry.built_in().get(CUP), lid=0.0)
    step = FlipOver(
        start=0.0, end=OPEN, speed=0.05, force_limit=LIMIT, heading=0.0, prediction=EASY_FLIP
    )
    found = REACH.flip_configuration(step, CUP, WorldState({CUP: seen}))
    assert not isinstance(found, ReachAnswer)
    configuration = found[0]
    body = Cup(configuration, **script)  # type: ignore[arg-type]
    posture = configuration.stance.posture
    q = configuration.joint_angles(configuration.hands.path.points[0], 0.0)
    robot = ScriptedRobot(body, q, posture.joint_angles)
    recorder = TraceRecorder(robot, robot, REACH.mount, np.array([0.0, 0.0, 1.0]))
    recorder.fingers = posture.pushing
    end, _ = FlipControl(step, recorder, configuration, seen).flip()
    return end, body


def test_a_lid_that_goes_along_is_opened() -> None:
    end, body = _flip()
    assert end == "handled"
    assert body.angle == pytest.approx(OPEN, abs=math.radians(4.0))


def test_a_stuck_lid_is_given_up_after_eight_tenths_of_a_second() -> None:
    end, body = _flip(stuck=True)
    assert end == "force"
    first = next(time for time, force in body.pressed if force > 0.9 * LIMIT)
    # The felt force is 0.04 s late.
    assert body.time - first == pytest.approx(0.8 + 0.04, abs=0.06)
    # It runs into the lid at the speed of an opening, and is as late.
    assert max(force for _, force in body.pressed) < 1.25 * LIMIT


def test_a_cup_that_leans_is_let_go() -> None:
    end, body = _flip(leaning=math.radians(3.0))
    assert end == "tilted"
    # Seen 0.15 s late, by a filter of a fifth of each frame.
    assert math.degrees(body.tilt) == pytest.approx(2.5 + 0.45, abs=0.25)


def test_a_cup_that_moves_is_let_go() -> None:
    end, body = _flip(moving=0.008)
    assert end == "slid"
    assert body.way == pytest.approx(0.006 + 0.0012, abs=0.0006)
