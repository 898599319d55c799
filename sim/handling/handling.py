"""Carries out a plan of the whole hand: take hold, lift, carry, pour, set down, let go.

Arm and hand are joint impedances throughout. The fingers close until both sides feel the object;
then their springs are wound up until it feels the squeeze, which is the feed-forward torque Jᵀf in
another guise. Guards know what the robot feels and sees (`sim.handling.holding`). One that stops a
plan makes the hand go back the way it came, which was free, and set down what it holds where it
took it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from planner.handling.plan import Grasp, HandlingPlan, LiftUp, PourOut, SetDown
from planner.reach import ReachAnswer
from planner.state import Held, WorldState
from sim.attractor import attracted
from sim.hand import RESTING
from sim.handling.flip import flip_over
from sim.handling.grips import HOLDING
from sim.handling.holding import HandSense, Holding
from sim.handling.legs import Leg, upright_again
from sim.handling.search import HandWay
from sim.handling.weighing import Weight, weight
from sim.reach import ArmReach
from sim.recorder import Recorder
from sim.rotations import Array
from sim.touch import PAUSE, EarlyEndError
from sim.trace import EndReason, Trace
from sim.trip import Progress, look_around, move_joints, silent

if TYPE_CHECKING:
    from objectmodels.model import ObjectModel
    from sim.world import DrakeWorld

CLOSING_SPEED = 0.020
"""Of the fingertips on each side while they close and open [m/s]."""

CONTACT = 0.4
"""Force on each side that counts as contact [N]."""

SETTLE = 0.5
"""Time that everything gets to come to rest in the end [s]."""

_BEYOND = 0.008  # how far each side closes beyond the believed width to find something [m]
_WIDTH_ERROR = 0.012  # of a width between thumb and fingers that is not the object's [m]
_WINDING = 10.0  # rate at which the squeeze rises and falls [N/s]
_WINDS_BEYOND = 1.5  # times the squeeze for which the springs are wound up at most
_ENOUGH = 0.8  # share of the squeeze that must be felt
_STILL = 0.4  # time for which the hand hangs still to look at what it holds [s]
_LIFTED = 0.35  # share of the believed weight that must hang on the fingers
_ACCELERATES = 0.35  # time in which a leg comes to its speed [s]
_SLOW_DOWN = 0.020  # height over the table at which setting down becomes slow [m]
_FEELING_SPEED = 0.015  # of what is set down then [m/s]
_INTO = 0.006  # how far below the table it is looked for [m]
_STANDS = 0.5  # share of its weight with which it stands
_GRAVITY = 9.81


def handle(
    plan: HandlingPlan,
    world: DrakeWorld,
    models: Mapping[str, ObjectModel],
    *,
    reach: ArmReach | None = None,
    progress: Progress | None = None,
) -> Trace:
    """Carries out a plan of the whole hand.

    Args:
        plan: what to do.
        world: where; it moves on.
        models: what the robot believes of every object, by its name in the scene.
        reach: of the world's robot, if there is one already.
        progress: told of the phase, the simulated time [s] and what happens.

    Returns:
        What happened, also if it ended early. What the hand holds then is `world.holding`.
    """
    reach = reach or ArmReach(world.scene)
    if plan.grasp is None:
        return flip_over(plan, world, models, reach=reach, progress=progress)
    recorder = Recorder(world, reach.mount, -np.array(plan.grasp.approach_W))
    tell = progress or silent
    state = look_around(recorder, models, tell)
    way = reach.hand_way(plan, state)
    end: EndReason = "handled"
    detail = "all steps were made"
    if isinstance(way, ReachAnswer):
        end, detail = "unreachable", way.message
    else:
        trip = HandTrip(plan, plan.grasp, recorder, way, state, tell)
        try:
            trip.carry_out()
        except EarlyEndError as early:
            end, detail = early.end, early.detail
            tell("retreat", world.time, detail)
            trip.give_up()
    return recorder.trace(plan.object, np.array(plan.grasp.approach_W), end=end, detail=detail)


class HandTrip:
    """One plan of the whole hand.

    Args:
        plan: what to do.
        grasp: its grasp.
        recorder: through which the world is stepped.
        way: of arm and hand.
        state: what is believed.
        tell: progress.
    """

    def __init__(
        self,
        plan: HandlingPlan,
        grasp: Grasp,
        recorder: Recorder,
        way: HandWay,
        state: WorldState,
        tell: Progress,
    ) -> None:
        self._plan = plan
        self._grasp = grasp
        self._recorder = recorder
        self._world = recorder.world
        self._way = way
        self._tell = tell
        self._held = state.objects[plan.object]
        self._sense = HandSense(recorder, way.mount, plan.object, np.array(grasp.p_BG), state)
        self._wound = 0.0  # squeeze for which the finger springs are wound up [N]
        self._opening = way.grip.opening
        self._zero_samples = 0
        self._done: list[Leg] = []  # legs on which something was held
        self._came: list[Array] = []  # arm poses from home on
        self._weight: Weight | None = None
        self._holds = False
        self._guarded = False

    # -- the whole ------------------------------------------------------------------------------

    def carry_out(self) -> None:
        """Makes all steps.

        Raises:
            EarlyEndError: a guard stopped it, or nothing was held.
        """
        approach, *steps, retreat = self._way.legs
        if self._plan.held:
            self._take_up()
        else:
            self._reach_for(approach[0])
            self._take_hold()
        for step, legs in zip(self._plan.steps, steps, strict=True):
            if isinstance(step, PourOut):
                self._pour(step, legs)
            elif isinstance(step, SetDown):
                self._set_down(legs[0])
            else:
                self._go_all(legs)
            if isinstance(step, LiftUp):
                self._hold_up(step)
        if retreat:
            self._leave(retreat[0])
            self._come_home()
        else:
            self._keep()

    def give_up(self) -> None:
        """Back the way it came, whatever is still held set down where it was taken."""
        self._guarded = False
        approach = self._way.legs[0]
        self._recorder.phase = "retreat"
        for leg in [each.back(phase="retreat") for each in reversed(self._done)]:
            self._go(leg)
        if self._plan.held:
            self._keep()
            return
        if not self._came:
            return
        if self._done and self._holds:
            self._release()
        self._leave(approach[0].back(phase="retreat"))
        self._come_home()

    # -- free motion ----------------------------------------------------------------------------

    def _reach_for(self, approach: Leg) -> None:
        """From home to where the open hand is about the object."""
        self._tell("transit", self._world.time, "moving the hand")
        self._recorder.phase = "transit"
        opened = self._way.grip.posture(self._opening).joints
        first, _ = self._way.joints(*approach.poses(np.zeros(1)))
        for q in (*self._way.there, first[0]):
            self._came.append(self._world.commanded[0])
            move_joints(self._recorder, q, opened)
        self._tell("approach", self._world.time, f"reaching for the {self._plan.object}")
        self._go(approach)

    def _leave(self, retreat: Leg) -> None:
        """Off what was let go, from wherever the hand is."""
        self._guarded = False
        self._tell("retreat", self._world.time, "drawing the hand back")
        self._go(retreat)

    def _come_home(self) -> None:
        back = self._way.back if self._done else tuple(reversed(self._way.there))
        home = self._came[0]
        for q in (*back, home):
            last = q is home
            move_joints(self._recorder, q, RESTING.joints if last else self._world.commanded[1])
        self._tell("settle", self._world.time, "letting everything come to rest")
        self._recorder.phase = "settle"
        self._wait(SETTLE)

    def _keep(self) -> None:
        """Stays where it is, with what it holds."""
        self._recorder.phase = "settle"
        self._wait(SETTLE)
        if not self._holds:
            return
        R_WP, p_WP = self._way.mount.palm(self._world.commanded[0])
        R_PB, p_PG = self._sense.seen
        closing, approach = R_WP[:, 0], R_WP[:, 2]
        height = p_WP + R_WP @ p_PG - R_WP @ R_PB @ np.array(self._grasp.p_BG)
        grasp = self._grasp.model_copy(
            update={
                "closing_W": tuple(closing.tolist()),
                "approach_W": tuple(approach.tolist()),
            }
        )
        arm = tuple(self._world.commanded[0].tolist())
        held = Held(self._plan.object, grasp, float(height[2]), arm)
        zero = np.asarray(self._recorder.zero)
        self._world.holding = Holding(held, zero, self._zero_samples, self._wound, R_PB, p_PG)

    # -- taking hold ----------------------------------------------------------------------------

    def _take_up(self) -> None:
        """Goes on with what is held already."""
        holding = self._world.holding
        if holding is None or holding.held.name != self._plan.object:
            raise EarlyEndError("no_grasp", f"the hand does not hold the {self._plan.object}")
        self._world.holding = None
        self._recorder.fingers = HOLDING
        self._recorder.zero = holding.zero
        self._zero_samples = holding.zero_samples
        self._wound = holding.squeeze
        self._holds = self._guarded = True
        self._opening = 0.0
        self._wait(_STILL, guarded=False)
        self._sense.remember(holding.R_PB, holding.p_PG)

    def _take_hold(self) -> None:
        """Closes until both sides feel something, and squeezes it."""
        self._recorder.phase = "grasp"
        self._tell("grasp", self._world.time, f"taking hold of the {self._plan.object}")
        self._feel_nothing()
        sense, period = self._sense, self._world.period
        while min(sense.thumb, sense.fingers) < CONTACT:
            self._opening -= CLOSING_SPEED * period
            if self._opening < -_BEYOND:
                raise EarlyEndError("no_grasp", self._felt_too_little("closed"))
            self._stay()
        squeeze = self._grasp.squeeze
        while sense.squeeze < squeeze and self._wound < _WINDS_BEYOND * squeeze:
            self._wound += _WINDING * period
            self._stay()
        self._holds = True
        sense.forget()
        self._wait(_STILL)
        wrong = abs(sense.width - self._grasp.width) > _WIDTH_ERROR
        if min(sense.thumb, sense.fingers) < _ENOUGH * squeeze or wrong:
            raise EarlyEndError("no_grasp", self._felt_too_little("squeezed"))
        sense.remember()
        self._guarded = True

    def _feel_nothing(self) -> None:
        """What the torque sensors read while the open hand hangs still is their zero."""
        self._recorder.fingers = HOLDING
        torques = []
        for k in range(round(PAUSE / self._world.period)):
            self._stay()
            if k * self._world.period >= 0.2 * PAUSE:
                torques.append(self._recorder.torques)
        self._recorder.zero = np.mean(torques, axis=0)
        self._zero_samples = len(torques)
        self._sense.thumb = self._sense.fingers = 0.0

    def _felt_too_little(self, done: str) -> str:
        sense = self._sense
        return (
            f"the hand {done} to {1e3 * sense.width:.0f} mm and feels {sense.thumb:.1f} N at the "
            f"thumb, {sense.fingers:.1f} N at the fingers"
        )

    # -- holding --------------------------------------------------------------------------------

    def _hold_up(self, step: LiftUp) -> None:
        """Weighs what was lifted."""
        felt = self._weigh(max(step.hold, _STILL))
        believed = self._held.model.weight
        self._tell(
            "lift", self._world.time, f"it weighs {felt.mean:.2f} N, give or take {felt.sd:.2f} N"
        )
        if felt.mean < _LIFTED * believed:
            raise EarlyEndError(
                "no_grasp",
                f"{felt.mean:.1f} N hang on the fingers, and the {self._plan.object} should weigh "
                f"{believed:.1f} N",
            )

    def _weigh(self, seconds: float) -> Weight:
        """Hangs still and feels the weight."""
        felt = []
        for _ in range(round(seconds / self._world.period)):
            self._stay()
            felt.append(self._sense.vertical)
        # The arm still swings at first.
        steady = np.array(felt[len(felt) // 3 :])
        self._weight = weight(steady, self._zero_samples)
        return self._weight

    def _pour(self, step: PourOut, legs: tuple[Leg, ...]) -> None:
        """Tilts until enough has run out, waits, and comes back upright."""
        self._tell("pour", self._world.time, f"pouring into the {step.into}")
        half = len(legs) // 2
        first, *tilting = legs[:half]
        self._go(first)
        full = self._weigh(_STILL)
        model = self._held.model
        assert model.container is not None, "only a container is poured from"
        enough = full.mean - _GRAVITY * model.container.density * (step.volume or np.inf)
        made = [first]
        for leg in tilting:
            share = self._go(leg, until=enough)
            made.append(leg)
            if share < 1.0:
                break
        else:
            share = 1.0
            self._wait(step.wait)
        way = upright_again(made[:-1], made[-1], share)
        for leg in way:
            self._go(leg)
        del self._done[len(self._done) - len(made) - len(way) :]

    def _set_down(self, leg: Leg) -> None:
        """Down until it stands, then lets go."""
        self._tell("set_down", self._world.time, f"setting the {self._plan.object} down")
        height = float(leg.start[2] - leg.end[2])
        slow = min(_SLOW_DOWN, height)
        down = np.array([0.0, 0.0, -1.0])
        near = leg.start + (height - slow) * down
        if height > slow:
            self._go(replace(leg, end=near))
        hangs = self._weigh(_STILL).mean
        last = replace(leg, start=near, end=leg.end + _INTO * down, speed=_FEELING_SPEED)
        self._guarded = False
        self._go(last, until=_STANDS * hangs)
        self._release()

    def _release(self) -> None:
        """Lets go of what stands, and opens the hand."""
        period = self._world.period
        while self._wound > 0.0:
            self._wound = max(0.0, self._wound - _WINDING * period)
            self._stay()
        while self._opening < self._way.grip.opening:
            self._opening += CLOSING_SPEED * period
            self._stay()
        self._holds = False

    # -- steps ----------------------------------------------------------------------------------

    @property
    def _hand(self) -> Array:
        """Commanded angles of the fingers: where they are to be, and what winds their springs."""
        grip = self._way.grip
        return grip.posture(self._opening).joints + self._wound * grip.pressing

    def _stay(self) -> None:
        self._command(self._world.commanded[0])

    def _command(self, q_arm: Array) -> None:
        self._sense.step(q_arm, self._hand)
        if self._guarded:
            self._sense.require_held(self._grasp.squeeze)
            self._sense.require_others()

    def _wait(self, seconds: float, *, guarded: bool = True) -> None:
        before, self._guarded = self._guarded, self._guarded and guarded
        for _ in range(round(seconds / self._world.period)):
            self._stay()
        self._guarded = before

    def _go_all(self, legs: tuple[Leg, ...]) -> None:
        for leg in legs:
            self._go(leg)

    def _go(self, leg: Leg, until: float = -np.inf) -> float:
        """Moves along a leg; ends early if less than a weight is felt [N].

        Returns:
            The share of the leg that was made.
        """
        self._recorder.phase = leg.phase
        made = 0.0
        try:
            for share in self._shares(leg):
                q, valid = self._way.joints(*leg.poses(np.array([share])))
                if not valid[0]:
                    raise EarlyEndError("unreachable", "the arm does not get along its way")
                self._command(q[0])
                made = share
                if self._sense.weight < until:
                    break
        finally:
            if not leg.free and self._holds:
                self._done.append(leg if made == 1.0 else _part(leg, made))
        return made

    def _shares(self, leg: Leg) -> Iterator[float]:
        fastest = leg.fastest
        for (share,) in attracted(
            np.zeros(1),
            np.ones(1),
            speed=fastest,
            acceleration=fastest / _ACCELERATES,
            period=self._world.period,
        ):
            yield float(share)


def _part(leg: Leg, share: float) -> Leg:
    """The first part of a leg."""
    return replace(leg, end=leg.start + share * (leg.end - leg.start), turn=share * leg.turn)
