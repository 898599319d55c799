"""Plans of a whole hand: a grasp, the steps after it, and whether arm and hand get there.

Of several ways the first that hand and arm can make is taken; groups of grasps are looked at one
after the other, until there is one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import TypeVar

from planner.grasping.grasp_candidates import Candidate
from planner.grasping.grasp_selection import GraspLoad, StableGrasp
from planner.problem.planning_problem import GraspProblem
from planner.refusals.blocked import Blocked, dead_end, first_made, no_grasp_reached
from planner.types.actions import Action, Aim, GraspAction, GraspPrediction, Limits
from planner.types.plan import DefaultUsed, Plan, PlanTask
from planner.types.robot import FailedHold, ReachAnswer

_TRIES = 2  # of the same


@dataclass(frozen=True)
class MotionDraft:
    """Steps of a hand once it holds something.

    Attributes:
        steps: one after the other.
        probability: that it comes so if the hold holds.
        aim: where the object should stand at the end.
        defaults: values that the sentence left open.
        notes: how it was chosen.
    """

    steps: tuple[Action, ...]
    probability: float = 1.0
    aim: Aim | None = None
    defaults: tuple[DefaultUsed, ...] = ()
    notes: tuple[str, ...] = ()


Way = tuple[StableGrasp | None, MotionDraft]
HoldT = TypeVar("HoldT", Candidate, GraspLoad)


def each_with_each(
    ways: Sequence[StableGrasp] | Blocked, drafts: Sequence[MotionDraft]
) -> list[Way] | Blocked:
    """All grasps, if there are any, with all that may be done, the best with the best first."""
    if isinstance(ways, Blocked):
        return ways
    places = product(range(len(ways)), range(len(drafts)))
    return [(ways[i], drafts[j]) for i, j in sorted(places, key=sum)]


def first_plan_of_groups(
    groups: Iterable[list[HoldT]] | Blocked, plan_with: Callable[[list[HoldT]], Plan | Blocked]
) -> Plan | Blocked:
    """The plan with the first group of grasps, if there are any, for which there is one."""
    return groups if isinstance(groups, Blocked) else first_made(map(plan_with, groups))


def first_reachable_plan(
    problem: GraspProblem, action: PlanTask, ways: Sequence[Way] | Blocked
) -> Plan | Blocked:
    """The first plan that hand and arm can carry out, of ways, if there are any, the best first."""
    if isinstance(ways, Blocked):
        return ways
    answers: list[ReachAnswer] = []
    unlikely: Plan | None = None
    for number, (hold, draft) in enumerate(ways):
        made = _plan_with_grasp(problem, action, hold, draft)
        made = made.model_copy(update={"considered": len(ways), "satisfying": len(ways)})
        if made.probability < problem.effort.probability:
            unlikely = unlikely or made
            continue
        if len(answers) == problem.defaults.most_grasps:
            break
        problem.budget.require_rest(problem.target.name, len(ways) - number)
        ask = partial(problem.robot.reach_plan, made, problem.state)
        failed = _failed_twice(problem, made)
        answers.append(failed or problem.budget.answer_to((made.object, made.actions), ask))
        if answers[-1].ok:
            return made
    doing, name = problem.goal.doing, problem.target.name
    if not answers and unlikely is not None:
        asked = problem.effort.probability
        numbers = {"probability": unlikely.probability, "asked_probability": asked}
        return dead_end("unlikely_grasp", numbers, doing=doing, object=name)
    held = problem.state.held is not None
    return no_grasp_reached(doing, name, answers, problem.spared, held=held)


def _failed_twice(problem: GraspProblem, made: Plan) -> ReachAnswer | None:
    """The answer to what would be tried a third time; None to what would not."""
    failed = [each for each in problem.failed if isinstance(each, FailedHold)]
    same = [each for each in failed if each.repeats(made)]
    if len(same) < _TRIES:
        return None
    return ReachAnswer(False, "failed", "tried_before", words={"detail": same[-1].detail})


def _plan_with_grasp(
    problem: GraspProblem, action: PlanTask, hold: StableGrasp | None, draft: MotionDraft
) -> Plan:
    actions, sure = draft.steps, 1.0
    if hold is not None:
        sure, held = hold.probability, problem.state.held is not None
        hangs = {} if hold.hangs is None else {"lean": hold.hangs.angle, "lean_sd": hold.hangs.sd}
        sureness = {"held": held, "prediction": GraspPrediction(holds=sure, **hangs)}
        actions = (GraspAction.model_validate({**dict(hold.grasp), **sureness}), *actions)
    return Plan(
        object=problem.target.name,
        task=action,
        actions=actions,
        committed=len(actions),
        # Whatever hangs together, it is at least so likely.
        probability=max(draft.probability + sure - 1.0, 0.0),
        aim=draft.aim,
        speed=problem.motion.speed,
        limits=Limits(clear_of=problem.motion.clear_of),
        defaults=draft.defaults + problem.defaults_used,
        notes=draft.notes,
    )
