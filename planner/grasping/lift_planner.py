"""Lifting, putting down, and carrying to a place.

Model: what is held keeps its heading and stays upright. It is carried straight, at a height that
clears everything on the way, and let down where the words want it.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from grammar.frames import command as g
from objectmodels.geometry.support_points import hull_polygon
from planner.geometry.footprints import footprint, gap, travel_to_edge
from planner.grasping.grasp_sampling import of_body
from planner.grasping.grasp_selection import (
    Bearing,
    Draft,
    Hold,
    each_with_each,
    first_way,
    held_already,
    holds,
)
from planner.problem.goal_poses import aimed, here
from planner.problem.place_regions import moved
from planner.refusals import grasp_refusals as refusals
from planner.refusals.push_refusals import NoPlanError
from planner.types.actions import Action, Aim, Carry, LiftUp, SetDown
from planner.types.plan import DefaultUsed, Plan

if TYPE_CHECKING:
    from planner.problem.goal_poses import Aimed
    from planner.problem.planning_problem import Task
    from planner.types.plan import PlanTask
    from planner.types.world_state import SeenObject

TO_THE_SIDE = math.cos(math.radians(50.0))
"""Least cosine between a lean along the line across and the side of the opening."""

_CLOSER = 0.5  # share of a wanted gap that must be left where something is put
_AXES = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])


def lift(task: Task, goal: g.Lift) -> Plan:
    """Straight up, from the table or from where it is held.

    Raises:
        NoPlanError: it cannot be held, or not be lifted so far.
    """
    require_liftable(task)
    height, used = _height(task, goal)
    draft = Draft((LiftUp(height=height),), defaults=used)
    return _made(task, "lift", sorted(body_holds(task), key=partial(_turned, task)), [draft])


def set_down(task: Task) -> Plan:
    """Down where it is held.

    Raises:
        NoPlanError: the hand holds nothing, or nothing can stand there.
    """
    if task.state.held is None:
        raise refusals.holds_nothing()
    require_room(task, task.target, {})
    draft = Draft((SetDown(),), aim=here(task.target))
    return _made(task, "place", held_already(task), [draft])


def place(task: Task, frame: g.Frame) -> Plan:
    """To a place: up, over and down.

    Raises:
        NoPlanError: it cannot be held, the place is not free, or the hand does not get there.
    """
    require_liftable(task)
    found = aimed(frame, task.target, task.state, task.defaults)
    ways = body_holds(task)
    drafts, refused = [], None
    for aim in found.aims:
        try:
            drafts.append(_to(task, aim, found))
        except NoPlanError as error:
            refused = refused or error
    if not drafts:
        assert refused is not None, "there is an aim"
        raise refused
    return _made(task, "place", ways, drafts)


def _made(task: Task, action: PlanTask, ways: list[Hold], drafts: list[Draft]) -> Plan:
    return first_way(task, action, each_with_each(ways, drafts), len(ways) * len(drafts))


def _turned(task: Task, hold: Hold) -> bool:
    """Whether an object, held so, would not lean to where its opening is: it pours beside it."""
    container = task.target.model.container
    if container is None:
        return False
    opening = np.array([*container.opening.centre, 0.0])
    closing = np.array(hold.grasp.closing_W) @ task.target.pose.R_WB
    return bool(abs(closing @ opening) < TO_THE_SIDE * np.linalg.norm(opening))


def body_holds(task: Task) -> list[Hold]:
    """How the hand holds an object, or could."""
    held = held_already(task)
    if held:
        return held
    return holds(task, [Bearing(each) for each in of_body(task.target, task.hand, task.how)])


def require_liftable(task: Task) -> None:
    """It may leave the table.

    Raises:
        NoPlanError: a holder or the sentence keeps it there.
    """
    if task.target.fixed:
        raise refusals.is_fixed(task)
    if task.how.on_the_table:
        raise refusals.not_while(task, task.how.on_the_table, "takes it off the table")


def over(task: Task, to: Aim) -> float:
    """Height at which it passes over everything between where it is and an aim [m]."""
    start, end = footprint(task.target), footprint(moved(task.target, np.array([to.x, to.y])))
    way = hull_polygon(np.vstack([start, end])).vertices
    kept = dict(task.how.clear_of)
    tops = [
        seen.bulk()[1]
        for name, seen in others(task).items()
        if gap(way, footprint(seen)) < max(_apart(task, seen), kept.get(name, 0.0))
    ]
    return task.defaults.carry_clearance + max(tops, default=0.0)


def raised(task: Task, height: float) -> tuple[Action, ...]:
    """The steps that bring it to a height, if it is not so high already."""
    now = 0.0 if task.state.held is None else task.state.held.height
    return (LiftUp(height=height - now, hold=0.0),) if height > now else ()


def others(task: Task) -> dict[str, SeenObject]:
    """Everything else on the table."""
    return {name: seen for name, seen in task.state.objects.items() if name != task.target.name}


def require_room(task: Task, there: SeenObject, near: dict[str, float]) -> None:
    """It can stand somewhere.

    Args:
        task: what is planned for.
        there: the object, or a lid, as it would stand.
        near: objects that it is to stand close to, and how close [m].

    Raises:
        NoPlanError: something else stands there, or the table ends.
    """
    own, kept = footprint(there), dict(task.how.clear_of)
    for name, seen in others(task).items():
        apart = min(_apart(task, seen), _CLOSER * near.get(name, np.inf))
        if gap(own, footprint(seen)) < max(apart, kept.get(name, 0.0)):
            raise refusals.no_place(task, f"the {task.target.name}", name)
    edge = min(travel_to_edge(own, task.state.table, u, task.defaults.clearance) for u in _AXES)
    if edge < 0.0:
        raise refusals.no_place(task, f"the {task.target.name}", None)


def _apart(task: Task, seen: SeenObject) -> float:
    d = task.defaults
    return d.clearance_fragile if seen.fragile else d.clearance


def _to(task: Task, aim: Aim, found: Aimed) -> Draft:
    there = replace(moved(task.target, np.array([aim.x, aim.y])))
    require_room(task, there, dict(found.near))
    steps = (*raised(task, over(task, aim)), Carry(to=aim), SetDown())
    return Draft(steps, aim=aim, defaults=found.defaults)


def _height(task: Task, goal: g.Lift) -> tuple[float, tuple[DefaultUsed, ...]]:
    """How far it is lifted, and that this was not said."""
    d, height = task.defaults, goal.height
    if height is None:
        value, reason = {
            "little": (d.lift_little, "“a little”"),
            "lot": (d.lift_lot, "“a lot”"),
            None: (d.lift_height, "no height said"),
        }[goal.amount]
        return value, (DefaultUsed(name="lift_height", value=value, unit="m", reason=reason),)
    assert isinstance(height, float), "lengths measured in objects are resolved by now"
    # A bound is kept with the tolerance to spare.
    spare = {"exact": 0.0, "at_least": 1.0, "at_most": -1.0}[goal.bound]
    return height + spare * min(d.distance_tolerance, 0.5 * height), ()
