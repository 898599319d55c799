"""Candidates of a grasp: between two sides that look away from each other.

Model: the thumb touches one side, the other fingers the opposite one, on a line across. The
straight fingers come along the sides, level or from above, or askew where that does not do. A grip
is a pattern of contacts about its middle (`planner.types.robot.Grip`); all of them must lie on
the sides and between the heights at which the model may be touched. Along the sides the middle is
where the centre of mass is, so that the weight does not turn the object about the line across. A
knob or a cap is held from above, with the fingers around it.

Frame: B of the object.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.side_faces import Face
from objectmodels.geometry.side_press import FLAT, SidePress
from objectmodels.models.object_parts import LiftOffLid, ScrewCap
from planner.geometry.footprints import footprint, overlaps
from planner.problem.planning_problem import GraspProblem
from planner.refusals.refusal_builder import no_plan
from planner.refusals.refusal_marks import length_mark
from planner.types.marks import LengthMark
from planner.types.refusal import NoPlanError
from planner.types.robot import Grip, Robot
from planner.types.world_state import SeenObject, WorldState

_HEADINGS = np.radians(np.arange(0.0, 180.0, 22.5))  # in W, across which a round side is held
_BORDER = 0.004  # distance of a contact from the border of its side [m]
_OVER = 0.0015  # between fingertips and what a knob stands on [m]
_SQUARE = np.array([0.0, math.pi / 2.0])  # pitches at which the fingers come: level, from above
_ASKEW = np.radians([30.0, 45.0, 60.0])
_HEIGHTS = 3  # at which each side is tried
_UP = np.array([0.0, 0.0, 1.0])
_DOWN = -_UP
_LEVEL = np.array([1.0, 1.0, 0.0])


@dataclass(frozen=True, eq=False)
class Candidate:
    """A way to hold something.

    Attributes:
        part: `body`, or `lid`.
        middle: between thumb and fingers, p_BG, shape (3,) [m].
        closing: unit direction from the fingers' side to the thumb's, shape (3,).
        approach: unit direction of the straight fingers, shape (3,).
        width: between the sides [m].
        grip: how the hand closes about that width.
        press: of the outer fingertips on the sides.
    """

    part: Literal["body", "lid"]
    middle: Array
    closing: Array
    approach: Array
    width: float
    grip: Grip
    press: SidePress = FLAT

    def is_crowded(self, target: SeenObject, state: WorldState) -> bool:
        """Return True if something stands where the knuckles would be, as seen from above."""
        R_WB = target.pose.R_WB
        closing = (R_WB @ self.closing)[:2]
        across = np.array([-closing[1], closing[0]])
        at = (R_WB @ self.middle + target.pose.p_WB)[:2]
        fingers, thumb = (0.5 * self.width + room for room in self.grip.room)
        half = 0.5 * float(np.ptp(self.grip.contacts, axis=0).max()) + _BORDER
        swept = np.array(
            [
                at - fingers * closing - half * across,
                at + thumb * closing - half * across,
                at + thumb * closing + half * across,
                at - fingers * closing + half * across,
            ]
        )
        others = (seen for name, seen in state.objects.items() if name != target.name)
        low = float(self.middle[2])
        return any(
            seen.bulk()[1] > low and overlaps(swept, footprint(seen), 0.0) for seen in others
        )


@dataclass(frozen=True, eq=False)
class _Sides:
    """Two upright sides that look away from each other.

    Attributes:
        normal: outward unit normal of one of them, horizontal, shape (3,).
        along: ẑ × normal, shape (3,).
        middle: of the line across, shape (3,) at height 0 [m].
        width: between them [m].
        face: one of them.
        extent: between which they may be touched along `along`, from the middle [m].
    """

    normal: Array
    along: Array
    middle: Array
    width: float
    face: Face
    extent: tuple[float, float]


def body_candidates(problem: GraspProblem) -> list[Candidate]:
    """All ways to hold an object by its body.

    Raises:
        NoPlanError: there is none.
    """
    target, robot, asked = problem.target, problem.robot, problem.contact
    graspable = target.model.grasp
    if graspable is None:
        raise no_plan("not_graspable", object=target.name)
    low, high = max(graspable.lowest, asked.low), min(graspable.highest, asked.high)
    if low > high:
        numbers = {"lowest": graspable.lowest, "highest": graspable.highest}
        raise no_plan(
            "no_such_height", numbers, spans=asked.spans, object=target.name, region=asked.region
        )
    sides = list(_opposite_sides(target))
    grips = [(pair, robot.grasp(pair.width)) for pair in sides if _fits(pair.width, robot)]
    closing = [(pair, grip) for pair, grip in grips if grip is not None]
    if not closing:
        slimmest = sorted(sides, key=lambda pair: pair.width)[:1]
        marks = tuple(_width_mark(target, pair, 0.5 * (low + high), robot) for pair in slimmest)
        raise _not_that_wide(f"the {target.name}", [pair.width for pair in sides], robot, marks)
    found: list[Candidate] = []
    # Where neither level nor upright fingers find room, those that come down askew may.
    for pitches in (_SQUARE, _ASKEW):
        for pair, grip in closing:
            found += _candidates_about(target, pair, grip, (low, high), robot, pitches)
        if found:
            break
    else:
        code = "no_room_there" if asked.region else "no_room"
        numbers = {"lowest": low, "highest": high}
        raise no_plan(code, numbers, spans=asked.spans, object=target.name)
    return found


def lid_candidates(
    problem: GraspProblem, lid: LiftOffLid | ScrewCap, headings: Array = _HEADINGS
) -> list[Candidate]:
    """All ways to hold a lid by its knob or by its rim, from above.

    Args:
        problem: about the object that it is on.
        lid: what is held.
        headings: directions in W across which it may be held [rad].

    Raises:
        NoPlanError: the hand does not close about it, or it is too low for the fingers.
    """
    target, robot = problem.target, problem.robot
    radius, low, high = held_part(target, lid)
    grip = robot.grasp(2.0 * radius, pinch=True) if _fits(2.0 * radius, robot) else None
    if grip is None:
        raise _not_that_wide(f"the {target.name}'s lid", [2.0 * radius], robot)
    # The fingertips stay above what a knob stands on, and below its upper end.
    height = max(0.5 * (low + high), low + grip.ahead + _OVER)
    if height > high - _BORDER:
        numbers = {"height": high - low, "needed": grip.ahead + _OVER + _BORDER}
        raise no_plan("low_lid", numbers, object=target.name)
    middle = np.array([*lid_middle(target), height])
    both = np.concatenate((headings, headings + np.pi)) - target.pose.yaw
    return [
        Candidate("lid", middle, np.array([np.cos(a), np.sin(a), 0.0]), _DOWN, 2.0 * radius, grip)
        for a in both
    ]


def held_part(target: SeenObject, lid: LiftOffLid | ScrewCap) -> tuple[float, float, float]:
    """Radius, lowest and highest point of what a lid is held by [m]."""
    top = target.model.top
    if lid.kind == "screw":
        return lid.radius, top, top + lid.height
    return lid.knob_radius, top + lid.height, top + lid.height + lid.knob_height


def lid_middle(target: SeenObject) -> tuple[float, float]:
    """Middle of a lid in B, (x, y) [m]."""
    container = target.model.container
    return (0.0, 0.0) if container is None else container.opening.centre


def _grasp_widths(robot: Robot) -> tuple[float, float]:
    """Least and largest width that the hand holds [m]."""
    assert robot.limits.grasp_widths is not None, "a robot that only pushes plans no grasp"
    return robot.limits.grasp_widths


def _fits(width: float, robot: Robot) -> bool:
    narrowest, widest = _grasp_widths(robot)
    return narrowest <= width <= widest


def _not_that_wide(
    part: str, widths: list[float], robot: Robot, marks: tuple[LengthMark, ...] = ()
) -> NoPlanError:
    """Dead end since the hand does not close about an object, or about its lid."""
    if not widths:
        return no_plan("no_two_sides", part=part)
    narrowest, widest = _grasp_widths(robot)
    wide = min(widths) > widest
    width = min(widths) if wide else max(widths)
    numbers = {"width": width, "widest": widest, "narrowest": narrowest}
    return no_plan("too_wide" if wide else "too_narrow", numbers, marks=marks, part=part)


def _width_mark(target: SeenObject, pair: _Sides, height: float, robot: Robot) -> LengthMark:
    """The mark of the width between two sides, above the object's base [m]."""
    across = target.pose.R_WB @ pair.normal
    middle = target.pose.p_WB + target.pose.R_WB @ pair.middle + [0.0, 0.0, height]
    least, most = (1e3 * width for width in _grasp_widths(robot))
    text = f"{1e3 * pair.width:.0f} mm wide; the hand holds {least:.0f} to {most:.0f} mm"
    return length_mark(middle - 0.5 * pair.width * across, across, pair.width, text)


def _opposite_sides(target: SeenObject) -> Iterator[_Sides]:
    """Pairs of opposite sides; a round side is held across some directions."""
    faces = target.model.faces(_HEADINGS - target.pose.yaw)
    upright = [face for face in faces if abs(face.normal[2]) < 1e-9]
    for number, face in enumerate(upright):
        if face.curvature > 0.0:
            n = np.array(face.normal)
            axis = np.array(face.centre) - n / face.curvature
            half = 0.5 * face.width
            yield _Sides(
                n, np.array(face.tangent), axis * _LEVEL, 2 / face.curvature, face, (-half, half)
            )
            continue
        for other in upright[number + 1 :]:
            pair = _pair_of_sides(face, other)
            if pair is not None:
                yield pair


def _pair_of_sides(one: Face, other: Face) -> _Sides | None:
    """Two flat sides as a pair, if they look away from each other and face one another."""
    n, along = np.array(one.normal), np.array(one.tangent)
    if other.curvature or n @ np.array(other.normal) > -1.0 + 1e-6:
        return None
    a, b = np.array(one.centre), np.array(other.centre)
    low = max(face @ along - 0.5 * width for face, width in ((a, one.width), (b, other.width)))
    high = min(face @ along + 0.5 * width for face, width in ((a, one.width), (b, other.width)))
    if high <= low:
        return None
    across = 0.5 * (a @ n + b @ n)
    middle = across * n + 0.5 * (low + high) * along
    half = 0.5 * float(high - low) - _BORDER
    return _Sides(n, along, middle * _LEVEL, float((a - b) @ n), one, (-half, half))


def _candidates_about(
    target: SeenObject,
    pair: _Sides,
    grip: Grip,
    limits: tuple[float, float],
    robot: Robot,
    pitches: Array,
) -> Iterator[Candidate]:
    """All ways to hold a pair of sides between two heights, from beside not too low."""
    for closing, approach in product(
        (pair.normal, -pair.normal), _approach_directions(pair, pitches)
    ):
        offsets = grip.contacts @ np.array([approach, np.cross(approach, closing)])
        heights = _range_within(limits, offsets @ _UP)
        laterals = _range_within(pair.extent, offsets @ pair.along)
        if heights is None or laterals is None:
            continue
        if approach[2] == 0.0:
            heights = (max(heights[0], robot.limits.lowest_grasp), heights[1])
            if heights[0] > heights[1]:
                continue
        balanced = (np.array(target.model.com) - pair.middle) @ pair.along
        tip_radius = robot.limits.fingertip_radius
        press = SidePress.on_face(pair.face, closing, approach, grip.contacts, tip_radius)
        at = pair.middle + float(np.clip(balanced, *laterals)) * pair.along
        for height in np.unique(np.linspace(*heights, _HEIGHTS)):
            middle = at + height * _UP
            yield Candidate("body", middle, closing, approach, pair.width, grip, press)


def _approach_directions(pair: _Sides, pitches: Array) -> list[Array]:
    """Directions of the straight fingers, as steep as some pitches."""
    found = [
        math.cos(pitch) * along - math.sin(pitch) * _UP
        for pitch in pitches.tolist()
        for along in (pair.along, -pair.along)
        if pitch < math.pi / 2.0
    ]
    return [*found, _DOWN] if math.pi / 2.0 in pitches else found


def _range_within(limits: tuple[float, float], offsets: Array) -> tuple[float, float] | None:
    """Range of the middle of contacts all of which lie between limits; None if there is none."""
    low = limits[0] - float(offsets.min())
    high = limits[1] - float(offsets.max())
    return (low, high) if low <= high else None
