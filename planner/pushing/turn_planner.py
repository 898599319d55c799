"""Turning an object about the vertical: pushes off the middle of opposite sides by turns.

Model: each push turns the object about a pivot off its middle
(`objectmodels.mechanics.push_motion`), so that it is displaced as well; the next push, on the
opposite side, takes most of that back. Of some ways to part a turn (equal parts, or those of
`turn_parts`, whose displacements cancel) and of all sides to begin on, the one is taken that ends
nearest to where the object should be with few pushes. It is parted anew after each push, from where
the object is seen then.

A push turns the object about a pivot p of B, the same push on the opposite face about −p. Turning
by a, b and c on one face, the other, and the first again moves B's origin, with R the turn in the
plane, by

    (1 − 2 R(a) + 2 R(a + b) − R(a + b + c)) p

which vanishes for a = c and sin(b / 2) = sin((a + b + c) / 2) / 2, wherever the pivot is. So the
friction radius, which is known least, does not matter. Two such threes in a row share a push.

Frames: W, its table plane; pivots in B.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from objectmodels import Face
from objectmodels.mechanics.push_motion import TurningPush, best_turn
from planner.problem.directions import heading_of
from planner.problem.footprints import footprint, gap, room_to_edge
from planner.problem.planning_problem import Side
from planner.types.actions import Aim, Push
from planner.types.world_state import PlanarPose, SeenObject, WorldState

MOST = math.radians(52.0)
"""Largest turn by one push: the palm turns with the object, and the arm must follow."""

LARGEST_TURN = math.radians(90.0)
"""Largest turn by three pushes [rad]; the largest of them then turns by 49°."""

PAIRED_TURN = math.radians(15.0)
"""Largest turn by two pushes [rad]: they leave the object p · (turn / 2)² off, 2 mm."""

_SMALL = math.radians(20.0)  # turn whose pivot stands for all
_CORRECTION = 2.2, 0.1  # pushes that a correction takes, and one more for each so much way [m]
_ROUND_HEADINGS = np.radians(np.arange(-180.0, 180.0, 30.0))


@dataclass(frozen=True)
class TurnStroke:
    """A push that turns the object.

    Attributes:
        side: on which side.
        angle: by what angle, counter-clockwise [rad].
        pivot: about which point of B, (x, y) [m].
    """

    side: Side
    angle: float
    pivot: tuple[float, float]

    def push(self, target: SeenObject, height: float = 0.0) -> TurningPush:
        """The push that does it best at a height."""
        found = best_turn(target.model, self.side.face, self.angle, height)
        assert found is not None, "its side was chosen for that"
        return found

    def lateral(self, target: SeenObject) -> float:
        """Place along the face at which it is touched, from its middle [m]."""
        face = self.side.face
        return float((np.array(self.push(target).point) - face.centre) @ np.array(face.tangent))

    def target_after(self, target: SeenObject, share: float = 1.0) -> SeenObject:
        """The object after a share of the turn, as predicted."""
        pose, angle = target.pose, share * self.angle
        pivot, after = np.array(self.pivot), replace(pose, yaw=pose.yaw + angle)
        # The pivot stays where it is.
        x, y = (pose.p_WB + (pose.R_WB - after.R_WB) @ np.append(pivot, 0.0))[:2].tolist()
        return replace(target, pose=replace(after, x=x, y=y))


def turn_sequences(target: SeenObject, turn: float, aim: Aim) -> Iterator[tuple[TurnStroke, ...]]:
    """Ways to turn an object by an angle [rad], the one that leaves it nearest to its aim first."""
    sides = _turnable_sides(target, math.copysign(_SMALL, turn))
    found = []
    for parts, (number, side) in itertools.product(_turn_partings(turn), enumerate(sides)):
        steps = tuple(
            replace(each, angle=angle) for each, angle in zip(itertools.cycle(side), parts)
        )
        offs, there = [], target
        for step in steps:
            there = step.target_after(there)
            offs.append(math.dist((aim.x, aim.y), (there.pose.x, there.pose.y)))
        # An object so near to its place needs no further push [m].
        rest = 0.0 if offs[-1] < 0.004 else _CORRECTION[0] + offs[-1] / _CORRECTION[1]
        # On its way it had better stay near, too.
        # Way from its place on the way that counts as much as a push [m].
        cost = len(steps) + rest + max(offs) / 0.05
        found.append((round(cost, 3), abs(side[0].side.heading), number, steps))
    for *_, steps in sorted(found, key=lambda each: each[:3]):
        yield steps


def remaining_turn(
    target: SeenObject, turn: float, foreseen: tuple[Push, ...]
) -> tuple[TurnStroke, ...] | None:
    """The rest of a turn as it was foreseen, its parts scaled to what is left [rad].

    None if none of the foreseen pushes turns the object, or one would turn it too far.
    """
    parts = [*itertools.takewhile(lambda push: push.ends_on == "turned", foreseen)]
    whole = sum(push.turn for push in parts)
    if not parts or whole * turn <= 0.0:
        return None
    steps = []
    for push in parts:
        swing = _turn_stroke(_touched_side(target, push), target, push.turn * turn / whole)
        if swing is None or abs(swing.angle) > MOST:
            return None
        steps.append(swing)
    return tuple(steps)


def _touched_side(target: SeenObject, push: Push) -> Side:
    """The side that a push touches."""
    p = np.array(push.p_BC)
    headings = np.array([math.atan2(-p[1], -p[0])])
    faces = target.model.faces(headings if target.model.base.is_round else None)
    on = [abs(float((p - face.centre) @ np.array(face.normal))) for face in faces]
    beside = [abs(float((p - face.centre) @ np.array(face.tangent))) for face in faces]
    off = [o + max(b - 0.5 * f.width, 0.0) for o, b, f in zip(on, beside, faces, strict=True)]
    return _side_of_face(faces[int(np.argmin(off))], target.pose)


def _turn_partings(turn: float) -> list[tuple[float, ...]]:
    """Ways to part a turn, none of whose parts is too large."""
    least = max(math.ceil(abs(turn) / MOST), 1)
    parted = [(turn / n,) * n for n in (least, least + 1)]
    cancelling = turn_parts(turn)
    parted.append(cancelling)
    # What is left of one after its first push.
    rest = sum(cancelling[1:])
    parted.append(tuple(part * turn / rest for part in cancelling[1:]))
    return [parts for parts in dict.fromkeys(parted) if max(map(abs, parts)) <= MOST]


def turn_parts(angle: float) -> tuple[float, ...]:
    """Turns of alternating pushes on two opposite faces that leave the object in its place [rad].

    Args:
        angle: of the whole turn, counter-clockwise [rad].
    """
    if abs(angle) <= PAIRED_TURN:
        return (0.5 * angle, 0.5 * angle)
    threes = int(np.ceil(abs(angle) / LARGEST_TURN - 1e-9))
    whole = angle / threes
    middle = 2.0 * float(np.arcsin(0.5 * np.sin(0.5 * whole)))
    outer = 0.5 * (whole - middle)
    return (outer, *(middle, 2.0 * outer) * (threes - 1), middle, outer)


def _turnable_sides(target: SeenObject, angle: float) -> list[tuple[TurnStroke, TurnStroke]]:
    """Opposite sides on which a finger turns the object in a sense, each as the first once."""
    found = []
    # Of a round object some sides, evenly around it.
    pose, model = target.pose, target.model
    headings = _ROUND_HEADINGS - pose.yaw if model.base.is_round else None
    for side in [_side_of_face(face, pose) for face in model.faces(headings)]:
        pair = [_turn_stroke(each, target, angle) for each in (side, _opposite_side(side, target))]
        if pair[0] is not None and pair[1] is not None:
            found.append((pair[0], pair[1]))
    return found


def _turn_stroke(side: Side, target: SeenObject, angle: float) -> TurnStroke | None:
    pushed = best_turn(target.model, side.face, angle, 0.0)
    if pushed is None:
        return None
    x, y, turned = pushed.pose
    across = 1.0 / math.tan(0.5 * turned)
    return TurnStroke(side, angle, (0.5 * (x - across * y), 0.5 * (y + across * x)))


def turn_obstacle(
    target: SeenObject,
    steps: tuple[TurnStroke, ...],
    state: WorldState,
    clearances: dict[str, float],
    margin: float,
) -> str | None:
    """Obstacle that the object would come too close to as it turns.

    Args:
        target: the object before.
        steps: its pushes.
        state: what is believed.
        clearances: distance kept from each other object [m].
        margin: distance kept from the table's edge [m].

    Returns:
        Name of another object, "table", or None if the turn is free.
    """
    names, apart = list(clearances), np.array(list(clearances.values()))[:, None]
    others = [footprint(state.objects[name]) for name in names]
    low = np.array([other.min(axis=0) for other in others]).reshape(-1, 2) - apart
    high = np.array([other.max(axis=0) for other in others]).reshape(-1, 2) + apart
    for step in steps:
        for share in np.linspace(0.25, 1.0, 4):  # poses of one push that must be free
            here = footprint(step.target_after(target, float(share)))
            # What is farther off along an axis is farther off.
            near = ((low <= here.max(axis=0)) & (here.min(axis=0) <= high)).all(axis=1)
            for k in np.flatnonzero(near).tolist():
                if gap(here, others[k]) < clearances[names[k]]:
                    return names[k]
            if room_to_edge(here, state.table, margin) < 0.0:
                return "table"
        target = step.target_after(target)
    return None


def _side_of_face(face: Face, pose: PlanarPose) -> Side:
    return Side(face, heading_of(-pose.R_WB @ np.array(face.normal)))


def _opposite_side(side: Side, target: SeenObject) -> Side:
    """The side that looks the other way in B."""
    normal = np.array(side.face.normal)
    headings = None
    if target.model.base.is_round:
        headings = np.array([math.atan2(normal[1], normal[0])])
    faces = target.model.faces(headings)
    return _side_of_face(
        min(faces, key=lambda face: float(np.array(face.normal) @ normal)), target.pose
    )
