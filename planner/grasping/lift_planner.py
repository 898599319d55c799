"""Lifting, putting down, and carrying to a place.

Model: what is held keeps its heading and stays upright. It is carried straight, at a height that
clears everything on the way, and let down where the words want it.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from grammar.frames import command as g
from objectmodels.geometry.base_shapes import Array, Polygon, hull_polygon
from objectmodels.geometry.rotations import axis_and_angle, axis_rotation
from objectmodels.mechanics.standing_balance import stack_margins, standing_probability
from objectmodels.models.object_model import Resting
from planner.grasping.grasp_candidates import Candidate, body_candidates
from planner.grasping.grasp_plans import (
    MotionDraft,
    Way,
    each_with_each,
    first_plan_of_groups,
    first_reachable_plan,
)
from planner.grasping.grasp_selection import GraspLoad, StableGrasp, held_already, stable_grasps
from planner.problem.directions import heading_of
from planner.problem.footprints import footprint, gap, room_to_edge
from planner.problem.goal_poses import find_goal_poses, pose_as_aim
from planner.problem.places import WALL_ROOM, InBox, object_at, region
from planner.problem.planning_problem import GraspProblem, value_in_bound
from planner.problem.predicted_states import standing_object
from planner.problem.stacks import level_top, put_on, stack_with, stacked_bodies
from planner.refusals.blocked import Blocked, Spans, all_made, dead_end
from planner.types.actions import (
    Action,
    Aim,
    Carry,
    LiftUp,
    SetDown,
    SetOn,
    StandPrediction,
    TurnOver,
)
from planner.types.plan import DefaultUsed, Plan, Reached
from planner.types.world_state import SeenObject

# Whether something stands where it is to be put on another object, or into it.
#
# Model: `objectmodels.mechanics.standing_balance`, with the place of what is put down known as
# well as hands put things down. Frame: W.


def why_not_upon(lower: SeenObject) -> Blocked | None:
    """The top of an object is not level, or it has a lid, so that nothing may stand on it."""
    if level_top(lower) is not None:
        return None
    is_open = lower.attitude is None and lower.model.inside is not None
    return dead_end("no_level_top.open" if is_open else "no_level_top", other=lower.name)


def why_not_inside(problem: GraspProblem, box: SeenObject) -> Blocked | None:
    """An object finds no place in another one, that is no open box, or too small, or full."""
    goal, own = problem.frame.goal, problem.target
    assert isinstance(goal, g.Place), "it is put there"
    place = region(goal, problem.state, problem.defaults, own)
    if not isinstance(place, InBox) or box.attitude is not None:
        return dead_end("not_open", object=own.name, other=box.name)
    if (excess := place.excess(own)) > 0.0:
        numbers = {"excess": excess, "room": WALL_ROOM}
        return dead_end("too_long_for_box", numbers, object=own.name, other=box.name)
    if not place.spots(own):
        inside = [seen.name for seen in place.contents if seen.name != own.name]
        return dead_end("box_is_full", object=own.name, box=box.name, other=inside[0])
    return None


def step_onto(problem: GraspProblem, there: SeenObject) -> SetOn | Blocked:
    """The step that puts an object on another one, with what is predicted of it.

    Args:
        problem: whose object it is.
        there: the object, where it is to stand.
    """
    assert there.on is not None, "it is put on something"
    lower = problem.state.objects[there.on]
    name = there.name
    if not _covers_opening(there, lower):
        return dead_end("falls_in", object=name, other=lower.name)
    # Standard deviation of where a hand puts something, along each axis [m].
    bodies = stacked_bodies(stack_with(there, problem.state.objects), name, 0.003)
    margin, stands = float(stack_margins(bodies).min()), standing_probability(bodies)
    if margin < 0.0:
        return dead_end(
            "overhangs", {"margin": margin, "beyond": -margin}, object=name, other=lower.name
        )
    asked = problem.effort.probability
    if stands < asked:
        numbers = {"margin": margin, "probability": stands, "asked_probability": asked}
        return dead_end("may_fall_off", numbers, object=name, other=lower.name)
    prediction = StandPrediction(margin=margin, stands=stands)
    inside = lower.model.inside is not None
    return SetOn(onto=lower.name, height=there.pose.z, inside=inside, prediction=prediction)


def _covers_opening(there: SeenObject, lower: SeenObject) -> bool:
    """Return True if the base of an object covers the opening of the one below, if that has one."""
    container = lower.model.container
    if container is None:
        return True
    x, y = container.opening.centre
    middle = lower.pose.p_WB + lower.pose.R_WB @ [x, y, 0.0]
    at = (middle - there.pose.p_WB) @ there.pose.R_WB
    base = Polygon.convex(there.model.base.corners)
    return bool((base.normals @ at[:2] + container.opening.radius < base.offsets).all())


TO_THE_SIDE = math.cos(math.radians(50.0))
"""Least cosine between a lean along the line across and the side of the opening."""

_SPOTS = 6  # on top of an object that are looked at
_BESIDE = 1e-6  # what ends no more than so much higher than another begins is below it [m]


def lift(problem: GraspProblem, goal: g.Lift) -> Plan | Reached | Blocked:
    """Straight up, from the table or from where it is held; down if it is held too high."""
    if why := why_not_liftable(problem):
        return why
    height, used = _lift_height(problem, goal)
    if abs(height) < problem.defaults.aim_position:
        return Reached()
    draft = MotionDraft((LiftUp(height=height),), defaults=used)

    def lift_plan(grasps: list[StableGrasp]) -> Plan | Blocked:
        ways = sorted(grasps, key=partial(_pours_beside, problem))
        return first_reachable_plan(problem, "lift", each_with_each(ways, [draft]))

    return _plan_with_grasps(problem, lift_plan)


def set_down(problem: GraspProblem) -> Plan | Reached | Blocked:
    """Down where it is held; what stands on another object is put on the table beside that."""
    lower = problem.target.on
    if problem.state.held is None and lower is not None:
        off = g.Place(relation="off", reference=(g.ObjectRef(text=lower, id=lower),))
        frame = problem.frame.model_copy(update={"goal": off})
        return place(replace(problem, frame=frame))
    if problem.state.held is None:
        return Reached()  # it stands on the table
    if why := why_no_room(problem, problem.target, {}):
        return why
    draft = MotionDraft((SetDown(),), aim=pose_as_aim(problem.target))
    return first_reachable_plan(problem, "place", each_with_each(held_already(problem), [draft]))


def place(problem: GraspProblem) -> Plan | Blocked:
    """To a place: up, over and down."""
    if why := why_not_liftable(problem):
        return why
    lower, goal = _object_below(problem), problem.frame.goal
    if lower is not None:
        inside = isinstance(goal, g.Place) and goal.relation == "in"
        if why := why_not_inside(problem, lower) if inside else why_not_upon(lower):
            return why
    found = find_goal_poses(problem)
    if isinstance(found, Blocked):
        return found
    near, used = dict(found.goal.near), found.defaults_used
    drafts = all_made(_draft_to(problem, aim, lower, near, used) for aim in found.goal.aims)
    if isinstance(drafts, Blocked):
        return drafts
    drafts = sorted(drafts, key=lambda draft: -round(draft.probability, 3))[:_SPOTS]
    return _plan_with_grasps(
        problem,
        lambda grasps: first_reachable_plan(problem, "place", each_with_each(grasps, drafts)),
    )


def _draft_to(
    problem: GraspProblem,
    aim: Aim,
    lower: SeenObject | None,
    near: dict[str, float],
    used: tuple[DefaultUsed, ...],
) -> MotionDraft | Blocked:
    """The steps to an aim, on the table or on an object below."""
    there = put_on(object_at(problem.target, np.array([aim.x, aim.y])), lower)
    if why := why_no_room(problem, there, near):
        return why
    last = SetDown() if lower is None else step_onto(problem, there)
    if isinstance(last, Blocked):
        return last
    steps = (*lift_steps(problem, clearance_height(problem, aim)), Carry(to=aim), last)
    stands = last.prediction.stands if isinstance(last, SetOn) else 1.0
    return MotionDraft(steps, stands, aim=aim, defaults=used)


def _pours_beside(problem: GraspProblem, hold: StableGrasp) -> bool:
    """Return True if an object, held so, would not lean to the side of its opening."""
    container = problem.target.model.container
    if container is None:
        return False
    opening = np.array([*container.opening.centre, 0.0])
    closing = np.array(hold.grasp.closing_W) @ problem.target.pose.R_WB
    return bool(abs(closing @ opening) < TO_THE_SIDE * np.linalg.norm(opening))


def _plan_with_grasps(
    problem: GraspProblem, plan_with: Callable[[list[StableGrasp]], Plan | Blocked]
) -> Plan | Blocked:
    """The plan with the grasp that holds an object, or with one of those that would."""
    if held := held_already(problem):
        return plan_with(held)

    def with_group(group: list[Candidate]) -> Plan | Blocked:
        found = stable_grasps(problem, [GraspLoad(each) for each in group])
        return found if isinstance(found, Blocked) else plan_with(found)

    return first_plan_of_groups(body_candidates(problem), with_group)


def why_not_liftable(problem: GraspProblem) -> Blocked | None:
    """A holder or the sentence keeps the object on the table."""
    if problem.target.fixed:
        return dead_end("is_fixed", doing=problem.goal.doing, object=problem.target.name)
    if problem.motion.on_the_table:
        return _forbidden(problem, problem.motion.on_the_table, "takes it off the table")
    return None


def why_not_tiltable(problem: GraspProblem) -> Blocked | None:
    """A holder or the sentence keeps the object on the table, or upright."""
    why = why_not_liftable(problem)
    if why is None and problem.motion.upright:
        return _forbidden(problem, problem.motion.upright, "tilts it")
    return why


def _forbidden(problem: GraspProblem, spans: Spans, what: str) -> Blocked:
    """Dead end since the sentence asks for something and forbids what that takes."""
    doing, name = problem.goal.doing, problem.target.name
    return dead_end("forbidden_meanwhile", spans=spans, doing=doing, object=name, forbidden=what)


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


def why_no_room(problem: GraspProblem, there: SeenObject, near: dict[str, float]) -> Blocked | None:
    """An object, or a lid, cannot stand `there`, `near` others as close as said [m]."""
    own, kept = footprint(there), dict(problem.motion.clear_of)
    for name, seen in problem.others.items():
        if name == there.on or there.pose.z > seen.top_height - _BESIDE:
            continue  # it stands on that one or in it, or higher
        # Share of a wanted gap that must be left where something is put.
        apart = min(problem.clearance(seen), 0.5 * near.get(name, np.inf))
        if gap(own, footprint(seen)) < max(apart, kept.get(name, 0.0)):
            return dead_end("place_taken", what=f"the {problem.target.name}", other=name)
    if room_to_edge(own, problem.state.table, problem.defaults.clearance) < 0.0:
        return dead_end("table_ends", what=f"the {problem.target.name}")
    return None


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


# Standing up what has fallen: held, lifted, turned until its own bottom is below, and set down.
#
# Model: it turns evenly about the middle of the grasp, with hand and all. How it is turned about
# the vertical in the end is free: the hand had better point then where it pointed before, so that
# its wrist rolls and the arm stays where it is. A hand from above, which pointed nowhere, ends
# level, and may point away from W's origin or to the sides.

_UP = np.array([0.0, 0.0, 1.0])
_ASIDE = np.radians([0.0, 40.0, -40.0, 80.0, -80.0])  # of a hand in the end, off "away"
_SAMPLES = 32  # orientations on the way that are looked at


def stand_up(problem: GraspProblem) -> Plan | Reached | Blocked:
    """Lifts what lies and sets it down on its own bottom; what is held upright is set down."""
    rest = problem.target.rest
    if held_already(problem):
        if rest is None:
            return set_down(problem)
        return dead_end("hand_not_free", object=problem.target.name)
    if rest is None:
        return Reached()
    if why := why_not_tiltable(problem):
        return why
    groups = body_candidates(problem)
    if isinstance(groups, Blocked):
        return groups

    def with_loads(loads: list[GraspLoad]) -> Plan | Blocked:
        found = stable_grasps(problem, loads)
        if isinstance(found, Blocked):
            return found
        turns = all_made(_turning_way(problem, rest, hold) for hold in found)
        return first_reachable_plan(problem, "stand", turns)

    loads = (
        [load for each in group for load in _turned(each, rest, problem.target)] for group in groups
    )
    some = [group for group in loads if group]
    if not some:
        return dead_end("hand_from_below", object=problem.target.name)
    return first_plan_of_groups(some, with_loads)


def _turned(held: Candidate, rest: Resting, target: SeenObject) -> Iterator[GraspLoad]:
    """Ways to turn an object in a hold until its bottom is below, this or that way round.

    None if the fingers would then point up.
    """
    level = _lean_onto(rest.foot)
    last = level @ held.approach
    if last[2] > 0.2:  # of straight fingers in the end, how much they go up at most
        return
    away = heading_of(target.pose.p_WB) - target.pose.yaw
    kept = [heading_of(held.approach)] if np.any(held.approach[:2]) else []
    for heading in (*kept, *(away + _ASIDE)):
        axis, angle = axis_and_angle(axis_rotation(_UP, heading - heading_of(last)) @ level)
        yield GraspLoad(held, turned=angle * axis)
        # Turns by more than this are tried the other way round, too.
        if angle > math.radians(150.0):
            yield GraspLoad(held, turned=(angle - math.tau) * axis)


def _lean_onto(foot: Array) -> Array:
    """The shortest rotation by which a direction, shape (3,), comes to look down, shape (3, 3)."""
    axis = np.cross(foot, -_UP)
    if np.linalg.norm(axis) < 1e-9:
        return axis_rotation([1.0, 0.0, 0.0], 0.0 if foot[2] < 0.0 else math.pi)
    angle = math.acos(float(np.clip(-foot[2], -1.0, 1.0)))
    return axis_rotation(axis / np.linalg.norm(axis), angle)


def _turning_way(problem: GraspProblem, rest: Resting, hold: StableGrasp) -> Way | Blocked:
    """A hold, and the steps after the grasp."""
    assert hold.turned is not None, "it is turned"
    target, middle = problem.target, np.array(hold.grasp.p_BG)
    R_WN, angle = target.pose.R_WB, float(np.linalg.norm(hold.turned))
    axis = R_WN @ hold.turned / angle
    R_WE = axis_rotation(axis, angle) @ R_WN
    R_WB, p_WB = rest.body_pose(R_WE, target.pose.p_WB + R_WN @ middle - R_WE @ middle)
    aim = Aim(x=float(p_WB[0]), y=float(p_WB[1]), yaw=heading_of(R_WB[:, 0]))
    if why := why_no_room(problem, standing_object(target, aim), {}):
        return why
    here = Aim(x=target.pose.x, y=target.pose.y)
    # Lifted so, it clears the table while it turns.
    ways = axis_rotation(hold.turned / angle, np.linspace(0.0, angle, _SAMPLES))
    outline, top = target.model.outline, target.model.top
    corners = np.array([(x, y, z) for z in (0.0, top) for x, y in outline])
    lowest = float(((corners - middle) @ ways[:, 2].T).min())
    up = clearance_height(problem, here) + max(0.0, -lowest - float(middle[2]))
    x, y, z = axis.tolist()
    steps: tuple[Action, ...] = (
        *lift_steps(problem, up),
        TurnOver(axis_W=(x, y, z), angle=angle),
        SetDown(),
    )
    return hold, MotionDraft(steps, aim=aim)
