"""Strategies to plan pushes, tried in order: each with more effort, or less precision, than before.

First as usual. Where the hand did not get to what would do, it looks thoroughly. What has begun
goes on less surely. Last come plans of less precision: an oblique push, a place that only just
counts as the one that is asked, a fall askew or elsewhere. A new strategy is one class and one
entry in `STRATEGIES`.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from planner.problem.directions import unit
from planner.problem.goal_poses import pose_as_aim, wanted_aims
from planner.problem.planning_problem import PushProblem
from planner.pushing.contact_planner import PushCandidate
from planner.pushing.contact_sampling import why_not_so_fast
from planner.pushing.drag_planner import FORCES, drag_to
from planner.pushing.push_sequence import PushSequencePlanner, why_not_in_time
from planner.pushing.reach_search import ReachSearch
from planner.pushing.topple_planner import TopplePlanner
from planner.refusals.blocked import Blocked, SearchEndedError, dead_end, first_made
from planner.types.actions import Aim, Limits
from planner.types.plan import Plan, PlanTask, Reached

_TASKS: dict[str, PlanTask] = {"toppled": "topple", "tilted": "tilt"}  # by the last push's end
_SHORT = (0.0, 0.5, 1.0)  # of the room that the tolerance of the distance leaves
_ASIDE = (0.0, 0.5, -0.5, 1.0, -1.0)  # of that of the direction, to the left of the way
_LEAST = 3.0  # of tolerances; of shorter ways a bound ("at least") keeps less than one to spare
_IN_THE_WAY = ("impossible", "blocked")  # refusals that a place near by may avoid


@dataclass(frozen=True)
class FailedStrategy:
    """A strategy that found no plan.

    Attributes:
        why: it found none.
        denied: whether the hand did not get to something.
        decides: whether that stands in place of the reasons before.
    """

    why: Blocked
    denied: bool
    decides: bool


def deciding_reason(so_far: Sequence[FailedStrategy]) -> Blocked:
    """The reason of the last strategy that decides."""
    return [end.why for end in so_far if end.decides][-1]


def _was_denied(so_far: Sequence[FailedStrategy]) -> bool:
    """True if the hand did not get to something that is usually tried."""
    return so_far[0].denied


class PlanningStrategy(ABC):
    """One way to look for a plan of pushes.

    Attributes:
        is_precise: whether its plan does exactly what is asked.
    """

    is_precise = True

    @abstractmethod
    def applies(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> bool:
        """Return True if it may find a plan where those before did not."""

    def relax(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> PushProblem:
        """The problem that it solves in place of the one that is posed."""
        return problem

    def plan(self, problem: PushProblem, search: ReachSearch) -> Plan | Reached | Blocked:
        """The plan for the problem that it solves."""
        # What is left of the plan before is tried first.
        foreseen = () if problem.previous is None else problem.previous.pushes[1:]
        if not problem.goal.aims:
            return _joint_plan(problem, TopplePlanner(problem, search, foreseen).pushes())
        return first_made(
            _joint_plan(problem, PushSequencePlanner(problem, aim, search, foreseen).pushes(), aim)
            for aim in wanted_aims(problem)
        )

    def notes(self, problem: PushProblem, aim: Aim | None) -> tuple[str, ...]:
        """Sentences on what a plan of less precision does, beside why it was needed."""
        return ()

    def decides(self, why: Blocked) -> bool:
        """Return True if its reason stands in place of those before."""
        return self.is_precise


class NominalPlan(PlanningStrategy):
    """As usual."""

    def applies(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> bool:
        """Always."""
        return True


class ExhaustiveReach(PlanningStrategy):
    """More contacts, for which the robot looks longer."""

    def applies(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> bool:
        """Return True if the hand did not get to something."""
        return _was_denied(so_far)

    def relax(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> PushProblem:
        """The problem with more effort."""
        last = problem.defaults
        effort = replace(
            problem.effort,
            contacts=last.most_contacts_last,
            questions=last.most_looks_last,
            thorough=True,
        )
        return replace(problem, effort=effort)

    def decides(self, why: Blocked) -> bool:
        """Return False of a search that was given up: it says less than one that ended."""
        return why.reason != "out_of_time"


class RelaxedProbability(PlanningStrategy):
    """The probability that what is left of a plan must have."""

    def applies(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> bool:
        """Return True if a plan was begun, and its rest is not sure enough."""
        begun = problem.previous is not None
        return begun and deciding_reason(so_far).reason == "too_uncertain"

    def relax(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> PushProblem:
        """The problem with less probability, and with the effort of the strategy before."""
        if _was_denied(so_far):
            problem = ExhaustiveReach().relax(problem, so_far)
        defaults = problem.defaults
        probability = min(defaults.probability, defaults.probability_on)
        return replace(problem, effort=replace(problem.effort, probability=probability))


class ObliquePush(PlanningStrategy):
    """One push straight to an aim, oblique to the face, if two fingertips may make it."""

    is_precise = False

    def applies(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> bool:
        """Return True if the hand did not get to something, or has little time."""
        pressed = _was_denied(so_far) or problem.motion.duration is not None
        goal = problem.goal
        return pressed and bool(goal.aims) and not goal.rotates and 2 in problem.contact.fingers

    def relax(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> PushProblem:
        """The problem with two fingertips that may push obliquely."""
        effort = replace(problem.effort, oblique=True, thorough=True)
        return replace(problem, effort=effort, contact=replace(problem.contact, fingers=(2,)))


class DragFromAbove(PlanningStrategy):
    """A fingertip that presses on top of an object draws it straight to an aim."""

    is_precise = False

    def applies(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> bool:
        """Return True if no fingertip gets to its sides, and nothing is said that takes them."""
        goal, contact, why = problem.goal, problem.contact, deciding_reason(so_far)
        said = contact.face or contact.region or problem.motion.duration or problem.force.min
        moved = goal.aims and not goal.rotates and goal.until is None and 1 in contact.fingers
        no_side = why.reason == "out_of_reach" or why.code == "pushes_blocked"
        return bool(moved and no_side and not said)

    def relax(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> PushProblem:
        """The problem with the probability that a drag must have."""
        least = min(problem.effort.probability, problem.defaults.drag_probability)
        return replace(problem, effort=replace(problem.effort, probability=least))

    def plan(self, problem: PushProblem, search: ReachSearch) -> Plan | Reached | Blocked:
        """The drag to the first aim to which there is one."""
        return first_made(
            _joint_plan(problem, drag_to(problem, aim, search), aim) for aim in wanted_aims(problem)
        )

    def decides(self, why: Blocked) -> bool:
        """Return True if it is asked for, or says with what force it would have to press."""
        return self.is_precise or why.code in FORCES


class SaidDrag(DragFromAbove):
    """The same, since the sentence says so."""

    is_precise = True

    def applies(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> bool:
        """Return True if the top face is said, or if it is to hang over the table's edge."""
        return problem.contact.face == "top" or problem.goal.hangs_over


class RelaxedGoal(PlanningStrategy):
    """Straight to a pose at the edge of the tolerance."""

    is_precise = False

    def applies(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> bool:
        """Return True if something stands in the way of what is to be begun."""
        free_hand = not _was_denied(so_far) and problem.motion.duration is None
        obstructed = deciding_reason(so_far).reason in _IN_THE_WAY
        new = problem.previous is None and bool(problem.goal.aims)
        return new and free_hand and obstructed and any(True for _ in nearly_goal_poses(problem))

    def relax(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> PushProblem:
        """The problem with those poses, straight to which it goes."""
        goal = replace(problem.goal, aims=tuple(dict(nearly_goal_poses(problem))))
        return replace(problem, goal=goal, effort=replace(problem.effort, direct=True))

    def notes(self, problem: PushProblem, aim: Aim | None) -> tuple[str, ...]:
        """A sentence on where it ends."""
        return () if aim is None else (dict(nearly_goal_poses(problem))[aim],)


class OtherFall(PlanningStrategy):
    """The fall of what does not fall square to the side where it stands."""

    is_precise = False

    def applies(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> bool:
        """Return True if the object is to fall or to tilt."""
        return not problem.goal.aims

    def relax(self, problem: PushProblem, so_far: Sequence[FailedStrategy]) -> PushProblem:
        """The problem for which the robot looks longer."""
        return replace(problem, effort=replace(problem.effort, thorough=True))

    def plan(self, problem: PushProblem, search: ReachSearch) -> Plan | Reached | Blocked:
        """The plan of a fall askew, or of a push and a fall elsewhere."""
        return _joint_plan(problem, TopplePlanner(problem, search).other_pushes())


STRATEGIES: tuple[PlanningStrategy, ...] = (
    NominalPlan(),
    ExhaustiveReach(),
    RelaxedProbability(),
    ObliquePush(),
    DragFromAbove(),
    RelaxedGoal(),
    OtherFall(),
)
"""In the order in which they are tried."""


def plan_pushes(
    problem: PushProblem, notify: Callable[[str], None] = lambda _: None
) -> Plan | Reached | Blocked:
    """The plan of the first strategy that finds one.

    `notify` is called with a sentence before a search that takes long.

    Raises:
        SearchEndedError: the budget of the plan is used up.
    """
    so_far: list[FailedStrategy] = []
    budget, untried = problem.budget, 0
    if budget.is_used_up:
        raise budget.end(problem.target.name, len(STRATEGIES))
    for strategy in (SaidDrag(),) if SaidDrag().applies(problem, ()) else STRATEGIES:
        if not strategy.applies(problem, so_far):
            continue
        if budget.is_used_up:
            untried += 1
            continue
        relaxed = strategy.relax(problem, so_far)
        if relaxed.effort.thorough:
            notify("no plan as usual; looking thoroughly for what the hand can do")
        search = ReachSearch(relaxed)
        try:
            made = strategy.plan(relaxed, search)
        except SearchEndedError as ended:
            made = ended.blocked
        if isinstance(made, Blocked):
            so_far.append(FailedStrategy(made, search.was_denied, strategy.decides(made)))
            continue
        if strategy.is_precise or made.status == "reached":
            return made
        why = f"another way, since {deciding_reason(so_far).sentence}"
        notes = (why, *strategy.notes(relaxed, made.aim), *made.notes)
        return made.model_copy(update={"notes": notes})
    if untried or so_far[-1].why.code == "work_used_up":
        raise budget.end(problem.target.name, untried)
    return deciding_reason(so_far)


def _joint_plan(
    problem: PushProblem, found: list[PushCandidate] | Reached | Blocked, aim: Aim | None = None
) -> Plan | Reached | Blocked:
    """Pushes one after another as a plan; where there are none, what was found instead."""
    if not isinstance(found, list):
        return found
    target, motion = problem.target, problem.motion
    pushes = [each.push for each in found]
    if why := why_not_in_time(problem, len(found)) or why_not_so_fast(problem, pushes):
        return why
    # At least so likely, however the outcomes hang together; those of equal pushes are equal.
    doubts: dict[tuple[object, ...], float] = {}
    for each in found:
        doubt = 1.0 - each.push.prediction.probability
        doubts[each.event] = max(doubt, doubts.get(each.event, 0.0))
    probability = max(1.0 - sum(doubts.values()), 0.0)
    if probability < problem.effort.probability:
        numbers = {"probability": probability, "asked_probability": problem.effort.probability}
        return dead_end("unlikely_pushes", numbers, object=target.name, pushes=len(found))
    first, *later = pushes
    # What must be done in time is pushed faster than by default.
    if any(push.speed != motion.speed for push in pushes):
        problem = problem.without_default("speed")
    # Limits that all pushes of a plan keep.
    limits = [push.limits for push in pushes]
    common = set(limits[0]).intersection(*limits[1:])
    return Plan(
        object=target.name,
        task=_TASKS.get(pushes[-1].ends_on, "push"),
        actions=(first, *(push.model_copy(update={"displacement": None}) for push in later)),
        committed=1,
        limits=Limits(**dict(common)),
        aim=aim,
        probability=probability,
        defaults=problem.defaults_used,
        considered=sum(each.considered for each in found),
        satisfying=sum(each.satisfying for each in found),
        # Of several pushes each note has the number of its push.
        notes=tuple(
            note if len(found) == 1 else f"push {number}: {note}"
            for number, each in enumerate(found, start=1)
            for note in each.notes
        ),
    )


def nearly_goal_poses(problem: PushProblem) -> Iterator[tuple[Aim, str]]:
    """Poses that only just count as the goal of a displacement, each with a sentence about it.

    Model: a displacement holds if its length and its direction are within their tolerances. So an
    object may end a little short of its aim, or beside it; how exactly the robot brings it there is
    kept from the tolerance. The poses nearest to the aim come first; any other goal has none.
    """
    goal, target, defaults = problem.goal, problem.target, problem.defaults
    if goal.heading is None or goal.until is not None or goal.rotates:
        return
    if not _LEAST * defaults.distance_tolerance <= goal.distance < math.inf:
        return
    tolerance = defaults.tolerance_of(goal.distance, defaults.distance_tolerance)
    spare = max(tolerance - defaults.aim_position, 0.0)
    ahead, left = unit(goal.heading), unit(goal.heading + 0.5 * math.pi)
    shares = sorted(itertools.product(_SHORT, _ASIDE), key=lambda share: math.hypot(*share))
    for short, aside in ((spare * short, aside) for short, aside in shares[1:]):
        along = goal.distance - short
        slant = along * math.tan(defaults.direction_tolerance) - defaults.aim_position
        if slant <= 0.0:
            continue
        x, y, _ = (target.pose.p_WB + along * ahead + aside * slant * left).tolist()
        yield pose_as_aim(target, x, y), _place_note(short, aside * slant)


def _place_note(short: float, aside: float) -> str:
    ways = [f"{1e3 * short:.0f} mm too early"] if short else []
    if aside:
        ways.append(
            f"{1e3 * abs(aside):.0f} mm to the {'left' if aside > 0.0 else 'right'} of the way"
        )
    return f"it ends {' and '.join(ways)}, which the tolerances allow"
