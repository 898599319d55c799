"""Grasps that hold, the best first.

Model: the hand squeezes harder than what just holds by a reserve, and as hard as the worst case of
what is believed takes, if it can; that must be likely enough to hold, and the object to hang
upright in it. Of several grasps the one with most squeeze to spare comes first.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, Literal

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.rotations import axis_rotation, left_of, spatial_cross
from objectmodels.geometry.side_faces import FLAT, Face, SidePress
from objectmodels.mechanics.grasp_stability import Contacts, Lifted, least_squeezes
from objectmodels.mechanics.push_outcomes import normal_cdf
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.object_parts import LiftOffLid, ScrewCap
from planner.problem.footprints import footprint, overlaps
from planner.problem.planning_problem import GraspProblem
from planner.refusals.no_plan import length_mark, no_plan
from planner.types.actions import Grasp
from planner.types.refusal import NoPlanError
from planner.types.robot import Grip, Robot
from planner.types.world_state import LengthMark, SeenObject, WorldState, plain_vector

# Candidates of a grasp: between two sides that look away from each other.
#
# Model: the thumb touches one side, the other fingers the opposite one, on a line across. The
# straight fingers come along the sides, level or from above, or askew where that does not do. A
# grip is a pattern of contacts about its middle (`planner.types.robot.Grip`); all of them must
# lie on the sides, between the heights that the model's file prefers, or anywhere where that does
# not do or the file says none. Sides may lean a little, as those of a hull do: such a wedge takes
# a part of the friction. Along the sides the middle is where the centre of mass is, so that the
# weight does not turn the object about the line across. A knob or a cap is held from above, by
# fingers around it.

_HEADINGS = np.radians(np.arange(0.0, 180.0, 22.5))  # in W, across which a round side is held
_BORDER = 0.004  # distance of a contact from the border of its side [m]
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


def body_candidates(problem: GraspProblem) -> Iterator[list[Candidate]]:
    """Ways to hold an object by its body, in groups: one is looked at if those before do not do.

    First come those where its file prefers it, then those anywhere on its sides; each square, then
    askew; then those by a hand that makes room for something deep, at last those up to a low rim.

    Raises:
        NoPlanError: there is none.
    """
    target, asked = problem.target, problem.contact
    sides = _sides_within(problem)
    stated, tip = target.model.grasp, problem.robot.limits.fingertip_radius
    anywhere = (tip, target.model.top - tip)
    ranges = [anywhere]
    if stated is not None:
        ranges = [(max(stated.lowest, tip), min(stated.highest, anywhere[1])), anywhere]
    ways = [(limits, how, False) for limits, how in product(ranges, (_SQUARE, _ASKEW))]
    ways.append((anywhere, _SQUARE, True))
    if target.model.top < _LOW:
        ways += [((tip, target.model.top - _BORDER), how, False) for how in (_SQUARE, _ASKEW)]
    none = True
    for (low, high), pitches, deep in ways:
        limits = (max(low, asked.low), min(high, asked.high))
        about = (_candidates_about(problem, pair, limits, pitches, deep=deep) for pair in sides)
        found = [candidate for each in about for candidate in each]
        if found:
            none = False
            yield found
    if none:
        code = "no_room_there" if asked.region else "no_room"
        numbers = {"lowest": max(anywhere[0], asked.low), "highest": min(anywhere[1], asked.high)}
        raise no_plan(code, numbers, spans=asked.spans, object=target.name)


def _sides_within(problem: GraspProblem) -> list[_Sides]:
    """Pairs of opposite sides about which the hand closes.

    Raises:
        NoPlanError: there is none.
    """
    target, robot = problem.target, problem.robot
    sides = list(_opposite_sides(target))
    closing = [pair for pair in sides if _fits(pair.width, robot) and robot.grasp(pair.width)]
    if not closing:
        slimmest = sorted(sides, key=lambda pair: pair.width)[:1]
        marks = tuple(_width_mark(target, pair, robot) for pair in slimmest)
        raise _not_that_wide(f"the {target.name}", [pair.width for pair in sides], robot, marks)
    return closing


def lid_candidates(problem: GraspProblem, lid: LiftOffLid | ScrewCap) -> list[Candidate]:
    """All ways to hold a lid by its knob or by its rim, from above.

    Args:
        problem: about the object that it is on.
        lid: what is held.

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
) -> NoPlanError:
    """Dead end since the hand does not close about an object, or about its lid."""
    if not widths:
        return no_plan("no_two_sides", part=part)
    narrowest, widest = _grasp_widths(robot)
    wide = min(widths) > widest
    width = min(widths) if wide else max(widths)
    numbers = {"width": width, "widest": widest, "narrowest": narrowest}
    return no_plan("too_wide" if wide else "too_narrow", numbers, marks=marks, part=part)


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


# How far something leans that a hand holds.
#
# Model: the fingertips stick, and their springs give way. About the closing direction they resist
# a turn with a stiffness K; the others they hardly allow. The weight m g acts at the centre of
# mass, e beside the line across, to its left, and h above it, so that it leans by −φ: K φ = m g
# (e + h φ). What is not known of mass and centre of mass counts to first order; all else is
# `HAND_LEAN`.

HAND_LEAN = math.radians(1.2)
"""Standard deviation of a lean by what is not in the model, as simulated lifts have it [rad]."""


@dataclass(frozen=True)
class Lean:
    """Lean about the closing direction, and its standard deviation [rad]; infinite if it tips."""

    angle: float
    sd: float

    @classmethod
    def of_grasp(cls, model: ObjectModel, candidate: Candidate) -> Lean:
        """The lean of an object that hangs in a hand."""
        off = np.array(model.com) - candidate.middle
        closing = candidate.closing
        beside = np.array([-closing[1], closing[0], 0.0])
        weight = model.weight
        holds = candidate.grip.stiffness - weight * float(off[2])
        if holds <= 0.0:
            return cls(math.inf, math.inf)
        angle = 0.0 - weight * float(off @ beside) / holds
        by_place = weight * math.hypot(*(beside * model.com_sd)) / holds
        by_mass = angle * model.mass_sd / model.mass
        return cls(angle, math.hypot(by_place, by_mass, HAND_LEAN))

    def probability_within(self, most: float) -> float:
        """Probability that it leans by no more than an angle [rad]."""
        if math.isinf(self.sd):
            return 0.0
        ends = (np.array([most, -most]) - self.angle) / self.sd
        within, below = normal_cdf(ends).tolist()
        return float(within - below)


_PATCH = np.array([[0.0, 0.0], [0.0, 0.004], [0.0, -0.004]])  # contacts at a knob [m]
_TILTS = 8  # at which a motion is looked at

ACCELERATION = 1.0
"""Of what is lifted and carried slowly, with what makes it tremble [m/s²]."""


@dataclass(frozen=True)
class Load:
    """Load of a hand that is not the object's weight.

    Attributes:
        force: downwards [N].
        force_sd: its standard deviation [N].
    """

    force: float
    force_sd: float = 0.0


@dataclass(frozen=True, eq=False)
class GraspLoad:
    """A grasp, and what it has to bear.

    Attributes:
        candidate: the grasp.
        load: that hangs on it; the object's weight if None.
        lean: direction in B in which it is tilted [rad].
        angle: how far [rad].
        turned: rotation vector, in B, of a turn about whatever axis, (3,) [rad]; None of a tilt.
    """

    candidate: Candidate
    load: Load | None = None
    lean: float = 0.0
    angle: float = 0.0
    turned: Array | None = None

    @property
    def down(self) -> Array:
        """Directions of its weight in B on its way, shape (k, 3)."""
        if self.turned is not None:
            angle = float(np.linalg.norm(self.turned))
            R = axis_rotation(self.turned / angle, np.linspace(0.0, angle, _TILTS))
            return -R[:, 2]
        tilts = np.linspace(0.0, self.angle, _TILTS) if self.angle else np.zeros(1)
        ahead, ones = np.sin(tilts), np.ones(len(tilts))
        return np.stack(
            [ahead * math.cos(self.lean), ahead * math.sin(self.lean), -np.cos(tilts) * ones], -1
        )

    def lifted_object(self, model: ObjectModel) -> Lifted:
        """It in the hand, through its motion."""
        each = self.candidate
        closing, approach, contacts = each.closing, each.approach, each.grip.contacts
        shares = each.grip.shares
        # The fingers have slipped, as far as that is known: what creeps must still hold.
        borne = model.model_copy(update={"finger_friction": friction(model)})
        if self.load is not None:
            force = {"mass": self.load.force / GRAVITY, "mass_sd": self.load.force_sd / GRAVITY}
            borne = borne.model_copy(update=force)
        if each.part == "lid":
            # The fingers around a knob do not keep it from swinging until its weight is below.
            borne = borne.model_copy(update={"com": tuple(each.middle), "com_sd": (0.0, 0.0, 0.0)})
            contacts, shares = _PATCH, np.array([1.0, 0.5, 0.5])
        R_BG = np.column_stack([closing, spatial_cross(approach, closing), approach])
        grasp = Contacts(contacts, shares, each.press)
        return Lifted(borne, grasp, each.middle, R_BG, self.down, ACCELERATION)


@dataclass(frozen=True, eq=False)
class StableGrasp:
    """A grasp that holds.

    Attributes:
        grasp: as a plan states it.
        probability: that it holds, and hangs upright.
        lean: direction in B in which it holds while it is tilted [rad]; None if any will do.
        hangs: how the object leans in it; None if it is held already, or is a lid.
        turned: as of `GraspLoad`, for which it holds.
    """

    grasp: Grasp
    probability: float
    lean: float | None = None
    hangs: Lean | None = None
    turned: Array | None = None


def held_already(problem: GraspProblem) -> list[StableGrasp]:
    """The grasp in which the hand holds it; none if it holds nothing."""
    held = problem.state.held
    return [] if held is None else [StableGrasp(held.grasp, 1.0)]


def stable_grasps(problem: GraspProblem, bearings: Sequence[GraspLoad]) -> list[StableGrasp]:
    """The grasps that hold, those with most squeeze to spare first.

    Raises:
        NoPlanError: none does.
    """
    d, known = problem.defaults, _GraspBeliefs(problem.target.model)
    just, worst = known.squeezes_needed(bearings)
    wanted = problem.force.reserve * just
    limit = np.array([strongest(problem, each.candidate) for each in bearings])
    spare = limit / wanted
    if not (spare >= 1.0).any():
        best = int(spare.argmax())
        needed = float(wanted[best])
        if math.isinf(needed):
            numbers = {
                "needed_friction": known.friction_needed(bearings),
                "friction": friction(problem.target.model),
            }
            doing, name = problem.goal.doing, problem.target.name
            raise no_plan("no_squeeze_holds", numbers, doing=doing, object=name)
        if known.probability(bearings[best], needed) < d.probability:
            needed = _free_squeeze(problem, bearings) or needed
        raise _too_heavy(problem, bearings[best].candidate, needed)
    squeeze = np.minimum(np.maximum(wanted, worst), limit)
    probability = np.array(
        [known.probability(*each) for each in zip(bearings, squeeze, strict=True)]
    )
    unsure = probability < d.probability
    # Where the belief is uncertain, more squeeze may do.
    squeeze[unsure] = limit[unsure]
    for i in np.flatnonzero(unsure & (spare >= 1.0)).tolist():
        probability[i] = known.probability(bearings[i], squeeze[i])
    leans = [_lean(problem, each.candidate) for each in bearings]
    upright = np.array([1.0 if u is None else u.probability_within(d.upright) for u in leans])
    holds = (spare >= 1.0) & (probability >= d.probability)
    probability = np.maximum(probability + upright - 1.0, 0.0)
    good = holds & (probability >= d.probability)
    if holds.any() and not good.any():
        raise _hangs_askew(problem, [leans[i] for i in np.flatnonzero(holds)])
    if not good.any():
        best = int(np.where(spare >= 1.0, probability, -1.0).argmax())
        raise _may_slip(problem, bearings, best, float(squeeze[best]), float(probability[best]))
    order = _order(problem, bearings, upright, spare)
    return [
        StableGrasp(
            _grasp_value(problem, bearings[i].candidate, float(squeeze[i]), float(just[i])),
            float(probability[i]),
            bearings[i].lean if bearings[i].angle else None,
            leans[i],
            bearings[i].turned,
        )
        for i in order
        if good[i]
    ]


def _order(
    problem: GraspProblem, bearings: Sequence[GraspLoad], upright: Array, spare: Array
) -> list[int]:
    """Indices of the grasps: with room, upright and with squeeze to spare first."""
    candidates = [each.candidate for each in bearings]
    crowded = [each.is_crowded(problem.target, problem.state) for each in candidates]
    # Height does not matter to a hold; in the middle there is most room for the hand.
    heights = np.array([each.middle[2] for each in candidates])
    off = np.abs(heights - 0.5 * (heights.min() + heights.max()))
    # Except for a hand that comes down askew: its palm is low, which counts before any squeeze.
    steep = np.array([-each.approach[2] for each in candidates])
    askew = (steep > 0.0) & (steep < 1.0)
    low = np.where(askew, heights.max() - heights, 0.0)
    keys = np.array([off, -spare.round(2), -upright.round(3), low, crowded])
    return [int(i) for i in np.lexsort(keys)]


def _may_slip(
    problem: GraspProblem,
    bearings: Sequence[GraspLoad],
    best: int,
    squeeze: float,
    probability: float,
) -> NoPlanError:
    """Dead end since even the best of the grasps is not sure enough."""
    if free := _free_squeeze(problem, bearings):
        return _too_heavy(problem, bearings[best].candidate, free)
    found_to = problem.defaults.found_to
    learn, then = _best_experiment(problem.target.model, bearings[best], squeeze, found_to)
    numbers = {
        "squeeze": squeeze,
        "probability": probability,
        "probability_then": then,
        "asked_probability": problem.effort.probability,
    }
    return no_plan("may_slip", numbers, object=problem.target.name, learn=learn)


def _lean(problem: GraspProblem, candidate: Candidate) -> Lean | None:
    """How an object leans in a grasp; None of a lid."""
    return Lean.of_grasp(problem.target.model, candidate) if candidate.part == "body" else None


def _hangs_askew(problem: GraspProblem, leans: Sequence[Lean | None]) -> NoPlanError:
    """Dead end since the object would lean in every grasp that holds it."""
    most = problem.defaults.upright
    known = [lean for lean in leans if lean is not None]
    best = max(known, key=lambda lean: lean.probability_within(most))
    numbers = {
        "lean": abs(best.angle),
        "lean_sd": best.sd,
        "upright": most,
        "probability": best.probability_within(most),
    }
    return no_plan("hangs_askew", numbers, doing=problem.goal.doing, object=problem.target.name)


def _free_squeeze(problem: GraspProblem, bearings: Sequence[GraspLoad]) -> float | None:
    """Squeeze with which it would be held if the sentence allowed any [N]; None if it would not."""
    if math.isinf(problem.force.max):
        return None
    free = replace(problem, force=replace(problem.force, max=math.inf))
    with suppress(NoPlanError):
        return stable_grasps(free, bearings)[0].grasp.squeeze
    return None


def _too_heavy(problem: GraspProblem, candidate: Candidate, wanted: float) -> NoPlanError:
    """Dead end since it takes more squeeze than there is."""
    model, has, force = problem.target.model, candidate.grip.strongest, problem.force
    numbers = {"needed_force": wanted, "strongest": has, "friction": friction(model)}
    words: dict[str, Any] = {
        "doing": problem.goal.doing,
        "object": problem.target.name,
        "width": candidate.width,
    }
    crush = _crush_force(model, candidate)
    if force.max <= min(has, crush) and wanted <= min(has, crush):
        numbers = {"allowed_force": force.max, **numbers}
        return no_plan("squeeze_not_allowed", numbers, spans=force.spans, **words)
    if crush < has:
        return no_plan("bears_no_squeeze", {"crush": crush, **numbers}, **words)
    return no_plan("squeeze_not_there", numbers, **words)


def strongest(problem: GraspProblem, candidate: Candidate) -> float:
    """Largest squeeze that hand, object and sentence allow [N]."""
    crush = _crush_force(problem.target.model, candidate)
    return min(candidate.grip.strongest, problem.force.max, crush)


def _crush_force(model: ObjectModel, candidate: Candidate) -> float:
    """Squeeze that an object bears [N]; a lid bears any."""
    return math.inf if model.grasp is None or candidate.part == "lid" else model.grasp.crush


class _GraspBeliefs:
    """Beliefs about grasps; those that differ by a turn only are computed once."""

    def __init__(self, model: ObjectModel) -> None:
        self._model = model
        self._keyed: dict[GraspLoad, tuple[bytes, Lifted]] = {}
        self._likely: dict[bytes, float] = {}

    def squeezes_needed(self, bearings: Sequence[GraspLoad]) -> tuple[Array, Array]:
        """Squeezes with everything as believed, and in the worst case, each shape (n,) [N]."""
        distinct: dict[bytes, Lifted] = {}
        for key, each in map(self._key_and_object, bearings):
            distinct.setdefault(key, each)
        where = {key: i for i, key in enumerate(distinct)}
        needed, worst = least_squeezes(tuple(distinct.values()))
        at = [where[self._key_and_object(bearing)[0]] for bearing in bearings]
        return needed[at], worst[at]

    def friction_needed(self, bearings: Sequence[GraspLoad]) -> float:
        """Least coefficient at the fingers with which any squeeze holds in one of the grasps."""
        needed = (self._key_and_object(each)[1].friction_needed() for each in bearings)
        return min(needed)

    def probability(self, bearing: GraspLoad, squeeze: float) -> float:
        """Probability that a squeeze holds."""
        key, lifted = self._key_and_object(bearing)
        key += f"{squeeze:.6g}".encode()
        if key not in self._likely:
            self._likely[key] = lifted.hold_probability(squeeze)
        return self._likely[key]

    def _key_and_object(self, bearing: GraspLoad) -> tuple[bytes, Lifted]:
        """All that a hold depends on, and the object in the hand."""
        if bearing not in self._keyed:
            lifted = bearing.lifted_object(self._model)
            # All of it in the frame of the grasp.
            R, model = lifted.R_BG, lifted.model
            parts = (
                lifted.contacts.places,
                (np.array(model.com) - lifted.p_BG) @ R,
                R.T @ np.diag(np.square(model.com_sd)) @ R,
                lifted.down_B @ R,
                np.array([model.mass, model.mass_sd, *vars(lifted.contacts.press).values()]),
            )
            key = b"".join((np.round(part, 7) + 0.0).tobytes() for part in parts)
            self._keyed[bearing] = key, lifted
        return self._keyed[bearing]


def friction(model: ObjectModel) -> float:
    """The coefficient at the fingers that a hold relies on."""
    kinetic = model.finger_friction_kinetic
    return model.finger_friction if kinetic is None else kinetic


def _grasp_value(
    problem: GraspProblem, candidate: Candidate, squeeze: float, needed: float
) -> Grasp:
    R_WB = problem.target.pose.R_WB
    return Grasp(
        part=candidate.part,
        p_BG=plain_vector(np.round(candidate.middle, 12)),
        closing_W=plain_vector(np.round(R_WB @ candidate.closing, 12)),
        approach_W=plain_vector(np.round(R_WB @ candidate.approach, 12)),
        width=candidate.width,
        squeeze=squeeze,
        needed=needed,
        strongest=candidate.grip.strongest,
        depth=candidate.depth,
    )


def _best_experiment(
    model: ObjectModel, bearing: GraspLoad, squeeze: float, found_to: float
) -> tuple[str, float]:
    """The most useful thing to find out first, and the probability of the hold then."""
    sd = {"finger_friction_sd": model.finger_friction, "mass_sd": model.mass}
    words = {
        "finger_friction_sd": f"find out how slippery the {model.name} is to the fingers first",
        "mass_sd": f"find out the weight of the {model.name} first",
    }
    then = {}
    for name, mean in sd.items():
        known = model.model_copy(update={name: min(getattr(model, name), found_to * mean)})
        then[name] = bearing.lifted_object(known).hold_probability(squeeze)
    best = max(then, key=lambda name: then[name])
    return words[best], then[best]
