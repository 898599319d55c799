"""Motions of the hand about something that it holds, and back.

Arm and hand are joint impedances; what is commanded is where their springs rest. The finger springs
are wound up by Jᵀf/k to exert a force f: the squeeze, and what bears the weight, so that the object
does not sag in the hand. Every arm pose on the way is kept, since the way back along them is free.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from itertools import chain, repeat
from typing import TYPE_CHECKING

import numpy as np

from sim.control.free_motion import move_joints
from sim.control.grasping.held_object_sensing import HandSense, Holding
from sim.control.pushing.guarded_touch import PAUSE
from sim.control.trace_recorder import EarlyEndError
from sim.paths.held_segment import HeldSegment
from sim.paths.point_attractor import attractor_points
from sim.rotations import Array

if TYPE_CHECKING:
    from planner.types.world_state import Held
    from sim.control.trace_recorder import TraceRecorder
    from sim.motion.grasp_motion_search import GraspMotion

CLOSING_SPEED = 0.020
"""Of the fingertips on each side while they close and open [m/s]."""

WINDING = 10.0
"""Rate at which the squeeze rises and falls [N/s]."""

ACCELERATES = 0.35
"""Time in which a leg comes to its speed [s]."""

_BEARING = 20.0  # rate at which the springs take a weight over, or what held would jump [N/s]
_SWINGS = 0.25  # period with which what is carried swings on the springs of arm and hand [s]
_SWING_SPEED = 0.5  # of the arm's joints together, near objects [rad/s]
_SWING_STEP = 0.02  # between arm poses that are kept for the way back [rad]
_PRESSES = 2.0  # force down on what is held at which it stands on something [N]


class HandMotion:
    """Motions of arm and hand about one object.

    Attributes:
        opening: how far each fingertip stands off its side [m].
        wound: squeeze for which the finger springs are wound up [N].
        squeeze: with which something is held, while that is guarded; else 0 [N].
        bears: whether the springs are wound up to bear what is felt to hang on them, too.
    """

    def __init__(self, recorder: TraceRecorder, way: GraspMotion, sense: HandSense) -> None:
        self._recorder = recorder
        self._port = recorder.port
        self._way = way
        self._sense = sense
        self.opening = way.grip.opening
        self.wound = 0.0
        self.squeeze = 0.0
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
        self.wound += WINDING * self._port.period
        self.stay()

    def let_go(self) -> None:
        """Unwinds the springs, and opens the hand."""
        self.squeeze, self.bears = 0.0, False
        steps = max(1, round(self.wound / (WINDING * self._port.period)))
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
            shares = _running_means(shares, round(_SWINGS / self._port.period))
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
        for at in self._shares(float(far[-1]), _SWING_SPEED):
            self._command(np.array([np.interp(at, far, joint) for joint in poses.T]))
            if stop and self._sense.weight < -_PRESSES:
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
            most = _BEARING * self._port.period
            more = float(np.clip(self._sense.weight - self._borne[2], -most, most))
            self._borne[2] = max(0.0, self._borne[2] + more)
        self._sense.step(q_arm, self._hand)
        if np.linalg.norm(q_arm - self.came[-1]) > _SWING_STEP:
            self.came.append(np.array(q_arm))
        if self.squeeze > 0.0:
            self._sense.require_held(self.squeeze)
            self._sense.require_others()

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
