"""Execution of a plan: of pushes, of a hand that holds something, of lids.

One plan of the whole hand: take hold, lift, carry, pour, set down, let go.

Arm and hand are joint impedances throughout. The fingers close until both sides feel the object;
then their springs are wound up until they feel the squeeze. Guards know what the robot feels and
sees (`sim.control.held_object_sensing`). One that stops a plan makes the hand go back the
way it came, which was free, and set down what it holds where it took it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from objectmodels.geometry.rotations import Array, rot_z
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_parts import LiftOffLid
from objectmodels.safety_figure import SafetyFigure
from planner.refusals.blocked import reach_sentence
from planner.types.actions import (
    Action,
    FlipOver,
    LiftUp,
    PourOut,
    Push,
    PutOn,
    SetDown,
    SetOn,
    TurnCap,
)
from planner.types.end_reasons import Ended
from planner.types.plan import Plan
from planner.types.robot import ReachAnswer
from planner.types.world_state import Held, SeenObject, WorldState
from sim.control.free_motion import look_around, move_joints, return_home, straight_line, transit
from sim.control.grasp_control import ACCELERATES, FlipControl, HandMotion
from sim.control.guards import Guard, Watch
from sim.control.held_object_sensing import (
    HandSense,
    Holding,
    LidSense,
    Weight,
    cap_guard,
    contact_guard,
    drop_guard,
    estimate_weight,
)
from sim.control.press_control import DragControl
from sim.control.push_control import (
    ExecutionContext,
    ForceController,
    PushControl,
    TiltControl,
    TurnControl,
)
from sim.control.trace_recorder import EarlyEndError, TraceRecorder
from sim.motion.collision_scene import SPARE
from sim.motion.fingertip_path import BACK, FingertipPath
from sim.motion.held_object_path import THREAD, HeldObject, HeldSegment, upright_again
from sim.motion.inverse_kinematics import ArmConfiguration, UnreachableError
from sim.motion.motion_planner import FlipConfiguration, GraspMotion
from sim.supervision import Progress
from sim.traces.trace import Trace

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from sim.control.free_motion import RobotSetup


SETTLE = 0.5
"""Time that everything gets to come to rest in the end [s]."""


def how_it_ended(motion: Callable[[], Ended]) -> Ended:
    """Makes a motion; returns how it ended, also if something stopped it on its way."""
    try:
        return motion()
    except EarlyEndError as early:
        return early.ended
    except UnreachableError as error:
        return Ended("unreachable", str(error))


@dataclass(frozen=True)
class GraspTuning:
    """Speeds, and what the hand must feel, of a plan of the whole hand."""

    # How far each side closes beyond the believed width to find something [m].
    closes_beyond: float = 0.008
    # Of a width between thumb and fingers that is not the object's [m].
    width_error: SafetyFigure = 0.012
    # Times the squeeze for which the springs are wound up at most.
    most_winding_share: SafetyFigure = 1.5
    least_squeeze_share: SafetyFigure = 0.8  # share of the squeeze that must be felt
    look_time: float = 0.5  # time for which the hand hangs still to look at what it holds [s]
    # Share of the believed weight that must hang on the fingers.
    least_weight_share: SafetyFigure = 0.35
    # Way upwards over which the weight comes onto the fingers, and the object swings [m].
    lift_off_height: float = 0.008
    # Height over where it is to stand at which setting down becomes slow [m].
    slow_height: float = 0.015
    feeling_speed: float = 0.015  # of what is set down then, or lifted off [m/s]
    search_depth: float = 0.006  # how far below that place it is looked for [m]
    # Time after which nothing runs out any more, once it is tilted back [s].
    run_out_time: float = 0.15
    least_pour_share: float = 0.12  # share of the rate of tilting just before enough has run out
    standing_share: float = 0.5  # share of its weight with which it stands
    standing_force: float = 0.4  # or with so much less [N]


class GraspExecution:
    """One plan of the whole hand, whose `holding` is what the hand holds, where that lasts."""

    tuning = GraspTuning()

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
        self._motion.watch, self._motion.bears = None, False
        self._recorder.phase = "retreat"
        self._motion.back_to(self._grasped, stop=self._holds)
        dropped = drop_guard(self._handled.name, self._grasp.squeeze).is_tripped(self._sense)
        if self._grasp.held and not dropped:
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
        tuning = self.tuning
        self._recorder.begin("grasp", f"taking hold of the {self._plan.object}")
        motion, sense, squeeze = self._motion, self._sense, self._grasp.squeeze
        motion.feel_nothing()
        self._grasped = len(motion.came) - 1
        self._holds = True
        contact = contact_guard(self._grasp.width)
        while contact.is_tripped(sense):
            if motion.opening < -tuning.closes_beyond:
                raise EarlyEndError(*contact.end_of(sense))
            motion.close()
        while sense.squeeze < squeeze and motion.wound < tuning.most_winding_share * squeeze:
            motion.wind()
        sense.forget()
        motion.wait(tuning.look_time)
        wrong = abs(sense.width - self._grasp.width) > tuning.width_error
        if min(sense.thumb, sense.fingers) < tuning.least_squeeze_share * squeeze or wrong:
            raise EarlyEndError("no_grasp", sense.felt_text("squeezed"))
        sense.remember()
        motion.watch = self._watch()
        self._recorder.report_contact()

    def _watch(self, *more: Guard[Any]) -> Watch[Any]:
        """Guards of what is held from now on, and some more."""
        return Watch((*self._sense.guards(self._grasp.squeeze), *more), self._port.period)

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
        motion.wait(self.tuning.look_time)
        self._sense.remember(holding.R_PB, holding.p_PG)
        motion.watch = self._watch()
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
        felt = self._weigh(max(step.hold, self.tuning.look_time))
        believed = self._held.model.weight
        self._recorder.report("lift", f"it weighs {felt.mean:.2f} N, give or take {felt.sd:.2f} N")
        if felt.mean < self.tuning.least_weight_share * believed:
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
        full = self._weigh(self.tuning.look_time).mean
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
        poured = (full - self._weigh(self.tuning.look_time).mean) / (GRAVITY * container.density)
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
                pace = min(
                    float(np.clip(min(left, ahead), self.tuning.least_pour_share, 1.0)), faster
                )
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
        coming = sense.weight - sense.weight_ahead(self.tuning.run_out_time)
        return gone + float(np.clip(coming, 0.0, gone))

    def _set_down(self, leg: HeldSegment) -> None:
        """Down until it stands, then lets go."""
        tuning = self.tuning
        self._recorder.report("set_down", f"setting the {self._plan.object} down")
        height = float(leg.start[2] - leg.end[2])
        slow = min(tuning.slow_height, height)
        down = np.array([0.0, 0.0, -1.0])
        near = leg.start + (height - slow) * down
        if height > slow:
            self._motion.go(replace(leg, end=near))
        hangs = self._weigh(tuning.look_time).mean
        self._motion.watch, self._motion.bears = None, False
        last = replace(
            leg, start=near, end=leg.end + tuning.search_depth * down, speed=tuning.feeling_speed
        )
        self._motion.go(
            last, until=min(tuning.standing_share * hangs, hangs - tuning.standing_force)
        )
        self._motion.let_go()
        self._holds = False


def _lift_off(legs: tuple[HeldSegment, ...]) -> tuple[HeldSegment, ...]:
    """Legs upwards, slow until it hangs: what hangs askew swings as fast as it is lifted off."""
    first, *rest = legs
    way = first.end - first.start
    share = GraspExecution.tuning.lift_off_height / float(np.linalg.norm(way))
    if share >= 1.0:
        return legs
    hangs = first.start + share * way
    slow = replace(first, end=hangs, speed=min(first.speed, GraspExecution.tuning.feeling_speed))
    return slow, replace(first, start=hangs), *rest


@dataclass(frozen=True)
class LidTuning:
    """Speeds, and what must be seen, of a plan in which a lid is held."""

    follow_share: SafetyFigure = 0.5  # share of a lift that a lid which comes along is seen lifted
    look_time: float = 0.4  # time after which the camera shows what became of it [s]
    spare_strokes: int = 6  # for what slips through the fingers
    turn_tolerance: float = math.radians(4.0)  # less than that is missing of no turn [rad]
    slow_height: float = 0.012  # height over the rim at which putting it on becomes slow [m]
    slow_speed: float = 0.015  # [m/s]
    press_depth: float = 0.008  # how far below the rim it is pressed at most [m]


class LidExecution(GraspExecution):
    """One plan in which a lid is held.

    Law: as for anything that is held (`GraspExecution`). A cap is turned by the arm, which lets
    go, turns back and grips anew where the wrist ends.
    """

    lid_tuning = LidTuning()

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
        for stroke in range(len(legs) + self.lid_tuning.spare_strokes):
            turned = self._feels.view.lid - before
            if abs(step.angle) - abs(turned) < self.lid_tuning.turn_tolerance:
                self._recorder.report("lid", f"the cap is seen turned by {np.degrees(turned):.0f}°")
                return
            up = np.array([0.0, 0.0, self._handled.pitch * turned / THREAD])
            leg = replace(first, start=first.start + up, end=first.end + up)
            if stroke:
                self._motion.let_go()
                self._motion.go(leg.way_back(start=leg.start, free=True))
                self._take_hold()
            self._feels.torque = 0.0
            self._motion.watch = self._watch(cap_guard(step))
            self._motion.go(leg)
            self._motion.wait(self.lid_tuning.look_time)
            self._motion.watch = self._watch()
        seen = np.degrees(self._feels.view.lid - before)
        raise EarlyEndError("missed", f"the cap is seen turned by {seen:.0f}° only")

    def _hold_up(self, step: LiftUp) -> None:
        """Requires that the lid came along; raises `EarlyEndError` if it is seen where it was."""
        self._motion.wait(max(step.hold, self.lid_tuning.look_time))
        seen, lid = self._feels.view.lid, self._handled.state.objects[self._handled.name].model.lid
        if isinstance(lid, LiftOffLid) and seen < self.lid_tuning.follow_share * step.height:
            raise EarlyEndError("missed", f"the lid is seen lifted by {1e3 * seen:.0f} mm only")

    def _require_on(self, step: PutOn) -> None:
        """Requires that the lid sits on its rim; raises `EarlyEndError` if it is seen off."""
        self._motion.wait(self.lid_tuning.look_time)
        if self._feels.view.is_off:
            raise EarlyEndError("missed", f"the lid does not sit on the {step.onto}")

    def _put_on(self, step: PutOn, leg: HeldSegment) -> None:
        """Down onto the rim, until it presses."""
        tuning = self.lid_tuning
        self._recorder.report("lid", f"putting the lid onto the {step.onto}")
        height = float(leg.start[2] - leg.end[2])
        slow = min(tuning.slow_height, height)
        near = leg.end + np.array([0.0, 0.0, slow])
        if height > slow:
            self._motion.go(replace(leg, end=near))
        hangs = self._weigh(tuning.look_time).mean
        self._motion.bears = False
        into = leg.end - np.array([0.0, 0.0, tuning.press_depth])
        down = replace(leg, start=near, end=into, speed=tuning.slow_speed)
        made = self._motion.go(down, until=hangs - step.press)
        # Fingers that press while they open would drag it along.
        _, (here,) = down.poses_at(np.array([made]))
        self._motion.go(replace(leg, start=here, speed=tuning.slow_speed))


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

    def flip() -> Ended:
        state = look_around(recorder, models, setup.held)
        target = state.objects[plan.object]
        now = step if target.lid is None else step.model_copy(update={"start": target.lid})
        found = setup.reach.flip_configuration(now, plan.object, state)
        if isinstance(found, ReachAnswer):
            return Ended("unreachable", reach_sentence(found))
        return _flip_lid(now, recorder, found[0], target)

    end, detail = how_it_ended(flip)
    return recorder.trace(plan.object, towards, end=end, detail=detail)


def _flip_lid(
    step: FlipOver, recorder: TraceRecorder, motion: FlipConfiguration, target: SeenObject
) -> Ended:
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
        control = FlipControl(step, recorder, motion, target)
        ended = how_it_ended(control.flip)
        control.leave(done=ended.end == "handled")
        return ended
    finally:
        recorder.phase = "retreat"
        move(above)
        return_home(recorder, came, SETTLE)


class PushExecution:
    """The hand's way to the contact of a push and back; `recorder` records all of it.

    The robot knows what its ports tell it: joint angles, finger torques and late, noisy camera
    frames. Frames: W is the world, T the midpoint of the pushing fingertips' centres.
    """

    def __init__(
        self,
        push: Push,
        setup: RobotSetup,
        models: Mapping[str, ObjectModel],
        progress: Progress | None = None,
    ) -> None:
        self.recorder = setup.recorder(np.array(push.normal_W), progress)
        self._push = push
        self._setup = setup
        self._port = setup.port
        self._models = models
        self._descent: list[Array] = []  # arm angles from above the start down to it
        self._came: list[Array] = []  # arm angles between home and there, in order

    def look(self) -> WorldState:
        """Looks at the table and returns where everything stands."""
        return look_around(self.recorder, self._models, self._setup.held)

    def stance(self, state: WorldState) -> tuple[ArmConfiguration, FingertipPath]:
        """Configuration of arm and hand, and the path of the fingertips.

        Raises:
            EarlyEndError: the hand does not get there.
        """
        for reach in (self._setup.reach, self._setup.reach.thorough_reach):
            # It was reached from where things were seen before.
            for spare in (0.0, SPARE):
                answer = reach.push_configuration(self._push, state, spare)
                if not isinstance(answer, ReachAnswer):
                    return answer[0], reach.fingertip_path(self._push, state)
                why = reach_sentence(answer)
        raise EarlyEndError("unreachable", why)

    def approach(self, stance: ArmConfiguration, way: FingertipPath) -> None:
        """Free motion: over the start, then down to it."""
        above = np.array([*way.start[:2], stance.lift])
        way_there = (*stance.via, stance.joint_angles(above))
        transit(self.recorder, stance.posture, way_there, self._came)
        self.recorder.begin("approach", "down to the object")
        for point in straight_line(above, way.start, self._port.period):
            self._go(stance, point)
            self._descent.append(self._port.commanded[0])

    def leave(
        self, stance: ArmConfiguration, tip: Array, way: FingertipPath, turned: float = 0.0
    ) -> None:
        """Off the face, and back along the way that was free.

        Args:
            stance: of arm and hand.
            tip: where T is commanded to be, shape (3,) [m].
            way: on which it came.
            turned: how far the palm has turned [rad]; it turns back once it is off the face.
        """
        self.recorder.begin("retreat", "leaving the object")
        self.recorder.force_limit = 0.0
        off = tip - BACK * rot_z(turned) @ way.inward
        far = max(float(np.linalg.norm(off - way.start)), 1e-9)
        try:
            for point in straight_line(tip, off, self._port.period):
                self._go(stance, point, turned)
            for point in straight_line(off, way.start, self._port.period):
                left = float(np.linalg.norm(point - way.start)) / far
                self._go(stance, point, left * turned)
        except UnreachableError:
            # Both ends of the way are reached, so the joints lead from one to the other.
            move_joints(self.recorder, self._descent[-1], self._port.commanded[1])

    def come_home(self, settle: float) -> None:
        """Back home, and some time for everything to come to rest [s]."""
        self.recorder.phase = "retreat"
        for q in reversed(self._descent):
            self.recorder.step(q, self._port.commanded[1])
        return_home(self.recorder, self._came, settle)

    def _go(self, stance: ArmConfiguration, tip: Array, turned: float = 0.0) -> None:
        self.recorder.step(stance.joint_angles(tip, turned), stance.posture.joint_angles)


_CONTROLS: dict[str, type[ForceController]] = {
    "tilted": TiltControl,
    "turned": TurnControl,
}
"""What controls a push, by what it ends on."""

SETTLE_AFTER = {"stroke": 0.5, "toppled": 1.5}
"""Time that an object gets to come to rest [s]."""


def execute(
    plan: Plan,
    setup: RobotSetup,
    models: Mapping[str, ObjectModel],
    progress: Progress | None = None,
) -> Trace:
    """Carries out a plan.

    The push is the paper's interface to its arm: a movement vector, a force magnitude and a
    largest speed. The fingertips advance along the vector while less than the force is felt, no
    faster than the speed, and end on the stroke, the force, the speed or a guard. Arm and hand
    are joint impedances throughout; what is commanded is where their springs rest.

    Args:
        plan: what to do.
        setup: the robot.
        models: what the robot believes of every object, by its name in the scene.
        progress: called while something happens; a `Monitor` also says when to stop.

    Returns:
        What happened, also if it ended early.
    """
    if not plan.pushes:
        return _execute_by_hand(plan, setup, models, progress)
    execution = PushExecution(plan.push, setup, models, progress)
    end, detail = how_it_ended(lambda: _push(plan, execution))
    execution.come_home(SETTLE_AFTER.get(end, SETTLE_AFTER["stroke"]))
    push = plan.push
    return execution.recorder.trace(push.object, np.array(push.direction_W), end=end, detail=detail)


def _push(plan: Plan, execution: PushExecution) -> Ended:
    """Looks, goes there and pushes; returns how that ended."""
    state = execution.look()
    stance, way = execution.stance(state)
    execution.approach(stance, way)
    execution.recorder.report("touch", "feeling for the face")
    make = DragControl if plan.push.press else _CONTROLS.get(plan.push.ends_on, PushControl)
    control = make(ExecutionContext(plan, execution.recorder, stance, way, state))
    try:
        control.touch()
        return control.act()
    finally:
        execution.leave(stance, control.commanded, way, control.turned)


def _execute_by_hand(
    plan: Plan, setup: RobotSetup, models: Mapping[str, ObjectModel], progress: Progress | None
) -> Trace:
    """Carries out a plan of the whole hand; what it holds then is `setup.holding`.

    A guard that stops it makes the hand go back the way it came, which was free, and set down what
    it holds where it took it.
    """
    if plan.grasp is None:
        return flip_over(plan, setup, models, progress)
    approach = np.array(plan.grasp.approach_W)
    recorder = setup.recorder(-approach, progress)
    end, detail = how_it_ended(lambda: _handle(plan, setup, models, recorder))
    return recorder.trace(plan.object, approach, end=end, detail=detail)


def _handle(
    plan: Plan, setup: RobotSetup, models: Mapping[str, ObjectModel], recorder: TraceRecorder
) -> Ended:
    """Looks and makes all steps; returns how that ended."""
    state = look_around(recorder, models, setup.held)
    way = setup.reach.grasp_motion(plan, state, SPARE)
    if isinstance(way, ReachAnswer):
        return Ended("unreachable", reach_sentence(way))
    handled = HeldObject.from_plan(plan, state)
    make = GraspExecution if handled.owner is None else LidExecution
    execution = make(handled, recorder, way, setup.holding)
    try:
        execution.carry_out(setup.reach.mount.home)
    except EarlyEndError as early:
        recorder.report("retreat", early.ended.detail)
        execution.give_up()
        raise
    finally:
        setup.holding = execution.holding
    return Ended("handled", "all steps were made")
