"""Sides of an object: which of them a push may touch, which way it goes then, and what is beyond.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import math

import numpy as np

from planner.geometry.directions import HEADINGS, angle_between, face_name, heading_of, phrase, unit
from planner.geometry.footprints import (
    footprint,
    landing_area,
    leading_point,
    overlaps,
    travel_to_edge,
)
from planner.problem.planning_problem import PushProblem, PushStep, Side
from planner.problem.tilt_goals import require_free_tilt
from planner.pushing.push_paths import largest_obliqueness
from planner.refusals.refusal_builder import no_plan
from planner.refusals.refusal_marks import tilt_mark
from planner.types.world_state import SeenObject

UNCLEAR_FACE = math.radians(40.0)
"""A face turned by more from the direction of its name is within 5° of the next name."""


def touchable_sides(problem: PushProblem, step: PushStep) -> list[Side]:
    """Sides that a push may touch: the straightest, or all if no direction is said.

    Raises:
        NoPlanError: there is none, or it is not square enough to the direction.
    """
    if step.side is not None:
        return [step.side]
    target, face_said, spans = problem.target, problem.contact.face, problem.contact.spans
    sides, unclear = [], None
    for face in target.model.faces(_push_headings(step) - target.pose.yaw):
        outward = target.pose.R_WB @ np.array(face.normal)
        name, off = face_name(outward)
        if face_said is not None:
            if abs(off) > UNCLEAR_FACE:
                unclear = off
                continue
            if name != face_said:
                continue
        sides.append(Side(face, heading_of(-outward)))
    if not sides and unclear is not None:
        turned = {"turned": unclear}
        raise no_plan("face_not_clear", turned, spans=spans, object=target.name, face=face_said)
    if not sides:
        where = "side" if face_said is None else f"{face_said} face"
        raise no_plan("no_side", spans=spans, object=target.name, where=where)
    if step.heading is None:
        return sides
    return [_square_enough(problem, step, sides, step.heading)]


def _square_enough(problem: PushProblem, step: PushStep, sides: list[Side], heading: float) -> Side:
    """The side that is most square to a push along a heading in W [rad]."""
    target, contact = problem.target, problem.contact
    side = _most_square(sides, heading)
    oblique = angle_between(heading, side.heading)
    # An object that slides straight presses back along the push: that must be in the friction cone.
    # What topples or tilts is pushed square to its face, and goes about where it was meant to.
    largest = largest_obliqueness(target, problem.defaults.sigmas, steep=problem.effort.oblique)
    if step.outcome == "topple":
        largest = 0.5 * problem.defaults.side_tolerance
    if abs(oblique) > largest:
        raise no_plan(
            "oblique_face" if contact.face else "oblique",
            {"obliqueness": abs(oblique), "largest_obliqueness": largest},
            spans=contact.spans,
            object=target.name,
            face=f"its {contact.face} face" if contact.face else "its nearest face",
            direction=phrase(heading),
            square=phrase(side.heading),
        )
    return side


def straightest_side(target: SeenObject, heading: float) -> Side:
    """The side of an object that is most square to a push along a heading in W [rad]."""
    faces = target.model.faces(np.array([heading - target.pose.yaw]))
    inward = [Side(f, heading_of(-target.pose.R_WB @ np.array(f.normal))) for f in faces]
    return _most_square(inward, heading)


def _most_square(sides: list[Side], heading: float) -> Side:
    return min(sides, key=lambda side: abs(angle_between(side.heading, heading)))


def _push_headings(step: PushStep) -> np.ndarray:
    """Headings in W along which a round object may be pushed, shape (k,) [rad]."""
    if step.heading is not None:
        return np.array([step.heading])
    return np.array(list(HEADINGS.values()))


def push_direction(step: PushStep, side: Side) -> np.ndarray:
    """Unit direction of the push in W, shape (3,); a topple is pushed square to the face."""
    if step.outcome == "slide" and step.heading is not None:
        return unit(step.heading)
    return unit(side.heading)


def require_room(problem: PushProblem, step: PushStep, side: Side) -> None:
    """Make sure that the object hits nothing when it falls, or leans over, from a side.

    Raises:
        NoPlanError: there is no room, or a tilt may end in a fall.
    """
    u = push_direction(step, side)
    if step.tilt is None:
        _require_landing(problem, u)
    else:
        require_free_tilt(problem, side.face.normal, u, step.tilt)


def _require_landing(problem: PushProblem, u: np.ndarray) -> None:
    target = problem.target
    there, height = landing_area(target, u), {"height": target.model.top}
    edge = leading_point(target, u)
    if travel_to_edge(there, problem.state.table, u[:2], 0.0) < problem.defaults.clearance:
        marks = (tilt_mark(target.name, edge, u, math.pi / 2.0, "over the edge of the table"),)
        raise no_plan("falls_off", height, marks=marks, object=target.name)
    for other in problem.others.values():
        if overlaps(there, footprint(other), problem.clearance(other)):
            mark = tilt_mark(
                target.name, edge, u, math.pi / 2.0, f"it would fall on the {other.name}"
            )
            raise no_plan("falls_on", height, marks=(mark,), object=target.name, other=other.name)
