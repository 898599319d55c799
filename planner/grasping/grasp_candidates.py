"""Candidates of a grasp: between two sides that look away from each other.

Model: the thumb touches one side, the other fingers the opposite one, on a line across. The
straight fingers come along the sides, level or from above, or askew where that does not do. A
grip is a pattern of contacts about its middle (`planner.types.robot.Grip`); all of them must
lie on the sides, between the heights that the model's file prefers, or anywhere where that does
not do or the file says none. Sides may lean a little, as those of a hull do: such a wedge takes
a part of the friction. Along the sides the middle is where the centre of mass is, so that the
weight does not turn the object about the line across. A knob or a cap is held from above, by
fingers around it.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, product
from typing import Literal

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.rotations import left_of, spatial_cross
from objectmodels.geometry.side_faces import FLAT, Face, SidePress
from objectmodels.models.object_parts import LiftOffLid, ScrewCap
from objectmodels.safety_figure import SafetyFigure
from planner.problem.footprints import footprint, overlaps
from planner.problem.planning_problem import GraspProblem
from planner.refusals.blocked import Blocked, dead_end, length_mark
from planner.types.robot import Grip, Robot
from planner.types.world_state import LengthMark, SeenObject, WorldState

_HEADINGS = np.radians(np.arange(0.0, 180.0, 22.5))  # in W, across which a round side is held
_BORDER: SafetyFigure = 0.004  # distance of a contact from the border of its side [m]
_OVER = 0.0015  # between fingertips and what a knob stands on [m]
_SQUARE = np.array([0.0, math.pi / 2.0])  # pitches at which the fingers come: level, from above
_ASKEW = np.radians([30.0, 45.0, 60.0])
_LOW = 0.1  # what is lower is held up to its rim, too: the fingers stay over the table [m]
_HEIGHTS = 3  # at which each side is tried
_LEANING = math.sin(math.radians(10.0))  # a side leans no more if it is to be held
_OPPOSITE = math.cos(math.radians(20.0))  # sides that look away from each other at least so
_UPRIGHT = 1e-6  # of normals that differ by rounding alone
_OFF_BALANCE = (0.0, 0.01, 0.02)  # before the centre of mass, where it is too deep there [m]
_DEPTHS = 0.005  # between those for which room is made [m]
_UP, _LEVEL = np.array([0.0, 0.0, 1.0]), np.array([1.0, 1.0, 0.0])
_DOWN = -_UP


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
        depth: as of `planner.types.actions.Grasp` [m].
    """

    part: Literal["body", "lid"]
    middle: Array
    closing: Array
    approach: Array
    width: float
    grip: Grip
    press: SidePress = FLAT
    depth: float = 0.0

    def is_crowded(self, target: SeenObject, state: WorldState) -> bool:
        """Return True if something stands where the knuckles would be, as seen from above."""
        R_WB = target.pose.R_WB
        closing = (R_WB @ self.closing)[:2]
        across = left_of(closing)
        at = (R_WB @ self.middle + target.pose.p_WB)[:2]
        fingers, thumb = (0.5 * self.width + room for room in self.grip.room)
        half = 0.5 * float(np.ptp(self.grip.contacts, axis=0).max()) + _BORDER
        first, last = at - fingers * closing, at + thumb * closing
        side = half * across
        swept = np.array([first - side, last - side, last + side, first + side])
        (x, y), around = (0.5 * (first + last)).tolist(), math.hypot(0.5 * (fingers + thumb), half)
        low = target.pose.z + float(self.middle[2])
        return any(
            seen.top_height > low
            and seen.is_within(around, x, y)
            and overlaps(swept, footprint(seen), 0.0)
            for name, seen in state.objects.items()
            if name != target.name
        )


@dataclass(frozen=True, eq=False)
class _Sides:
    """Two sides that look away from each other, nearly upright.

    Attributes:
        normal: unit direction across, outward of one of them, horizontal, shape (3,).
        along: ẑ × normal, shape (3,).
        middle: of the line across, shape (3,) at height 0 [m].
        width: between them [m].
        faces: the two; of a round side one.
        extent: between which they may be touched along `along`, from the middle [m].
        heights: between which they are so wide [m].
        wedge: largest angle between a side's normal and the direction across [rad].
    """

    normal: Array
    along: Array
    middle: Array
    width: float
    faces: tuple[Face, ...]
    extent: tuple[float, float]
    heights: tuple[float, float]
    wedge: float = 0.0

    def press(self, closing: Array, approach: Array, contacts: Array, tip: float) -> SidePress:
        """Press of the fingertips, as `SidePress.on_face` has it."""
        if self.wedge > _UPRIGHT:
            return SidePress(0.0, 0.0, math.cos(self.wedge), 0.0, math.sin(self.wedge))
        return SidePress.on_face(self.faces[0], closing, approach, contacts, tip)

    def carry(self, places: Array) -> bool:
        """Return True if places, shape (k, 3) [m], lie on both sides, whatever their outline."""
        return all(
            bool(face.contains((places - face.centre) @ face.tangent, places[:, 2], _BORDER).all())
            for face in self.faces
            if face.outline is not None
        )


def body_candidates(problem: GraspProblem) -> Iterator[list[Candidate]] | Blocked:
    """Ways to hold an object by its body, in groups: one is looked at if those before do not do.

    First come those where its file prefers it, then those anywhere on its sides; each square, then
    askew; then those by a hand that makes room for something deep, at last those up to a low rim.
    """
    target, asked = problem.target, problem.contact
    sides = _sides_within(problem)
    if isinstance(sides, Blocked):
        return sides
    stated, tip = target.model.grasp, problem.robot.limits.fingertip_radius
    anywhere = (tip, target.model.top - tip)
    ranges = [anywhere]
    if stated is not None:
        ranges = [(max(stated.lowest, tip), min(stated.highest, anywhere[1])), anywhere]
    ways = [(limits, how, False) for limits, how in product(ranges, (_SQUARE, _ASKEW))]
    ways.append((anywhere, _SQUARE, True))
    if target.model.top < _LOW:
        ways += [((tip, target.model.top - _BORDER), how, False) for how in (_SQUARE, _ASKEW)]
    found = (
        [
            candidate
            for pair in sides
            for candidate in _candidates_about(
                problem, pair, (max(low, asked.low), min(high, asked.high)), pitches, deep=deep
            )
        ]
        for (low, high), pitches, deep in ways
    )
    groups = filter(None, found)
    first = next(groups, None)
    if first is not None:
        return chain([first], groups)
    code = "no_room_there" if asked.region else "no_room"
    numbers = {"lowest": max(anywhere[0], asked.low), "highest": min(anywhere[1], asked.high)}
    return dead_end(code, numbers, spans=asked.spans, object=target.name)


def _sides_within(problem: GraspProblem) -> list[_Sides] | Blocked:
    """Pairs of opposite sides about which the hand closes."""
    target, robot = problem.target, problem.robot
    sides = list(_opposite_sides(target))
    closing = [pair for pair in sides if _fits(pair.width, robot) and robot.grasp(pair.width)]
    if not closing:
        slimmest = sorted(sides, key=lambda pair: pair.width)[:1]
        marks = tuple(_width_mark(target, pair, robot) for pair in slimmest)
        return _not_that_wide(f"the {target.name}", [pair.width for pair in sides], robot, marks)
    return closing


def lid_candidates(problem: GraspProblem, lid: LiftOffLid | ScrewCap) -> list[Candidate] | Blocked:
    """All ways to hold a lid by its knob or by its rim, from above.

    Args:
        problem: about the object that it is on.
        lid: what is held.
    """
    target, robot = problem.target, problem.robot
    radius, low, high = held_part(target, lid)
    grip = robot.grasp(2.0 * radius, pinch=True) if _fits(2.0 * radius, robot) else None
    if grip is None:
        return _not_that_wide(f"the {target.name}'s lid", [2.0 * radius], robot)
    # The fingertips stay above what a knob stands on, and below its upper end.
    height = max(0.5 * (low + high), low + grip.ahead + _OVER)
    if height > high - _BORDER:
        numbers = {"height": high - low, "needed": grip.ahead + _OVER + _BORDER}
        return dead_end("low_lid", numbers, object=target.name)
    middle = np.array([*lid_middle(target), height])
    both = np.concatenate((_HEADINGS, _HEADINGS + np.pi)) - target.pose.yaw
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
) -> Blocked:
    """Dead end since the hand does not close about an object, or about its lid."""
    if not widths:
        return dead_end("no_two_sides", part=part)
    narrowest, widest = _grasp_widths(robot)
    wide = min(widths) > widest
    width = min(widths) if wide else max(widths)
    numbers = {"width": width, "widest": widest, "narrowest": narrowest}
    return dead_end("too_wide" if wide else "too_narrow", numbers, marks=marks, part=part)


def _width_mark(target: SeenObject, pair: _Sides, robot: Robot) -> LengthMark:
    """The mark of the width between two sides, half-way up where it may be held [m]."""
    stated = target.model.grasp
    height = 0.5 * (target.model.top if stated is None else stated.lowest + stated.highest)
    across = target.pose.R_WB @ pair.normal
    middle = target.pose.p_WB + target.pose.R_WB @ pair.middle + [0.0, 0.0, height]
    least, most = (1e3 * width for width in _grasp_widths(robot))
    text = f"{1e3 * pair.width:.0f} mm wide; the hand holds {least:.0f} to {most:.0f} mm"
    return length_mark(middle - 0.5 * pair.width * across, across, pair.width, text)


def _opposite_sides(target: SeenObject) -> Iterator[_Sides]:
    """Pairs of opposite sides, each once; a round side is held across some directions."""
    model = target.model
    headings = np.concatenate((_HEADINGS, _HEADINGS + math.pi)) - target.pose.yaw
    faces = [face for face in model.faces(headings) if abs(face.normal[2]) <= _LEANING]
    round_ones: list[Array] = []
    for number, face in enumerate(faces):
        n = np.array(face.normal)
        if face.curvature == 0.0:
            pairs = (_pair_of_sides(face, other) for other in faces[number + 1 :])
            yield from (pair for pair in pairs if pair is not None)
        elif not any(n @ other < _UPRIGHT - 1.0 for other in round_ones):
            round_ones.append(n)
            axis = np.array(face.centre) - n / face.curvature
            half = 0.5 * face.width
            yield _Sides(
                n,
                np.array(face.tangent),
                axis * _LEVEL,
                2 / face.curvature,
                (face,),
                (-half, half),
                (face.bottom, face.top),
            )


def _pair_of_sides(one: Face, other: Face) -> _Sides | None:
    """Two flat sides as a pair, if they look away from each other and face one another."""
    n, m = np.array(one.normal), np.array(other.normal)
    if other.curvature or n @ m > -_OPPOSITE:
        return None
    across = (n - m) * _LEVEL
    across /= np.linalg.norm(across)
    along = spatial_cross(_UP, across)
    low, high = max(one.bottom, other.bottom), min(one.top, other.top)
    steep = math.hypot(n[2], m[2])
    if steep > _UPRIGHT:
        # Leaning sides are so wide in the middle between their ends, and nearly so around it.
        around = 0.002 / steep  # half of what the width between leaning sides may change by [m]
        low, high = max(low, 0.5 * (low + high) - around), min(high, 0.5 * (low + high) + around)
    spans = [(each.centre @ along, 0.5 * each.width) for each in (one, other)]
    left, right = max(at - half for at, half in spans), min(at + half for at, half in spans)
    if right <= left or high <= low:
        return None
    a, b = (face.points_at(0.0, 0.5 * (low + high))[0] for face in (one, other))
    middle = 0.5 * float(a @ across + b @ across) * across + 0.5 * (left + right) * along
    half = 0.5 * float(right - left) - _BORDER
    width = float((a - b) @ across)
    wedge = float(np.arccos(np.clip(min(n @ across, -(m @ across)), -1.0, 1.0)))
    return _Sides(
        across, along, middle * _LEVEL, width, (one, other), (-half, half), (low, high), wedge
    )


def _candidates_about(
    problem: GraspProblem, pair: _Sides, limits: tuple[float, float], pitches: Array, *, deep: bool
) -> Iterator[Candidate]:
    """All ways to hold a pair of sides between two heights.

    A deep object is held where the hand makes room, nearer to the palm than in balance if it must.
    """
    target, robot = problem.target, problem.robot
    usual = robot.grasp(pair.width)
    assert usual is not None, "the hand closes about it"
    for closing, approach in product(
        (pair.normal, -pair.normal), _approach_directions(pair, pitches)
    ):
        for off in _OFF_BALANCE if deep else _OFF_BALANCE[:1]:
            for middle in _middles(problem, pair, usual, (closing, approach), limits, off):
                depth = _depth_before(target, middle, approach) if deep else 0.0
                grip = robot.grasp(pair.width, depth=depth) if deep else usual
                if grip is None:
                    continue
                press = pair.press(closing, approach, grip.contacts, robot.limits.fingertip_radius)
                yield Candidate("body", middle, closing, approach, pair.width, grip, press, depth)


def _middles(
    problem: GraspProblem,
    pair: _Sides,
    grip: Grip,
    ways: tuple[Array, Array],
    limits: tuple[float, float],
    off: float,
) -> Iterator[Array]:
    """Middles of grasps whose contacts lie on both sides, from beside not too low.

    Args:
        problem: whose object it is.
        pair: sides between which it is held.
        grip: of the hand.
        ways: closing and approach.
        limits: heights between which it may be touched [m].
        off: how far before the balance they are, as the fingers come [m].
    """
    closing, approach = ways
    low, high = max(limits[0], pair.heights[0]), min(limits[1], pair.heights[1])
    offsets = grip.contacts @ np.array([approach, spatial_cross(approach, closing)])
    heights = _range_within((low, high), offsets @ _UP)
    laterals = _range_within(pair.extent, offsets @ pair.along)
    if heights is None or laterals is None:
        return
    if approach[2] == 0.0:
        heights = (max(heights[0], problem.robot.limits.lowest_grasp), heights[1])
        if heights[0] > heights[1]:
            return
    balanced = (np.array(problem.target.model.com) - pair.middle - off * approach) @ pair.along
    at = pair.middle + float(np.clip(balanced, *laterals)) * pair.along
    for height in np.unique(np.linspace(*heights, _HEIGHTS)):
        if pair.carry(at + height * _UP + offsets):
            yield at + height * _UP


def _depth_before(target: SeenObject, middle: Array, approach: Array) -> float:
    """How far the object reaches towards the palm from the middle of a grasp, rounded up [m]."""
    corners = [(x, y, z) for z in (0.0, target.model.top) for x, y in target.model.outline]
    before = float(((middle - corners) @ approach).max())
    return math.ceil(before / _DEPTHS) * _DEPTHS


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
