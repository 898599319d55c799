"""Clauses about the contact: which heights and faces of an object, and which part of the hand."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from grammar.frames import command as g
from objectmodels.models.object_parts import FlipLid
from planner.geometry.directions import FACE_OF_PUSH, HEADINGS
from planner.problem.planning_problem import GoalT, GraspProblem, PlanningProblem, PushProblem
from planner.refusals.refusal_builder import not_capable, unsupported_while
from planner.types.defaults import Defaults

Band = tuple[float, float, str]
"""The lowest and the highest of some heights [m], and words for them."""


def height_bands(clause: g.ContactRegion, top: float, defaults: Defaults) -> Iterator[Band]:
    """The heights that a clause allows on an object as high as `top` [m]; all of them hold."""
    if clause.region is not None:
        third = {"bottom": 0, "middle": 1, "top": 2}[clause.region]
        yield third * top / 3.0, (third + 1) * top / 3.0, f"at the {clause.region}"
    if clause.height is not None:
        yield _band_at(clause.height, top, defaults)


def _band_at(height: g.ContactHeight, top: float, defaults: Defaults) -> Band:
    assert isinstance(height.value, float), "lengths measured in objects are resolved by now"
    upwards = height.origin == "table"
    at = height.value if upwards else top - height.value
    where = f"{1e3 * at:.0f} mm above the table"
    if height.bound == "exact":
        near = 0.5 * defaults.height_tolerance
        return at - near, at + near, where
    if (height.bound == "at_least") == upwards:
        return at, top, f"at least {where}"
    return 0.0, at, f"at most {where}"


def _with_heights(
    problem: PlanningProblem[GoalT], clause: g.ContactRegion
) -> PlanningProblem[GoalT]:
    """The problem with one more restriction of the heights; all of them hold."""
    contact = replace(problem.contact, spans=problem.contact.spans + clause.spans)
    for low, high, words in height_bands(clause, problem.target.model.top, problem.defaults):
        region = f"{contact.region} and {words}" if contact.region else words
        contact = replace(
            contact, low=max(contact.low, low), high=min(contact.high, high), region=region
        )
    return replace(problem, contact=contact)


def limit_push_contact(problem: PushProblem, clause: g.ContactRegion) -> PushProblem:
    """The problem with a push on one face, or between two heights.

    Raises:
        NoPlanError: the face is the top one, on which a fingertip presses to draw an object along,
            and something else is asked.
    """
    goal = problem.goal
    if clause.face == "top" and (not goal.aims or goal.rotates or goal.until is not None):
        raise not_capable(
            "pushing on the top face",
            "a fingertip on the top face draws an object along, over a distance or to a place; it "
            "does nothing else there",
            clause.spans,
            "say “at the top” for the upper third of a side face",
        )
    if clause.face is not None:
        if goal.outcome == "topple" and goal.heading is None:
            push = next(d for d, face in FACE_OF_PUSH.items() if face == clause.face)
            goal = replace(goal, heading=HEADINGS[push])
        contact = replace(problem.contact, face=clause.face)
        problem = replace(problem, goal=goal, contact=contact)
    return _with_heights(problem, clause)


def limit_grasp_contact(problem: GraspProblem, clause: g.ContactRegion) -> GraspProblem:
    """The problem with a grasp between two heights.

    Raises:
        NoPlanError: a face is named.
    """
    if clause.face is not None:
        raise unsupported_while("touching a named face", problem.goal.doing, clause.spans)
    return _with_heights(problem, clause)


def limit_fingertips(problem: PushProblem, clause: g.Effector) -> PushProblem:
    """The problem with the number of fingertips that a sentence asks for.

    Raises:
        NoPlanError: the robot does not push with what is asked for.
    """
    _require_right(clause)
    if clause.tool == "arm" or (clause.tool == "hand" and clause.side is None):
        raise not_capable(
            f"pushing with the {clause.tool}",
            f"this robot pushes with its fingertips, not with the {clause.tool}",
            clause.spans,
            "say “with one finger” or “with two fingers”",
        )
    if clause.tool != "finger" or clause.count is None:
        return problem
    if clause.count > 2:
        raise not_capable(
            f"pushing with {clause.count} fingers",
            "this robot pushes with one or two fingertips",
            clause.spans,
        )
    contact = replace(
        problem.contact,
        fingers=(2,) if clause.count == 2 else (1,),
        spans=problem.contact.spans + clause.spans,
    )
    return replace(problem, contact=contact)


def require_whole_hand(problem: GraspProblem, clause: g.Effector) -> GraspProblem:
    """The same problem; a whole hand does it, or one fingertip if it flips a lid.

    Raises:
        NoPlanError: the sentence asks for something else.
    """
    _require_right(clause)
    doing = problem.goal.doing
    fingertip = isinstance(problem.target.model.lid, FlipLid) and doing in ("opening", "closing")
    if clause.tool == "arm" or (clause.tool == "finger" and not fingertip):
        which = "fingers" if clause.tool == "finger" else "the arm"
        raise unsupported_while(f"using only {which}", doing, clause.spans)
    if clause.tool == "finger" and (clause.count or 1) > 1:
        raise unsupported_while(f"using {clause.count} fingers", doing, clause.spans)
    return problem


def _require_right(clause: g.Effector) -> None:
    """The robot has no left hand."""
    if clause.side == "left":
        raise not_capable(
            "a second (left) hand",
            "this robot has one hand, a right one",
            clause.spans,
            "leave out which hand, or say the right one",
        )
