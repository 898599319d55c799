"""Sides of an object: which of them a push may touch, which way it goes then, and what is beyond.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from planner.geometry.directions import HEADINGS, angle_between, face_name, heading_of, unit
from planner.geometry.footprints import footprint, landing_strip, overlaps, travel_to_edge
from planner.problem import tilt_goals as tilts
from planner.pushing.push_paths import grip
from planner.refusals import push_refusals as refusals
from planner.refusals.push_refusals import NoPlanError

if TYPE_CHECKING:
    from objectmodels.geometry.side_faces import Face
    from planner.problem.push_problem import Asked
    from planner.types.defaults import Defaults
    from planner.types.refusal import Refusal
    from planner.types.world_state import SeenObject, WorldState

UNCLEAR_FACE = math.radians(40.0)
"""A face turned by more from the direction of its name is within 5° of the next name."""


@dataclass(frozen=True)
class Side:
    """A side face as a place to push: the face in B and its inward normal's heading in W [rad]."""

    face: Face
    heading: float


def touchable(asked: Asked, target: SeenObject, defaults: Defaults) -> list[Side]:
    """Sides that a push as asked may touch: the straightest, or all if no direction is said.

    Raises:
        NoPlanError: there is none, or it is not square enough to the direction.
    """
    sides, unclear = [], None
    for face in target.model.faces(_pushed_along(asked) - target.pose.yaw):
        outward = target.pose.R_WB @ np.array(face.normal)
        name, off = face_name(outward)
        if asked.face is not None:
            if abs(off) > UNCLEAR_FACE:
                unclear = off
                continue
            if name != asked.face:
                continue
        sides.append(Side(face, heading_of(-outward)))
    if not sides and unclear is not None:
        raise NoPlanError(refusals.unclear_face(asked, target, unclear))
    if not sides:
        raise NoPlanError(refusals.no_side(asked, target))
    if asked.heading is None:
        return sides
    side = _most_square(sides, asked.heading)
    oblique = angle_between(asked.heading, side.heading)
    # An object that slides straight presses back along the push: that must be in the friction cone.
    # What topples or tilts is pushed square to its face, and goes about where it was meant to.
    largest = grip(target, defaults.sigmas, steep=asked.steep)
    if asked.outcome == "topple":
        largest = 0.5 * defaults.side_tolerance
    if abs(oblique) > largest:
        raise NoPlanError(refusals.askew(asked, target, side, oblique, largest))
    return [side]


def straightest(target: SeenObject, heading: float) -> Side:
    """The side of an object that is most square to a push along a heading in W [rad]."""
    faces = target.model.faces(np.array([heading - target.pose.yaw]))
    inward = [Side(f, heading_of(-target.pose.R_WB @ np.array(f.normal))) for f in faces]
    return _most_square(inward, heading)


def _most_square(sides: list[Side], heading: float) -> Side:
    return min(sides, key=lambda side: abs(angle_between(side.heading, heading)))


def _pushed_along(asked: Asked) -> np.ndarray:
    """Headings in W along which a round object may be pushed: the one asked, else the robot's four.

    Shape (k,) [rad].
    """
    if asked.heading is not None:
        return np.array([asked.heading])
    return np.array(list(HEADINGS.values()))


def direction(asked: Asked, side: Side) -> np.ndarray:
    """Unit direction of the push in W; a topple is pushed square to the face."""
    if asked.outcome == "slide" and asked.heading is not None:
        return unit(asked.heading)
    return unit(side.heading)


def hindered(
    side: Side, asked: Asked, target: SeenObject, state: WorldState, defaults: Defaults
) -> Refusal | None:
    """What the object would hit if it fell, or leaned over, from a face; None if nothing."""
    u = direction(asked, side)
    if asked.tilt is None:
        return _fall_blocked(target, state, u, defaults)
    return tilts.hindered(target, state, side.face.normal, u, asked.tilt, defaults)


def _fall_blocked(
    target: SeenObject, state: WorldState, u: np.ndarray, defaults: Defaults
) -> Refusal | None:
    strip = landing_strip(target, u)
    if travel_to_edge(strip, state.table, u[:2], 0.0) < defaults.clearance:
        return refusals.falls_off(target)
    for name, other in state.objects.items():
        apart = defaults.clearance_fragile if other.fragile else defaults.clearance
        if name != target.name and overlaps(strip, footprint(other), apart):
            return refusals.falls_on(target, other)
    return None
