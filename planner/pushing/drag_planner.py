"""A drag: a fingertip presses on top of an object over its centre of mass and draws it along.

There nothing turns, whichever way it goes, so that it goes straight to its aim. The pressing force
is the least with which it surely goes along, as the exact tier has it; where no force makes that as
sure as a push must be, the one with which it does so with the probability that a drag must have: a
fingertip that slips instead is seen to, within a centimetre. What is to hang over the table's edge
goes no farther than it surely lies there, pressed and drawn, and left alone.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from objectmodels.exact.top_drag import drag_probability, press_range, top_drag
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.standing_balance import TopLoad
from objectmodels.safety_figure import SafetyFigure
from planner.problem.directions import unit
from planner.problem.overhangs import Overhang, most_overhang, overhangs, table_with_room
from planner.problem.planning_problem import PushProblem
from planner.pushing.contact_planner import PushCandidate
from planner.pushing.push_paths import Obstructions, PathSegment, free_length_mark
from planner.pushing.push_sequence import path_clearances
from planner.pushing.reach_search import ReachSearch
from planner.refusals.blocked import Blocked, dead_end, no_push_reached
from planner.types.actions import Aim, Margins, Prediction, Push, PushAction, finite_or_none
from planner.types.plan import Reached
from planner.types.world_state import plain_vector

FORCES = ("drag_slips", "press_too_weak", "finger_too_smooth", "force_not_allowed")
"""Codes of refusals since no pressing force that is allowed takes an object along."""

_CLOSE = 0.004  # what is nearer to its aim counts as there [m]
_RIM: SafetyFigure = 0.005  # between the contact and the edge of the top, at least [m]
_RATED, _CONFIRMED = 1, 3  # units of work of a force found, and of a hand asked for


def drag_to(
    problem: PushProblem, aim: Aim, search: ReachSearch
) -> list[PushCandidate] | Reached | Blocked:
    """The one drag that brings an object straight to an aim, or the finding that it is there."""
    target = problem.target
    way = np.array([aim.x - target.pose.x, aim.y - target.pose.y])
    off, turn = float(np.hypot(*way)), 0.0 if aim.yaw is None else aim.yaw - target.pose.yaw
    if abs(turn) > problem.defaults.no_turn:
        return dead_end("drag_turns", {"turn": turn}, object=target.name)
    if off <= _CLOSE:
        return Reached(aim=aim, off=off, turned_off=abs(turn))
    segment = PathSegment(math.atan2(way[1], way[0]), off)
    there = replace(target, pose=replace(target.pose, x=aim.x, y=aim.y))
    hanging = [*overhangs(there, problem.state.table)] if problem.goal.hangs_over else []
    if why := _why_not_free(problem, segment, hanging):
        return why
    problem.budget.spend(_RATED + _CONFIRMED)
    push = _drag_along(problem, segment)
    if isinstance(push, Blocked):
        return push
    notes = []
    for over in hanging:
        most = _most_overhang(problem, push, over)
        if over.length > most:
            numbers = {"overhang": over.length, "most": most}
            return dead_end("hangs_too_far", numbers, object=target.name, edge=over.edge)
        notes.append(
            f"It will hang {1e3 * over.length:.0f} mm over the table's {over.edge} edge, where it "
            f"could hang {math.floor(1e3 * most):.0f} mm"
        )
    answer = search.reach(push, problem.state)
    if not answer.ok:
        return no_push_reached(target.name, [answer], problem.spared)
    return [PushCandidate(push, ("drag",), considered=1, satisfying=1, notes=tuple(notes))]


def _most_overhang(problem: PushProblem, push: PushAction, over: Overhang) -> float:
    """How far it could hang over an edge at the end, pressed and drawn, or left alone [m]."""
    target, point = problem.target, np.array(push.p_BC[:2])
    along = (target.pose.R_WB.T @ push.direction_W)[:2]
    loads = [TopLoad(point, push.press, force * along) for force in (0.0, push.force_limit)]
    return most_overhang(target, over, problem.defaults, loads)


def _why_not_free(
    problem: PushProblem, segment: PathSegment, hanging: list[Overhang]
) -> Blocked | None:
    """The obstacle on its way, or the table's edge where it may not leave the table."""
    target, margin = problem.target, problem.defaults.clearance
    table = table_with_room(problem.state.table, hanging, 2.0 * margin)
    state = replace(problem.state, table=table)
    met = Obstructions(target, state, path_clearances(problem), margin).first_stop((segment,))
    if met is None:
        return None
    marks, free = (free_length_mark(target, (segment,), met),), max(met.free, 0.0)
    if met.other is None:
        numbers = {"room": free, "distance": segment.distance}
        return dead_end("off_the_table", numbers, marks=marks, object=target.name)
    numbers = {"free": free, "distance": segment.distance}
    return dead_end("in_the_way", numbers, marks=marks, object=target.name, other=met.other)


def _contact(problem: PushProblem) -> Array | Blocked:
    """The point on the top face over the centre of mass, in B, shape (3,) [m]."""
    model, said = problem.target.model, problem.contact.face
    if said not in (None, "top"):
        spans, name = problem.contact.spans, problem.target.name
        return dead_end("pushed_over_edge", spans=spans, object=name, face=said)
    face, over = model.top_face, np.array(model.com[:2])
    if model.container is not None or face is None or not face.contains(over[None], -_RIM):
        return dead_end("no_top_to_press", object=problem.target.name)
    return np.append(over, model.top)


def _drag_along(problem: PushProblem, segment: PathSegment) -> PushAction | Blocked:
    """The drag along a segment, with what the exact tier says of it."""
    target, motion, force = problem.target, problem.motion, problem.force
    model, point = target.model, _contact(problem)
    if isinstance(point, Blocked):
        return point
    direction = target.pose.R_WB.T @ unit(segment.heading)
    direction = np.array([*direction[:2], 0.0]) / np.hypot(*direction[:2])
    pressing = _pressing(problem, point, direction)
    if isinstance(pressing, Blocked):
        return pressing
    press, probability = pressing
    drag = top_drag(model, point[None], direction[None], press)
    needed, grip = float(np.hypot(*drag.force[0])), float(drag.grip[0])
    # Where the sentence limits the force, what the fingertip could pass on as it lands counts.
    # Pressing force as the fingertip begins to slide along, of that to be kept; 1.48 was felt.
    most = 1.5 * grip if force.spans else needed
    if most > force.max:
        numbers = {"needed_force": most, "allowed_force": force.max}
        doing, name = "drawing along", target.name
        return dead_end("force_not_allowed", numbers, spans=force.spans, object=name, doing=doing)
    tips = float(drag.tip_ratio[0] * min(needed, grip))
    push = Push(
        object=target.name,
        face="top",
        p_BC=plain_vector(point),
        normal_W=(0.0, 0.0, 1.0),
        direction_W=plain_vector(unit(segment.heading)),
        force_limit=min(grip, force.max),
        speed=motion.speed,
        stroke=segment.distance,
        fingers=1,
        spread=0.0,
        ends_on="stroke",
        limits=motion.guards,
        press=press,
    )
    prediction = Prediction(
        outcome="slide",
        onset=needed,
        slide_force=needed,
        topple_force=finite_or_none(tips),
        critical_height=None,
        critical_height_worst=None,
        probability=probability,
        stay_on_base_angle=model.angle_of_no_return(direction),
        tier="exact",
        friction="static",
    )
    face = model.top_face
    assert face is not None, "a contact was found on it"
    lateral = float((face.offsets - face.normals @ point[:2]).min())
    margins = Margins(
        force=grip - needed, height=0.0, lateral=lateral, sigmas=0.0, force_limit=grip - needed
    )
    displacement = plain_vector(segment.displacement)
    return PushAction(
        **dict(push), prediction=prediction, margins=margins, displacement=displacement
    )


def _pressing(
    problem: PushProblem, point: Array, direction: Array
) -> tuple[float, float] | Blocked:
    """The pressing force [N], and the probability with which the object then goes along."""
    model, most = problem.target.model, problem.robot.max_press
    if most <= 0.0:
        return dead_end("no_pressing", object=problem.target.name)
    surest = float(drag_probability(model, point[None], direction[None], most)[0])
    asked = problem.defaults.probability
    if surest < asked:
        asked = problem.effort.probability
    found = press_range(model, point, direction, most, asked) if surest >= asked else None
    if found is None:
        return _not_taken_along(problem, point, direction, surest)
    press = found[0]
    return press, float(drag_probability(model, point[None], direction[None], press)[0])


def _not_taken_along(
    problem: PushProblem, point: Array, direction: Array, surest: float
) -> Blocked:
    """Dead end since pressing does not take an object along, with what decides."""
    target, most = problem.target, problem.robot.max_press
    model = target.model
    pressed = top_drag(model, point[None], direction[None], most)
    numbers = {"max_press": most, "probability": surest}
    if pressed.outcome[0] == "tips":
        return dead_end("drag_tips", numbers, object=target.name, height=model.top)
    # What takes more than twenty times the force of a fingertip is not told in newtons.
    nominal = press_range(model, point, direction, 20.0 * most)
    if nominal is None:
        words = {"finger": model.finger_friction, "table": model.friction}
        return dead_end("finger_too_smooth", numbers | words, object=target.name)
    numbers |= {"needed_force": nominal[0], "asked_probability": problem.effort.probability}
    code = "press_too_weak" if nominal[0] > most else "drag_slips"
    return dead_end(code, numbers, object=target.name)
