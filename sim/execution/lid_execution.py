"""A lid that comes off, held in the hand: pulled off and put aside, put on, a cap turned.

Law: as for anything that is held (`sim.execution.grasp_execution`). A cap is turned by the arm,
which lets go, turns back and grips anew where the wrist ends.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from objectmodels.models.object_parts import LiftOffLid
from planner.types.actions import Action, LiftUp, PutOn, SetDown, TurnCap
from sim.control.free_motion import Progress
from sim.control.grasping.held_object_sensing import Holding
from sim.control.grasping.lid_sensing import LidSense
from sim.control.pushing.guarded_touch import EarlyEndError
from sim.control.trace_recorder import TraceRecorder
from sim.execution.grasp_execution import GraspExecution
from sim.motion.grasp_motion_search import GraspMotion
from sim.paths.held_object_path import THREAD, HeldObject, HeldSegment

_FOLLOWS = 0.5  # share of a lift that a lid which comes along is seen lifted
_LOOKS = 0.4  # time after which the camera shows what came of it [s]
_MORE_STROKES = 6  # for what slips through the fingers
_TURNED = float(np.radians(4.0))  # less than that is missing of no turn [rad]
_SLOW_DOWN = 0.012  # height over the rim at which putting it on becomes slow [m]
_SLOWLY = 0.015  # [m/s]
_INTO = 0.008  # how far below the rim it is pressed at most [m]


class LidExecution(GraspExecution):
    """One plan in which a lid is held.

    Args:
        handled: the lid, and the plan.
        recorder: through which the robot is stepped.
        way: of arm and hand.
        tell: progress.
        holding: what the hand holds already.
    """

    def __init__(
        self,
        handled: HeldObject,
        recorder: TraceRecorder,
        way: GraspMotion,
        tell: Progress,
        holding: Holding | None = None,
    ) -> None:
        super().__init__(handled, recorder, way, tell, holding)
        self._lid = handled.state.objects[handled.name].model.lid

    def _senses(self) -> LidSense:
        self._feels = LidSense(self._recorder, self._way, self._handled)
        return self._feels

    def _make(self, step: Action, legs: tuple[HeldSegment, ...]) -> None:
        if isinstance(step, TurnCap):
            self._turn(step, legs)
        elif isinstance(step, PutOn):
            self._put_on(step, legs[0])
        elif isinstance(step, SetDown):
            self._set_down(legs[0])
        else:
            for leg in legs:
                self._motion.go(leg)
        if isinstance(step, LiftUp):
            self._require_off(step)
        elif isinstance(step, TurnCap | PutOn) and step is self._plan.steps[-1]:
            self._motion.let_go()
            self._holds = False
        if isinstance(step, PutOn):
            self._require_on(step)

    def _turn(self, step: TurnCap, legs: tuple[HeldSegment, ...]) -> None:
        """Turns the cap, gripping anew between the strokes, until it is seen turned."""
        before, first = self._feels.lid, legs[0]
        self._tell("lid", f"turning the cap by {np.degrees(step.angle):.0f}°")
        for stroke in range(len(legs) + _MORE_STROKES):
            turned = self._feels.lid - before
            if abs(step.angle) - abs(turned) < _TURNED:
                self._tell("lid", f"the cap is seen turned by {np.degrees(turned):.0f}°")
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
        seen = np.degrees(self._feels.lid - before)
        raise EarlyEndError("missed", f"the cap is seen turned by {seen:.0f}° only")

    def _require_off(self, step: LiftUp) -> None:
        """The lid came along with the hand.

        Raises:
            EarlyEndError: it is seen where it was.
        """
        self._motion.wait(max(step.hold, _LOOKS))
        seen = self._feels.lid
        if isinstance(self._lid, LiftOffLid) and seen < _FOLLOWS * step.height:
            raise EarlyEndError("missed", f"the lid is seen lifted by {1e3 * seen:.0f} mm only")

    def _require_on(self, step: PutOn) -> None:
        """The lid sits on its rim.

        Raises:
            EarlyEndError: the camera shows it off.
        """
        self._motion.wait(_LOOKS)
        if self._feels.is_off:
            raise EarlyEndError("missed", f"the lid does not sit on the {step.onto}")

    def _put_on(self, step: PutOn, leg: HeldSegment) -> None:
        """Down onto the rim, until it presses."""
        self._tell("lid", f"putting the lid onto the {step.onto}")
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
