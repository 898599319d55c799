"""A plan carried out whose only step flips a lid with a fingertip."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from planner.types.actions import FlipOver
from planner.types.plan import Plan
from planner.types.robot import ReachAnswer
from planner.types.world_state import SeenObject
from sim.control.free_motion import (
    HAND_ACCELERATION,
    HAND_SPEED,
    Progress,
    look_around,
    move_joints,
)
from sim.control.grasping.flip_control import FlipControl
from sim.control.trace_recorder import TraceRecorder
from sim.motion.arm_configuration import UnreachableError
from sim.motion.flip_motion_search import FlipConfiguration
from sim.paths.point_attractor import attractor_points
from sim.rotations import Array
from sim.traces.trace import EndReason, Trace

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from sim.control.robot_setup import RobotSetup

SETTLE = 0.5
"""Time that everything gets to come to rest [s]."""


class FlipExecution:
    """The hand's way to a lid and back home.

    Args:
        recorder: through which the robot is stepped.
        stance: of arm and hand.
    """

    def __init__(self, recorder: TraceRecorder, stance: FlipConfiguration) -> None:
        self._recorder = recorder
        self._stance = stance
        self._came: list[Array] = []

    def go(self, tell: Progress) -> None:
        """Free motion: over the start of the way, then down to it."""
        recorder, stance = self._recorder, self._stance
        tell("transit", recorder.port.time, f"moving the hand ({stance.stance.posture.name})")
        recorder.phase = "transit"
        recorder.fingers = stance.stance.posture.pushing
        for q in (*stance.stance.via, stance.joint_angles(self._above, 0.0)):
            self._came.append(recorder.port.commanded[0])
            move_joints(recorder, q, stance.stance.posture.joint_angles)
        tell("approach", recorder.port.time, "down to the lid")
        recorder.phase = "approach"
        self._straight(self._above, self._start)

    def come_home(self, tell: Progress) -> None:
        """The same way back, and some time for everything to come to rest."""
        recorder = self._recorder
        recorder.phase = "retreat"
        self._straight(self._start, self._above)
        for q in reversed(self._came):
            last = q is self._came[0]
            move_joints(
                recorder,
                q,
                recorder.mount.hand.resting.joint_angles if last else recorder.port.commanded[1],
            )
        tell("settle", recorder.port.time, "letting everything come to rest")
        recorder.phase = "settle"
        for _ in range(round(SETTLE / recorder.port.period)):
            recorder.step(*recorder.port.commanded)

    @property
    def _start(self) -> Array:
        return np.asarray(self._stance.hands.path.points[0])

    @property
    def _above(self) -> Array:
        return np.asarray(self._start + np.array([0.0, 0.0, self._stance.stance.lift]))

    def _straight(self, start: Array, goal: Array) -> None:
        recorder, posture = self._recorder, self._stance.stance.posture
        for point in attractor_points(
            start,
            goal,
            speed=HAND_SPEED,
            acceleration=HAND_ACCELERATION,
            period=recorder.port.period,
        ):
            recorder.step(self._stance.joint_angles(point, 0.0), posture.joint_angles)


def flip_over(
    plan: Plan,
    setup: RobotSetup,
    models: Mapping[str, ObjectModel],
    tell: Progress,
) -> Trace:
    """Carries out a plan whose only step flips a lid.

    Args:
        plan: what to do.
        setup: the robot.
        models: what the robot believes of every object, by its name in the scene.
        tell: progress.

    Returns:
        What happened, also if it ended early.
    """
    (step,) = plan.steps
    assert isinstance(step, FlipOver), "a lid is flipped over"
    towards = np.array([np.cos(step.heading), np.sin(step.heading), 0.0])
    recorder = setup.recorder(towards)
    state = look_around(recorder, models, tell, setup.held)
    target = state.objects[plan.object]
    if target.lid is not None:
        step = step.model_copy(update={"start": target.lid})
    found = setup.reach.flip_configuration(step, plan.object, state)
    end: EndReason
    if isinstance(found, ReachAnswer):
        end, detail = "unreachable", found.message
    else:
        end, detail = _flipped(step, recorder, found[0], target, tell)
    return recorder.trace(plan.object, towards, end=end, detail=detail)


def _flipped(
    step: FlipOver,
    recorder: TraceRecorder,
    stance: FlipConfiguration,
    target: SeenObject,
    tell: Progress,
) -> tuple[EndReason, str]:
    """Goes there, flips the lid and comes home; returns how that ended."""
    trip = FlipExecution(recorder, stance)
    trip.go(tell)
    control = FlipControl(step, recorder, stance, target, tell)
    end: EndReason
    try:
        end, detail = control.flip()
    except UnreachableError as error:
        end, detail = "unreachable", str(error)
    tell("retreat", recorder.port.time, "leaving the lid")
    control.leave(done=end == "handled")
    trip.come_home(tell)
    return end, detail
