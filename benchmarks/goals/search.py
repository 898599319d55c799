"""Brute force: random strokes of a fingertip until every clause of a sentence holds.

Model: `benchmarks.worlds.strokes`, in Drake. A sentence is searched for by rounds, each of which
goes on from the best stroke of the round before. Of the strokes of a round the first are drawn at
random, the others are variations of the best so far. What counts are the checks of the sentence
alone, by how far they are missed in all, and what every push of the robot keeps: only fingertips
touch the object, and it stays away from the others. Of the goal a search knows no more than the
direction. Strokes are slow enough for speed not to matter, so a slower one is rolled out at `QUICK`
and its time is stretched.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.goals.judge import objects_named
from benchmarks.worlds.drake import DrakeBench
from benchmarks.worlds.strokes import (
    PERIOD,
    Array,
    Bench,
    Generator,
    Rolled,
    Stroke,
    heading_of,
    random_stroke,
    towards,
    upright,
)
from grammar.frames import command as g
from nlcontrol.checks.frame_checks import check
from nlcontrol.checks.verdicts import Check
from nlcontrol.references.reference_resolution import parts_within
from objectmodels import ObjectModel
from planner.problem.directions import HEADINGS, bisector
from planner.problem.footprints import footprint, gap, overlaps
from planner.types.defaults import DEFAULTS
from planner.types.world_state import PlanarPose, SeenObject, TableState
from sim.traces.trace import ContactEvent, Trace
from sim.truth.scene_file import Scene

QUICK = 0.10
"""Speed of strokes [m/s]."""
ROUNDS = 3
"""Strokes one after another; between two the hand goes home and looks, which takes 20 s."""

_SCALES = {"m": 0.01, "rad": 0.1, "N": 0.5, "m/s": 0.01, "s": 1.0, "": 1.0}
_BETWEEN = 2.0  # time that a trace gives the hand to go elsewhere [s]
_SPACING = 10  # samples between two at which distances are looked at
_ROUNDING = 1e-4  # of distances [m]
_RANDOM = 0.6  # share of a round that is drawn at random


@dataclass(frozen=True)
class Asked:
    """What is searched for.

    Attributes:
        frame: its objects resolved.
        name: of the object that is pushed.
        models: shapes of everything on the table, by name, as the checks need them.
        table: extent of the table top.
        fragile: names of what is.
    """

    frame: g.Frame
    name: str
    models: Mapping[str, ObjectModel]
    table: TableState
    fragile: frozenset[str] = frozenset()

    @property
    def model(self) -> ObjectModel:
        """The shape of what is pushed."""
        return self.models[self.name]

    @property
    def fingers(self) -> tuple[int, ...]:
        """Numbers of fingertips that may push."""
        counts = [c.count for c in self.frame.constraints if isinstance(c, g.Effector) and c.count]
        return tuple(n for n in (1, 2) if all(n == count for count in counts))

    @property
    def heading(self) -> float | None:
        """Direction that the sentence names in W [rad]."""
        named = getattr(self.frame.goal, "direction", None)
        if isinstance(named, tuple):
            return bisector(named)
        return HEADINGS[named] if named else getattr(self.frame.goal, "heading", None)

    def speaks_of(self, name: str) -> bool:
        """Whether the sentence names an object."""
        return name in [getattr(part, "id", None) for part in parts_within(self.frame)]

    @property
    def wanted(self) -> frozenset[str]:
        """Names of what the sentence brings it to, which may be near or touched."""
        return frozenset(ref.id for ref in objects_named(self.frame) if ref.id)

    @property
    def rounds(self) -> int:
        """How many strokes there is time for, one after another."""
        hurried = any(clause.kind == "max_duration" for clause in self.frame.constraints)
        return 1 if hurried else ROUNDS

    @property
    def slower(self) -> float:
        """How many times as slow as `QUICK` a stroke must be."""
        speeds = [QUICK]
        for clause in self.frame.constraints:
            if isinstance(clause, g.Slow | g.Gentle):
                speeds.append(DEFAULTS.speed_gentle)
            elif isinstance(clause, g.MaxSpeed | g.Speed):
                speeds.append(clause.value)
        return QUICK / min(speeds)


@dataclass(frozen=True)
class Found:
    """Strokes after which every clause holds.

    Attributes:
        strokes: in their order.
        before: where everything stood before each of them.
        fingers: how many fingertips push.
    """

    strokes: tuple[Stroke, ...]
    before: tuple[Mapping[str, Array], ...]
    fingers: int


def search(
    scene: Scene,
    asked: Asked,
    tries: int,
    rng: Generator,
    *,
    enough: int = 1,
) -> tuple[list[Found], int]:
    """Looks for strokes that do what is asked.

    Args:
        scene: how everything is and stands.
        asked: what is asked.
        tries: roll-outs in each round and for each number of fingertips.
        rng: to draw from.
        enough: the search ends with so many.

    Returns:
        What was found, and how many strokes were rolled out.
    """
    found: list[Found] = []
    rolled = 0
    for fingers in asked.fingers:
        bench = DrakeBench(scene, asked.name, fingers)
        for each, cost in _rounds(bench, asked, fingers, tries, rng):
            rolled += 1
            if cost == 0.0:
                found.append(each)
            if len(found) >= enough:
                return found, rolled
    return found, rolled


def _rounds(
    bench: Bench, asked: Asked, fingers: int, tries: int, rng: Generator
) -> Iterator[tuple[Found, float]]:
    """Every attempt, and by how much it misses."""
    so_far = Found((), (), fingers)
    done: list[tuple[Stroke, Rolled]] = []
    for _ in range(asked.rounds):
        state, here = bench.keep(), bench.poses()
        if not upright(here[asked.name]):
            return
        best: tuple[float, Stroke, Rolled, object] | None = None
        for k in range(tries):
            if best is None or k < _RANDOM * tries:
                stroke = _drawn(asked, here[asked.name], rng)
            else:
                stroke = best[1].varied(rng)
            bench.back(state)
            rolled = bench.roll(stroke, QUICK)
            cost = _cost(asked, [*done, (stroke, rolled)])
            cost += _met(asked, rolled)
            attempt = Found((*so_far.strokes, stroke), (*so_far.before, here), fingers)
            yield attempt, cost
            # What has fallen the wrong way is no place to go on from.
            stands = upright(rolled.poses[asked.name][-1])
            if stands and (best is None or cost < best[0]):
                best, farther = (cost, stroke, rolled, bench.keep()), attempt
        if best is None:
            return
        so_far, done = farther, [*done, best[1:3]]
        bench.back(best[3])


def _met(asked: Asked, rolled: Rolled) -> bool:
    """Whether the object, or a fingertip, came too near to anything that it is not to touch."""
    others = rolled.poses.keys() - {asked.name} - asked.wanted
    if any(others & pair for pair in rolled.touched):
        return True
    poses = rolled.poses[asked.name]
    standing = [k for k in range(0, len(poses), _SPACING) if upright(poses[k])]
    for name in others:
        there = footprint(seen(name, asked.models[name], rolled.poses[name][0]))
        usual = DEFAULTS.clearance_fragile if name in asked.fragile else DEFAULTS.clearance
        apart = min(usual, gap(_outline(asked, poses[0]), there))
        if any(overlaps(_outline(asked, poses[k]), there, apart - _ROUNDING) for k in standing):
            return True
    return False


def _outline(asked: Asked, pose: Array) -> Array:
    return footprint(seen(asked.name, asked.model, pose))


def seen(name: str, model: ObjectModel, pose: Array) -> SeenObject:
    """An object where it truly stands.

    Args:
        name: of the object.
        model: its shape.
        pose: quaternion (w, x, y, z) and p_WB [m], shape (7,); it stands upright.
    """
    return SeenObject(name, PlanarPose(pose[4], pose[5], heading_of(pose)), model)


def _drawn(asked: Asked, pose: Array, rng: Generator) -> Stroke:
    if rng.random() < 0.5:
        return random_stroke(asked.name, asked.model, pose, rng)
    heading = asked.heading
    if heading is None:
        # Else sentences are about faces and the robot's directions.
        heading = 0.5 * np.pi * int(rng.integers(4)) + float(rng.choice([0.0, heading_of(pose)]))
    return towards(asked.name, asked.model, pose, heading, float(rng.uniform(0.01, 0.3)), rng)


def repeated(scene: Scene, asked: Asked, found: Found) -> bool:
    """Whether strokes do what is asked in another world too."""
    bench = DrakeBench(scene, asked.name, found.fingers)
    done = [(stroke, bench.roll(stroke, QUICK)) for stroke in found.strokes]
    return _cost(asked, done) == 0.0 and not any(_met(asked, rolled) for _, rolled in done)


def _cost(asked: Asked, done: Sequence[tuple[Stroke, Rolled]]) -> float:
    """By how much strokes miss what is asked, all together, and each of them its constraints.

    A clause about the contact looks at the first one of a trace, but it is meant for every stroke.
    """
    kinds = {clause.kind for clause in asked.frame.constraints}
    each = [c for one in done for c in _checked(asked, [one]) if c.clause in kinds]
    return missed(_checked(asked, done)) + missed(each)


def _checked(asked: Asked, done: Sequence[tuple[Stroke, Rolled]]) -> tuple[Check, ...]:
    trace = trace_of(asked.name, done, asked.slower)
    return check(asked.frame, trace, asked.models, asked.table)


def missed(checks: Sequence[Check]) -> float:
    """By how much clauses are missed in all; 0 if and only if all hold."""
    total = 0.0
    for each in checks:
        if each.ok:
            continue
        if isinstance(each.expected, str) or isinstance(each.measured, str):
            total += 1.0
        else:
            off = abs(each.measured - each.expected) - (each.tolerance or 0.0)
            total += max(off / _SCALES[each.unit], 1e-3)
    return total


def trace_of(name: str, done: Sequence[tuple[Stroke, Rolled]], slower: float = 1.0) -> Trace:
    """Strokes one after another as the trace of an execution, so many times as slow."""
    rolled = [each for _, each in done]
    times, contacts, begun = [], [], 0.0
    for each in rolled:
        times.append(begun + slower * PERIOD * np.arange(len(each.pushing)))
        contacts += [ContactEvent(begun, *sorted(pair)) for pair in each.touched]
        begun = float(times[-1][-1]) + _BETWEEN
    pushing = np.concatenate([each.pushing for each in rolled])
    first = rolled[0]

    def joined(kind: str, key: str) -> Array:
        return np.concatenate([getattr(each, kind)[key] for each in rolled])

    poses = {key: joined("poses", key) for key in first.poses}
    return Trace(
        time=np.concatenate(times),
        phase=np.where(pushing, "push", "settle"),
        poses=poses,
        seen=poses,
        joints=np.zeros((len(pushing), 0)),
        joint_names=(),
        tips={key: joined("tips", key) for key in first.tips},
        felt={key: joined("felt", key) for key in first.felt},
        force_limit=np.zeros(len(pushing)),
        contacts=tuple(contacts),
        pushed=name,
        direction=done[-1][0].direction,
        end="stroke",
        detail="",
        seed=0,
    )
