"""Poses of an object at the end: goals as aims on the table.

A goal of moving, placing or turning is an aim, a pose of the object in W, or several of which one
will do, the nearest first. Aims are fixed once, from where everything stands at first: later
pushes correct what earlier ones missed, they do not shift the aim.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from grammar.frames import command as g
from objectmodels.geometry.base_shapes import Array
from planner.problem.directions import (
    FACE_OF_PUSH,
    HEADINGS,
    angle_between,
    bisector,
    heading_of,
    unit,
)
from planner.problem.footprints import footprint, free_travel, gap, travel_to_edge
from planner.problem.places import Beside, Between, region, share_of_way, table_region
from planner.problem.planning_problem import GoalT, PlanningProblem, PushGoal, value_in_bound
from planner.refusals.blocked import Blocked, dead_end
from planner.types.actions import Aim
from planner.types.defaults import Defaults
from planner.types.plan import DefaultUsed
from planner.types.world_state import SeenObject, WorldState

# Headings of an object that turns to face something, or to lie along it.
#
# Model: an object looks where its broad side faces look, those as wide as its widest. So a long
# box looks in two directions, a square one in four, and lies along the lines of these faces; one
# that is round looks everywhere. An edge of the table on the robot's left or right runs away from
# the robot, the others across.
#
# Frame: W.

_BROAD = 0.98  # share of the widest face's width from which a face counts as as wide
_QUARTER = math.pi / 2.0
_ACROSS_EDGES = {
    "left_edge": (_QUARTER, -_QUARTER),
    "right_edge": (_QUARTER, -_QUARTER),
    "front_edge": (0.0, math.pi),
    "back_edge": (0.0, math.pi),
    "edge": (0.0, _QUARTER, math.pi, -_QUARTER),
}
"""Headings square to the edges of the table [rad]."""


def is_orientation(goal: g.Rotate) -> bool:
    """Return True if a goal says how an object should look at the end, not how far it turns."""
    return goal.facing is not None or goal.parallel_to is not None


def turns_to_orientation(goal: g.Rotate, own: SeenObject, state: WorldState) -> tuple[float, ...]:
    """Turns after which an object looks as asked, counter-clockwise, the smallest first [rad].

    There are none along what has no sides.
    """
    looks = _headings_of_sides(own)
    if not looks:
        return (0.0,)
    turns = [
        angle_between(asked, look) for asked in _asked_headings(goal, own, state) for look in looks
    ]
    return tuple(sorted(dict.fromkeys(round(turn, 9) for turn in turns), key=abs))


def _asked_headings(goal: g.Rotate, own: SeenObject, state: WorldState) -> tuple[float, ...]:
    """Headings in W of which a broad side should have one [rad]."""
    facing, along = goal.facing, goal.parallel_to
    if isinstance(facing, str):
        return (HEADINGS[facing],)
    if facing is not None:
        return (heading_of(state.objects[facing.id or ""].pose.p_WB - own.pose.p_WB),)
    if isinstance(along, g.ObjectRef):
        looks = _headings_of_sides(state.objects[along.id or ""])
        return tuple(look + turn for look in looks for turn in (0.0, math.pi))
    return _ACROSS_EDGES.get(along, ()) if along is not None else ()


def _headings_of_sides(seen: SeenObject) -> tuple[float, ...]:
    """Headings in which the broad side faces look [rad]; none of what is round."""
    faces = seen.model.faces()
    if seen.model.base.is_round or not faces:
        return ()
    widest = max(face.width for face in faces)
    broad = (face for face in faces if face.width >= _BROAD * widest)
    return tuple(heading_of(seen.pose.R_WB @ np.array(face.normal)) for face in broad)


_HALVINGS = 40  # of a way of metres: far below a micrometre
_BEYOND = 0.008  # travel beyond the place where something should be met [m]


_CAPABILITIES = {
    "on": "putting objects on others",
    "in": "putting objects into others",
    "out_of": "taking objects out of others",
    "off": "taking objects off others",
}
"""Relations to objects that no push over the table brings about, and what they take."""


@dataclass(frozen=True)
class GoalPoses:
    """A goal on the table.

    Attributes:
        goal: its poses, and what belongs to them.
        defaults_used: what the sentence left open.
    """

    goal: PushGoal
    defaults_used: tuple[DefaultUsed, ...] = ()


def find_goal_poses(problem: PlanningProblem[GoalT]) -> GoalPoses | Blocked:
    """The poses that a frame which moves, turns or taps its object aims at."""
    goal = problem.frame.goal
    until = next((c for c in problem.frame.constraints if isinstance(c, g.Until)), None)
    match goal:
        case g.Rotate():
            return _rotation_poses(problem, goal)
        case g.Place():
            return _place_poses(problem, goal)
        case g.Displace() if until is not None and until.event not in ("tips", "about_to_tip"):
            return _event_poses(problem, goal, until)
        case g.NoGoal():
            return _tap_poses(problem)
        case g.Displace():
            return _displacement_poses(problem, goal)
    raise AssertionError(f"{goal.kind} moves nothing")


def wanted_aims(problem: PlanningProblem[PushGoal]) -> tuple[Aim, ...]:
    """The aim of the plan before, which is kept; of a new plan those of its goal."""
    kept = None if problem.previous is None else problem.previous.aim
    return problem.goal.aims if kept is None else (kept,)


def pose_as_aim(target: SeenObject, x: float | None = None, y: float | None = None) -> Aim:
    """The pose that an object has as an aim, or the same elsewhere.

    The heading of what is round does not matter unless it is to be turned.
    """
    pose = target.pose
    yaw = None if target.model.base.is_round else pose.yaw
    return Aim(x=pose.x if x is None else x, y=pose.y if y is None else y, yaw=yaw)


def _displacement_poses(problem: PlanningProblem[GoalT], goal: g.Displace) -> GoalPoses | Blocked:
    defaults, constraints = problem.defaults, problem.frame.constraints
    if why := _why_no_heading(problem, goal):
        return why
    heading, used = _motion_heading(problem, goal)
    distance, reason = goal_distance(goal, problem.target, problem.state, defaults, constraints)
    if reason:
        used += (DefaultUsed(name="distance", value=distance, unit="m", reason=reason),)
    elif goal.distance is not None:
        distance = value_in_bound(distance, goal.bound, defaults.distance_tolerance)
    return _pose_along(problem.target, heading, distance, used)


def _pose_along(
    target: SeenObject, heading: float, distance: float, used: tuple[DefaultUsed, ...] = ()
) -> GoalPoses:
    x, y, _ = (target.pose.p_WB + distance * unit(heading)).tolist()
    aims = (pose_as_aim(target, x, y),)
    return GoalPoses(PushGoal(heading=heading, distance=distance, aims=aims), used)


def _why_no_heading(problem: PlanningProblem[GoalT], goal: g.Displace) -> Blocked | None:
    """An object cannot move towards itself."""
    name = problem.target.name
    for other, way in ((goal.toward, "towards"), (goal.away_from, "away from")):
        if isinstance(other, g.ObjectRef) and other.id == name:
            return dead_end("moves_itself", spans=other.spans, object=name, way=way)
    return None


def _motion_heading(
    problem: PlanningProblem[GoalT], goal: g.Displace
) -> tuple[float, tuple[DefaultUsed, ...]]:
    """Direction of a displacement in W [rad], and that it was not said."""
    heading = goal_heading(goal, problem.target, problem.state, problem.defaults)
    if heading is not None:
        return heading, ()
    way = "toward" if problem.frame.action == "pull" else "away"
    used = DefaultUsed(
        name="direction", value=HEADINGS[way], unit="rad", reason=f"no direction said: {way}"
    )
    return used.value, (used,)


def _tap_poses(problem: PlanningProblem[GoalT]) -> GoalPoses | Blocked:
    """A touch that ends as soon as the object gives way; on the side that is said, or the front."""
    faces = [c.face for c in problem.frame.constraints if isinstance(c, g.ContactRegion)]
    push = next((way for way, face in FACE_OF_PUSH.items() if face in faces), "away")
    return _until_it_moves(_pose_along(problem.target, HEADINGS[push], problem.defaults.tap))


def _until_it_moves(found: GoalPoses | Blocked) -> GoalPoses | Blocked:
    if isinstance(found, Blocked):
        return found
    return replace(found, goal=replace(found.goal, until="moves"))


def _event_poses(
    problem: PlanningProblem[GoalT], goal: g.Displace, until: g.Until
) -> GoalPoses | Blocked:
    """As far as it takes until an event."""
    if until.event == "moves":
        return _until_it_moves(_displacement_poses(problem, goal))
    target, state, defaults = problem.target, problem.state, problem.defaults
    other = None if until.object is None else state.objects.get(until.object.id or "")
    if goal.direction is None and goal.heading is None and other is not None:
        goal = goal.model_copy(update={"toward": until.object})
    if why := _why_no_heading(problem, goal):
        return why
    heading, used = _motion_heading(problem, goal)
    u, own = unit(heading), footprint(target)
    if until.event == "edge":
        room = travel_to_edge(own, state.table, u[:2], defaults.edge_gap)
        return _pose_along(target, heading, max(room, 0.0), used)
    if other is None:
        return dead_end("not_capable.event", spans=until.spans, event=until.event)
    way = free_travel(own, footprint(other), u[:2], 0.0)
    if until.event == "touching":
        if math.isinf(way):
            return dead_end("never_met", spans=until.spans, object=target.name, other=other.name)
        met = _pose_along(target, heading, way + _BEYOND, used)
        return replace(met, goal=replace(met.goal, until="touching", meets=other.name))
    # In line with it, or beside it: as far along the way as the other one stands.
    along = float((other.pose.p_WB - target.pose.p_WB) @ u)
    if until.event == "next_to" and math.isfinite(way):
        along = min(along, way - defaults.place_gap)
    if along <= 0.0:
        return dead_end("never_met", spans=until.spans, object=target.name, other=other.name)
    return _pose_along(target, heading, along, used)


def _place_poses(problem: PlanningProblem[GoalT], goal: g.Place) -> GoalPoses | Blocked:
    target, defaults = problem.target, problem.defaults
    place = region(goal, problem.state, defaults, target)
    by_pushes = isinstance(problem.goal, PushGoal)
    if place is None or (by_pushes and goal.relation in _CAPABILITIES):
        what = _CAPABILITIES.get(goal.relation, "going there")
        return dead_end("not_capable.place", spans=goal.spans, what=what)
    if goal.fraction is not None:
        place = share_of_way(place, goal.fraction, target, defaults)
    spots = place.spots(target)
    if not spots:
        return dead_end("no_room_at_goal", spans=goal.spans, object=target.name)
    used: tuple[DefaultUsed, ...] = ()
    if isinstance(place, Beside) and goal.distance is None and place.gap > 0.0:
        reason = "no distance said"
        used = (DefaultUsed(name="place_gap", value=place.gap, unit="m", reason=reason),)
    aims = tuple(pose_as_aim(target, float(x), float(y)) for x, y in spots)
    if goal.relation == "over":
        if goal.distance is None:
            value, reason = defaults.overhang, "no overhang said"
            used = (DefaultUsed(name="overhang", value=value, unit="m", reason=reason),)
        return GoalPoses(PushGoal(aims=aims, hangs_over=True), used)
    if isinstance(place, Between):
        both = tuple((seen.name, place.apart(target)) for seen in (place.one, place.other))
        return GoalPoses(PushGoal(aims=aims, near=both), used)
    if not isinstance(place, Beside):
        return GoalPoses(PushGoal(aims=aims), used)
    if goal.relation != "touching":
        return GoalPoses(PushGoal(aims=aims, near=((place.other.name, place.gap),)), used)
    beyond = tuple(_aim_beyond(aim, target, _BEYOND) for aim in aims)
    return GoalPoses(PushGoal(aims=beyond, until="touching", meets=place.other.name), used)


def _aim_beyond(aim: Aim, target: SeenObject, by: float) -> Aim:
    """An aim so much farther on the way to it [m]."""
    x, y = target.pose.x, target.pose.y
    length = math.dist((aim.x, aim.y), (x, y))
    share = 1.0 + by / max(length, by)
    return aim.model_copy(update={"x": x + share * (aim.x - x), "y": y + share * (aim.y - y)})


def _rotation_poses(problem: PlanningProblem[GoalT], goal: g.Rotate) -> GoalPoses | Blocked:
    angle, used, defaults = goal.angle, [], problem.defaults
    if is_orientation(goal):
        pose, turns = problem.target.pose, turns_to_orientation(goal, problem.target, problem.state)
        if not turns:
            along = goal.parallel_to
            spans, other = goal.spans, str(along)
            if isinstance(along, g.ObjectRef):
                spans, other = along.spans, along.id or ""
            return dead_end("no_sides", spans=spans, other=other)
        aims = tuple(Aim(x=pose.x, y=pose.y, yaw=pose.yaw + turn) for turn in turns)
        return GoalPoses(PushGoal(aims=aims, rotates=True))
    if angle is None:
        angle, reason = {
            "little": (defaults.turn_little, "“a little”"),
            "lot": (defaults.turn_lot, "“a lot”"),
            None: (defaults.turn, "no angle said"),
        }[goal.amount]
        used.append(DefaultUsed(name="turn", value=angle, unit="rad", reason=reason))
    angle = value_in_bound(angle, goal.bound, defaults.turn_tolerance)
    signs = {"ccw": (1.0,), "cw": (-1.0,), None: (1.0, -1.0)}[goal.sense]
    pose = problem.target.pose
    aims = tuple(Aim(x=pose.x, y=pose.y, yaw=pose.yaw + sign * angle) for sign in signs)
    return GoalPoses(PushGoal(aims=aims, rotates=True), tuple(used))


def goal_heading(goal: g.Displace, own: SeenObject, state: WorldState, d: Defaults) -> float | None:
    """Heading of a displacement in W [rad]; None if the sentence does not say where to.

    The objects of the goal are resolved; `own` is what is moved, where it stands at the start.
    """
    if goal.heading is not None:
        return goal.heading
    for target, sign in ((goal.toward, 1.0), (goal.away_from, -1.0)):
        if target is not None:
            # The edge itself is where "towards the edge" leads, however near it is.
            return heading_of(sign * _way_vector(target, own, state, replace(d, edge_gap=0.0)))
    if isinstance(goal.direction, tuple):
        return bisector(goal.direction)
    return HEADINGS[goal.direction] if goal.direction else None


def goal_distance(
    goal: g.Displace,
    own: SeenObject,
    state: WorldState,
    d: Defaults,
    constraints: Sequence[g.Constraint] = (),
) -> tuple[float, str | None]:
    """Length of a displacement [m], and why it is a default, if it is one; see `goal_heading`.

    Lengths of the goal are in metres; the constraints of the frame may say how far at most.
    """
    whole = _whole_way(goal, own, state, d)
    if goal.fraction is not None and whole is not None:
        return goal.fraction * whole, None
    if goal.distance is not None:
        assert isinstance(goal.distance, float), "lengths measured in objects are resolved"
        return goal.distance, None
    length, reason = {
        None: (d.distance, "no distance said"),
        "little": (d.distance_little, "“a little”"),
        "lot": (d.distance_lot, "“a lot”"),
    }[goal.amount]
    most = [clause.value for clause in constraints if isinstance(clause, g.MaxDistance)]
    # A limit is kept with the tolerance to spare.
    limits = [value - min(d.distance_tolerance, 0.5 * value) for value in most]
    if whole:
        limits.append(whole)
    return min([length, *limits]), reason


def _whole_way(goal: g.Displace, own: SeenObject, state: WorldState, d: Defaults) -> float | None:
    """Length of the way to what is moved towards [m]; None if there is no such thing."""
    if goal.toward is None:
        return None
    way = _way_vector(goal.toward, own, state, d)
    length = float(np.linalg.norm(way))
    if isinstance(goal.toward, str):
        return length
    u = way[:2] / length
    here, there = footprint(own), footprint(state.objects[goal.toward.id or ""])
    free = free_travel(here, there, u, 0.0)
    low, high = 0.0, free if np.isfinite(free) else length
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        apart = gap(here + middle * u, there)
        low, high = (middle, high) if apart > d.place_gap else (low, middle)
    return low


def _way_vector(
    target: g.ObjectRef | g.TableRegion, own: SeenObject, state: WorldState, d: Defaults
) -> Array:
    """From an object to what it is moved towards or away from, in W, shape (3,) [m]."""
    if isinstance(target, str):
        x, y = table_region(target, state.table, d).spots(own)[0]
        return np.array([x, y, 0.0]) - own.pose.p_WB
    return np.asarray(state.objects[target.id or ""].pose.p_WB - own.pose.p_WB)
