"""Control of a hand that holds something, or flips a lid.

Motions of the hand about something that it holds, and back.

Arm and hand are joint impedances; what is commanded is where their springs rest. The finger springs
are wound up by Jᵀf/k to exert a force f: the squeeze, and what bears the weight, so that the object
does not sag in the hand. Every arm pose on the way is kept, since the way back along them is free.
"""

from __future__ import annotations

import math
import operator
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain, repeat
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.rotations import Array
from objectmodels.safety_figure import SafetyFigure
from planner.types.actions import FlipOver
from planner.types.end_reasons import Ended
from planner.types.world_state import SeenObject
from sim.control.free_motion import HAND_ACCELERATION, HAND_SPEED, move_joints
from sim.control.guarded_touch import PAUSE, TOUCH_SPEED
from sim.control.guards import Guard, Watch
from sim.control.held_object_sensing import HandSense, Holding, LidEstimator
from sim.control.trace_recorder import EarlyEndError, TraceRecorder
from sim.motion.held_object_path import HeldSegment, attractor_points
from sim.motion.motion_planner import FlipConfiguration

if TYPE_CHECKING:
    from planner.types.world_state import Held
    from sim.motion.motion_planner import GraspMotion


def force_limits_at(step: FlipOver, shares: Array | float) -> Array:
    """Felt forces at which a flip stops, at shares of its arc [N]."""
    limits = step.force_limits or (step.force_limit,)
    return np.asarray(np.interp(shares, np.linspace(0.0, 1.0, len(limits)), limits))


_STOPPED_ROOM = 0.5  # share of its speed below which the force is taken to stop a finger


@dataclass(frozen=True)
class FlipTuning:
    """Rates of a flip, and what shows that the lid follows."""

    acceleration: float = 2.0  # of the commanded angle [rad/s²]
    braking: float = 3.0  # rate per remaining angle near the end [1/s]
    least_rate: float = 0.15  # rate near the end, and until the lid is seen to move [rad/s]
    caught_angle: float = math.radians(
        4.0
    )  # a lid that is seen to have moved so far does move [rad]
    # How far the finger goes on for a lid that lags behind [rad].
    overrun: float = math.radians(12.0)
    end_tolerance: float = math.radians(2.0)  # seen angle from the end that counts as the end [rad]
    # How far a lid that follows is seen behind the finger [rad].
    largest_lag: float = math.radians(15.0)
    force_band: float = 0.2  # share of the force limit over which the speed falls to zero
    filter_time: float = 0.04  # time constant of the felt force [s]
    stuck_time: SafetyFigure = 0.8  # time at the force limit after which it does not move [s]
    wait_time: float = 0.6  # for the camera, once the finger is at its end [s]
    # Way of the fingertip that a whole turn of the palm takes as long as [m].
    palm_way: float = 0.15
    # Tilt [rad] and displacement [m] of the object at which the fingertip lets go of its lid, or
    # more where the camera is noisy.
    largest_tilt: SafetyFigure = math.radians(2.5)
    largest_displacement: SafetyFigure = 0.006


@dataclass(frozen=True)
class FlipSample:
    """What is felt and seen of a lid that is flipped.

    Attributes:
        view: of the lid and its object.
        felt: force into the lid, filtered [N].
        finger: angle that a lid has which touches the fingertip [rad].
        room: share of its speed with which the finger went on last, −1 to 1.
        remaining: how far it could still go before that [rad].
    """

    view: LidEstimator
    felt: float
    finger: float
    room: float
    remaining: float


def flip_guards(
    step: FlipOver, view: LidEstimator, tuning: FlipTuning
) -> Iterator[Guard[FlipSample]]:
    """Ends of a flip: the lid must follow the finger, and its object must neither lean nor move.

    Args:
        step: what is done.
        view: of the lid; tells which motion of its object may be the camera's noise.
        tuning: with the limits.
    """
    opens = step.end > step.start
    sign = 1.0 if opens else -1.0

    def seen(s: FlipSample) -> str:
        return f"{np.degrees(s.view.lid):.0f}°"

    yield Guard(
        "handled",
        lambda s: s.view.lid,
        step.end,
        lambda s: f"the lid is seen open by {seen(s)}",
        beyond=operator.gt if opens else operator.lt,
        trips_at=step.end - sign * tuning.end_tolerance,
        text=f"the lid is seen at {np.degrees(step.end):.0f}°",
        unit="rad",
    )
    yield Guard(
        "force",
        lambda s: s.room,
        step.force_limit,
        lambda s: f"the lid does not move with {s.felt:.1f} N",
        beyond=operator.lt,
        trips_at=_STOPPED_ROOM,
        lasts=tuning.stuck_time,
        text=f"the lid does not move with {step.force_limit:.1f} N",
        unit="N",
    )
    yield Guard(
        "slid",
        lambda s: s.view.displacement,
        tuning.largest_displacement,
        lambda s: f"it was seen to move by {1e3 * s.view.displacement:.0f} mm",
        trips_at=max(tuning.largest_displacement, view.unsure),
        text=f"the {view.name} is seen moved by {1e3 * tuning.largest_displacement:.0f} mm",
        unit="m",
    )
    yield Guard(
        "tilted",
        lambda s: s.view.tilt,
        tuning.largest_tilt,
        lambda s: f"it was seen to lean by {np.degrees(s.view.tilt):.0f}°",
        trips_at=max(tuning.largest_tilt, view.unsure_angle),
    )
    yield Guard(
        "missed",
        lambda s: sign * (s.finger - s.view.lid),
        tuning.largest_lag,
        lambda s: f"the lid does not follow the finger: it is seen open by {seen(s)}",
    )
    yield Guard(
        "missed",
        lambda s: s.remaining,
        0.0,
        lambda s: f"the lid is seen open by {seen(s)} only",
        beyond=operator.le,
        lasts=tuning.wait_time,
    )


class FlipControl:
    """One flip, from before the lid of an object that was seen until the hand is back there.

    Law: the commanded angle of the lid advances while less than the force limit is felt, no
    faster than the plan's speed; the fingertip follows the arc of that angle, its spring bent
    by what the lid resists. The limit is that of the angle at which the finger is felt to
    stand. What has come of it only the camera tells: the lid must follow the finger, and the
    object must neither lean nor move. Where it does, or where the force is not enough, the
    finger goes back the way it came.

    Frames: W is the world, E stands at the hinge (`sim.robots.lid_path`), T is the fingertip's
    centre.
    """

    tuning = FlipTuning()

    def __init__(
        self,
        step: FlipOver,
        recorder: TraceRecorder,
        stance: FlipConfiguration,
        target: SeenObject,
    ) -> None:
        self._step = step
        self._recorder = recorder
        self._stance = stance
        # The way was looked for with rounded angles.
        self._lid = replace(stance.lid, start=step.start, end=step.end)
        self._view = LidEstimator(target, step.start, recorder.port.cell.vision)
        self._period = recorder.port.period
        self._angle = step.start
        self._at = (stance.hands.path.points[0], 0.0)
        self._felt = 0.0

    def flip(self) -> Ended:
        """Goes to the lid and flips it; returns how that ended and why."""
        degrees = np.degrees(self._step.end)
        verb = "opening" if self._lid.is_opening else "closing"
        self._recorder.begin("lid", f"{verb} the lid to {degrees:.0f}°")
        self._recorder.force_limit = self._step.force_limit
        self._recorder.inward = self._into(self._step.start)
        self._recorder.take_zero(PAUSE, lambda: self._command(*self._at))
        self._felt = 0.0
        start = np.array([self._step.start])
        self._go(self._stance.hands.path.points[1], 0.0, 2.0 * TOUCH_SPEED)
        self._go(self._lid.tip_centres(start)[0], 0.0, TOUCH_SPEED)
        return self._along()

    def leave(self, *, done: bool) -> None:
        """Off the lid and to where the flip began: straight if it is done, else as it came."""
        self._recorder.begin("retreat", "leaving the lid")
        self._recorder.force_limit = 0.0
        way = self._stance.hands.path
        if done:
            for point, share in zip(way.points[-3:], way.shares[-3:], strict=True):
                self._go(point, float(share), HAND_SPEED)
            return
        back = np.arange(self._angle, self._step.start, -self._sign * self._rate * self._period)
        for angle in back.tolist():
            self._to_angle(angle)
        for point in way.points[1::-1]:
            self._go(point, 0.0, 0.5 * HAND_SPEED)

    # -- along the arc --------------------------------------------------------------------------

    @property
    def _sign(self) -> float:
        return 1.0 if self._lid.is_opening else -1.0

    @property
    def _rate(self) -> float:
        """Largest one of the lid [rad/s]."""
        return self._step.speed / self._lid.touch_lever

    def _along(self) -> Ended:
        """Follows the arc until the lid is seen where it should be, or something is wrong."""
        last = self._step.end + self._sign * self.tuning.overrun
        watch = Watch(flip_guards(self._step, self._view, self.tuning), self._period)
        rate, room, remaining = 0.0, 1.0, math.inf
        while True:
            sample = FlipSample(self._view, self._felt, self._finger(), room, remaining)
            ended = watch.first_tripped(sample)
            if ended is not None:
                return ended
            limit = self._recorder.force_limit = self._limit()
            rate = min(self._largest_rate(), rate + self.tuning.acceleration * self._period)
            room = float(
                np.clip((limit - self._felt) / (self.tuning.force_band * limit), -1.0, 1.0)
            )
            remaining = self._sign * (last - self._angle)
            advance = min(rate * room * self._period, remaining)
            self._to_angle(self._angle + self._sign * advance)

    def _largest_rate(self) -> float:
        """Largest rate now [rad/s]: slow until the lid moves, and as its end is near."""
        tuning = self.tuning
        if abs(self._view.lid - self._step.start) < tuning.caught_angle:
            return min(tuning.least_rate, self._rate)
        near = tuning.braking * self._sign * (self._step.end - self._angle)
        return min(self._rate, max(tuning.least_rate, near))

    def _limit(self) -> float:
        """Felt force at which it stops where the finger stands now [N]."""
        start, end = self._step.start, self._step.end
        return float(force_limits_at(self._step, (self._finger() - start) / (end - start)))

    def _finger(self) -> float:
        """Angle that a lid has which touches the fingertip [rad]."""
        assert self._recorder.touch is not None, "the recorder knows the finger"
        R_WE, p_WE = self._stance.R_WE, self._stance.p_WE
        return self._lid.angle_at_tip(R_WE.T @ (self._recorder.touch.midpoint - p_WE))

    def _to_angle(self, angle: float) -> None:
        """Commands the fingertip to where it touches a lid of some angle."""
        self._angle = angle
        start, end = self._step.start, self._step.end
        share = float(np.clip((angle - start) / (end - start), 0.0, 1.0))
        self._recorder.inward = self._into(angle)
        self._command(self._lid.tip_centres(np.array([angle]))[0], share)

    def _into(self, angle: float) -> Array:
        """Direction into the lid in W, shape (3,)."""
        return np.asarray(self._stance.R_WE @ self._lid.lid_normals(np.array([angle]))[0])

    # -- steps ----------------------------------------------------------------------------------

    def _go(self, point: Array, share: float, speed: float) -> None:
        """Straight to a point of E, the palm turning along."""
        here, goal = (
            np.append(self._at[0], self.tuning.palm_way * self._at[1]),
            np.append(point, self.tuning.palm_way * share),
        )
        for at in attractor_points(
            here, goal, speed=speed, acceleration=HAND_ACCELERATION, period=self._period
        ):
            self._command(at[:3], float(at[3]) / self.tuning.palm_way)

    def _command(self, p_ET: Array, share: float) -> None:
        """Commands T to a point of E, and takes in what was felt and seen."""
        self._at = (p_ET, share)
        posture = self._stance.stance.posture
        self._recorder.step(self._stance.joint_angles(p_ET, share), posture.joint_angles)
        assert self._recorder.touch is not None, "the recorder knows the finger"
        felt = float(self._recorder.touch.forces[0] @ self._recorder.inward)
        self._felt += min(1.0, self._period / self.tuning.filter_time) * (felt - self._felt)
        self._view.update_from_camera(self._recorder.frames)


CLOSING_SPEED = 0.020
"""Of the fingertips on each side while they close and open [m/s]."""


ACCELERATES = 0.35
"""Time in which a leg comes to its speed [s]."""


@dataclass(frozen=True)
class HandTuning:
    """Speeds of a hand that closes, holds and carries."""

    # Rate at which the springs take a weight over, or what is held would jump [N/s].
    bearing_rate: float = 20.0
    # With which what is carried swings on the springs of arm and hand [s].
    swing_period: float = 0.25
    swing_speed: float = 0.5  # of the arm's joints together, near objects [rad/s]
    swing_step: float = 0.02  # between arm poses that are kept for the way back [rad]
    # Force down on what is held at which it stands on something [N].
    standing_force: SafetyFigure = 2.0
    winding_rate: float = 10.0  # rate at which the squeeze rises and falls [N/s]


class HandMotion:
    """Motions of arm and hand about one object.

    Attributes:
        opening: how far each fingertip stands off its side [m].
        wound: squeeze for which the finger springs are wound up [N].
        watch: guards of what is held; None where it may do as it will.
        bears: whether the springs are wound up to bear what is felt to hang on them, too.
    """

    tuning = HandTuning()

    def __init__(self, recorder: TraceRecorder, way: GraspMotion, sense: HandSense) -> None:
        self._recorder = recorder
        self._port = recorder.port
        self._way = way
        self._sense = sense
        self.opening = way.grip.opening
        self.wound = 0.0
        self.watch: Watch[HandSense] | None = None
        self.bears = False
        self._borne = np.zeros(3)  # force upwards for which the springs are wound up, in W [N]
        self.zero_samples = 0
        self.came: list[Array] = [self._port.commanded[0]]

    # -- the hand -------------------------------------------------------------------------------

    def feel_nothing(self) -> None:
        """Takes what the torque sensors read while the open hand hangs still as their zero."""
        self._recorder.fingers = self._way.mount.hand.grasp_fingers
        self.zero_samples = self._recorder.take_zero(PAUSE, self.stay)
        self._sense.zero_forces()

    def close(self) -> None:
        """The fingertips a little nearer to each other, for one control step."""
        self.opening -= CLOSING_SPEED * self._port.period
        self.stay()

    def wind(self) -> None:
        """A little more squeeze, for one control step."""
        self.wound += self.tuning.winding_rate * self._port.period
        self.stay()

    def let_go(self) -> None:
        """Unwinds the springs, and opens the hand."""
        self.watch, self.bears = None, False
        steps = max(1, round(self.wound / (self.tuning.winding_rate * self._port.period)))
        wound, borne = self.wound, self._borne
        for left in np.linspace(1.0, 0.0, steps + 1)[1:]:
            self.wound, self._borne = left * wound, left * borne
            self.stay()
        while self.opening < self._way.grip.opening:
            self.opening += CLOSING_SPEED * self._port.period
            self.stay()

    def take_over(self, holding: Holding) -> None:
        """Goes on with what was held before."""
        self.opening, self.wound = holding.opening, holding.wound
        self.zero_samples = holding.zero_samples
        self.came = [*holding.came, self._port.commanded[0]]
        self._borne[2] = holding.borne
        self._sense.weighs(holding.borne)
        self.bears = True

    def holding(self, held: Held, R_PB: Array, p_PG: Array) -> Holding:
        """The part of it that lasts until the next plan."""
        return Holding(
            held=held,
            zero=np.asarray(self._recorder.zero),
            zero_samples=self.zero_samples,
            opening=self.opening,
            wound=self.wound,
            borne=float(self._borne[2]),
            R_PB=R_PB,
            p_PG=p_PG,
            came=tuple(self.came),
        )

    @property
    def _hand(self) -> Array:
        """Commanded angles of the fingers."""
        grip = self._way.grip
        R_WP, _ = self._way.mount.palm_poses(self._port.commanded[0])
        q = grip.posture_at(self.opening).joint_angles + self.wound * grip.squeeze_offsets
        return np.asarray(q + grip.force_offsets(R_WP.T @ self._borne))

    # -- the arm --------------------------------------------------------------------------------

    def transit(self, poses: tuple[Array, ...], q_hand: Array, *, homeward: bool = False) -> None:
        """Free motion through arm poses, the hand opening or closing on the first way."""
        for q in poses:
            move_joints(self._recorder, q, q_hand, homeward=homeward)
            self.came.append(q)

    def go(self, leg: HeldSegment, until: float = -np.inf) -> float:
        """Moves along a leg; ends early if less than a weight is felt [N].

        Returns:
            The share of the leg that was made.

        Raises:
            EarlyEndError: a guard stopped it.
        """
        made = 0.0
        shares = self._shares(1.0, leg.share_rate)
        if leg.phase == "carry":
            shares = _running_means(shares, round(self.tuning.swing_period / self._port.period))
        for share in shares:
            self.reach(leg, share)
            made = share
            if self._sense.weight < until:
                break
        return made

    def reach(self, leg: HeldSegment, share: float) -> None:
        """To a place on a leg, for one control step.

        Raises:
            EarlyEndError: a guard stopped it.
        """
        self._recorder.phase = leg.phase
        q, valid = self._way.joint_angles(*leg.poses_at(np.array([share])))
        if not valid[0]:
            raise EarlyEndError("unreachable", "the arm does not get along its way")
        self._command(q[0])

    def swing(self, poses: Array, *, stop: bool = False) -> None:
        """The arm through poses without a pause; may stop where what is held stands."""
        far = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(poses, axis=0), axis=1)))
        for at in self._shares(float(far[-1]), self.tuning.swing_speed):
            self._command(np.array([np.interp(at, far, joint) for joint in poses.T]))
            if stop and self._sense.weight < -self.tuning.standing_force:
                break

    def back_to(self, place: int, *, stop: bool = False) -> None:
        """Back along the way that it came, to a place in `came`; may stop as `swing` does."""
        poses = np.array([self._port.commanded[0], *self.came[: place - 1 if place else None : -1]])
        del self.came[place + 1 :]
        before = len(self.came)
        if len(poses) > 1:
            self.swing(poses, stop=stop)
        del self.came[before:]

    def come_home(self, poses: tuple[Array, ...]) -> None:
        """Free motion home, where the hand closes."""
        *rest, home = poses
        self.transit(tuple(rest), self._port.commanded[1])
        self.transit((home,), self._way.mount.hand.resting.joint_angles, homeward=True)

    def stay(self) -> None:
        """Hangs still for one control step."""
        self._command(self._port.commanded[0])

    def wait(self, seconds: float) -> None:
        """Hangs still [s]."""
        for _ in range(round(seconds / self._port.period)):
            self.stay()

    def _command(self, q_arm: Array) -> None:
        if self.bears:
            most = self.tuning.bearing_rate * self._port.period
            more = float(np.clip(self._sense.weight - self._borne[2], -most, most))
            self._borne[2] = max(0.0, self._borne[2] + more)
        self._sense.step(q_arm, self._hand)
        if np.linalg.norm(q_arm - self.came[-1]) > self.tuning.swing_step:
            self.came.append(np.array(q_arm))
        ended = None if self.watch is None else self.watch.first_tripped(self._sense)
        if ended is not None:
            raise EarlyEndError(*ended)

    def _shares(self, far: float, speed: float) -> Iterator[float]:
        """From 0 to an end, one per control step."""
        for (share,) in attractor_points(
            np.zeros(1),
            np.array([far]),
            speed=speed,
            acceleration=speed / ACCELERATES,
            period=self._port.period,
        ):
            yield float(share)


def _running_means(shares: Iterable[float], steps: int) -> Iterator[float]:
    """Shares of a way from rest at 0 to rest at 1, each averaged with those before it."""
    last = deque([0.0] * steps, maxlen=steps)
    for share in chain(shares, repeat(1.0, steps)):
        last.append(share)
        yield sum(last) / steps
