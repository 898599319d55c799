"""Lids: one that comes off is pulled off and put aside, put on, or turned; one on a hinge flipped.

Law: as for anything that is held (`sim.execution.grasp_execution`). A cap is turned by the arm,
which lets go, turns back and grips anew where the wrist ends.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.models.object_parts import LiftOffLid
from planner.types.actions import Action, FlipOver, LiftUp, PutOn, TurnCap
from planner.types.plan import Plan
from planner.types.robot import ReachAnswer
from planner.types.world_state import SeenObject
from sim.control.free_motion import look_around, return_home, straight_line, transit
from sim.control.grasping.flip_control import FlipControl
from sim.control.grasping.lid_sensing import LidSense
from sim.control.trace_recorder import EarlyEndError, TraceRecorder
from sim.execution.grasp_execution import SETTLE, GraspExecution
from sim.motion.arm_configuration import UnreachableError
from sim.motion.flip_motion_search import FlipConfiguration
from sim.paths.held_object_path import THREAD
from sim.paths.held_segment import HeldSegment
from sim.rotations import Array
from sim.supervision import Progress
from sim.traces.trace import EndReason, Trace

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from sim.control.free_motion import RobotSetup

_FOLLOWS = 0.5  # share of a lift that a lid which comes along is seen lifted
_LOOKS = 0.4  # time after which the camera shows what came of it [s]
_MORE_STROKES = 6  # for what slips through the fingers
_TURNED = float(np.radians(4.0))  # less than that is missing of no turn [rad]
_SLOW_DOWN = 0.012  # height over the rim at which putting it on becomes slow [m]
_SLOWLY = 0.015  # [m/s]
_INTO = 0.008  # how far below the rim it is pressed at most [m]


class LidExecution(GraspExecution):
    """One plan in which a lid is held."""

    def _senses(self) -> LidSense:
        self._feels = LidSense(self._recorder, self._way, self._handled)
        return self._feels

    def _make(self, step: Action, legs: tuple[HeldSegment, ...]) -> None:
        if isinstance(step, TurnCap):
            self._turn(step, legs)
        elif isinstance(step, PutOn):
            self._put_on(step, legs[0])
        else:
            super()._make(step, legs)
        if isinstance(step, TurnCap | PutOn) and step is self._plan.steps[-1]:
            self._motion.let_go()
            self._holds = False
        if isinstance(step, PutOn):
            self._require_on(step)

    def _turn(self, step: TurnCap, legs: tuple[HeldSegment, ...]) -> None:
        """Turns the cap, gripping anew between the strokes, until it is seen turned."""
        before, first = self._feels.view.lid, legs[0]
        self._recorder.report("lid", f"turning the cap by {np.degrees(step.angle):.0f}°")
        for stroke in range(len(legs) + _MORE_STROKES):
            turned = self._feels.view.lid - before
            if abs(step.angle) - abs(turned) < _TURNED:
                self._recorder.report("lid", f"the cap is seen turned by {np.degrees(turned):.0f}°")
                return
            up = np.array([0.0, 0.0, self._handled.pitch * turned / THREAD])
            leg = replace(first, start=first.start + up, end=first.end + up)
            if stroke:
                self._motion.let_go()
                self._motion.go(leg.way_back(start=leg.start, free=True))
                self._take_hold()
            self._feels.torque, self._feels.most_torque = 0.0, step.torque_limit
            self._motion.go(leg)
            self._motion.wait(_LOOKS)
            self._feels.most_torque = np.inf
        seen = np.degrees(self._feels.view.lid - before)
        raise EarlyEndError("missed", f"the cap is seen turned by {seen:.0f}° only")

    def _hold_up(self, step: LiftUp) -> None:
        """Requires that the lid came along; raises `EarlyEndError` if it is seen where it was."""
        self._motion.wait(max(step.hold, _LOOKS))
        seen, lid = self._feels.view.lid, self._handled.state.objects[self._handled.name].model.lid
        if isinstance(lid, LiftOffLid) and seen < _FOLLOWS * step.height:
            raise EarlyEndError("missed", f"the lid is seen lifted by {1e3 * seen:.0f} mm only")

    def _require_on(self, step: PutOn) -> None:
        """Requires that the lid sits on its rim; raises `EarlyEndError` if it is seen off."""
        self._motion.wait(_LOOKS)
        if self._feels.view.is_off:
            raise EarlyEndError("missed", f"the lid does not sit on the {step.onto}")

    def _put_on(self, step: PutOn, leg: HeldSegment) -> None:
        """Down onto the rim, until it presses."""
        self._recorder.report("lid", f"putting the lid onto the {step.onto}")
        height = float(leg.start[2] - leg.end[2])
        slow = min(_SLOW_DOWN, height)
        near = leg.end + np.array([0.0, 0.0, slow])
        if height > slow:
            self._motion.go(replace(leg, end=near))
        hangs = self._weigh(_LOOKS).mean
        self._motion.bears = False
        into = leg.end - np.array([0.0, 0.0, _INTO])
        down = replace(leg, start=near, end=into, speed=_SLOWLY)
        made = self._motion.go(down, until=hangs - step.press)
        # Fingers that press while they open would drag it along.
        _, (here,) = down.poses_at(np.array([made]))
        self._motion.go(replace(leg, start=here, speed=_SLOWLY))


def flip_over(
    plan: Plan,
    setup: RobotSetup,
    models: Mapping[str, ObjectModel],
    progress: Progress | None = None,
) -> Trace:
    """Carries out a plan whose only step flips a lid, as `plan_execution.execute` does."""
    (step,) = plan.steps
    assert isinstance(step, FlipOver), "a lid is flipped over"
    towards = np.array([np.cos(step.heading), np.sin(step.heading), 0.0])
    recorder = setup.recorder(towards, progress)
    end: EndReason
    try:
        state = look_around(recorder, models, setup.held)
        target = state.objects[plan.object]
        if target.lid is not None:
            step = step.model_copy(update={"start": target.lid})
        found = setup.reach.flip_configuration(step, plan.object, state)
        if isinstance(found, ReachAnswer):
            end, detail = "unreachable", found.message
        else:
            end, detail = _flip_lid(step, recorder, found[0], target)
    except EarlyEndError as early:
        end, detail = early.end, early.detail
    return recorder.trace(plan.object, towards, end=end, detail=detail)


def _flip_lid(
    step: FlipOver, recorder: TraceRecorder, motion: FlipConfiguration, target: SeenObject
) -> tuple[EndReason, str]:
    """Goes to a lid, flips it and comes home; returns how that ended."""
    port, posture = recorder.port, motion.stance.posture
    start = motion.hands.path.points[0]
    here = above = start + np.array([0.0, 0.0, motion.stance.lift])
    came: list[Array] = []

    def move(there: Array) -> None:
        nonlocal here
        for point in straight_line(here, there, port.period):
            recorder.step(motion.joint_angles(point, 0.0), posture.joint_angles)
            here = point

    way = (*motion.stance.via, motion.joint_angles(above, 0.0))
    try:
        transit(recorder, posture, way, came)
        recorder.begin("approach", "down to the lid")
        move(start)
        return _flip_and_leave(FlipControl(step, recorder, motion, target))
    finally:
        recorder.phase = "retreat"
        move(above)
        return_home(recorder, came, SETTLE)


def _flip_and_leave(control: FlipControl) -> tuple[EndReason, str]:
    """Flips the lid before which the finger stands, and comes back there; returns how it ended."""
    end: EndReason
    try:
        end, detail = control.flip()
    except UnreachableError as error:
        end, detail = "unreachable", str(error)
    except EarlyEndError as early:
        end, detail = early.end, early.detail
    control.leave(done=end == "handled")
    return end, detail
