"""Steps of a command behind its first, planned from where everything is predicted to be then.

What would end halfway is told before anything moves, or the first step is made otherwise: something
is held so that it can be put down, too. It is looked through as far as what comes of each step is
predicted: of poses and of the hand, not of contents, lids, and what touching finds out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Protocol

from grammar import paraphrase
from nlcontrol.session.stoppable_robot import StoppableRobot
from planner import planning
from planner.problem.planning_problem import SearchBudget
from planner.problem.predicted_states import state_after
from planner.types.plan import Plan, PlanningResult, Reached
from planner.types.refusal import Refusal
from planner.types.robot import ReachAnswer

if TYPE_CHECKING:
    from grammar.frames import command as g
    from nlcontrol.session.executor import Planner
    from nlcontrol.session.foresight.kept_plans import KeptPlans
    from planner.types.defaults import Defaults
    from planner.types.robot import Robot
    from planner.types.world_state import WorldState
    from sim.supervision import StopToken

    PlanStep = Callable[[g.Frame, WorldState], PlanningResult]

MOST_EACH = 500
"""Work of planning what comes after one way to hold something."""


class StepPlanner(Protocol):
    """Robot that plans single steps: a `nlcontrol.session.controller.Controller`."""

    planner: Planner | None
    defaults: Defaults
    time_limit: float | None

    @property
    def robot(self) -> Robot:
        """Arm and hand."""

    def plan(
        self, frame: g.Frame, state: WorldState | None = None, *, stop: StopToken | None = None
    ) -> PlanningResult:
        """A plan of one frame, or why there is none."""


def plan_with_foresight(
    controller: StepPlanner,
    made: Plan | Reached,
    state: WorldState,
    frames: Sequence[g.Frame],
    stop: StopToken,
    kept: KeptPlans,
) -> PlanningResult:
    """The plan of the first step, or another one, after which the others can be done; or why not.

    Args:
        controller: that plans.
        made: the plan of the first step.
        state: from where that was made.
        frames: all steps, their objects resolved.
        stop: asked whether to go on.
        kept: takes the plans that are made.

    Raises:
        Stopped: that was asked for.
        ControlError: as of `Controller.plan`.
    """

    def plan_step(frame: g.Frame, then: WorldState) -> PlanningResult:
        return kept.plan(frame, then, lambda: controller.plan(frame, then, stop=stop))

    refused = _refused_ahead(plan_step, made, state, frames)
    if refused is not None and isinstance(made, Plan) and made.task == "lift":
        budget = SearchBudget(controller.defaults.most_work)
        lift = partial(lasting_lift, controller, state, frames, stop, budget)
        other = kept.plan(tuple(frames), state, lift)
        if isinstance(other, Plan):
            return other
    return made if refused is None else refused


def lasting_lift(
    controller: StepPlanner,
    state: WorldState,
    frames: Sequence[g.Frame],
    stop: StopToken,
    budget: SearchBudget,
) -> PlanningResult:
    """A plan of the first of some frames, with a grasp after which the others can be done."""
    robot = _ForesightedRobot(controller, frames, stop)
    planner = controller.planner or partial(planning.plan, budget=budget)
    return planner(frames[0], state, robot, defaults=controller.defaults)


def _refused_ahead(
    plan_step: PlanStep, made: Plan | Reached, state: WorldState, frames: Sequence[g.Frame]
) -> Refusal | None:
    """The refusal of the first step that will have no plan; None as far as all have one."""
    for number, frame in enumerate(frames[1:], start=1):
        after = state_after(made, state)
        if after is None or frame.action == "explore":
            return None
        state, made = after, Reached()
        if frame.query is not None:
            continue
        answer = plan_step(frame, state)
        if isinstance(answer, Refusal):
            before = paraphrase(frames[:number])
            told = f"nothing is moved: after “{before}” {answer.message}"
            return answer.model_copy(update={"message": told})
        made = answer
    return None


class _ForesightedRobot(StoppableRobot):
    """A robot that gets to a grasp only if it can do what comes after it."""

    def __init__(self, controller: StepPlanner, frames: Sequence[g.Frame], stop: StopToken) -> None:
        super().__init__(controller.robot, stop, controller.time_limit)
        self._controller, self._frames = controller, frames

    def reach_plan(self, plan: Plan, state: WorldState) -> ReachAnswer:
        """Answer of the robot, and of planning what comes after."""
        answer = super().reach_plan(plan, state)
        if not answer.ok:
            return answer
        budget, defaults = SearchBudget(MOST_EACH), self._controller.defaults
        planner = self._controller.planner or partial(planning.plan, budget=budget)

        def plan_step(frame: g.Frame, then: WorldState) -> PlanningResult:
            return planner(frame, then, self._robot, defaults=defaults)

        refused = _refused_ahead(plan_step, plan, state, self._frames)
        if refused is None:
            return replace(answer, work=answer.work + budget.done)
        return ReachAnswer(False, "approach", refused.message, work=answer.work + budget.done)
