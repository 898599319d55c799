"""From a frame to actions whose predicted outcome satisfies it, or to a refusal with numbers.

What takes a whole hand (lifting, pouring, opening) is planned in `planner.grasping`, if the robot
has one. What is to be placed is lifted if its file says how, or else pushed; where that does not
do, it is the other way round. What is to stand up is lifted and turned, or else tipped over an
edge. All else is pushed.

The frame becomes a problem (`planner.problem`). Pushes for it are planned by strategies
(`planner.pushing.strategies`): a fall or a tilt (`planner.pushing.topple_planner`), or an aim on
the table, to which the object goes by several pushes (`planner.pushing.push_sequence`). A stage
that goes no further returns `Blocked`; the one that counts becomes a refusal here.

Frames: W is the world, B the object.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from grammar.frames import command as g
from planner.problem.frame_interpretation import (
    grasp_problem,
    interpret_frame,
    why_no_place,
    why_not_loose,
    why_not_on_table,
    why_not_resting,
)
from planner.problem.least_amounts import why_not_tellable
from planner.problem.places import region
from planner.problem.planning_problem import (
    GraspProblem,
    PushProblem,
    SearchBudget,
    is_handled,
    is_off_the_table,
)
from planner.problem.predicted_states import state_after
from planner.pushing.strategies import plan_pushes
from planner.refusals.blocked import (
    Blocked,
    SearchEndedError,
    dead_end,
    first_made,
    with_account,
)
from planner.true_reasons import REASON_WORK, true_reason
from planner.types.defaults import DEFAULTS, Defaults
from planner.types.plan import Plan, PlanningResult, Reached
from planner.types.robot import Failed, Robot
from planner.types.world_state import WorldState

Made = Plan | Reached | Blocked
Way = Callable[[], Made]


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
    outcome = partial(
        _outcome, frame=frame, robot=robot, defaults=defaults, previous=previous, failed=failed
    )
    made = outcome(state, budget or SearchBudget(defaults.most_work), notify=notify)
    # In a search it does not matter which of the reasons is the one.
    if isinstance(made, Blocked) and budget is None and frame.object is not None:
        less = int(REASON_WORK * defaults.most_work)
        made = true_reason(made, frame, state, lambda other: outcome(other, SearchBudget(less)))
    return made.refusal if isinstance(made, Blocked) else made


def _outcome(
    state: WorldState,
    budget: SearchBudget,
    *,
    frame: g.Frame,
    robot: Robot,
    defaults: Defaults,
    previous: Plan | None,
    failed: Sequence[Failed],
    notify: Callable[[str], None] = lambda _: None,
) -> Made:
    """The plan, or what the search for it ends in, with an account of that."""
    upright = isinstance(frame.goal, g.Upright)
    only_pushes = robot.limits.grasp_widths is None or previous is not None

    def by_hand() -> Made:
        problem = grasp_problem(frame, state, robot, defaults, failed)
        if isinstance(problem, Blocked):
            return problem
        return _plan_with_hand(replace(problem, budget=budget))

    def by_pushes() -> Made:
        problem = interpret_frame(frame, state, defaults, robot, previous=previous, failed=failed)
        if isinstance(problem, Blocked):
            return problem
        if why := _why_not_pushed(problem):
            return why
        made = plan_pushes(replace(problem, budget=budget), notify)
        if not (upright and isinstance(made, Plan)):
            return made
        if not _stands(made.object, state_after(made, state)):
            return dead_end("falls_otherwise", object=made.object)
        return made

    def search() -> Made:
        if why := why_no_place(frame):
            return why
        is_new = previous is None and not failed
        if is_new and (why := why_not_tellable(frame, state, defaults)):
            return why
        if upright and state.held is None and _stands(_name_of(frame), state):
            return Reached()
        if only_pushes or not is_handled(frame):
            return by_pushes()
        return _plan_handled(frame, state, defaults, by_hand, by_pushes)

    try:
        made = search()
    except SearchEndedError as ended:
        made = ended.blocked
    if isinstance(made, Blocked):
        return with_account(made, budget.answers.values(), budget.done)
    return made


def _why_not_pushed(problem: PushProblem) -> Blocked | None:
    """The hand is not free to push an object, or something keeps it where it is."""
    frame, target, state = problem.frame, problem.target, problem.state
    if state.held is not None:
        return dead_end("hand_not_free", object=state.held.name)
    stays = not _is_placed(frame, state, problem.defaults) and why_not_loose(frame, target)
    return stays or why_not_resting(target) or why_not_on_table(target, state)


def _plan_handled(
    frame: g.Frame, state: WorldState, defaults: Defaults, by_hand: Way, by_pushes: Way
) -> Made:
    """Plan what a whole hand does, or pushes where these would do too."""
    upright = isinstance(frame.goal, g.Upright)
    if _is_placed(frame, state, defaults):
        return Reached() if is_off_the_table(frame) else by_pushes()
    two_ways = frame.goal.kind in ("place", "upright") and not is_off_the_table(frame)
    if state.held is not None or not two_ways:
        return by_hand()
    # What states a grasp is lifted.
    if not upright and state.objects[_name_of(frame)].model.grasp is not None:
        lifted = by_hand()
        return by_pushes() if isinstance(lifted, Blocked) else lifted
    ways = (by_hand, by_pushes) if upright else (by_pushes, by_hand)
    return first_made(way() for way in ways)


def _stands(name: str, state: WorldState | None) -> bool:
    """Return True if an object stands on its bottom, as far as that is foreseen."""
    return state is not None and state.objects[name].lies_on == "bottom"


def _name_of(frame: g.Frame) -> str:
    """The name of the object of a frame."""
    assert frame.object is not None, "only pushes and holds of an object are planned"
    return frame.object.id or ""


def _is_placed(frame: g.Frame, state: WorldState, defaults: Defaults) -> bool:
    """Return True if what is placed stands there already, or nearly: a push moves it least."""
    goal = frame.goal
    if not isinstance(goal, g.Place) or goal.fraction is not None or state.held is not None:
        return False
    target = state.objects[_name_of(frame)]
    place = region(goal, state, defaults, target)
    return place is not None and place.holds(target)


def _plan_with_hand(problem: GraspProblem) -> Made:
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
