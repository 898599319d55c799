"""Turning an object about the vertical: pushes off the middle of its sides, in pairs.

Model: each push turns the object about a pivot off its middle (`objectmodels.turning`), so that it
is displaced as well. A second push by the same angle on the opposite side takes most of that back.
So a turn is made in pairs, each on the sides that leave the object nearest to where it should be; a
turn so small that little is to be taken back is made by one.

Frames: W, its table plane.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.base import Disc
from objectmodels.turning import best_turn
from planner.candidates import Side
from planner.directions import heading_of
from planner.footprints import footprint, gap, travel_to_edge

if TYPE_CHECKING:
    from objectmodels.faces import Face
    from objectmodels.turning import TurningPush
    from planner.plan import Aim
    from planner.state import PlanarPose, SeenObject, WorldState

MOST = math.radians(50.0)
"""Largest turn by one push: the palm turns with the object, and the arm must follow."""

_EFFORT = 0.008  # displacement that is worth another push [m]
_ROUND_HEADINGS = np.radians(np.arange(-180.0, 180.0, 30.0))
_LOOKED_AT = 4  # poses of one push that must be free


@dataclass(frozen=True)
class Swing:
    """A push that turns the object: on which side, and by what angle [rad]."""

    side: Side
    angle: float

    def push(self, target: SeenObject, height: float = 0.0) -> TurningPush | None:
        """The push that does it best at a height; None if none does."""
        return best_turn(target.model, self.side.face, self.angle, height)

    def lateral(self, target: SeenObject) -> float:
        """Where along the face it is touched, from its middle [m]."""
        pushed, face = self.push(target), self.side.face
        assert pushed is not None, "it turns"
        return float((np.array(pushed.point) - face.centre) @ np.array(face.tangent))

    def left(self, target: SeenObject, share: float = 1.0) -> SeenObject:
        """The object after a share of the turn, as predicted."""
        pushed = best_turn(target.model, self.side.face, share * self.angle, 0.0)
        assert pushed is not None, "it turns by the whole angle"
        x, y, turned = pushed.pose
        p = target.pose.R_WB @ np.array([x, y, 0.0]) + target.pose.p_WB
        yaw = target.pose.yaw + turned
        return replace(target, pose=replace(target.pose, x=float(p[0]), y=float(p[1]), yaw=yaw))


def swings(target: SeenObject, turn: float, aim: Aim) -> Iterator[tuple[Swing, ...]]:
    """One push, or a pair on opposite sides, with which a turn may begin.

    Args:
        target: the object.
        turn: angle by which it has to turn [rad].
        aim: where it should be; what leaves it near to that with few pushes comes first.
    """
    least = max(math.ceil(abs(turn) / MOST), 1)
    found = []
    for number in (least, least + 1):
        for side in _sides(target):
            # Pairs stay where they are; an odd one first takes back what one before it did.
            steps, there = _steps(target, side, turn / number, 2 - number % 2)
            if steps:
                off = math.dist((aim.x, aim.y), (there.pose.x, there.pose.y))
                cost = round(off + _EFFORT * number, 4)
                found.append((cost, abs(side.heading), steps))
    for _, _, steps in sorted(found, key=lambda each: each[:2]):
        yield steps


def _steps(
    target: SeenObject, side: Side, angle: float, number: int
) -> tuple[tuple[Swing, ...], SeenObject]:
    """Pushes on a side and the one opposite to it in turn, and the object after them."""
    steps: tuple[Swing, ...] = ()
    for _ in range(number):
        step = Swing(side, angle)
        if step.push(target) is None:
            return (), target
        steps, target = (*steps, step), step.left(target)
        side = _opposite(side, target)
    return steps, target


def free(
    target: SeenObject,
    steps: tuple[Swing, ...],
    state: WorldState,
    clearances: dict[str, float],
    margin: float,
) -> str | None:
    """What the object would come too close to as it turns.

    Args:
        target: the object before.
        steps: its pushes.
        state: what is believed.
        clearances: distance kept from each other object [m].
        margin: distance kept from the table's edge [m].

    Returns:
        Name of another object, "table", or None if the turn is free.
    """
    for step in steps:
        for share in np.linspace(0.0, 1.0, _LOOKED_AT + 1)[1:]:
            here = footprint(step.left(target, float(share)))
            for name, apart in clearances.items():
                if gap(here, footprint(state.objects[name])) < apart:
                    return name
            for u in np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]):
                if travel_to_edge(here, state.table, u, margin) < 0.0:
                    return "table"
        target = step.left(target)
    return None


def _sides(target: SeenObject) -> list[Side]:
    """Sides of an object; of a round one some, evenly around it."""
    pose, model = target.pose, target.model
    headings = _ROUND_HEADINGS - pose.yaw if isinstance(model.base, Disc) else None
    return [_side(face, pose) for face in model.faces(headings)]


def _side(face: Face, pose: PlanarPose) -> Side:
    return Side(face, heading_of(-pose.R_WB @ np.array(face.normal)))


def _opposite(side: Side, target: SeenObject) -> Side:
    """The side that looks the other way in B, where the object is now."""
    normal = np.array(side.face.normal)
    headings = None
    if isinstance(target.model.base, Disc):
        headings = np.array([math.atan2(normal[1], normal[0])])
    faces = target.model.faces(headings)
    return _side(min(faces, key=lambda face: float(np.array(face.normal) @ normal)), target.pose)
