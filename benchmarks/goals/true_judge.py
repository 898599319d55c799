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

import numpy as np

from grammar.frames import command as g
from objectmodels import ObjectModel
from objectmodels.geometry.base_shapes import Array, hull_polygon
from planner.problem.footprints import gap
from planner.types.defaults import DEFAULTS as D
from sim.traces.trace import Trace

SLACK = 1.25
"""Tolerance of this judge over that of the defaults."""
SHARE = 1.0 / 3.0
"""Most of an amount that is asked that its tolerance may be."""
STIRRED = 0.015
"""Motion of what was not spoken of that breaks a clause which nobody has to say [m]."""

_WAYS = {"away": (1.0, 0.0), "toward": (-1.0, 0.0), "left": (0.0, 1.0), "right": (0.0, -1.0)}
_BESIDE = {"left_of": (0.0, 1.0), "right_of": (0.0, -1.0), "behind": (1.0, 0.0),
           "in_front_of": (-1.0, 0.0)}  # fmt: skip
_STANDS = math.radians(45.0)  # what tilts less has not toppled [rad]
_HANGS = 0.003  # what is higher than this above the table may hang in the hand [m]
_ASKEW = math.radians(30.0)  # by which it may hang there [rad]
_SPACING = 20  # samples between those at which distances are looked at


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
    seen = _Truth(trace, frame.object.id or frame.object.text, models)
    with np.errstate(invalid="ignore"):
        return Verdict(_is_met(frame, seen), tuple(_broken(frame, seen)))


class _Truth:
    """True motion of an object among others."""

    def __init__(self, trace: Trace, name: str, models: Mapping[str, ObjectModel]) -> None:
        self.trace, self.name, self._models = trace, name, models
        self.rotations = np.array([_rotation(q) for q in trace.poses[name][:, :4]])
        # In W, what of the object looked up at the start; it may lie on any of its faces.
        self.upwards = self.rotations @ self._up_at_start()
        self.tilts = np.arccos(np.clip(self.upwards[:, 2], -1.0, 1.0))
        self.moved = self.middle(name, -1) - self.middle(name, 0)

    def _up_at_start(self) -> Array:
        """What of the object looks up as it rests, shape (3,) in B.

        What hangs in the hand as its step begins may hang askew; that counts as a tilt.
        """
        up = np.asarray(self.rotations[0, 2])
        upright = np.zeros(3)
        upright[np.argmax(abs(up))] = np.sign(up[np.argmax(abs(up))])
        hangs = self.corners(self.name, 0)[:, 2].min() > _HANGS
        return upright if hangs and up @ upright > math.cos(_ASKEW) else up

    def corners(self, name: str, sample: int) -> Array:
        """Corners of an upright prism around an object in W, shape (k, 3) [m]."""
        pose, model = self.trace.poses[name][sample], self._models[name]
        prism = [(x, y, z) for z in (0.0, model.top) for x, y in model.outline]
        return np.asarray(np.array(prism) @ _rotation(pose[:4]).T + pose[4:])

    def middle(self, name: str, sample: int) -> Array:
        """Middle of an object in W, shape (3,) [m]."""
        return np.asarray(self.corners(name, sample).mean(axis=0))

    def apart(self, name: str, sample: int) -> float:
        """Distance between the outlines of the object and of another [m]."""
        own, other = (
            hull_polygon(self.corners(n, sample)[:, :2]).vertices for n in (self.name, name)
        )
        return gap(own, other)

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


def _rotation(q: Array) -> Array:
    w, x, y, z = (q / np.linalg.norm(q)).tolist()
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + 2.0 * w * K + 2.0 * K @ K)


def _near(value: float, asked: float, tolerance: float, bound: str = "exact") -> bool:
    if bound == "exact":
        return abs(value - asked) <= SLACK * tolerance
    past = value - asked if bound == "at_least" else asked - value
    return past >= -(SLACK - 1.0) * tolerance


def _is_met(frame: g.Frame, seen: _Truth) -> bool | None:
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
            base = float(seen.corners(seen.name, -1)[:, 2].min())
            high = base if frame.goal.above == "table" else float(seen.moved[2])
            return hangs and _near(high, asked, min(D.lift_tolerance, SHARE * asked), bound)
        case g.Open():
            return _is_open(seen) and stands
    return None


def _happened(until: g.Until, seen: _Truth) -> bool | None:
    name = until.object.id if until.object is not None else None
    most = float(seen.tilts.max())
    match until.event:
        case "touching" if name:
            return seen.apart(name, -1) <= 0.005
        case "moves":
            return float(np.linalg.norm(seen.moved[:2])) >= D.moves / SLACK
        case "about_to_tip":
            return most >= D.tips and float(seen.tilts[-1]) < _STANDS
        case "tips":
            return float(seen.tilts[-1]) >= D.toppled / SLACK
    return None


def _displaced(goal: g.Displace, seen: _Truth) -> bool | None:
    way = _asked_way(goal, seen)
    asked = _asked_distance(goal)
    if way is None or asked is None:
        return None
    moved = seen.moved[:2]
    along, aside = float(moved @ way), float(abs(moved[0] * way[1] - moved[1] * way[0]))
    straight = aside <= max(SLACK * D.distance_tolerance, 0.2 * abs(along))
    return straight and _near(along, asked, min(D.distance_tolerance, SHARE * asked), goal.bound)


def _asked_way(goal: g.Displace, seen: _Truth) -> Array | None:
    """Direction that is asked for in W, shape (2,); None if none is, or a part of the table."""
    if goal.direction is not None:
        ways = goal.direction if isinstance(goal.direction, tuple) else (goal.direction,)
        total = np.sum([_WAYS[way] for way in ways], axis=0)
        return np.asarray(total / np.linalg.norm(total))
    if goal.heading is not None:
        return np.array([math.cos(goal.heading), math.sin(goal.heading)])
    other, sign = (goal.toward, 1.0) if goal.toward is not None else (goal.away_from, -1.0)
    if not isinstance(other, g.ObjectRef) or goal.fraction is not None:
        return None
    off = (seen.middle(other.id or "", 0) - seen.middle(seen.name, 0))[:2]
    return np.asarray(sign * off / np.linalg.norm(off))


def _asked_distance(goal: g.Displace) -> float | None:
    if goal.fraction is not None or isinstance(goal.distance, g.RelativeLength):
        return None
    said = {None: D.distance, "little": D.distance_little, "lot": D.distance_lot}[goal.amount]
    return said if goal.distance is None else goal.distance


def _placed(goal: g.Place, seen: _Truth) -> bool | None:
    here = seen.middle(seen.name, -1)[:2]
    if isinstance(goal.reference, g.Point):
        off = here - [goal.reference.x, goal.reference.y]
        return float(np.linalg.norm(off)) <= SLACK * D.place_tolerance
    if isinstance(goal.reference, str) or len(goal.reference) != 1:
        return None
    name = goal.reference[0].id or ""
    apart, other = seen.apart(name, -1), seen.middle(name, -1)[:2]
    if goal.relation == "touching":
        return apart <= 0.005
    side = _BESIDE.get(goal.relation)
    if side is not None and float((here - other) @ side) <= 0.0:
        return False
    if goal.relation != "next_to" and side is None:
        return None
    said = isinstance(goal.distance, float)
    asked = goal.distance if isinstance(goal.distance, float) else D.place_gap
    return _near(apart, asked, D.place_tolerance if said else D.place_gap_tolerance)


def _is_open(seen: _Truth) -> bool:
    lid, at = seen._models[seen.name].lid, float(seen.trace.lids[seen.name][-1])
    if lid is None:
        return False
    return at >= D.lid_opened / SLACK if lid.kind == "flip" else lid.leaves_free(at)


def _is_towards(way: Array, asked: str) -> bool:
    return float(way @ _WAYS[asked]) >= math.cos(SLACK * D.side_tolerance)


def _broken(frame: g.Frame, seen: _Truth) -> Iterator[str]:
    """Kinds of the clauses that were broken."""
    most, turned = float(seen.tilts.max()), abs(seen.turned)
    samples = range(0, len(seen.tilts), _SPACING)
    for clause in frame.constraints:
        match clause:
            case g.NoTopple() if most > _STANDS:
                yield clause.kind
            case g.NoTilt() if most > SLACK * D.no_tilt:
                yield clause.kind
            case g.MaxTilt() if most > clause.value + SLACK * D.tilt_tolerance:
                yield clause.kind
            case g.NoTurn() if turned > SLACK * D.no_turn:
                yield clause.kind
            case g.NoTouch(object=None) if any(
                seen.name in pair and _other(pair, seen.name) in seen.trace.poses
                for pair in _touches(seen.trace)
            ):
                yield clause.kind
            case g.NoTouch(object=g.ObjectRef(id=str(name)), clearance=kept):
                near = kept is not None and any(
                    seen.apart(name, k) < kept - SLACK * D.clear_tolerance for k in samples
                )
                if near or any(name in pair for pair in _touches(seen.trace)):
                    yield clause.kind
    named = {ref.id for ref in _objects_named(frame)}
    for name in seen.trace.poses:
        known = name in seen._models and name not in named and name != seen.name
        if known and np.linalg.norm(seen.middle(name, -1) - seen.middle(name, 0)) > STIRRED:
            yield "others"
            return


def _touches(trace: Trace) -> list[tuple[str, str]]:
    return [(event.body_a, event.body_b) for event in trace.contacts]


def _other(pair: tuple[str, str], name: str) -> str:
    return pair[1] if pair[0] == name else pair[0]


def _objects_named(frame: g.Frame) -> Iterator[g.ObjectRef]:
    """Objects beside its own that the sentence brings its own to."""
    for part in (getattr(frame.goal, "reference", ()), getattr(frame.goal, "toward", None)):
        yield from (ref for ref in (part if isinstance(part, tuple) else (part,))
                    if isinstance(ref, g.ObjectRef))  # fmt: skip
    yield from (c.object for c in frame.constraints if isinstance(c, g.Until) and c.object)
