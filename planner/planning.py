"""From a frame to actions whose predicted outcome satisfies it, or to a refusal with numbers.

What takes a whole hand (lifting, pouring, opening) is planned in `planner.grasping`, if the robot
has one. What is to be placed is lifted if its file says how, or else pushed; where that does not
do, it is the other way round. What is to stand up is lifted and turned, or else tipped over an
edge. All else is pushed.

The frame becomes a problem (`planner.problem`). Pushes for it are planned by strategies
(`planner.pushing.strategies`): a fall or a tilt (`planner.pushing.topple_planner`), or an aim on
the table, to which the object goes by several pushes (`planner.pushing.push_sequence`). Inside the
planner a dead end raises `NoPlanError`; here it becomes a refusal.

Frames: W is the world, B the object.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from grammar.frames import command as g
from planner.problem.frame_interpretation import (
    grasp_problem,
    interpret_frame,
    require_loose,
    require_on_table,
    require_other_objects,
    require_resting,
)
from planner.problem.least_amounts import require_tellable
from planner.problem.places import region
from planner.problem.planning_problem import (
    GraspProblem,
    SearchBudget,
    is_handled,
    is_off_the_table,
)
from planner.problem.predicted_states import state_after
from planner.pushing.strategies import plan_pushes
from planner.refusals.no_plan import no_plan, with_account
from planner.true_reasons import REASON_WORK, true_refusal
from planner.types.defaults import DEFAULTS, Defaults
from planner.types.plan import Plan, PlanningResult, Reached
from planner.types.refusal import Alternatives, NoPlanError
from planner.types.robot import Failed, Robot
from planner.types.world_state import WorldState

Way = Callable[[], PlanningResult]


def plan(
    frame: g.Frame,
    state: WorldState,
    robot: Robot,
    *,
    defaults: Defaults = DEFAULTS,
    previous: Plan | None = None,
    failed: Sequence[Failed] = (),
    notify: Callable[[str], None] = lambda _: None,
    budget: SearchBudget | None = None,
) -> PlanningResult:
    """Plan what satisfies a frame: pushes, or what a whole hand does.

    Args:
        frame: what is asked, its objects resolved to names in `state`.
        state: what the robot believes; the object's heading counts whole turns after a plan before.
        robot: that is to do it.
        defaults: what a clause means when the sentence does not say more.
        previous: the plan whose first push was made last; its aim is kept.
        failed: pushes of this frame that went wrong, whose contacts are not tried again; and what
            the whole hand failed at, which is not tried a third time.
        notify: called with a sentence before a search that takes long.
        budget: of a search for something else; without one, a refusal names what is in the way.

    Returns:
        A plan; that nothing is left to be done; or the reason why there is no plan.
    """
    told, budget = budget is None, budget or SearchBudget(defaults.most_work)
    upright = isinstance(frame.goal, g.Upright)
    only_pushes = robot.limits.grasp_widths is None or previous is not None

    def by_hand() -> PlanningResult:
        problem = grasp_problem(frame, state, robot, defaults, failed)
        return _plan_with_hand(replace(problem, budget=budget))

    def by_pushes() -> PlanningResult:
        problem = interpret_frame(frame, state, defaults, robot, previous=previous, failed=failed)
        if state.held is not None:
            raise no_plan("hand_not_free", object=state.held.name)
        if not _is_placed(frame, state, defaults):
            require_loose(frame, problem.target)
        require_resting(problem.target)
        require_on_table(problem.target, state)
        made = plan_pushes(replace(problem, budget=budget), notify)
        if upright and isinstance(made, Plan):
            _require_standing_after(made, state)
        return made

    try:
        require_other_objects(frame)
        if previous is None and not failed:
            require_tellable(frame, state, defaults)
        if upright and state.held is None and _stands(frame, state):
            return Reached()
        if only_pushes or not is_handled(frame):
            return by_pushes()
        return _plan_handled(frame, state, defaults, by_hand, by_pushes)
    except NoPlanError as error:
        refusal = with_account(error.refusal, budget.answers.values(), budget.done)
    # In a search it does not matter which of the reasons is the one.
    if not told or frame.object is None:
        return refusal

    def plan_from(other: WorldState) -> PlanningResult:
        less = SearchBudget(int(REASON_WORK * defaults.most_work))
        return plan(
            frame, other, robot, defaults=defaults, previous=previous, failed=failed, budget=less
        )

    return true_refusal(refusal, frame, state, plan_from)


def _plan_handled(
    frame: g.Frame, state: WorldState, defaults: Defaults, by_hand: Way, by_pushes: Way
) -> PlanningResult:
    """Plan what a whole hand does, or pushes where these would do too."""
    upright = isinstance(frame.goal, g.Upright)
    if _is_placed(frame, state, defaults):
        return Reached() if is_off_the_table(frame) else by_pushes()
    two_ways = frame.goal.kind in ("place", "upright") and not is_off_the_table(frame)
    if state.held is not None or not two_ways:
        return by_hand()
    ways = (by_hand, by_pushes)
    if not upright and not _is_said_how_to_hold(frame, state):
        ways = (by_pushes, by_hand)
    dead_ends = Alternatives()
    for way in ways:
        with dead_ends:
            return way()
    raise dead_ends.first if upright or ways[-1] is by_hand else dead_ends.last


def _is_said_how_to_hold(frame: g.Frame, state: WorldState) -> bool:
    """Return True if the model of what is to be placed states a grasp, so that it is lifted."""
    assert frame.object is not None
    return state.objects[frame.object.id or ""].model.grasp is not None


def _stands(frame: g.Frame, state: WorldState) -> bool:
    assert frame.object is not None
    return state.objects[frame.object.id or ""].lies_on == "bottom"


def _require_standing_after(made: Plan, state: WorldState) -> None:
    """Make sure that a fall ends on the bottom of what falls.

    Raises:
        NoPlanError: it does not.
    """
    after = state_after(made, state)
    if after is None or after.objects[made.object].lies_on != "bottom":
        raise no_plan("falls_otherwise", object=made.object)


def _is_placed(frame: g.Frame, state: WorldState, defaults: Defaults) -> bool:
    """Return True if what is placed stands there already, or nearly: a push moves it least."""
    goal = frame.goal
    if not isinstance(goal, g.Place) or goal.fraction is not None or state.held is not None:
        return False
    assert frame.object is not None
    target = state.objects[frame.object.id or ""]
    place = region(goal, state, defaults, target)
    return place is not None and place.holds(target)


def _plan_with_hand(problem: GraspProblem) -> Plan | Reached:
    """Plan a grasp and the steps after it, or what a fingertip does to a lid."""
    # Pushes do without them.
    from planner.grasping import lid_planner, lift_planner, pour_planner

    match problem.frame.goal:
        case g.Lift() as goal:
            return lift_planner.lift(problem, goal)
        case g.SetDown():
            return lift_planner.set_down(problem)
        case g.Place():
            return lift_planner.place(problem)
        case g.Upright():
            return lift_planner.stand_up(problem)
        case g.Pour() as goal:
            return pour_planner.pour_out(problem, goal)
        case g.Open():
            return lid_planner.open_lid(problem)
        case g.Close():
            return lid_planner.close_lid(problem)
    raise AssertionError(f"{problem.frame.goal.kind} takes no hand")
