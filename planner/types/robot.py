"""The planner's questions to the robot: can arm and hand carry it out?

`sim` answers them from the kinematics of arm and hand; a real robot's driver may answer them from
its own. The planner only asks.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from planner.types.actions import FlipOver, Push
from planner.types.plan import Plan
from planner.types.world_state import WorldState

_SAME_HOLD, _SAME_WAY = 0.01, 0.97  # distance [m] and cosine up to which holds are the same

ReachEffort = Literal["usual", "thorough"]
"""How long a robot looks for a way of the hand. A thorough search also lets it pass nearer."""


@dataclass(frozen=True)
class ReachAnswer:
    """Answer to whether the hand can carry out a push.

    Attributes:
        ok: the whole way (approach, touch, stroke, retreat) is free and within joint limits.
        reason: if not ok, what stops it: `kinematics`, `table`, `object` (the pushed one),
            `obstacle` (another one), `approach`, `torque` (it gets there, but is too weak there),
            `failed` (a push there went wrong before).
        code: of its sentence in `planner.refusals.sentences.REACH`; `told`, with the word `text`,
            for a robot that has a sentence of its own.
        blocker: name of the obstacle, if one is in the way.
        margin: if ok, smallest distance to a joint limit on the way [rad].
        numbers: figures behind the answer [SI].
        words: names, and other numbers of the sentence.
        stiffness: if ok, force per displacement of the fingertips along the push, all together
            [N/m]; 0 of a robot that does not know it.
        work: units of work behind it, whatever was known before; see `Defaults.most_work`.
        postures: of the hand that were looked at for it.
        crowded: whether what stands about leaves no posture of the hand any room, so that none has
            room any lower there.
        stopped_by: if not ok, names of the other objects that took part in that: as long as these
            stand where they do, it stays so, wherever the rest is; None of a robot that does not
            know them.
    """

    ok: bool
    reason: str | None = None
    code: str = ""
    blocker: str | None = None
    margin: float = 0.0
    numbers: dict[str, float] = field(default_factory=dict)
    words: Mapping[str, object] = field(default_factory=dict)
    stiffness: float = 0.0
    work: int = 1
    postures: int = 0
    crowded: bool = False
    stopped_by: frozenset[str] | None = None


@dataclass(frozen=True, eq=False)
class Grip:
    """Grip of the hand about something of a width.

    Attributes:
        contacts: of the fingers that touch, the thumb first, in the plane across the closing
            direction, from the middle of the grasp: along the approach, and along
            approach × closing, shape (k, 2) [m].
        shares: of the squeeze that each of them bears; the thumb's is 1, the others' sum to 1,
            shape (k,).
        strongest: largest squeeze, with a tangential load as large beside it [N].
        room: free length beyond the fingers' side that the knuckles need, and beyond the thumb's,
            along the closing direction [m].
        ahead: how far the fingers reach beyond the middle, along the approach [m].
        stiffness: moment that turns what is held about the closing direction, per angle [N·m/rad];
            infinite of a hand that does not know it.
    """

    contacts: NDArray[np.float64]
    shares: NDArray[np.float64]
    strongest: float
    room: tuple[float, float]
    ahead: float = 0.0
    stiffness: float = math.inf


@dataclass(frozen=True)
class RobotLimits:
    """Figures of arm and hand on which plans depend.

    Attributes:
        fingertip_radius: radius of a fingertip [m].
        finger_spreads: distances between the two outer fingertips of a two-finger push, the largest
            first [m].
        max_force: largest force that one fingertip can exert [N].
        force_skew: largest vertical force at a fingertip per force along the push while the tip
            sticks: what the hand's own stiffness lets it transmit, whatever friction would allow.
        lowest_height: lowest contact height above the table that a fingertip reaches anywhere [m].
        grasp_widths: least and largest width between thumb and fingers [m]; None of a robot that
            only pushes.
        lowest_grasp: least height above the table of the middle of a grasp from beside [m].
    """

    fingertip_radius: float
    finger_spreads: tuple[float, ...]
    max_force: float
    force_skew: float
    lowest_height: float
    grasp_widths: tuple[float, float] | None = None
    lowest_grasp: float = 0.0


@dataclass(frozen=True)
class FailedPush:
    """A push that went wrong when it was carried out.

    Attributes:
        push: the push.
        detail: what went wrong, in words.
    """

    push: Push
    detail: str


@dataclass(frozen=True)
class FailedHold:
    """What a whole hand tried and failed at.

    Attributes:
        plan: of it.
        detail: what went wrong, in words.
    """

    plan: Plan
    detail: str

    def repeats(self, plan: Plan) -> bool:
        """Return True if a plan would try the same: as it holds, and no harder."""
        mine, other = ([step.kind for step in each.steps] for each in (self.plan, plan))
        if mine != other or (self.plan.grasp is None) != (plan.grasp is None):
            return False
        if self.plan.grasp is not None and plan.grasp is not None:
            apart = math.dist(self.plan.grasp.p_BG, plan.grasp.p_BG)
            along = np.dot(self.plan.grasp.closing_W, plan.grasp.closing_W)
            if apart > _SAME_HOLD or along < _SAME_WAY:
                return False
        # What is tried harder by this factor is tried anew.
        return _effort(plan) < 1.1 * _effort(self.plan)


def _effort(plan: Plan) -> float:
    """How hard a hand tries: its squeeze, or the force of the fingertip [N]."""
    if plan.grasp is not None:
        return plan.grasp.squeeze
    return max((step.force_limit for step in plan.steps if isinstance(step, FlipOver)), default=0.0)


Failed = FailedPush | FailedHold


class Robot(Protocol):
    """Arm and hand, as far as plans depend on them."""

    @property
    def limits(self) -> RobotLimits:
        """Figures of arm and hand."""

    @property
    def max_press(self) -> float:
        """Largest force with which one fingertip can press on a level face [N]."""

    def reach(self, push: Push, state: WorldState, effort: ReachEffort = "usual") -> ReachAnswer:
        """Answer whether the hand can make a push, all of its way free."""

    def estimate_reach(self, push: Push, state: WorldState) -> float:
        """Room to the joint limits at a glance [rad]; a push without any may still be possible."""

    def grasp(self, width: float, *, pinch: bool = False, depth: float = 0.0) -> Grip | None:
        """Grip of the hand about a width [m], or about a knob or a cap; None if there is none.

        It leaves free so much room between the middle of the grasp and the palm [m]; of 0 it is
        the best one, however much room that leaves.
        """

    def reach_plan(self, plan: Plan, state: WorldState) -> ReachAnswer:
        """Answer whether arm and hand can carry out a plan, all of its way free."""


class NoRobot:
    """A robot that gets nowhere: for questions about a sentence alone."""

    limits = RobotLimits(0.0, (0.0,), 0.0, 0.0, 0.0)
    max_press = 0.0

    def reach(self, push: Push, state: WorldState, effort: ReachEffort = "usual") -> ReachAnswer:
        """No."""
        return ReachAnswer(ok=False, reason="kinematics", code="no_robot")

    def estimate_reach(self, push: Push, state: WorldState) -> float:
        """No room [rad]."""
        return 0.0

    def grasp(self, width: float, *, pinch: bool = False, depth: float = 0.0) -> Grip | None:
        """No grip."""
        return None

    def reach_plan(self, plan: Plan, state: WorldState) -> ReachAnswer:
        """No."""
        return ReachAnswer(ok=False, reason="kinematics", code="no_robot")
