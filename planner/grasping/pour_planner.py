"""Pouring from one container into another one.

Model: `objectmodels.containers.pour_dynamics` says what runs out over time, where it lands and what
is caught. The lip is held so that the stream falls into the middle of the opening below. The
container leans towards the thumb or away from it, so that the contacts do not turn under it, and
towards the side where its opening is. Everything is poured by a tilt at which it runs out fast; a
part of it by the tilt at which even the least contents that are believed give as much, and the hand
stops when it feels that so much has left.

Frames: W is the world, B the container that is poured from.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from grammar.frames import command as g
from objectmodels.containers.pour_dynamics import Catch, Poured, UncertainPour, pour, tilt_for
from objectmodels.geometry.base_shapes import Array
from objectmodels.models.object_parts import Container, Vessel
from planner.grasping import lift_planner
from planner.grasping.grasp_candidates import Candidate, body_candidates
from planner.grasping.grasp_plans import MotionDraft, first_plan_of_groups, first_reachable_plan
from planner.grasping.grasp_selection import GraspLoad, StableGrasp, held_already, stable_grasps
from planner.grasping.lid_planner import is_open
from planner.problem.directions import heading_of, unit
from planner.problem.planning_problem import GraspProblem
from planner.refusals.blocked import Blocked, dead_end
from planner.types.actions import Action, Aim, Carry, PourOut, PourPrediction, SetDown
from planner.types.defaults import Defaults
from planner.types.plan import DefaultUsed, Plan, Reached
from planner.types.world_state import SeenObject

# How much is poured: what the sentence says, what is there, and what fits.
#
# Volumes that a refusal names are there and fit even in the worst case of what is believed.

_DROP = 1e-6  # less than this is nothing [m³]


@dataclass(frozen=True, eq=False)
class Hollow:
    """An open container that stands, as it is believed to be.

    Attributes:
        seen: the object.
        container: what is in it.
        vessel: its cavity.
    """

    seen: SeenObject
    container: Container
    vessel: Vessel

    @classmethod
    def from_object(cls, seen: SeenObject, defaults: Defaults) -> Hollow | Blocked:
        """An object as a container, or why it is none, or not open."""
        if seen.lies_on != "bottom":
            return dead_end("container_lies", object=seen.name)
        container, vessel = seen.model.container, seen.model.vessel
        if container is None or vessel is None:
            return dead_end("no_container", object=seen.name)
        if not is_open(seen, defaults):
            return dead_end("is_closed", object=seen.name)
        return cls(seen, container, vessel)

    @property
    def room(self) -> float:
        """Volume that still fits in [m³]; negative if it is believed to be too full."""
        return self.vessel.capacity - self.container.contents


@dataclass(frozen=True)
class Amount:
    """Volume that is poured.

    Attributes:
        volume: how much [m³].
        room: how much fits in [m³].
        all: whether that is everything.
        defaults: what the sentence left open.
    """

    volume: float
    room: float
    all: bool = False
    defaults: tuple[DefaultUsed, ...] = ()


def poured_amount(
    problem: GraspProblem, source: Hollow, into: Hollow, goal: g.Pour
) -> Amount | Blocked | None:
    """Volume that is poured; None if it is filled as far as it should be already."""
    has, room, d = source.container.contents, into.room, problem.defaults
    if has < _DROP:
        return dead_end("is_empty", {"contents": 0.0}, object=problem.target.name)
    wanted, used = _wanted_volume(source, into, goal, d)
    if goal.fill is not None and wanted < _DROP:
        return None
    if wanted > room:
        numbers = {"volume": wanted, "room": max(room, 0.0), "contents": has}
        code = "does_not_fit" if has > room else "all_does_not_fit"
        code = code if room > 0.0 else "is_full"
        surely = _surely_poured(source, into, d)
        return dead_end(code, numbers, spans=goal.spans, into=into.seen.name, surely=surely)
    if wanted > has:
        numbers = {"volume": wanted, "contents": has}
        name, surely = problem.target.name, _surely_poured(source, into, d)
        return dead_end("not_so_much", numbers, spans=goal.spans, object=name, surely=surely)
    everything = goal.volume is None and goal.fill is None and wanted > has - _DROP
    return Amount(wanted, room, everything, used)


def _surely_poured(source: Hollow, into: Hollow, d: Defaults) -> float:
    """Volume that is there and fits, in the worst case; as believed if that leaves nothing [m³]."""
    there = source.container.contents - d.sigmas * source.container.contents_sd
    fits = into.room - d.sigmas * into.container.contents_sd
    surely = min(there, fits)
    # Nobody is told to pour less than this [m³].
    return surely if surely >= 1e-5 else min(source.container.contents, max(into.room, 0.0))


def _wanted_volume(
    source: Hollow, into: Hollow, goal: g.Pour, d: Defaults
) -> tuple[float, tuple[DefaultUsed, ...]]:
    """The volume that is meant [m³], and what the sentence left open."""
    has = source.container.contents
    if goal.volume is not None:
        return goal.volume, ()
    if goal.fraction is not None:
        return goal.fraction * has, ()
    if goal.fill is not None:
        share = min(goal.fill, d.pour_fill)
        full = DefaultUsed(name="pour_fill", value=d.pour_fill, unit="", reason="“full”")
        volume = share * into.vessel.capacity - into.container.contents
        return volume, (full,) if goal.fill > d.pour_fill else ()
    if goal.amount is None:
        return has, ()
    said = {
        "little": ("pour_little", min(d.pour_little, has), "m³", "“a little”"),
        "lot": ("pour_lot", d.pour_lot, "", "“a lot”"),
    }
    name, value, unit, reason = said[goal.amount]
    used = DefaultUsed(name=name, value=value, unit=unit, reason=reason)
    return value if unit else value * has, (used,)


_TURNS = np.radians([0.0, 30.0, -30.0, 60.0, -60.0, 90.0, -90.0, 135.0, -135.0, 180.0]).tolist()
_ANGLES = np.radians(np.arange(0.0, 60.0, 5.0))  # beyond the tilt at which it would run out slowly
_LEAST_LEFT = 0.01  # share that may stay where everything is poured
_SOON, _PART_WAIT = 1.0, 2.0  # everything, or a part, has run out so soon after the tilt [s]


@dataclass(frozen=True)
class Motion:
    """Motion of a container that pours, and its predicted result.

    Attributes:
        lean: direction in B [rad].
        angle: largest tilt [rad].
        wait: at that [s].
        ahead: of the lip, where the stream lands [m].
        poured: over the cases of what is not known.
        probability: that enough is received, and next to nothing spilled.
    """

    lean: float
    angle: float
    wait: float
    ahead: float
    poured: Poured
    probability: float


def pour_out(problem: GraspProblem, goal: g.Pour) -> Plan | Reached | Blocked:
    """Lifts a container, pours from it and sets it down again."""
    if goal.into is None:
        return dead_end("into_nothing", spans=goal.spans, object=problem.target.name)
    if goal.into.id == problem.target.name:
        return dead_end("into_itself", spans=goal.spans, object=problem.target.name)
    source = Hollow.from_object(problem.target, problem.defaults)
    if isinstance(source, Blocked):
        return source
    into = Hollow.from_object(problem.state.objects[goal.into.id or ""], problem.defaults)
    if isinstance(into, Blocked):
        return into
    if why := lift_planner.why_not_tiltable(problem):
        return why
    wanted = poured_amount(problem, source, into, goal)
    if isinstance(wanted, Blocked):
        return wanted
    return Reached() if wanted is None else _Pouring(problem, source, into, wanted).best()


class _Pouring:
    """One container that is poured into another one."""

    def __init__(self, problem: GraspProblem, source: Hollow, into: Hollow, wanted: Amount) -> None:
        self._problem, self._source, self._into, self._wanted = problem, source, into, wanted
        slower = problem.motion.speed / problem.defaults.carry_speed
        self._rate = problem.defaults.pour_rate * min(slower, 1.0)

    def best(self) -> Plan | Blocked:
        """The first way that hand and arm can go."""
        problem, held = self._problem, held_already(self._problem)
        if not held:
            return first_plan_of_groups(body_candidates(problem), self._best_with)
        closing = [np.array(held[0].grasp.closing_W) @ problem.target.pose.R_WB]
        motions = self._likely_motions(closing)
        if isinstance(motions, Blocked):
            return motions
        ways = [replace(held[0], lean=motion.lean) for motion in motions.values()]
        return self._first_way(ways, motions)

    def _best_with(self, each: list[Candidate]) -> Plan | Blocked:
        """The first way with one of some grasps."""
        motions = self._likely_motions([candidate.closing for candidate in each])
        if isinstance(motions, Blocked):
            return motions
        ways = stable_grasps(self._problem, self._grasp_loads(each, motions))
        if isinstance(ways, Blocked):
            return ways
        # The hand had better be beside what pours, not over it.
        beside_first = sorted(ways, key=lambda hold: hold.grasp.approach_W[2] < -0.5)
        return self._first_way(beside_first, motions)

    def _first_way(self, ways: list[StableGrasp], motions: dict[int, Motion]) -> Plan | Blocked:
        """The first of some grasps with some motions that hand and arm can go."""
        drafts = {k: [self._motion_draft(m, turn) for turn in _TURNS] for k, m in motions.items()}
        ranked = [
            (rank + times, (hold, draft))
            for rank, hold in enumerate(ways)
            for times, draft in enumerate(drafts[_lean_key(hold.lean)])
        ]
        found = [way for _, way in sorted(ranked, key=lambda each: each[0])]
        return first_reachable_plan(self._problem, "pour", found)

    def _grasp_loads(self, each: list[Candidate], motions: dict[int, Motion]) -> list[GraspLoad]:
        """All ways to hold it through its motion."""
        found = []
        for candidate in each:
            for lean in self._lean_directions(candidate.closing):
                motion = motions.get(_lean_key(lean))
                if motion is not None:
                    found.append(GraspLoad(candidate, None, motion.lean, motion.angle))
        return found

    def _lean_directions(self, closing: Array) -> list[float]:
        """Directions in B in which it may lean, held so: along the line across [rad]."""
        opening = np.array([*self._source.container.opening.centre, 0.0])
        off = float(np.linalg.norm(opening))
        # An opening so near to the middle has no side [m].
        return [
            heading_of(side * closing)
            for side in (1.0, -1.0)
            if off < 0.001 or side * closing @ opening > lift_planner.TO_THE_SIDE * off
        ]

    def _likely_motions(self, closing: list[Array]) -> dict[int, Motion] | Blocked:
        """The motion for each direction in which it may lean, if it is likely enough."""
        leans = {_lean_key(lean): lean for each in closing for lean in self._lean_directions(each)}
        if not leans:
            held = self._problem.state.held is not None
            code = "wrong_side_in_hand" if held else "wrong_side"
            holds = "is held" if held else "can be held"
            return dead_end(code, object=self._problem.target.name, holds=holds)
        found = {key: self._pour_motion(lean) for key, lean in leans.items()}
        best = max(found.values(), key=lambda motion: motion.probability)
        if best.probability < self._problem.effort.probability:
            numbers = {
                "volume": self._wanted.volume,
                "room": self._wanted.room,
                **{name: float(value) for name, value in best.poured.mean_volumes().items()},
                "probability": best.probability,
                "asked_probability": self._problem.effort.probability,
            }
            name, into = self._problem.target.name, self._into.seen.name
            return dead_end("may_spill", numbers, object=name, into=into)
        asked = self._problem.effort.probability
        return {key: motion for key, motion in found.items() if motion.probability >= asked}

    def _pour_motion(self, lean: float) -> Motion:
        container, vessel, d = self._source.container, self._source.vessel, self._problem.defaults
        wanted, basin = self._wanted, self._into.container
        if wanted.all:
            angle, wait = _all_of_it(vessel, container.contents, lean, self._rate)
        else:
            least = max(container.contents - d.sigmas * container.contents_sd, wanted.volume)
            angle, wait = _part_of_it(vessel, least, wanted.volume, lean, self._rate)
        motion = {"heading": lean, "angle": angle, "rate": self._rate, "wait": wait}
        # What is not known of either content counts where it runs over.
        sd = math.hypot(container.contents_sd, basin.contents_sd)
        running = UncertainPour.from_belief(vessel, container.contents, sd, **motion)
        ahead = float(running.nominal_pour.landing(d.pour_clearance)[0])
        catch = Catch(
            along=ahead,
            across=0.0,
            fall=d.pour_clearance,
            radius=basin.opening.radius,
            free=wanted.room,
            sd=d.pour_aim,
        )
        everything = running.caught_by(catch)
        poured = everything if wanted.all else _pour_stopped_at(everything, wanted.volume)
        # Probability that enough is received, and next to nothing spilled.
        if wanted.all:
            enough = poured.received >= d.pour_all * poured.contents
        else:
            missing = d.pour_tolerance * self._source.container.contents
            enough = poured.received >= wanted.volume - missing
        clean = poured.spilled <= d.spill_tolerance * poured.poured
        return Motion(lean, angle, wait, ahead, poured, float((enough & clean).mean()))

    def _motion_draft(self, motion: Motion, turn: float) -> MotionDraft:
        """The steps after the grasp, with the container turned about the vertical before."""
        problem, into, d = self._problem, self._into.seen, self._problem.defaults
        pose, held = problem.target.pose, problem.state.held is not None
        heading = math.remainder(pose.yaw + turn + motion.lean, math.tau)
        # The stream falls into the middle of the opening below, at height 0.
        below = np.array([*self._into.container.opening.centre, 0.0])
        lip = into.pose.p_WB + into.pose.R_WB @ below - motion.ahead * unit(heading)
        behind = float(np.linalg.norm(self._source.vessel.lip_point(motion.lean)[:2]))
        x, y, _ = (lip - behind * unit(heading)).tolist()
        up = max(
            lift_planner.clearance_height(problem, Aim(x=x, y=y)),
            into.model.top + d.carry_clearance,
        )
        mean = {name: float(value) for name, value in motion.poured.mean_volumes().items()}
        filled = self._into.container.contents + mean["received"]
        out = PourOut(
            into=into.name,
            heading=heading,
            lip_W=(float(lip[0]), float(lip[1]), into.model.top + d.pour_clearance),
            angle=motion.angle,
            rate=self._rate,
            wait=motion.wait + d.pour_wait,
            volume=None if self._wanted.all else self._wanted.volume,
            prediction=PourPrediction(**mean, level_after=filled / self._into.vessel.capacity),
        )
        steps: tuple[Action, ...] = (*lift_planner.lift_steps(problem, up), out)
        if turn:
            turned, back = (Aim(x=pose.x, y=pose.y, yaw=pose.yaw + by) for by in (turn, 0.0))
            steps = (*lift_planner.lift_steps(problem, up), Carry(to=turned), out, Carry(to=back))
        used = DefaultUsed(name="pour_rate", value=d.pour_rate, unit="rad/s", reason="no rate said")
        by_default = () if self._rate < d.pour_rate else (used,)
        return MotionDraft(
            steps if held else (*steps, SetDown()),
            motion.probability,
            aim=None if held else Aim(x=pose.x, y=pose.y, yaw=pose.yaw),
            defaults=(*self._wanted.defaults, *by_default),
            notes=(f"the stream lands {1e3 * motion.ahead:.0f} mm ahead of the lip",),
        )


def _lean_key(lean: float | None) -> int:
    """A direction in whole degrees."""
    assert lean is not None, "it is tilted"
    return round(math.degrees(lean)) % 360


def _all_of_it(vessel: Vessel, volume: float, lean: float, rate: float) -> tuple[float, float]:
    """Least tilt at which all runs out soon, and how long to wait there."""
    nearly = (1.0 - _LEAST_LEFT) * volume
    angles = float(tilt_for(vessel, volume, nearly, lean)) + _ANGLES
    running = pour(vessel, volume, heading=lean, angle=angles, rate=rate, wait=2.0 * _SOON)
    late = running.end_time - angles / rate
    good = (running.total_volume >= nearly) & (late <= _SOON)
    first = int(good.argmax()) if good.any() else len(angles) - 1
    return float(angles[first]), max(float(late[first]), 0.0)


def _part_of_it(
    vessel: Vessel, volume: float, part: float, lean: float, rate: float
) -> tuple[float, float]:
    """Least tilt at which a part, if not the last drop, runs out soon; how long to wait there."""
    part = min(part, (1.0 - _LEAST_LEFT) * volume)
    angles = float(tilt_for(vessel, volume, part, lean)) + 0.5 * _ANGLES
    running = pour(vessel, volume, heading=lean, angle=angles, rate=rate, wait=_PART_WAIT)
    good = running.total_volume >= part
    first = int(good.argmax()) if good.any() else len(angles) - 1
    return float(angles[first]), _PART_WAIT


def _pour_stopped_at(poured: Poured, volume: float) -> Poured:
    """A pour that ends when so much has left."""
    share = np.minimum(volume / np.maximum(poured.poured, 1e-12), 1.0)
    return Poured(poured.contents, share * poured.poured, share * poured.received)
