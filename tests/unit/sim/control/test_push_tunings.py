"""Figures of pushes, touches, tilts, turns and drags that protect: each ends what it should end.

The thing that is pushed is scripted: a block on a table that holds against the fingertip with its
friction, seen without noise.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from objectmodels import BoxModel
from objectmodels.geometry.rotations import Array, rot_y
from planner.types.actions import Push
from planner.types.robot import ReachAnswer
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim.control.guarded_touch import TOUCH_SPEED
from sim.control.press_control import DragControl
from sim.control.push_control import (
    ExecutionContext,
    ForceController,
    PushControl,
    TiltControl,
    TurnControl,
)
from sim.control.trace_recorder import EarlyEndError, TraceRecorder
from sim.motion.fingertip_path import STANDOFF, TiltArc
from sim.robots.finger_kinematics import FINGERS
from sim.worlds.ports import SeenPose
from tests.plans import push_plan
from tests.unit.sim.control.scripted_robot import PERIOD, REACH, ScriptedRobot

ALONG = np.array([1.0, 0.0, 0.0])
BLOCK = BoxModel(
    name="block",
    size=(0.10, 0.12, 0.16),
    mass=0.8,
    friction=0.4,
    finger_friction=0.6,
)
LOW = 0.05  # of a block that is pressed on [m]
FINGER = "index"


@dataclass
class Block:
    """Something with a face across the push, that slides at a force.

    Attributes:
        at: where it stands first [m].
        friction: force along the push at which it slides [N].
        face: x of its face in W [m].
        stiffness: of the pushing finger along x [N/m].
    """

    at: tuple[float, float, float] = (0.55, 0.0, 0.0)
    friction: float = 3.0
    face: float = 0.50
    stiffness: float = 0.0
    tip_radius: float = 0.01
    R_WB: Array = field(default_factory=lambda: np.eye(3))
    time: float = 0.0

    def press(self, tips: dict[str, Array], time: float) -> dict[str, Array]:
        self.time = time
        depth = max(0.0, float(tips[FINGER][0]) + self.tip_radius - self.face)
        slides = max(0.0, depth - self.friction / self.stiffness)
        self.face += slides
        return {FINGER: self.stiffness * (depth - slides) * ALONG}

    def seen(self) -> dict[str, SeenPose]:
        return {"block": SeenPose(self.R_WB, np.array(self.at) + (self.face - 0.50) * ALONG)}

    def lids(self) -> dict[str, float]:
        return {}


def _push(**changes: Any) -> Push:
    return Push.model_validate(
        {
            "object": "block",
            "face": "front",
            "p_BC": (-0.05, 0.0, 0.03),
            "normal_W": (-1.0, 0.0, 0.0),
            "direction_W": (1.0, 0.0, 0.0),
            "force_limit": 6.0,
            "speed": 0.05,
            "stroke": 0.06,
            "fingers": 1,
            "spread": 0.0,
            "ends_on": "stroke",
            **changes,
        }
    )


def _control(
    make: type[ForceController],
    push: Push,
    body: Block,
    robot_of: type[ScriptedRobot] = ScriptedRobot,
) -> tuple[ForceController, ScriptedRobot]:
    """A controller before the face, with a robot that holds its hand there."""
    model = BLOCK.model_copy(update={"size": (0.10, 0.12, LOW)}) if push.press else BLOCK
    x, y, _ = body.at
    state = WorldState({"block": SeenObject("block", PlanarPose(x, y), model)})
    answer = REACH.push_configuration(push, state)
    assert not isinstance(answer, ReachAnswer), answer.code
    stance, way = answer[0], REACH.fingertip_path(push, state)
    body.stiffness = stance.push_stiffness(way.inward)
    robot = robot_of(body, stance.joint_angles(way.start), stance.posture.joint_angles)
    recorder = TraceRecorder(robot, robot, REACH.mount, np.array(push.normal_W))
    recorder.fingers = stance.posture.pushing
    assert recorder.fingers == (FINGER,)
    return make(ExecutionContext(push_plan(push), recorder, stance, way, state)), robot


def test_it_closes_in_slowly_and_stops_at_a_light_touch() -> None:
    control, robot = _control(PushControl, _push(), body := Block(friction=50.0))
    control.touch()
    # From 30 mm off at 15 mm/s, after half a second in which the sensors' zero is taken.
    assert robot.time == pytest.approx(0.5 + STANDOFF / 0.015, rel=0.12)
    # Felt a filter's time later, at which it presses 0.6 N and what is added meanwhile.
    pressed = float(robot.pressed[FINGER][0])
    late = body.stiffness * TOUCH_SPEED * 0.04
    assert 0.6 < pressed < 0.6 + 1.2 * late


def test_a_touch_is_looked_for_15_mm_beyond_the_face() -> None:
    control, robot = _control(PushControl, _push(), Block(face=5.0))
    with pytest.raises(EarlyEndError) as early:
        control.touch()
    assert early.value.ended.end == "no_touch"
    beyond = float(robot.tips[FINGER][0]) + 0.01 - 0.50
    assert beyond == pytest.approx(0.015, abs=0.001)


@dataclass
class Sudden(Block):
    """Presses against the fingertip with a force from a time on."""

    force: float = 0.9
    begins: float = 1.0

    def press(self, tips: dict[str, Array], time: float) -> dict[str, Array]:
        return {FINGER: (self.force if time >= self.begins - 1e-9 else 0.0) * ALONG}


def test_a_touch_is_felt_within_four_steps() -> None:
    control, robot = _control(PushControl, _push(), Sudden())
    control.touch()
    # Of 0.9 N 1 − 0.75⁴ = 0.68 are felt after four steps of a filter of 40 ms, 0.6 are asked for.
    assert robot.time - 1.0 == pytest.approx(3 * PERIOD, abs=1e-6)


class Noisy(ScriptedRobot):
    """The robot with noise of its own in each reading of a torque sensor."""

    draws: np.random.Generator

    def step(self, q_arm: Array, q_hand: Array) -> None:
        super().step(q_arm, q_hand)
        self.noise = self.draws.normal(0.0, self.torque_noise, (len(FINGERS), 3))

    def finger_torques(self, finger: str) -> Array:
        return np.asarray(super().finger_torques(finger) + self.noise[FINGERS.index(finger)])


def test_noise_is_no_touch() -> None:
    delays = []
    for seed in range(8):
        control, robot = _control(PushControl, _push(), Sudden(force=1.2, begins=2.0), Noisy)
        assert isinstance(robot, Noisy)
        robot.draws = np.random.default_rng(seed)
        # Noise of 0.6 N in each sample, as much as counts as a touch.
        robot.torque_noise = 0.6 / control.stance.force_noise_gain(control.way.inward)
        control.touch()
        delays.append(robot.time - 2.0)
    # For more than a second no noise was a touch.
    assert min(delays) >= 0.0
    # A sixth of it is left by the mean of 36 samples, for which a filter has a time constant of 18:
    # so 1.2 N are felt as 0.6 N after 0.18 s ln 2. Noise shifts the mean of eight by 0.015 s.
    assert np.mean(delays) == pytest.approx(0.125, abs=0.04)


# --- turns ----------------------------------------------------------------------------------------


# The spring of the finger gives way by 0.3 mm to the side before it turns anything.
@pytest.mark.parametrize(("from_end_mm", "ends"), [(2.1, True), (2.5, False)])
def test_a_turn_stops_2_mm_before_the_end_of_the_face(from_end_mm: float, ends: bool) -> None:
    aside = 0.06 - 1e-3 * from_end_mm
    push = _push(p_BC=(-0.05, aside, 0.03), ends_on="turned", turn=-0.5)
    control, robot = _control(TurnControl, push, Block())
    control.touch()
    began = robot.time
    end, detail = control.act()
    assert (end == "guard" and "off the face" in detail) == ends
    assert (robot.time == began) == ends


# --- tilts ----------------------------------------------------------------------------------------


@dataclass
class Tilted(Block):
    """A block that turns about the far edge of its base, as far as the fingertip leans on it.

    Attributes:
        tilts: angle in each step [rad].
    """

    arc: TiltArc | None = None
    tilts: list[float] = field(default_factory=list)

    def press(self, tips: dict[str, Array], time: float) -> dict[str, Array]:
        tip = tips[FINGER]
        if self.arc is None and float(tip[0]) + self.tip_radius > self.face:
            self.arc = TiltArc(tip, ALONG, 0.10, self.tip_radius)
        force, tilt = self.friction, 0.0
        for _ in range(5):  # each step leaves a hundredth of the error
            if self.arc is not None:
                bent = tip - force / self.stiffness * ALONG
                tilt = max(0.0, float(self.arc.tilt_angles(bent[None])[0]))
            force = self.friction * (1.0 - tilt / 0.5)
        if tilt == 0.0:
            depth = max(0.0, float(tip[0]) + self.tip_radius - self.face)
            force = min(self.friction, self.stiffness * depth)
        self.tilts.append(tilt)
        self.R_WB = rot_y(tilt)
        return {FINGER: force * ALONG}


def _tilt() -> tuple[str, Array]:
    push = _push(
        p_BC=(-0.05, 0.0, 0.12), ends_on="tilted", tilt=np.radians(8.0), speed=0.3, stroke=0.04
    )
    control, _ = _control(TiltControl, push, body := Tilted())
    control.touch()
    end, _ = control.act()
    return end, np.degrees(body.tilts)


def test_a_tilt_is_slow_and_sets_in_softly() -> None:
    end, tilts = _tilt()
    assert end == "returned"
    rates = np.convolve(np.diff(tilts), np.full(5, 0.2), "same") / PERIOD
    up, down = rates[: int(tilts.argmax())], rates[int(tilts.argmax()) :]
    # Up at 6°/s, back at 5°/s; the spring lets go of a little as the force falls.
    assert up.max() == pytest.approx(6.0, abs=0.8)
    assert down.min() == pytest.approx(-5.0, abs=0.8)
    begun = np.flatnonzero(up > 1.5)[0], np.flatnonzero(up > 4.5)[0]
    # 3°/s more at 12°/s².
    assert PERIOD * (begun[1] - begun[0]) == pytest.approx(0.25, abs=0.06)


# --- drags ----------------------------------------------------------------------------------------


@dataclass
class Pressed(Block):
    """A block under a fingertip that presses on its top, and comes along or not."""

    at: tuple[float, float, float] = (0.40, 0.0, 0.0)
    top: float = LOW
    comes_to: float = np.inf
    lets_off_at: float = np.inf
    presses: float = 0.0
    let_off: float = np.nan
    moved: float = 0.0
    first: float = np.nan

    def press(self, tips: dict[str, Array], time: float) -> dict[str, Array]:
        x, _, z = tips[FINGER]
        depth = max(0.0, self.top - (float(z) - self.tip_radius))
        if np.isnan(self.first) and depth > 0.0:
            self.first = float(x)
        self.moved = 0.0 if np.isnan(self.first) else min(float(x) - self.first, self.comes_to)
        down = self.stiffness * depth
        if float(x) - self.first > self.lets_off_at:
            self.let_off = time if np.isnan(self.let_off) else self.let_off
            down = self.presses
        return {FINGER: np.array([0.0, 0.0, -down])}

    def seen(self) -> dict[str, SeenPose]:
        return {"block": SeenPose(self.R_WB, np.array(self.at) + max(self.moved, 0.0) * ALONG)}


def _drag(body: Pressed) -> tuple[str, ScriptedRobot, float]:
    push = _push(
        p_BC=(0.0, 0.0, LOW),
        normal_W=(0.0, 0.0, 1.0),
        face="top",
        press=3.0,
        force_limit=3.0,
        speed=0.03,
    )
    control, robot = _control(DragControl, push, body)
    control.touch()
    end, _ = control.act()
    return end, robot, float(robot.tips[FINGER][0]) - body.first


def test_a_drag_ends_where_the_fingertip_slips() -> None:
    end, _, way = _drag(Pressed(comes_to=0.02))
    assert end == "slipped"
    # 8 mm beyond where it stayed, and what is seen late and filtered at 40 mm/s.
    assert 0.028 < way < 0.028 + 0.012


@pytest.mark.parametrize(("share", "lost"), [(0.12, False), (0.08, True)])
def test_a_drag_ends_where_the_fingertip_presses_no_more(share: float, lost: bool) -> None:
    end, robot, _ = _drag(body := Pressed(lets_off_at=0.02, presses=share * 3.0))
    assert end == ("lost" if lost else "stroke")
    if lost:
        # 0.3 s and what the felt force, filtered, takes to fall: 0.04 s ln(3.0 / 0.06).
        assert robot.time - body.let_off == pytest.approx(0.3 + 0.13, abs=0.04)
