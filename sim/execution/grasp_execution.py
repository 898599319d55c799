"""One plan of the whole hand: take hold, lift, carry, pour, set down, let go.

Arm and hand are joint impedances throughout. The fingers close until both sides feel the object;
then their springs are wound up until they feel the squeeze. Guards know what the robot feels and
sees (`sim.control.grasping.held_object_sensing`). One that stops a plan makes the hand go back the
way it came, which was free, and set down what it holds where it took it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from objectmodels.mechanics.push_thresholds import GRAVITY
from planner.types.actions import Action, LiftUp, PourOut, SetDown, SetOn
from planner.types.world_state import Held
from sim.control.grasping.hand_motion import ACCELERATES, HandMotion
from sim.control.grasping.held_object_sensing import (
    CONTACT,
    HandSense,
    Holding,
    Weight,
    estimate_weight,
)
from sim.control.trace_recorder import EarlyEndError, TraceRecorder
from sim.motion.grasp_motion_search import GraspMotion
from sim.paths.held_object_path import HeldObject, upright_again
from sim.paths.held_segment import HeldSegment
from sim.rotations import Array

SETTLE = 0.5
"""Time that everything gets to come to rest in the end [s]."""

_BEYOND = 0.008  # how far each side closes beyond the believed width to find something [m]
_WIDTH_ERROR = 0.012  # of a width between thumb and fingers that is not the object's [m]
_WINDS_BEYOND = 1.5  # times the squeeze for which the springs are wound up at most
_ENOUGH = 0.8  # share of the squeeze that must be felt
_STILL = 0.5  # time for which the hand hangs still to look at what it holds [s]
_LIFTED = 0.35  # share of the believed weight that must hang on the fingers
_LIFT_OFF = 0.008  # way upwards over which its weight comes onto the fingers, and it swings [m]
_SLOW_DOWN = 0.015  # height over where it is to stand at which setting down becomes slow [m]
_FEELING_SPEED = 0.015  # of what is set down then, or lifted off [m/s]
_INTO = 0.006  # how far below that place it is looked for [m]
_RIGHTED = 0.15  # time after which nothing runs out any more, once it is tilted back [s]
_SLOWEST_POUR = 0.12  # share of the rate of tilting just before enough has run out
_STANDS = 0.5  # share of its weight with which it stands
_PRESSES = 0.4  # or with so much less [N]


class GraspExecution:
    """One plan of the whole hand, whose `holding` is what the hand holds, where that lasts."""

    def __init__(
        self,
        handled: HeldObject,
        recorder: TraceRecorder,
        way: GraspMotion,
        holding: Holding | None = None,
    ) -> None:
        self._handled = handled
        self._plan = handled.plan
        self._grasp = handled.grasp
        self._recorder = recorder
        self._port = recorder.port
        self.holding = holding
        self._way = way
        self._held = handled.held
        self._sense = self._senses()
        self._motion = HandMotion(recorder, way, self._sense)
        self._grasped = 0  # where on the way it was taken hold of
        self._holds = False

    def carry_out(self, home: Array) -> None:
        """Makes all steps; at home the arm waits at angles of shape (7,) [rad].

        Raises:
            EarlyEndError: a guard stopped it, or nothing was held.
        """
        approach, *steps, retreat = self._way.legs
        if self._grasp.held:
            self._take_up()
        else:
            self._reach_for(approach[0])
            self._take_hold()
        for step, legs in zip(self._plan.steps, steps, strict=True):
            self._make(step, legs)
        if retreat:
            self._recorder.report("retreat", "drawing the hand back")
            self._motion.go(retreat[0])
            self._motion.come_home((*self._way.back, home))
            self._settle()
        else:
            self._keep()

    def _senses(self) -> HandSense:
        """The senses of what is held."""
        p_BG = np.array(self._grasp.p_BG)
        handled = self._handled
        return HandSense(self._recorder, self._way.mount, handled.name, p_BG, handled.state)

    def _make(self, step: Action, legs: tuple[HeldSegment, ...]) -> None:
        """Makes one step."""
        if isinstance(step, PourOut):
            self._pour(step, legs)
        elif isinstance(step, SetDown | SetOn):
            self._set_down(legs[0])
        else:
            off = isinstance(step, LiftUp) and not self._grasp.held and self._grasp.part != "lid"
            for leg in _lift_off(legs) if off else legs:
                self._motion.go(leg)
        if isinstance(step, LiftUp):
            self._hold_up(step)

    def give_up(self) -> None:
        """Back the way it came; what is still held is set down where it was taken, or kept."""
        self._motion.squeeze, self._motion.bears = 0.0, False
        self._recorder.phase = "retreat"
        self._motion.back_to(self._grasped, stop=self._holds)
        if self._grasp.held and self._sense.holds(self._grasp.squeeze):
            self._keep()
            return
        if self._holds and not self._grasp.held:
            self._motion.let_go()
        self._motion.back_to(0)
        self._motion.come_home((self._motion.came[0],))
        self._settle()

    def _settle(self) -> None:
        self._recorder.begin("settle", "letting everything come to rest")
        self._motion.wait(SETTLE)

    # -- taking hold ----------------------------------------------------------------------------

    def _reach_for(self, approach: HeldSegment) -> None:
        """From home to where the open hand is about the object."""
        self._recorder.begin("transit", "moving the hand")
        opened = self._way.grip.posture_at(self._motion.opening).joint_angles
        first, _ = self._way.joint_angles(*approach.poses_at(np.zeros(1)))
        self._motion.transit((*self._way.there, first[0]), opened)
        self._recorder.report("approach", f"reaching for the {self._plan.object}")
        self._motion.go(approach)

    def _take_hold(self) -> None:
        """Closes until both sides feel something, and squeezes it."""
        self._recorder.begin("grasp", f"taking hold of the {self._plan.object}")
        motion, sense, squeeze = self._motion, self._sense, self._grasp.squeeze
        motion.feel_nothing()
        self._grasped = len(motion.came) - 1
        self._holds = True
        while min(sense.thumb, sense.fingers) < CONTACT:
            if motion.opening < -_BEYOND:
                raise EarlyEndError("no_grasp", self._felt_too_little("closed"))
            motion.close()
        while sense.squeeze < squeeze and motion.wound < _WINDS_BEYOND * squeeze:
            motion.wind()
        sense.forget()
        motion.wait(_STILL)
        wrong = abs(sense.width - self._grasp.width) > _WIDTH_ERROR
        if min(sense.thumb, sense.fingers) < _ENOUGH * squeeze or wrong:
            raise EarlyEndError("no_grasp", self._felt_too_little("squeezed"))
        sense.remember()
        motion.squeeze = squeeze
        self._recorder.report_contact()

    def _felt_too_little(self, done: str) -> str:
        sense = self._sense
        return (
            f"the hand {done} to {1e3 * sense.width:.0f} mm and feels {sense.thumb:.1f} N at the "
            f"thumb, {sense.fingers:.1f} N at the fingers"
        )

    def _take_up(self) -> None:
        """Goes on with what is held already."""
        holding = self.holding
        if holding is None or holding.held.name != self._handled.name:
            raise EarlyEndError("no_grasp", f"the hand does not hold the {self._plan.object}")
        self.holding = None
        self._recorder.fingers = self._way.mount.hand.grasp_fingers
        self._recorder.zero = holding.zero
        motion = self._motion
        motion.take_over(holding)
        self._grasped = len(motion.came) - 1
        self._holds = True
        motion.wait(_STILL)
        self._sense.remember(holding.R_PB, holding.p_PG)
        motion.squeeze = self._grasp.squeeze
        motion.swing(np.array([self._port.commanded[0], *self._way.there]))

    def _keep(self) -> None:
        """Stays where it is, with what it holds."""
        self._recorder.phase = "settle"
        self._motion.wait(SETTLE)
        R_WP, p_WP = self._way.mount.palm_poses(self._port.commanded[0])
        R_PB, p_PG = self._sense.remembered_pose or (self._way.R_BP.T, self._way.grip.middle)
        base = p_WP + R_WP @ (p_PG - R_PB @ np.array(self._grasp.p_BG))
        turned = {
            "closing_W": tuple(R_WP[:, 0].tolist()),
            "approach_W": tuple(R_WP[:, 2].tolist()),
        }
        held = Held(
            self._handled.name,
            self._handled.asked.model_copy(update=turned),
            float(base[2]),
            tuple(self._port.commanded[0].tolist()),
        )
        self.holding = self._motion.holding(held, R_PB, p_PG)

    # -- steps ----------------------------------------------------------------------------------

    def _hold_up(self, step: LiftUp) -> None:
        """Weighs what was lifted."""
        felt = self._weigh(max(step.hold, _STILL))
        believed = self._held.model.weight
        self._recorder.report("lift", f"it weighs {felt.mean:.2f} N, give or take {felt.sd:.2f} N")
        if felt.mean < _LIFTED * believed:
            raise EarlyEndError(
                "no_grasp",
                f"{felt.mean:.1f} N hang on the fingers, and the {self._plan.object} should weigh "
                f"{believed:.1f} N",
            )
        self._motion.bears = True

    def _weigh(self, seconds: float) -> Weight:
        """Hangs still and feels the weight."""
        felt = []
        for _ in range(round(seconds / self._port.period)):
            self._motion.stay()
            felt.append(self._sense.vertical)
        # The arm still swings at first.
        return estimate_weight(np.array(felt[len(felt) // 3 :]), self._motion.zero_samples)

    def _pour(self, step: PourOut, legs: tuple[HeldSegment, ...]) -> None:
        """Tilts until enough has run out, waits, and comes back upright."""
        self._recorder.report("pour", f"pouring into the {step.into}")
        first, *tilting = legs[: len(legs) // 2]
        self._motion.go(first)
        container = self._held.model.container
        assert container is not None, "only a container is poured from"
        full = self._weigh(_STILL).mean
        if step.volume is None:
            for leg in tilting:
                self._motion.go(leg)
            self._motion.wait(step.wait)
            done, share = [first, *tilting], 1.0
        else:
            out = GRAVITY * container.density * step.volume
            done, share = self._pour_some(tilting, full, out, step.wait)
            done = [first, *done]
        for leg in upright_again(done[:-1], done[-1], share):
            self._motion.go(leg)
        poured = (full - self._weigh(_STILL).mean) / (GRAVITY * container.density)
        self._recorder.report("pour", f"{1e6 * poured:.0f} ml have run out, as the weight tells")

    def _pour_some(
        self, legs: list[HeldSegment], full: float, out: float, wait: float
    ) -> tuple[list[HeldSegment], float]:
        """Tilts ever slower until enough has run out; returns legs and share of the last one.

        Each leg sets in and ends smoothly: what speeds up downwards weighs less.
        """
        period = self._port.period
        done: list[HeldSegment] = []
        for leg in legs:
            done.append(leg)
            share = pace = 0.0
            while share < 1.0:
                left = 1.0 - self._run_out(full) / out
                if left < 0.0:
                    return done, share
                faster = pace + period / ACCELERATES
                ahead = (1.0 - share) / (leg.share_rate * ACCELERATES)
                pace = min(float(np.clip(min(left, ahead), _SLOWEST_POUR, 1.0)), faster)
                share = min(1.0, share + pace * leg.share_rate * period)
                self._motion.reach(leg, share)
        for _ in range(round(wait / period)):
            if self._run_out(full) > out:
                break
            self._motion.stay()
        return done, 1.0

    def _run_out(self, full: float) -> float:
        """Weight that will have run out once it is tilted back [N].

        What is still to come is no more than what has come: a motion that sets in shakes the hand.
        """
        sense = self._sense
        gone = max(full - sense.weight, 0.0)
        coming = sense.weight - sense.weight_ahead(_RIGHTED)
        return gone + float(np.clip(coming, 0.0, gone))

    def _set_down(self, leg: HeldSegment) -> None:
        """Down until it stands, then lets go."""
        self._recorder.report("set_down", f"setting the {self._plan.object} down")
        height = float(leg.start[2] - leg.end[2])
        slow = min(_SLOW_DOWN, height)
        down = np.array([0.0, 0.0, -1.0])
        near = leg.start + (height - slow) * down
        if height > slow:
            self._motion.go(replace(leg, end=near))
        hangs = self._weigh(_STILL).mean
        self._motion.squeeze, self._motion.bears = 0.0, False
        last = replace(leg, start=near, end=leg.end + _INTO * down, speed=_FEELING_SPEED)
        self._motion.go(last, until=min(_STANDS * hangs, hangs - _PRESSES))
        self._motion.let_go()
        self._holds = False


def _lift_off(legs: tuple[HeldSegment, ...]) -> tuple[HeldSegment, ...]:
    """Legs upwards, slow until it hangs: what hangs askew swings as fast as it is lifted off."""
    first, *rest = legs
    way = first.end - first.start
    share = _LIFT_OFF / float(np.linalg.norm(way))
    if share >= 1.0:
        return legs
    hangs = first.start + share * way
    slow = replace(first, end=hangs, speed=min(first.speed, _FEELING_SPEED))
    return slow, replace(first, start=hangs), *rest
