"""Heading and distance of a displacement, from where things stand.

Model: towards an object is towards its origin, towards an edge of the table straight across to it.
The way to an object ends next to it, at the gap that "next to" means, and a share of the way
("halfway to the mug") is a share of that. Where no distance is said, nothing goes farther towards
an object than that, and nothing farther than the sentence allows.

Frames: W's table plane [m]; headings are counter-clockwise from its x axis [rad].
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from grammar.frames import command as g
from planner.geometry.directions import HEADINGS, bisector, heading_of
from planner.geometry.footprints import footprint, free_travel, gap
from planner.problem.place_regions import table_region

if TYPE_CHECKING:
    from collections.abc import Sequence

    from planner.problem.place_regions import Array
    from planner.types.defaults import Defaults
    from planner.types.world_state import SeenObject, WorldState

_HALVINGS = 40  # of a way of metres: far below a micrometre


def goal_heading(goal: g.Displace, own: SeenObject, state: WorldState, d: Defaults) -> float | None:
    """Heading of a displacement in W [rad]; None if the sentence does not say where to.

    Args:
        goal: its objects resolved.
        own: what is moved, where it stands at the start.
        state: the objects on the table, and the table.
        d: what a region of the table means.
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
    """Length of a displacement [m], and why it is a default, if it is one.

    Args:
        goal: its objects resolved, its lengths in metres.
        own: what is moved, where it stands at the start.
        state: the objects on the table, and the table.
        d: what a distance means when no more is said.
        constraints: of the frame; they may say how far at most.
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
