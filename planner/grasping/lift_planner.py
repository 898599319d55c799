"""Lifting, putting down, and carrying to a place.

Model: what is held keeps its heading and stays upright. It is carried straight, at a height that
clears everything on the way, and let down where the words want it.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from grammar.frames import command as g
from objectmodels.geometry.base_shapes import hull_polygon
from planner.geometry.footprints import footprint, gap, room_to_edge
from planner.geometry.stacks import put_on
from planner.grasping.grasp_plans import (
    MotionDraft,
    each_with_each,
    first_plan_of_groups,
    first_reachable_plan,
)
from planner.grasping.grasp_sampling import Candidate, body_candidates
from planner.grasping.grasp_selection import GraspLoad, StableGrasp, held_already, stable_grasps
from planner.grasping.standing_place import require_level_top, require_room_inside, step_onto
from planner.problem.goal_poses import GoalPoses, find_goal_poses, pose_as_aim
from planner.problem.place_regions import object_at
from planner.problem.planning_problem import GraspProblem, value_in_bound
from planner.refusals.refusal_builder import Spans, no_plan
from planner.types.actions import Action, Aim, Carry, LiftUp, SetDown
from planner.types.plan import DefaultUsed, Plan, Reached
from planner.types.refusal import Alternatives, NoPlanError
from planner.types.stack_actions import SetOn
from planner.types.world_state import SeenObject

TO_THE_SIDE = math.cos(math.radians(50.0))
"""Least cosine between a lean along the line across and the side of the opening."""

_CLOSER = 0.5  # share of a wanted gap that must be left where something is put
_SPOTS = 6  # on top of an object that are looked at
_BESIDE = 1e-6  # what ends no more than so much higher than another begins is below it [m]


def lift(problem: GraspProblem, goal: g.Lift) -> Plan | Reached:
    """Straight up, from the table or from where it is held; down if it is held too high.

    Raises:
        NoPlanError: it cannot be held, or not be lifted so far.
    """
    require_liftable(problem)
    height, used = _lift_height(problem, goal)
    if abs(height) < problem.defaults.aim_position:
        return Reached()
    draft = MotionDraft((LiftUp(height=height),), defaults=used)

    def lift_plan(grasps: list[StableGrasp]) -> Plan:
        ways = sorted(grasps, key=partial(_pours_beside, problem))
        return first_reachable_plan(problem, "lift", each_with_each(ways, [draft]))

    return _plan_with_grasps(problem, lift_plan)


def set_down(problem: GraspProblem) -> Plan | Reached:
    """Down where it is held; what stands on another object is put on the table beside that.

    Raises:
        NoPlanError: nothing can stand there.
    """
    lower = problem.target.on
    if problem.state.held is None and lower is not None:
        off = g.Place(relation="off", reference=(g.ObjectRef(text=lower, id=lower),))
        frame = problem.frame.model_copy(update={"goal": off})
        return place(replace(problem, frame=frame))
    if problem.state.held is None:
        return Reached()  # it stands on the table
    require_room(problem, problem.target, {})
    draft = MotionDraft((SetDown(),), aim=pose_as_aim(problem.target))
    return first_reachable_plan(problem, "place", each_with_each(held_already(problem), [draft]))


def place(problem: GraspProblem) -> Plan:
    """To a place: up, over and down.

    Raises:
        NoPlanError: it cannot be held, the place is not free, or the hand does not get there.
    """
    require_liftable(problem)
    lower = _object_below(problem)
    if lower is not None:
        _require_place_on(problem, lower)
    found = find_goal_poses(problem)
    drafts, places = [], Alternatives()
    for aim in found.goal.aims:
        with places:
            drafts.append(_draft_to(problem, aim, found, lower))
    if not drafts:
        raise places.first
    drafts = sorted(drafts, key=lambda draft: -round(draft.probability, 3))[:_SPOTS]
    return _plan_with_grasps(
        problem,
        lambda grasps: first_reachable_plan(problem, "place", each_with_each(grasps, drafts)),
    )


def _pours_beside(problem: GraspProblem, hold: StableGrasp) -> bool:
    """Return True if an object, held so, would not lean to the side of its opening."""
    container = problem.target.model.container
    if container is None:
        return False
    opening = np.array([*container.opening.centre, 0.0])
    closing = np.array(hold.grasp.closing_W) @ problem.target.pose.R_WB
    return bool(abs(closing @ opening) < TO_THE_SIDE * np.linalg.norm(opening))


def _plan_with_grasps(
    problem: GraspProblem, plan_with: Callable[[list[StableGrasp]], Plan]
) -> Plan:
    """The plan with the grasp that holds an object, or with one of those that would."""
    if held := held_already(problem):
        return plan_with(held)

    def with_group(group: list[Candidate]) -> Plan:
        return plan_with(stable_grasps(problem, [GraspLoad(each) for each in group]))

    return first_plan_of_groups(body_candidates(problem), with_group)


def require_liftable(problem: GraspProblem) -> None:
    """Make sure that the object may leave the table.

    Raises:
        NoPlanError: a holder or the sentence keeps it there.
    """
    if problem.target.fixed:
        raise no_plan("is_fixed", doing=problem.goal.doing, object=problem.target.name)
    if problem.motion.on_the_table:
        raise forbidden_meanwhile(problem, problem.motion.on_the_table, "takes it off the table")


def forbidden_meanwhile(problem: GraspProblem, spans: Spans, what: str) -> NoPlanError:
    """Dead end since the sentence asks for something and forbids what that takes."""
    doing, name = problem.goal.doing, problem.target.name
    return no_plan("forbidden_meanwhile", spans=spans, doing=doing, object=name, forbidden=what)


def clearance_height(problem: GraspProblem, to: Aim) -> float:
    """Height at which it passes over everything between where it is and an aim [m]."""
    there = object_at(problem.target, np.array([to.x, to.y]))
    way = hull_polygon(np.vstack([footprint(problem.target), footprint(there)])).vertices
    kept = dict(problem.motion.clear_of)
    tops = [
        seen.top_height
        for name, seen in problem.others.items()
        if gap(way, footprint(seen)) < max(problem.clearance(seen), kept.get(name, 0.0))
    ]
    return problem.defaults.carry_clearance + max(tops, default=0.0)


def lift_steps(problem: GraspProblem, height: float) -> tuple[Action, ...]:
    """The steps that bring it to a height, if it is not so high already."""
    now = base_height(problem)
    return (LiftUp(height=height - now, hold=0.0),) if height > now else ()


def base_height(problem: GraspProblem) -> float:
    """Height of its base over the table before anything is done [m]."""
    held = problem.state.held
    return problem.target.pose.z if held is None else held.height


def _object_below(problem: GraspProblem) -> SeenObject | None:
    """The object on which or into which it is to be put; None for a place on the table."""
    goal = problem.frame.goal
    if not isinstance(goal, g.Place) or goal.relation not in ("on", "in"):
        return None
    assert isinstance(goal.reference, tuple), "it is put on an object"
    return problem.state.objects[goal.reference[0].id or ""]


def _require_place_on(problem: GraspProblem, lower: SeenObject) -> None:
    goal = problem.frame.goal
    if isinstance(goal, g.Place) and goal.relation == "in":
        require_room_inside(problem, lower)
    else:
        require_level_top(lower)


def require_room(problem: GraspProblem, there: SeenObject, near: dict[str, float]) -> None:
    """Make sure that an object, or a lid, can stand `there`, `near` others as close as said [m].

    Raises:
        NoPlanError: something else stands there, or the table ends.
    """
    own, kept = footprint(there), dict(problem.motion.clear_of)
    for name, seen in problem.others.items():
        if name == there.on or there.pose.z > seen.top_height - _BESIDE:
            continue  # it stands on that one or in it, or higher
        apart = min(problem.clearance(seen), _CLOSER * near.get(name, np.inf))
        if gap(own, footprint(seen)) < max(apart, kept.get(name, 0.0)):
            raise no_plan("place_taken", what=f"the {problem.target.name}", other=name)
    if room_to_edge(own, problem.state.table, problem.defaults.clearance) < 0.0:
        raise no_plan("table_ends", what=f"the {problem.target.name}")


def _draft_to(
    problem: GraspProblem, aim: Aim, found: GoalPoses, lower: SeenObject | None
) -> MotionDraft:
    there = put_on(object_at(problem.target, np.array([aim.x, aim.y])), lower)
    require_room(problem, there, dict(found.goal.near))
    last = SetDown() if lower is None else step_onto(problem, there)
    steps = (*lift_steps(problem, clearance_height(problem, aim)), Carry(to=aim), last)
    stands = last.prediction.stands if isinstance(last, SetOn) else 1.0
    return MotionDraft(steps, stands, aim=aim, defaults=found.defaults_used)


def _lift_height(problem: GraspProblem, goal: g.Lift) -> tuple[float, tuple[DefaultUsed, ...]]:
    """Height by which it is lifted [m], and the note that it was not said."""
    d, height = problem.defaults, goal.height
    if height is None:
        value, reason = {
            "little": (d.lift_little, "“a little”"),
            "lot": (d.lift_lot, "“a lot”"),
            None: (d.lift_height, "no height said"),
        }[goal.amount]
        return value, (DefaultUsed(name="lift_height", value=value, unit="m", reason=reason),)
    assert isinstance(height, float), "lengths measured in objects are resolved by now"
    now = base_height(problem) if goal.above == "table" else 0.0
    return value_in_bound(height, goal.bound, d.distance_tolerance) - now, ()
