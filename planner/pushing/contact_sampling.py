"""Contact points over the side faces, and what the object model says of each.

Model: a fingertip may transmit any force in its friction cone, so a contact counts only if the
wanted outcome holds for all of them. First the whole cone is taken; if nothing is left, the part
of it that the hand's stiffness allows (`RobotLimits.force_skew`), which the plan then says. The
parameters are taken at two standard deviations, then at fewer if the outcome still has the
probability that is asked.

Frames: contacts are in B; heights above the table.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypedDict

import numpy as np
from numpy.typing import NDArray

from objectmodels import ConeThresholds, Face, ObjectModel
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.friction_cone import worst_probability
from objectmodels.safety_figure import SafetyFigure
from planner.problem.constraint_limits import why_not_tilted
from planner.problem.directions import HEADINGS, angle_between, face_name, heading_of, phrase, unit
from planner.problem.footprints import (
    footprint,
    landing_area,
    leading_point,
    overlaps,
    travel_to_edge,
)
from planner.problem.planning_problem import PushProblem, PushStep, Side
from planner.pushing.push_paths import largest_obliqueness
from planner.refusals.blocked import Blocked, dead_end, tilt_mark
from planner.types.actions import PushAction
from planner.types.plan import FORCE_BAND, reached_speed
from planner.types.robot import ReachEffort, RobotLimits
from planner.types.world_state import SeenObject

EDGE: SafetyFigure = 0.006
"""How far from the edges of a face contacts stay at least; fingertips may overhang them [m]."""

_SIDESTEPS = {1: (0.0,), 2: (0.0, 0.01, -0.01, 0.02, -0.02)}
_ROUND = 0.7  # sine of the largest angle at which two fingertips touch a round side
# Places in the order of margins at which the reach may be asked for; the hand that does not get
# down beside a neighbour often gets to a place that is higher up.
_SHARES = np.array([0.0, 0.15, 0.4, 0.75])


@dataclass(frozen=True)
class Contacts:
    """Contacts of one face with one number of fingers, n of them, and their thresholds.

    Attributes:
        side: the face.
        fingers: how many fingertips push.
        spread: distance between two of them [m]; 0 for one.
        points: contacts (midpoints of two) in B, shape (n, 3) [m].
        lateral: room to the nearest edge of the face, shape (n,) [m].
        cone: thresholds over the friction cone at `sigmas`.
        sigmas: standard deviations that the worst case takes.
        guarded: whether the cone is that of the hand's stiffness instead of friction's.
        turning: whether the object may turn about the vertical before it does what is wanted.
        chosen: contacts whose outcome is as wanted, the best first.
        probability: of the wanted outcome by the closed form, for the chosen ones.
    """

    side: Side
    fingers: Literal[1, 2]
    spread: float
    points: Array
    lateral: Array
    cone: ConeThresholds
    sigmas: float
    guarded: bool
    turning: bool
    chosen: NDArray[np.intp]
    probability: Array

    def __iter__(self) -> Iterator[Contact]:
        """The chosen contacts, the best first."""
        return (Contact(self, rank) for rank in range(len(self.chosen)))

    def only(self, kept: NDArray[np.bool_]) -> Contacts:
        """The same with some of the chosen contacts, shape (k,)."""
        return replace(self, chosen=self.chosen[kept], probability=self.probability[kept])


@dataclass(frozen=True, eq=False)
class Contact:
    """One chosen contact.

    Attributes:
        among: the contacts of its face.
        rank: its place in their order.
    """

    among: Contacts
    rank: int

    @property
    def index(self) -> int:
        """Its index among the contacts of its face."""
        return int(self.among.chosen[self.rank])

    @property
    def point(self) -> Array:
        """The contact (midpoint of two) in B, shape (3,) [m]."""
        return np.asarray(self.among.points[self.index])

    @property
    def probability(self) -> float:
        """Probability of the wanted outcome by the closed form, exact for what does not turn."""
        return float(self.among.probability[self.rank])


def has_place(problem: PushProblem, step: PushStep, sides: list[Side]) -> bool:
    """True if fingertips find a place on one of the sides, whatever the outcome there."""
    return any(
        len(_contact_places(side.face, fingers, _allowed_part(problem, step, side, fingers))[0])
        for side in sides
        for fingers in problem.contact.fingers
    )


@dataclass(frozen=True)
class _Allowed:
    """Part of a face on which contacts may lie.

    Attributes:
        low, high: heights [m].
        aim: the best place along the face, from its middle [m].
        beside: further places, from there [m].
        tip: radius of a fingertip [m].
        spread: distance between two of them [m]; 0 for one.
        edge: how far from the edges of the face they stay [m].
    """

    low: float
    high: float
    aim: float
    beside: tuple[float, ...]
    tip: float
    spread: float
    edge: float


def _allowed_part(problem: PushProblem, step: PushStep, side: Side, fingers: int) -> _Allowed:
    limits, contact, face = problem.robot.limits, problem.contact, side.face
    tip = limits.fingertip_radius
    low = max(contact.low, limits.lowest_height, face.bottom)
    high = min(contact.high, face.top - tip)
    spread, edge = _spread_and_edge(face, fingers, limits)
    if step.swing:
        return _Allowed(low, high, step.lateral, (0.0,), tip, spread, edge)
    # To a micrometre, so that equal pushes are looked up as such.
    aim = round(_balanced_lateral(problem.target.model, step, side), 6)
    return _Allowed(low, high, aim, _SIDESTEPS[fingers], tip, spread, edge)


def _spread_and_edge(face: Face, fingers: int, limits: RobotLimits) -> tuple[float, float]:
    """The largest distance at which fingertips find a place, and that place's from the edge [m]."""
    whole = limits.fingertip_radius
    spreads = limits.finger_spreads if fingers == 2 else (0.0,)
    if face.curvature:
        return spreads[0], whole  # two hold what is round between them
    for edge, spread in itertools.product((whole, EDGE), spreads):
        if spread + 2.0 * edge <= face.width + 1e-9:
            return spread, edge
    return spreads[-1], EDGE


def _balanced_lateral(model: ObjectModel, step: PushStep, side: Side) -> float:
    """Place on the face at which a push along its heading goes through the centre of mass [m]."""
    face = side.face
    if face.curvature:
        return 0.0
    oblique = 0.0
    if step.outcome == "slide" and step.heading is not None:
        oblique = angle_between(step.heading, side.heading)
    off = np.array(model.com) - face.centre
    depth = -float(off @ np.array(face.normal))
    # The tangent is ẑ × normal: to the right of the push.
    return float(off @ np.array(face.tangent)) + depth * math.tan(oblique)


def _contact_places(face: Face, fingers: int, allowed: _Allowed) -> tuple[Array, Array, Array]:
    """Points in B (n, 3), room to the edges (n,), distances from the best place (n,)."""
    room = face.width / 2 - allowed.edge - allowed.spread / 2
    if face.curvature and fingers == 2:
        # Fingertips that would meet it too far round its side slip off.
        around = _ROUND * (1.0 / face.curvature + allowed.tip)
        room = 0.0 if allowed.spread / 2 <= around else -1.0
    low, high = allowed.low, allowed.high
    if room < -1e-9 or high < low - 1e-9:
        return np.empty((0, 3)), np.empty(0), np.empty(0)
    aim = float(np.clip(allowed.aim, -max(room, 0.0), max(room, 0.0)))
    lateral = np.array([aim + y for y in allowed.beside if abs(aim + y) <= room + 1e-9 or y == 0])
    # About 4 mm apart.
    heights = np.linspace(low, high, max(1, round((high - low) / 0.004)) + 1)
    z, y = (a.ravel() for a in np.meshgrid(heights, lateral, indexing="ij"))
    on = face.contains(y, z)
    points, _ = face.points_at(y[on], z[on])
    return points, room - np.abs(y[on]), np.abs(y[on] - aim)


def model_limited_by_hand(model: ObjectModel, limits: RobotLimits) -> ObjectModel:
    """The object for forces that the hand's stiffness lets a fingertip transmit, and no others."""
    return model.model_copy(
        update={
            "finger_friction": min(limits.force_skew, model.finger_friction),
            "finger_friction_sd": 0.0,
        }
    )


def rate_contacts(
    problem: PushProblem, step: PushStep, sides: list[Side], fingers: Literal[1, 2]
) -> Iterator[list[Contacts]]:
    """Contacts at which the wanted outcome is sure enough, from the surest case to the least."""
    model, defaults = problem.target.model, problem.defaults
    held = model_limited_by_hand(model, problem.robot.limits)
    places = [(side, _allowed_part(problem, step, side, fingers)) for side in sides]
    turns = fingers == 1
    cases = [(model, False, turns), (held, True, turns)]
    if turns and step.outcome == "topple":
        # Over an edge that lies on the table it does not turn; that it does not turn before it
        # is over, `confirm_with_exact_tier` looks at.
        cases.append((held, True, False))
    for believed, guarded, turning in cases:
        for sigmas in (defaults.sigmas, defaults.sigmas / 2, 0.0):
            # Within all sigmas the outcome is sure; within fewer it must also be likely.
            least = 0.0 if sigmas == defaults.sigmas else problem.effort.probability
            found = [
                Contacts(
                    side=side,
                    fingers=fingers,
                    spread=allowed.spread,
                    sigmas=sigmas,
                    guarded=guarded,
                    turning=turning,
                    **_rate_face(
                        believed,
                        side.face,
                        fingers,
                        allowed,
                        sigmas,
                        step.outcome,
                        least,
                        turning,
                    ),
                )
                for side, allowed in places
            ]
            yield [contacts for contacts in found if len(contacts.chosen)]


class _Rating(TypedDict):
    """The part of `Contacts` that depends on the model and the face alone."""

    points: Array
    lateral: Array
    cone: ConeThresholds
    chosen: NDArray[np.intp]
    probability: Array


@functools.lru_cache(maxsize=1024)
def _rate_face(
    model: ObjectModel,
    face: Face,
    fingers: Literal[1, 2],
    allowed: _Allowed,
    sigmas: float,
    outcome: Literal["slide", "topple"],
    least: float,
    turning: bool,
) -> _Rating:
    """The contacts of a face, kept: models and faces never change, new beliefs are new models."""
    points, lateral, aside = _contact_places(face, fingers, allowed)
    normals = np.tile(np.array(face.normal), (len(points), 1))
    cone = model.cone_thresholds(points, normals, sigmas=sigmas, yaw=turning)
    holds = cone.slides if outcome == "slide" else cone.topples
    margin = cone.slide_margin if outcome == "slide" else cone.topple_margin
    # Off the best place the object turns, or one finger carries more.
    order = np.argsort(-np.where(holds, margin, -np.inf) + 1e-3 * aside)
    chosen, probability = order[: np.count_nonzero(holds)], np.empty(0)
    if len(chosen):
        # The best, and some that are less good, but reached otherwise.
        chosen = chosen[sorted({int(share * len(chosen)) for share in _SHARES})]
        probability = worst_probability(model, points[chosen], normals[chosen], turning, outcome)
        likely = probability >= least
        chosen, probability = chosen[likely], probability[likely]
    return _Rating(
        points=points, lateral=lateral, cone=cone, chosen=chosen, probability=probability
    )


# Speeds that strokes come to, and sentences that ask for more than that.
#
# Model: what is round catches on the table now and then. A mug in the simulator lost up to a
# tenth of its speed at once, before the command changed; boxes did not. Fingertips of stiffness k
# that an object of mass m meets with Δv then press with Δv √(k m) more. If that takes them beyond
# the force limit less its band, the command falls back and the speed is lost. So a push keeps a
# speed v if
#
#     σ v √(k m) ≤ (1 − band) F_limit − F_onset,    σ = 0.1

_ASKING = ("speed", "min_speed", "fast")
_SURELY = 0.5  # share of the tolerance of a speed: pushes in the simulator are off by 0.4 at most


def why_not_so_fast(problem: PushProblem, pushes: Sequence[PushAction]) -> Blocked | None:
    """All strokes are too short for the speed that is asked for, or the force limit is too near.

    Only strokes count: how fast the finger becomes while something falls or turns is not foreseen.
    The force limits the first push alone: in which posture later ones are made is not known yet.
    """
    asking = [clause for clause in problem.frame.constraints if clause.kind in _ASKING]
    strokes = [push for push in pushes if push.ends_on == "stroke"]
    if not asking or not strokes or problem.previous is not None:
        return None
    asked = problem.motion.speed
    longest = max(strokes, key=lambda push: push.stroke)
    reached = {push: reached_speed(push.speed, push.stroke) for push in strokes}
    key, first = "too_fast.short", pushes[0]
    if first in reached and (kept := kept_speed(problem, first)) < reached[first]:
        reached[first] = kept
        key = "too_fast.weak"
    best = max(reached.values())
    if best < asked - _SURELY * problem.defaults.speed_tolerance:
        numbers = {"speed": asked, "most": best, "stroke": longest.stroke}
        length, limit = longest.stroke, first.force_limit
        return dead_end(key, numbers, spans=asking[0].spans, length=length, force_limit=limit)
    return None


def kept_speed(problem: PushProblem, push: PushAction) -> float:
    """Speed that a push made now keeps within its force limit [m/s]; inf if nothing limits it."""
    if not problem.target.model.base.is_round:
        return math.inf
    effort: ReachEffort = "thorough" if problem.effort.thorough else "usual"
    stiffness = problem.robot.reach(push, problem.state, effort).stiffness
    if stiffness == 0.0:
        return math.inf
    spare = (1.0 - FORCE_BAND) * push.force_limit - push.prediction.onset
    # Share of its speed that a round object loses at once, σ.
    return max(spare, 0.0) / (0.1 * math.sqrt(stiffness * problem.target.model.mass))


def touchable_sides(problem: PushProblem, step: PushStep) -> list[Side] | Blocked:
    """Sides that a push may touch: the straightest, or all if no direction is said."""
    if step.side is not None:
        return [step.side]
    target, face_said, spans = problem.target, problem.contact.face, problem.contact.spans
    sides, unclear = [], None
    # Along these a round object may be pushed.
    headings = np.array([*HEADINGS.values()] if step.heading is None else [step.heading])
    for face in target.model.faces(headings - target.pose.yaw):
        outward = target.pose.R_WB @ np.array(face.normal)
        name, off = face_name(outward)
        if face_said is not None:
            # A face turned by more from the direction of its name is within 5° of the next name.
            if abs(off) > math.radians(40.0):
                unclear = off
                continue
            if name != face_said:
                continue
        sides.append(Side(face, heading_of(-outward)))
    if not sides and unclear is not None:
        turned = {"turned": unclear}
        return dead_end("face_not_clear", turned, spans=spans, object=target.name, face=face_said)
    if not sides:
        where = "side" if face_said is None else f"{face_said} face"
        return dead_end("no_side", spans=spans, object=target.name, where=where)
    if step.heading is None:
        return sides
    contact = problem.contact
    side = _most_square(sides, step.heading)
    oblique = angle_between(step.heading, side.heading)
    # An object that slides straight presses back along the push: that must be in the friction cone.
    # What topples or tilts is pushed square to its face, and goes about where it was meant to.
    largest = largest_obliqueness(target, problem.defaults.sigmas, steep=problem.effort.oblique)
    if step.outcome == "topple":
        largest = 0.5 * problem.defaults.side_tolerance
    if abs(oblique) > largest:
        return dead_end(
            "oblique_face" if contact.face else "oblique",
            {"obliqueness": abs(oblique), "largest_obliqueness": largest},
            spans=contact.spans,
            object=target.name,
            face=f"its {contact.face} face" if contact.face else "its nearest face",
            direction=phrase(step.heading),
            square=phrase(side.heading),
        )
    return [side]


def straightest_side(target: SeenObject, heading: float) -> Side:
    """The side of an object that is most square to a push along a heading in W [rad]."""
    faces = target.model.faces(np.array([heading - target.pose.yaw]))
    inward = [Side(f, heading_of(-target.pose.R_WB @ np.array(f.normal))) for f in faces]
    return _most_square(inward, heading)


def _most_square(sides: list[Side], heading: float) -> Side:
    return min(sides, key=lambda side: abs(angle_between(side.heading, heading)))


def push_direction(step: PushStep, side: Side) -> np.ndarray:
    """Unit direction of the push in W, shape (3,); a topple is pushed square to the face."""
    if step.outcome == "slide" and step.heading is not None:
        return unit(step.heading)
    return unit(side.heading)


def why_no_room(problem: PushProblem, step: PushStep, side: Side) -> Blocked | None:
    """What the object hits when it falls, or leans over, from a side; or a tilt may be a fall."""
    u = push_direction(step, side)
    if step.tilt is not None:
        return why_not_tilted(problem, side.face.normal, u, step.tilt)
    target = problem.target
    there, height = landing_area(target, u), {"height": target.model.top}
    edge = leading_point(target, u)
    if travel_to_edge(there, problem.state.table, u[:2], 0.0) < problem.defaults.clearance:
        marks = (tilt_mark(target.name, edge, u, math.pi / 2.0, "over the edge of the table"),)
        return dead_end("falls_off", height, marks=marks, object=target.name)
    for other in problem.others.values():
        if overlaps(there, footprint(other), problem.clearance(other)):
            text = f"it would fall on the {other.name}"
            marks = (tilt_mark(target.name, edge, u, math.pi / 2.0, text),)
            return dead_end("falls_on", height, marks=marks, object=target.name, other=other.name)
    return None
