"""Standing up what has fallen: held, lifted, turned until its own bottom is below, and set down.

Model: it turns evenly about the middle of the grasp, with hand and all. How it is turned about the
vertical in the end is free: the hand had better point then where it pointed before, so that its
wrist rolls and the arm stays where it is. A hand from above, which pointed nowhere, ends level, and
may point away from W's origin or to the sides.

Frames: W is the world, N the face on which it lies, B the object as it stands.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.models.object_model import Resting
from planner.geometry.directions import heading_of
from planner.geometry.spatial_rotations import axis_and_angle, rotation_about
from planner.grasping import lift_planner
from planner.grasping.grasp_plans import MotionDraft, first_plan_of_groups, first_reachable_plan
from planner.grasping.grasp_sampling import Candidate, body_candidates
from planner.grasping.grasp_selection import GraspLoad, StableGrasp, held_already, stable_grasps
from planner.predicted_states import standing_object
from planner.problem.planning_problem import GraspProblem
from planner.refusals.refusal_builder import no_plan
from planner.types.actions import Action, Aim, SetDown
from planner.types.plan import Plan, Reached
from planner.types.refusal import Alternatives
from planner.types.turning_actions import TurnOver
from planner.types.world_state import SeenObject

_UP = np.array([0.0, 0.0, 1.0])
_HALF = math.radians(150.0)  # turns by more than this are tried the other way round, too
_ASIDE = np.radians([0.0, 40.0, -40.0, 80.0, -80.0])  # of a hand in the end, off "away"
_SAMPLES = 32  # orientations on the way that are looked at
_POINTS_UP = 0.2  # of straight fingers in the end, how much they go up at most


def stand_up(problem: GraspProblem) -> Plan | Reached:
    """Lifts what lies and sets it down on its own bottom; what is held upright is set down.

    Raises:
        NoPlanError: it cannot be held, there is no room, or the hand does not get around.
    """
    rest = problem.target.rest
    if held_already(problem):
        if rest is None:
            return lift_planner.set_down(problem)
        raise no_plan("hand_not_free", object=problem.target.name)
    if rest is None:
        return Reached()
    lift_planner.require_liftable(problem)
    if problem.motion.upright:
        raise lift_planner.forbidden_meanwhile(problem, problem.motion.upright, "tilts it")

    def with_loads(loads: list[GraspLoad]) -> Plan:
        return _first_way(problem, rest, stable_grasps(problem, loads))

    loads = ([load for each in group for load in _turned(each, rest, problem.target)]
             for group in body_candidates(problem))  # fmt: skip
    some = [group for group in loads if group]
    if not some:
        raise no_plan("hand_from_below", object=problem.target.name)
    return first_plan_of_groups(some, with_loads)


def _turned(held: Candidate, rest: Resting, target: SeenObject) -> Iterator[GraspLoad]:
    """Ways to turn an object in a hold until its bottom is below, this or that way round.

    None if the fingers would then point up.
    """
    level = _lean_onto(rest.foot)
    last = level @ held.approach
    if last[2] > _POINTS_UP:
        return
    away = heading_of(target.pose.p_WB) - target.pose.yaw
    kept = [heading_of(held.approach)] if np.any(held.approach[:2]) else []
    for heading in (*kept, *(away + _ASIDE)):
        axis, angle = axis_and_angle(rotation_about(_UP, heading - heading_of(last)) @ level)
        yield GraspLoad(held, turned=angle * axis)
        if angle > _HALF:
            yield GraspLoad(held, turned=(angle - math.tau) * axis)


def _lean_onto(foot: Array) -> Array:
    """The shortest rotation by which a direction, shape (3,), comes to look down, shape (3, 3)."""
    axis = np.cross(foot, -_UP)
    if np.linalg.norm(axis) < 1e-9:
        return rotation_about([1.0, 0.0, 0.0], 0.0 if foot[2] < 0.0 else math.pi)
    angle = math.acos(float(np.clip(-foot[2], -1.0, 1.0)))
    return rotation_about(axis / np.linalg.norm(axis), angle)


def _first_way(problem: GraspProblem, rest: Resting, ways: list[StableGrasp]) -> Plan:
    """The first of some turns, the best held first, that hand and arm can make."""
    drafts, places = [], Alternatives()
    for hold in ways:
        with places:
            drafts.append((hold, _motion_draft(problem, rest, hold)))
    if not drafts:
        raise places.first
    return first_reachable_plan(problem, "stand", drafts)


def _motion_draft(problem: GraspProblem, rest: Resting, hold: StableGrasp) -> MotionDraft:
    """The steps after the grasp."""
    assert hold.turned is not None, "it is turned"
    target, middle = problem.target, np.array(hold.grasp.p_BG)
    R_WN, angle = target.pose.R_WB, float(np.linalg.norm(hold.turned))
    axis = R_WN @ hold.turned / angle
    R_WE = rotation_about(axis, angle) @ R_WN
    R_WB, p_WB = rest.body_pose(R_WE, target.pose.p_WB + R_WN @ middle - R_WE @ middle)
    aim = Aim(x=float(p_WB[0]), y=float(p_WB[1]), yaw=heading_of(R_WB[:, 0]))
    lift_planner.require_room(problem, standing_object(target, aim), {})
    here = Aim(x=target.pose.x, y=target.pose.y)
    up = lift_planner.clearance_height(problem, here) + _room_below(target, middle, hold.turned)
    x, y, z = axis.tolist()
    steps: tuple[Action, ...] = (
        *lift_planner.lift_steps(problem, up),
        TurnOver(axis_W=(x, y, z), angle=angle),
        SetDown(),
    )
    return MotionDraft(steps, aim=aim)


def _room_below(target: SeenObject, middle: Array, turned: Array) -> float:
    """Height by which it is lifted so that it clears the table while it turns [m].

    Args:
        target: what is turned.
        middle: the point in N that stays where it is, shape (3,) [m].
        turned: rotation vector in N, shape (3,) [rad].
    """
    angle = float(np.linalg.norm(turned))
    ways = rotation_about(turned / angle, np.linspace(0.0, angle, _SAMPLES))
    outline, top = target.model.outline, target.model.top
    corners = np.array([(x, y, z) for z in (0.0, top) for x, y in outline])
    lowest = float(((corners - middle) @ ways[:, 2].T).min())
    return max(0.0, -lowest - float(middle[2]))
