"""Was it truly done? A judge of its own, that reads nothing but true poses and contacts.

It shares no code with the checks of a result. Lengths and angles may be off by `SLACK` times what
the defaults allow, so that what it calls missed is no matter of rounding. It knows the goals and
clauses that poses tell of; of others (forces, speeds, where a finger touched) it says nothing.

Frames: W is the world, z up, +x away from the robot, +y to its left; B is an object.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from grammar.frames import command as g
from nlcontrol.session.executor import Executor
from objectmodels import ObjectModel, Registry
from objectmodels.geometry.base_shapes import Array, hull_polygon
from objectmodels.geometry.rotations import from_quaternion, rot_z, yaw_of
from objectmodels.models.object_model import LEVEL
from planner.problem.directions import angle_between
from planner.problem.footprints import gap
from planner.types.defaults import DEFAULTS as D
from planner.types.world_state import PlanarPose, SeenObject
from sim.simulated_executor import simulation
from sim.traces.trace import Trace

SLACK = 1.25
"""Tolerance of this judge over that of the defaults."""
SHARE = 1.0 / 3.0
"""Most of an amount that is asked that its tolerance may be."""
STIRRED = 0.015
"""Motion of what was not spoken of that breaks a clause which nobody has to say [m]."""
MOVED = 0.005
"""What moves less has stayed where it was [m]."""
FELL = math.radians(45.0)
"""What leans so much more than before has fallen [rad]."""
BELOW = -0.02
"""What lies lower has left the table [m]."""
WAYS = {"left": (0.0, 1.0), "right": (0.0, -1.0), "away": (1.0, 0.0), "toward": (-1.0, 0.0)}
"""Directions as they are said, in W."""

_BESIDE = {"left_of": "left", "right_of": "right", "behind": "away", "in_front_of": "toward"}
_HANGS = 0.003  # what is higher than this above the table may hang in the hand [m]
_ASKEW = math.radians(30.0)  # by which it may hang there [rad]
_SPACING = 20  # samples between those at which distances are looked at


@dataclass(frozen=True, eq=False)
class TruePlace:
    """An object where it truly is.

    Attributes:
        model: its shape, and what is believed of the rest.
        R_WB, p_WB: its pose, shapes (3, 3) and (3,) [m].
        lid: how far its lid is open; None without one.
        fragile: whether it must not be stirred.
        farthest: how far it was from where it stood at first [m].
    """

    model: ObjectModel
    R_WB: Array
    p_WB: Array
    lid: float | None = None
    fragile: bool = False
    farthest: float = 0.0

    @cached_property
    def corners(self) -> Array:
        """Corners of a prism around it in W, shape (k, 3) [m]."""
        prism = [(x, y, z) for z in (0.0, self.model.top) for x, y in self.model.outline]
        return np.asarray(np.array(prism) @ self.R_WB.T + self.p_WB)

    @property
    def outline(self) -> Array:
        """What it covers, seen from above, shape (k, 2) [m]."""
        return hull_polygon(self.corners[:, :2]).vertices

    @property
    def middle(self) -> Array:
        """Its middle in W, shape (3,) [m]."""
        return np.asarray(self.corners.mean(axis=0))

    @property
    def lowest(self) -> float:
        """Height of its lowest corner [m]."""
        return float(self.corners[:, 2].min())

    @property
    def tilt(self) -> float:
        """Angle between its own axis and the vertical [rad]."""
        return math.acos(float(np.clip(self.R_WB[2, 2], -1.0, 1.0)))

    @property
    def is_round(self) -> bool:
        """Whether no heading can be told from its shape."""
        return self.model.base.is_round

    def way_to(self, other: TruePlace) -> float:
        """Distance between two middles [m]."""
        return float(np.linalg.norm(other.middle - self.middle))

    def leans_against(self, other: TruePlace) -> float:
        """Angle by which what looked up there is off the vertical here [rad]."""
        up = self.R_WB @ other.R_WB[2]
        return math.acos(float(np.clip(up[2], -1.0, 1.0)))

    def turned_against(self, other: TruePlace) -> float:
        """Angle by which it is turned about the vertical, less than half a turn [rad]."""
        R = self.R_WB @ other.R_WB.T
        return abs(angle_between(math.atan2(R[1, 0], R[0, 0]), 0.0))

    def seen(self, name: str) -> SeenObject:
        """As a camera without errors would see it."""
        yaw = float(yaw_of(self.R_WB))
        upright = self.R_WB[2, 2] > math.cos(LEVEL)
        attitude = None if upright else tuple((rot_z(-yaw) @ self.R_WB).ravel().tolist())
        pose = PlanarPose(float(self.p_WB[0]), float(self.p_WB[1]), yaw, attitude)
        return SeenObject.lying(name, pose, self.model, lid=self.lid)


Places = Mapping[str, TruePlace]


def true_places(executor: Executor) -> dict[str, TruePlace]:
    """Where everything in a simulated scene truly is now, by name."""
    world, registry = simulation(executor).world, Registry.built_in()
    sample = world.sample
    return {
        item.name: TruePlace(
            registry.get(item.model),
            from_quaternion(sample.poses[item.name][:4]),
            sample.poses[item.name][4:].copy(),
            sample.lids.get(item.name),
        )
        for item in world.scene.objects
    }


def fallen(before: Places, after: Places) -> list[str]:
    """Names of what fell over, or off the table."""
    return [
        name
        for name, now in after.items()
        if now.leans_against(before[name]) > FELL or now.middle[2] < BELOW
    ]


def moved(before: Places, after: Places, most: float = MOVED) -> list[str]:
    """Names of what lies elsewhere than before."""
    return [name for name, now in after.items() if now.way_to(before[name]) > most]


@dataclass(frozen=True)
class Verdict:
    """What truly came of a step.

    Attributes:
        met: whether its goal was met; None if poses do not tell.
        broken: kinds of the clauses that were broken; `others` for what was stirred.
    """

    met: bool | None
    broken: tuple[str, ...] = ()


def judged(frame: g.Frame, trace: Trace, models: Mapping[str, ObjectModel]) -> Verdict:
    """The verdict on a step.

    Args:
        frame: what was asked, its objects resolved, lengths in metres.
        trace: of all of the step, with true poses.
        models: shapes of what stands there, by name.
    """
    assert frame.object is not None, "what was done has an object"
    seen = _Motion(trace, frame.object.id or frame.object.text, models)
    with np.errstate(invalid="ignore"):
        return Verdict(_is_met(frame, seen), tuple(_broken(frame, seen)))


class _Motion:
    """True motion of an object among others."""

    def __init__(self, trace: Trace, name: str, models: Mapping[str, ObjectModel]) -> None:
        self.trace, self.name, self.models = trace, name, models
        first, self.last = self.at(name, 0), self.at(name, -1)
        # What hangs in the hand as the step begins may hang askew; that counts as a tilt.
        up = np.asarray(first.R_WB[2])
        upright = np.zeros(3)
        upright[np.argmax(abs(up))] = np.sign(up[np.argmax(abs(up))])
        hangs = first.lowest > _HANGS and up @ upright > math.cos(_ASKEW)
        # In W, what of the object looked up at the start; it may lie on any of its faces.
        self.upwards = from_quaternion(trace.poses[name][:, :4]) @ (upright if hangs else up)
        self.tilts = np.arccos(np.clip(self.upwards[:, 2], -1.0, 1.0))
        self.moved = self.last.middle - first.middle

    def at(self, name: str, sample: int) -> TruePlace:
        """Where an object is."""
        pose = self.trace.poses[name][sample]
        return TruePlace(self.models[name], from_quaternion(pose[:4]), pose[4:])

    def apart(self, name: str, sample: int) -> float:
        """Distance between the outlines of the object and of another [m]."""
        return gap(self.at(self.name, sample).outline, self.at(name, sample).outline)

    @property
    def turned(self) -> float:
        """Angle by which it turned about the vertical, whole turns counted [rad]."""
        w, z = self.trace.poses[self.name][:, 0], self.trace.poses[self.name][:, 3]
        twist = np.unwrap(2.0 * np.arctan2(z, w))
        return float(twist[-1] - twist[0])

    def leans_to(self, sample: int) -> Array:
        """Direction in which it leans against how it lay at the start, shape (2,)."""
        way = self.upwards[sample, :2]
        return np.asarray(way / np.linalg.norm(way))


def _near(value: float, asked: float, tolerance: float, bound: str = "exact") -> bool:
    if bound == "exact":
        return abs(value - asked) <= SLACK * tolerance
    past = value - asked if bound == "at_least" else asked - value
    return past >= -(SLACK - 1.0) * tolerance


def _is_met(frame: g.Frame, seen: _Motion) -> bool | None:
    events = [c for c in frame.constraints if isinstance(c, g.Until)]
    if events:
        return _happened(events[0], seen)
    tilt_at_end = float(seen.tilts[-1])
    stands = tilt_at_end <= SLACK * D.rest_tilt
    match frame.goal:
        case g.Displace() as goal:
            went = _displaced(goal, seen)
            return None if went is None else went and stands
        case g.Place() as goal:
            there = _placed(goal, seen)
            return None if there is None else there and stands
        case g.Rotate(angle=float(angle), sense=sense, bound=bound):
            turned = {"ccw": 1.0, "cw": -1.0, None: math.copysign(1.0, seen.turned)}[sense]
            there = float(np.linalg.norm(seen.moved[:2])) <= SLACK * 2.0 * D.turn_drift
            most = min(D.turn_tolerance, SHARE * angle)
            return stands and there and _near(turned * seen.turned, angle, most, bound)
        case g.Tilt(angle=float(angle), direction=way, bound=bound):
            most = int(np.argmax(seen.tilts))
            right = way is None or _is_towards(seen.leans_to(most), way)
            tilt = float(seen.tilts[most])
            allowed = min(D.tilt_tolerance, SHARE * angle)
            return stands and right and _near(tilt, angle, allowed, bound)
        case g.Topple(direction=way):
            fell = tilt_at_end >= D.toppled / SLACK
            return fell and (way is None or _is_towards(seen.leans_to(-1), way))
        case g.Lift(height=height, amount=amount, bound=bound):
            said = {None: D.lift_height, "little": D.lift_little, "lot": D.lift_lot}[amount]
            asked = height if isinstance(height, float) else said
            hangs = tilt_at_end <= SLACK * D.upright
            high = seen.last.lowest if frame.goal.above == "table" else float(seen.moved[2])
            return hangs and _near(high, asked, min(D.lift_tolerance, SHARE * asked), bound)
        case g.Open():
            return _is_open(seen) and stands
    return None


def _happened(until: g.Until, seen: _Motion) -> bool | None:
    name = until.object.id if until.object is not None else None
    most = float(seen.tilts.max())
    match until.event:
        case "touching" if name:
            return seen.apart(name, -1) <= 0.005
        case "moves":
            return float(np.linalg.norm(seen.moved[:2])) >= D.moves / SLACK
        case "about_to_tip":
            return most >= D.tips and float(seen.tilts[-1]) < FELL
        case "tips":
            return float(seen.tilts[-1]) >= D.toppled / SLACK
    return None


def _displaced(goal: g.Displace, seen: _Motion) -> bool | None:
    way = _asked_way(goal, seen)
    asked = _asked_distance(goal)
    if way is None or asked is None:
        return None
    moved = seen.moved[:2]
    along, aside = float(moved @ way), float(abs(moved[0] * way[1] - moved[1] * way[0]))
    straight = aside <= max(SLACK * D.distance_tolerance, 0.2 * abs(along))
    return straight and _near(along, asked, min(D.distance_tolerance, SHARE * asked), goal.bound)


def _asked_way(goal: g.Displace, seen: _Motion) -> Array | None:
    """Direction that is asked for in W, shape (2,); None if none is, or a part of the table."""
    if goal.direction is not None:
        ways = goal.direction if isinstance(goal.direction, tuple) else (goal.direction,)
        total = np.sum([WAYS[way] for way in ways], axis=0)
        return np.asarray(total / np.linalg.norm(total))
    if goal.heading is not None:
        return np.array([math.cos(goal.heading), math.sin(goal.heading)])
    other, sign = (goal.toward, 1.0) if goal.toward is not None else (goal.away_from, -1.0)
    if not isinstance(other, g.ObjectRef) or goal.fraction is not None:
        return None
    off = (seen.at(other.id or "", 0).middle - seen.at(seen.name, 0).middle)[:2]
    return np.asarray(sign * off / np.linalg.norm(off))


def _asked_distance(goal: g.Displace) -> float | None:
    if goal.fraction is not None or isinstance(goal.distance, g.RelativeLength):
        return None
    said = {None: D.distance, "little": D.distance_little, "lot": D.distance_lot}[goal.amount]
    return said if goal.distance is None else goal.distance


def _placed(goal: g.Place, seen: _Motion) -> bool | None:
    here = seen.last.middle[:2]
    if isinstance(goal.reference, g.Point):
        off = here - [goal.reference.x, goal.reference.y]
        return float(np.linalg.norm(off)) <= SLACK * D.place_tolerance
    if isinstance(goal.reference, str) or len(goal.reference) != 1:
        return None
    name = goal.reference[0].id or ""
    apart, other = seen.apart(name, -1), seen.at(name, -1).middle[:2]
    if goal.relation == "touching":
        return apart <= 0.005
    side = _BESIDE.get(goal.relation)
    if side is not None and float((here - other) @ WAYS[side]) <= 0.0:
        return False
    if goal.relation != "next_to" and side is None:
        return None
    said = isinstance(goal.distance, float)
    asked = goal.distance if isinstance(goal.distance, float) else D.place_gap
    return _near(apart, asked, D.place_tolerance if said else D.place_gap_tolerance)


def _is_open(seen: _Motion) -> bool:
    lid, at = seen.models[seen.name].lid, float(seen.trace.lids[seen.name][-1])
    if lid is None:
        return False
    return at >= D.lid_opened / SLACK if lid.kind == "flip" else lid.leaves_free(at)


def _is_towards(way: Array, asked: str) -> bool:
    return float(way @ WAYS[asked]) >= math.cos(SLACK * D.side_tolerance)


def _broken(frame: g.Frame, seen: _Motion) -> Iterator[str]:
    """Kinds of the clauses that were broken."""
    most, turned = float(seen.tilts.max()), abs(seen.turned)
    samples = range(0, len(seen.tilts), _SPACING)
    touches = [{event.body_a, event.body_b} for event in seen.trace.contacts]
    for clause in frame.constraints:
        match clause:
            case g.NoTopple() if most > FELL:
                yield clause.kind
            case g.NoTilt() if most > SLACK * D.no_tilt:
                yield clause.kind
            case g.MaxTilt() if most > clause.value + SLACK * D.tilt_tolerance:
                yield clause.kind
            case g.NoTurn() if turned > SLACK * D.no_turn:
                yield clause.kind
            case g.NoTouch(object=None) if any(
                seen.name in pair and pair <= seen.trace.poses.keys() for pair in touches
            ):
                yield clause.kind
            case g.NoTouch(object=g.ObjectRef(id=str(name)), clearance=kept):
                near = kept is not None and any(
                    seen.apart(name, k) < kept - SLACK * D.clear_tolerance for k in samples
                )
                if near or any(name in pair for pair in touches):
                    yield clause.kind
    named = {ref.id for ref in objects_named(frame)}
    for name in seen.trace.poses:
        known = name in seen.models and name not in named and name != seen.name
        if known and seen.at(name, -1).way_to(seen.at(name, 0)) > STIRRED:
            yield "others"
            return


def objects_named(frame: g.Frame) -> Iterator[g.ObjectRef]:
    """Objects beside its own that the sentence brings its own to."""
    for part in (getattr(frame.goal, "reference", ()), getattr(frame.goal, "toward", None)):
        refs = part if isinstance(part, tuple) else (part,)
        yield from (ref for ref in refs if isinstance(ref, g.ObjectRef))
    yield from (c.object for c in frame.constraints if isinstance(c, g.Until) and c.object)
