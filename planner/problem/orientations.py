"""Headings of an object that turns to face something, or to lie along it.

Model: an object looks where its broad side faces look, those as wide as its widest. So a long box
looks in two directions, a square one in four, and lies along the lines of these faces; one that is
round looks everywhere. An edge of the table on the robot's left or right runs away from the robot,
the others across.

Frame: W.
"""

from __future__ import annotations

import math

import numpy as np

from grammar.frames import command as g
from objectmodels.geometry.base_shapes import Disc
from planner.geometry.directions import HEADINGS, angle_between, heading_of
from planner.refusals.refusal_builder import no_plan
from planner.types.world_state import SeenObject, WorldState

_BROAD = 0.98  # share of the widest face's width from which a face counts as as wide
_QUARTER = math.pi / 2.0
_ACROSS_EDGES = {
    "left_edge": (_QUARTER, -_QUARTER), "right_edge": (_QUARTER, -_QUARTER),
    "front_edge": (0.0, math.pi), "back_edge": (0.0, math.pi),
    "edge": (0.0, _QUARTER, math.pi, -_QUARTER),
}  # fmt: skip
"""Headings square to the edges of the table [rad]."""


def is_orientation(goal: g.Rotate) -> bool:
    """Return True if a goal says how an object should look at the end, not how far it turns."""
    return goal.facing is not None or goal.parallel_to is not None


def turns_to_orientation(goal: g.Rotate, own: SeenObject, state: WorldState) -> tuple[float, ...]:
    """Turns after which an object looks as asked, counter-clockwise, the smallest first [rad].

    Raises:
        NoPlanError: it is to lie along what has no sides.
    """
    looks = _headings_of_sides(own)
    if not looks:
        return (0.0,)
    turns = [angle_between(asked, look) for asked in _asked_headings(goal, own, state)
             for look in looks]  # fmt: skip
    return tuple(sorted(dict.fromkeys(round(turn, 9) for turn in turns), key=abs))


def _asked_headings(goal: g.Rotate, own: SeenObject, state: WorldState) -> tuple[float, ...]:
    """Headings in W of which a broad side should have one [rad]."""
    facing, along = goal.facing, goal.parallel_to
    if isinstance(facing, str):
        return (HEADINGS[facing],)
    if facing is not None:
        return (heading_of(state.objects[facing.id or ""].pose.p_WB - own.pose.p_WB),)
    if isinstance(along, g.ObjectRef):
        other = state.objects[along.id or ""]
        looks = _headings_of_sides(other)
        if not looks:
            raise no_plan("no_sides", spans=along.spans, other=other.name)
        return tuple(look + turn for look in looks for turn in (0.0, math.pi))
    if along not in _ACROSS_EDGES:
        raise no_plan("no_sides", spans=goal.spans, other=str(along))
    return _ACROSS_EDGES[along]


def _headings_of_sides(seen: SeenObject) -> tuple[float, ...]:
    """Headings in which the broad side faces look [rad]; none of what is round."""
    faces = seen.model.faces()
    if isinstance(seen.model.base, Disc) or not faces:
        return ()
    widest = max(face.width for face in faces)
    broad = (face for face in faces if face.width >= _BROAD * widest)
    return tuple(heading_of(seen.pose.R_WB @ np.array(face.normal)) for face in broad)
