"""The planning problem: an object, the beliefs, and what the sentence says, as numbers.

A problem never changes. Whatever restricts or relaxes it makes another one with
`dataclasses.replace`, on the group of limits that changes.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Generic, Literal, TypeVar

import numpy as np

from grammar.frames import command as g
from objectmodels.geometry.side_faces import Face
from planner.refusals.blocked import SearchEndedError, dead_end
from planner.types.actions import Aim, FaceName, Limits, StopEvent
from planner.types.defaults import DEFAULTS, Defaults, kinds
from planner.types.plan import DefaultUsed, Plan
from planner.types.robot import Failed, ReachAnswer, Robot
from planner.types.world_state import SeenObject, WorldState

# The budget of one plan, counted in work instead of time: a loaded machine gives the same answer.
#
# A unit is about what a quiet core of today does in a quarter of a millisecond.
# `benchmarks.times search-work` compares the two.


class SearchBudget:
    """The work that all strategies of one plan may take together.

    Attributes:
        most: units that it may take.
        done: units that it has taken.
        untried: contacts or grasps that were left of one attempt when it was used up.
        answers: of the robot so far, by what was asked; nothing is asked twice.
    """

    def __init__(self, most: int = DEFAULTS.most_work) -> None:
        self.most = most
        self.done = self.untried = 0
        self.answers: dict[object, ReachAnswer] = {}

    def answer_to(self, asked: object, ask: Callable[[], ReachAnswer]) -> ReachAnswer:
        """The robot's answer to a question, which is asked once."""
        if asked not in self.answers:
            self.answers[asked] = answer = ask()
            self.spend(answer.work)
        return self.answers[asked]

    @property
    def is_used_up(self) -> bool:
        """True if no work is left."""
        return self.done >= self.most

    def spend(self, work: int) -> None:
        """Count work that was done."""
        self.done += work

    def require_rest(self, name: str, untried: int) -> None:
        """Make sure that there is work left for contacts or grasps of an object.

        Raises:
            SearchEndedError: it is used up.
        """
        if self.is_used_up:
            self.untried = untried
            raise self.end(name, 0)

    def end(self, name: str, strategies: int) -> SearchEndedError:
        """The end of a search that has used it up, with some other strategies untried.

        Its obstacles are those that stopped the hand most often so far.
        """
        numbers = {
            "work": float(self.done),
            "most_work": float(self.most),
            "untried": float(self.untried),
            "untried_strategies": float(strategies),
        }
        more = min(2.0 * self.most, kinds()["most_work"].most)
        stopped = Counter(each.blocker for each in self.answers.values() if each.blocker)
        obstacles = tuple(other for other, _ in stopped.most_common(2))
        used_up = dead_end("work_used_up", numbers, obstacles=obstacles, object=name, more=more)
        return SearchEndedError(used_up)


@dataclass(frozen=True)
class PushGoal:
    """The outcome that pushes are to have.

    Attributes:
        outcome: wanted class at the onset.
        heading: direction of motion or of the fall in W [rad]; None if any will do.
        distance: to be moved [m]; the most if the goal is to topple.
        aims: poses of which one should be reached, the nearest first; empty if it is to topple.
        rotates: whether it is to turn about the vertical.
        tilt: angle by which it is tilted and then let back [rad]; None if it is not to come back.
        until: event that ends the last push earlier; `meets` names what is to be touched then.
        near: objects that it is to stand close to, and how close [m].
        hangs_over: whether it is to hang over the table's edge.
    """

    outcome: Literal["slide", "topple"] = "slide"
    heading: float | None = None
    distance: float = math.inf
    aims: tuple[Aim, ...] = ()
    rotates: bool = False
    tilt: float | None = None
    until: StopEvent | None = None
    meets: str | None = None
    near: tuple[tuple[str, float], ...] = ()
    hangs_over: bool = False


HAND_GOALS = {
    "lift": "lifting",
    "set_down": "putting down",
    "place": "lifting",
    "upright": "standing up",
    "pour": "pouring from",
    "open": "opening",
    "close": "closing",
}
"""Goals that take a whole hand, and what it does then in words."""


@dataclass(frozen=True)
class GraspGoal:
    """The task of a whole hand.

    Attributes:
        doing: it in words, such as `lifting`.
    """

    doing: str


@dataclass(frozen=True)
class Side:
    """A side face as a place to push: the face in B and its inward normal's heading in W [rad]."""

    face: Face
    heading: float

    @property
    def inward(self) -> np.ndarray:
        """Inward unit normal of the face in B, shape (3,)."""
        return -np.array(self.face.normal)


@dataclass(frozen=True)
class PushStep:
    """The part of one push in a plan.

    Attributes:
        outcome: wanted class at the onset.
        heading: direction of motion or of the fall in W [rad]; None if any will do.
        distance: to be moved [m]; the most if it is to topple.
        tilt: angle by which it is tilted and then let back [rad]; None if it is not to come back.
        turn: small angle by which a straight push turns the object [rad], counter-clockwise.
        swing: angle by which a push off the middle of a side turns it [rad]; 0 for any other.
        lateral: where along its face that push touches, from the middle [m].
        until: event that ends the push earlier; `meets` names what is to be touched then.
        side: that is touched; None if any will do that fits the heading.
    """

    outcome: Literal["slide", "topple"]
    heading: float | None
    distance: float
    tilt: float | None = None
    turn: float = 0.0
    swing: float = 0.0
    lateral: float = 0.0
    until: StopEvent | None = None
    meets: str | None = None
    side: Side | None = None

    @classmethod
    def from_goal(cls, goal: PushGoal) -> PushStep:
        """The one push that is all of a goal."""
        return cls(
            goal.outcome,
            goal.heading,
            goal.distance,
            goal.tilt,
            until=goal.until,
            meets=goal.meets,
        )


@dataclass(frozen=True)
class ContactLimits:
    """Limits of the contact.

    Attributes:
        face: side face to be touched; None if any will do.
        low, high: contact heights allowed [m].
        region: words for the heights, if the sentence restricts them.
        fingers: how many fingertips may push.
        spans: words that restrict the contact.
    """

    face: FaceName | None = None
    low: float = 0.0
    high: float = math.inf
    region: str | None = None
    fingers: tuple[Literal[1, 2], ...] = (2, 1)
    spans: g.Spans = ()


@dataclass(frozen=True)
class ForceLimits:
    """Limits of a push's force, or of a squeeze.

    Attributes:
        reserve: of a push, share by which the force limit exceeds the force needed; of a squeeze,
            factor by which it exceeds the one that just holds.
        max: largest force, or squeeze [N].
        min: force that it must take to move the object [N].
        least_limit: lower bound of the force limit [N].
        spans: words that restrict the force.
    """

    reserve: float
    max: float = math.inf
    min: float = 0.0
    least_limit: float = 0.0
    spans: g.Spans = ()


@dataclass(frozen=True)
class MotionLimits:
    """Limits of the motion.

    Attributes:
        speed: largest speed of the fingertips, or of the hand that holds the object [m/s].
        lid_speed: of a fingertip that moves a lid [m/s].
        tilt: largest tilt [rad]; None if only its staying on the base matters.
        turn: largest turn from where the object stood at first [rad]; None for no limit.
        duration: longest time from the touch to the end of a push [s]; None for no limit.
        clear_of: other objects, and the distance that is kept from each of them [m].
        spans: words that restrict the duration.
        upright: words that forbid to tilt what is held; empty if none do.
        on_the_table: words that forbid to lift it; empty if none do.
    """

    speed: float
    lid_speed: float = math.inf
    tilt: float | None = None
    turn: float | None = None
    duration: float | None = None
    clear_of: tuple[tuple[str, float], ...] = ()
    spans: g.Spans = ()
    upright: g.Spans = ()
    on_the_table: g.Spans = ()

    @property
    def guards(self) -> Limits:
        """The limits that stop a push before it breaks a constraint."""
        return Limits(
            tilt=self.tilt, turn=self.turn, duration=self.duration, clear_of=self.clear_of
        )


@dataclass(frozen=True)
class Effort:
    """Effort of a search, and the certainty that it asks for.

    Attributes:
        contacts: of one push with as many fingertips for which the reach is asked.
        questions: to the robot, about all pushes of one attempt.
        probability: least probability of a plan.
        thorough: whether the robot looks longer for the pushes that can be made now.
        oblique: whether two fingertips may push farther from square to a face than they usually do.
        direct: whether ways around what stands there are left out.
    """

    contacts: int
    questions: int
    probability: float
    thorough: bool = False
    oblique: bool = False
    direct: bool = False

    @classmethod
    def from_defaults(cls, defaults: Defaults) -> Effort:
        """The usual effort."""
        return cls(defaults.most_contacts, defaults.most_looks, defaults.probability)


GoalT = TypeVar("GoalT", PushGoal, GraspGoal)


@dataclass(frozen=True)
class PlanningProblem(Generic[GoalT]):
    """One frame about one object, as the planner takes it.

    Attributes:
        frame: the frame, its objects resolved to names in `state`.
        target: the object, where it stands when the plan begins; its heading is not wrapped.
        state: what is believed then.
        robot: that is to do it.
        defaults: margins, and what a clause means when the sentence does not say more.
        goal: the outcome, or the task of the hand.
        contact, force, motion: limits that all of it keeps.
        effort: how much is tried.
        defaults_used: what the sentence left open.
        previous: the plan whose first push was made last; its aim is kept.
        failed: pushes and holds of this frame that went wrong.
        budget: of work, shared by all that is tried.
    """

    frame: g.Frame
    target: SeenObject
    state: WorldState
    robot: Robot
    defaults: Defaults
    goal: GoalT
    contact: ContactLimits
    force: ForceLimits
    motion: MotionLimits
    effort: Effort
    defaults_used: tuple[DefaultUsed, ...] = ()
    previous: Plan | None = None
    failed: tuple[Failed, ...] = field(default=())
    budget: SearchBudget = field(default_factory=SearchBudget)

    @property
    def others(self) -> Mapping[str, SeenObject]:
        """Everything else on the table, by name."""
        return {name: seen for name, seen in self.state.objects.items() if name != self.target.name}

    @property
    def spared(self) -> frozenset[str]:
        """Names of the objects by which the frame tells a place: they are never in the way."""
        return places_told_by(self.frame.goal)

    def clearance(self, other: SeenObject) -> float:
        """Distance that is usually kept from another object [m]."""
        return self.defaults.clearance_fragile if other.fragile else self.defaults.clearance

    def with_target(self, target: SeenObject) -> PlanningProblem[GoalT]:
        """The problem once the object stands elsewhere."""
        objects = {**self.state.objects, target.name: target}
        return replace(self, target=target, state=replace(self.state, objects=objects))

    def without_default(self, name: str) -> PlanningProblem[GoalT]:
        """The problem without the note that a value was left open."""
        kept = tuple(used for used in self.defaults_used if used.name != name)
        return replace(self, defaults_used=kept)


PushProblem = PlanningProblem[PushGoal]
GraspProblem = PlanningProblem[GraspGoal]


def places_told_by(goal: g.Goal) -> frozenset[str]:
    """Names of the objects that tell where something goes."""
    said = [getattr(goal, field, None) for field in ("toward", "away_from", "into", "reference")]
    refs = [ref for value in said for ref in (value if isinstance(value, tuple) else (value,))]
    return frozenset(ref.id for ref in refs if isinstance(ref, g.ObjectRef) and ref.id)


def is_handled(frame: g.Frame) -> bool:
    """Return True if a frame asks for a whole hand; what is placed may also be pushed there."""
    if is_off_the_table(frame):
        return frame.action in ("place", "lift", "move")
    return frame.goal.kind in HAND_GOALS and (frame.goal.kind != "place" or frame.action == "place")


def is_off_the_table(frame: g.Frame) -> bool:
    """Return True if a place takes an object up or down, which no push does."""
    goal = frame.goal
    return isinstance(goal, g.Place) and goal.relation in ("on", "off", "in", "out_of")


def value_in_bound(value: float, bound: str, tolerance: float) -> float:
    """The value to plan for: `at_least` and `at_most` are kept with the tolerance to spare."""
    spare = {"exact": 0.0, "exactly": 0.0, "at_least": 1.0, "at_most": -1.0}[bound]
    return value + spare * min(tolerance, 0.5 * value)
