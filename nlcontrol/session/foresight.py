"""Plans over predicted states: each step from where those before it leave everything.

What would end halfway is told before anything moves, or the first step is made otherwise: something
is held so that it can be put down, too. It is looked through as far as what comes of each step is
predicted: of poses and of the hand, not of contents, lids, and what touching finds out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from grammar import paraphrase
from grammar.frames import command as g
from nlcontrol.session.executor import CancellableRobot
from planner import planning
from planner.clearing import is_beyond_hand, may_be_brought
from planner.problem.planning_problem import SearchBudget
from planner.problem.predicted_states import state_after
from planner.types.defaults import Defaults
from planner.types.plan import Plan, PlanningResult, Reached
from planner.types.refusal import Refusal
from planner.types.robot import ReachAnswer, Robot
from sim.supervision import StopToken

if TYPE_CHECKING:
    from nlcontrol.session.controller import Controller
    from planner.types.world_state import WorldState

    PlanStep = Callable[[g.Frame, WorldState], PlanningResult]
    ExploreStep = Callable[[g.Frame, WorldState], WorldState]


class PlanCache:
    """What planning answered so far; beliefs other than poses and the hand stay what they are."""

    def __init__(self) -> None:
        self._made: dict[tuple[object, ...], PlanningResult] = {}

    def plan(
        self,
        frame: g.Frame | tuple[g.Frame, ...],
        state: WorldState,
        make: Callable[[], PlanningResult],
    ) -> PlanningResult:
        """The answer for a frame from a state; made if it is not known.

        Of several frames it is the one for the first after which the others can be done.
        """
        poses = ((name, seen.pose, seen.lies_on) for name, seen in state.objects.items())
        key = (frame, state.held, *poses)
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]


class BudgetedPlanner:
    """Plans of several steps, which have their work together.

    Args:
        controller: its planner, and what clauses mean to it.
        robot: the robot that answers.
        work: units for all plans.
        each: units for one of them, at most.
        defaults: what clauses mean here, if not as to the controller.

    Attributes:
        left: units that are left.
    """

    def __init__(
        self,
        controller: Controller,
        robot: Robot,
        work: int,
        each: int,
        defaults: Defaults | None = None,
    ) -> None:
        self.left = work
        self._planner, self._robot, self._each = controller.planner, robot, each
        self._defaults = defaults or controller.defaults

    def __call__(
        self, frame: g.Frame, state: WorldState, robot: Robot | None = None
    ) -> PlanningResult:
        """The plan of a frame, with no more work than is left, or why there is none."""
        budget = SearchBudget(min(self.left, self._each))
        planner = self._planner or partial(planning.plan, budget=budget)
        made = planner(frame, state, robot or self._robot, defaults=self._defaults)
        self.left -= budget.done
        return made


class Foresight:
    """Looks ahead over frames that are done one after the other.

    Args:
        make: plans a frame from a state.
        cache: plans that were made from here.
    """

    def __init__(self, make: PlanStep, cache: PlanCache | None = None) -> None:
        self._make = make
        self._cache = cache

    def plan(self, frame: g.Frame, state: WorldState) -> PlanningResult:
        """The plan of a step; of a question or a touch nothing is planned."""
        if frame.query is not None or frame.action == "explore":
            return Reached()
        if self._cache is None:
            return self._make(frame, state)
        return self._cache.plan(frame, state, lambda: self._make(frame, state))

    def dead_end(
        self,
        frames: Sequence[g.Frame],
        state: WorldState | None,
        explored: ExploreStep | None = None,
    ) -> tuple[int, Refusal] | None:
        """The place of the first frame that has no plan, and why; None as far as all have one.

        Args:
            frames: what is done, their objects resolved.
            state: what is believed before; None where that is not foreseen.
            explored: the belief after a touch; if not given, nothing is foreseen from there on.
        """
        for place, frame in enumerate(frames):
            if state is None or (frame.action == "explore" and explored is None):
                return None
            if frame.action == "explore" and explored is not None:
                state = explored(frame, state)
                continue
            made = self.plan(frame, state)
            if isinstance(made, Refusal):
                return place, made
            state = state_after(made, state)
        return None


def plan_with_foresight(
    controller: Controller,
    made: Plan | Reached,
    state: WorldState,
    frames: Sequence[g.Frame],
    stop: StopToken,
    cache: PlanCache,
) -> PlanningResult:
    """The plan of the first step, or another one, after which the others can be done; or why not.

    Args:
        controller: the controller that plans.
        made: the plan of the first step.
        state: the belief from which it was made.
        frames: all steps, their objects resolved.
        stop: asked whether to go on.
        cache: takes the plans that are made.

    Raises:
        Stopped: that was asked for.
        ControlError: as of `Controller.plan`.
    """
    foresight = Foresight(partial(controller.plan, stop=stop), cache)
    refused = foresight.dead_end(frames[1:], state_after(made, state))
    if refused is None:
        return made
    if isinstance(made, Plan) and made.task == "lift":
        robot = CancellableRobot(controller.robot, stop, controller.time_limit)
        most = controller.defaults.most_work
        planner = BudgetedPlanner(controller, robot, most, most)
        lift = partial(lasting_lift, controller, state, frames, stop, planner)
        other = cache.plan(tuple(frames), state, lift)
        if isinstance(other, Plan):
            return other
    return _refusal_ahead(frames, *refused)


def _refusal_ahead(frames: Sequence[g.Frame], place: int, refusal: Refusal) -> Refusal:
    """The refusal of a later frame, by its place behind the first, as told before any is done."""
    before = paraphrase(frames[: place + 1])
    told = f"nothing is moved: after “{before}” {refusal.message}"
    return refusal.model_copy(update={"message": told})


def lasting_lift(
    controller: Controller,
    state: WorldState,
    frames: Sequence[g.Frame],
    stop: StopToken,
    planner: BudgetedPlanner,
) -> PlanningResult:
    """A plan of the first of some frames, with a grasp after which the others can be done."""
    return planner(frames[0], state, _ForesightedRobot(controller, frames, stop))


class _ForesightedRobot(CancellableRobot):
    """A robot that gets to a grasp only if it can do what comes after it."""

    def __init__(self, controller: Controller, frames: Sequence[g.Frame], stop: StopToken) -> None:
        super().__init__(controller.robot, stop, controller.time_limit)
        self._controller, self._frames = controller, frames

    def reach_plan(self, plan: Plan, state: WorldState) -> ReachAnswer:
        """Answer of the robot, and of planning what comes after."""
        answer = super().reach_plan(plan, state)
        if not answer.ok:
            return answer
        # What comes after one way to hold something may take 500 units: 0.3 s of a quiet core.
        planner = BudgetedPlanner(self._controller, self._robot, 500, 500)
        refused = Foresight(planner).dead_end(self._frames[1:], state_after(plan, state))
        work = answer.work + 500 - planner.left
        if refused is None:
            return replace(answer, work=work)
        words = {"text": _refusal_ahead(self._frames, *refused).message}
        return ReachAnswer(False, "approach", "told", work=work, words=words)


# Plans midway: to the aim of the plan before, or to another one that the sentence allows.
#
# A push that ends elsewhere than foreseen may leave an object where the hand does not get to it
# for the aim that was chosen. From there another aim is looked for, if the sentence does not
# measure it from where the object stood.


def onward_plan(
    planning: Callable[..., PlanningResult],
    frame: g.Frame,
    state: WorldState,
    previous: Plan | None,
) -> PlanningResult:
    """The plan of what is left of a frame, or why there is none to the aim that was chosen.

    Args:
        planning: plans the frame from the present state; the aim of a `previous` plan is kept.
        frame: the frame that was begun.
        state: what is believed now.
        previous: the plan whose first push was made last; None if its aim is not kept.
    """
    made = planning(previous=previous)
    if previous is None or not isinstance(made, Refusal):
        return made
    if not (is_beyond_hand(made) and may_be_brought(frame, state)):
        return made
    anew = planning()
    if isinstance(anew, Plan):
        notes = (f"another aim, since {made.message}", *anew.notes)
        return anew.model_copy(update={"notes": notes})
    return made if isinstance(anew, Refusal) else anew
