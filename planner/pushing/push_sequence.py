"""The pushes that bring an object to an aim: it is turned first, then pushed along its faces.

Every push is planned from where the one before it is predicted to leave the object. The first path
on which all pushes are free, likely and within the hand's reach is taken; if there is none, the
refusal is that of the first.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from planner.problem.directions import angle_between, heading_of, unit
from planner.problem.footprints import (
    CLOSER,
    footprint,
    gap,
    kept_gap,
    room_to_edge,
    shortest_detour,
)
from planner.problem.places import object_at
from planner.problem.planning_problem import PushProblem, PushStep
from planner.pushing import push_paths, turn_planner
from planner.pushing.contact_planner import PushCandidate, best_push
from planner.pushing.push_paths import (
    DeniedPushes,
    Obstructions,
    PathSegment,
    SegmentEnd,
    is_denied,
)
from planner.pushing.reach_search import ReachSearch
from planner.refusals.blocked import Blocked, dead_end
from planner.types.actions import Aim, Push
from planner.types.plan import Reached
from planner.types.world_state import SeenObject

FirstStop = Callable[[tuple[PathSegment, ...]], SegmentEnd | None]

_ASIDE = 0.15  # way to a place where it may be turned instead [m]
_ROOM = 0.05  # room that such a place has around [m]
_SPOTS = 2  # such places that are looked at
_NEAR = 0.02  # what is nearer to its aim is not led around anything [m]
_TURNS = 12  # ways to part a turn for which it is asked
_LEAST = 0.01  # a shorter way is not worth proposing [m]
_CLOSE = 0.004  # what is nearer is corrected by a push right there, or counts as there [m]
_SQUARED_UP = math.radians(6.0)  # a turn up to this is made while the object is pushed straight
_SQUARE = math.radians(0.2)  # a turn below this is not
_SURELY = 0.7  # share of the tolerance of a direction that is kept where it ends by an event


class PushSequencePlanner:
    """Plans the pushes that bring an object to one aim.

    Args:
        problem: about the object, as it stands now; every push keeps its limits.
        aim: where the object should be.
        search: the budget of questions to the robot.
        foreseen: remaining pushes of the previous plan, tried first.
    """

    def __init__(
        self,
        problem: PushProblem,
        aim: Aim,
        search: ReachSearch,
        foreseen: tuple[Push, ...] = (),
    ) -> None:
        self._problem, self._aim, self._search = problem, aim, search
        self._foreseen = foreseen
        self._denied = DeniedPushes()
        target, defaults, goal = problem.target, problem.defaults, problem.goal
        oblique = problem.effort.oblique
        self._largest = push_paths.largest_obliqueness(target, defaults.sigmas, steep=oblique)
        self._apart = path_clearances(problem)
        # What it is to meet is come near only by the push that ends as they touch.
        self._clearances = {k: apart for k, apart in self._apart.items() if k != goal.meets}
        # What is turned may be displaced a little more than what is brought somewhere.
        self._within = defaults.aim_drift if goal.rotates else defaults.aim_position

    def pushes(self) -> list[PushCandidate] | Reached | Blocked:
        """The pushes, or the finding that the object is there already."""
        target, problem = self._problem.target, self._problem
        off, turn = self._distance_to_aim(target), self._turn_to_aim(target)
        reached = Reached(aim=self._aim, off=off, turned_off=abs(turn))
        looks_there = abs(turn) <= problem.defaults.aim_angle
        if 1 not in problem.contact.fingers and not problem.goal.rotates:
            looks_there = abs(turn) <= _SQUARED_UP  # one finger alone turns
        if off <= self._within and looks_there:
            return reached
        if abs(turn) <= _SQUARED_UP and off > self._within:
            straight = self._straight_pushes(target)
            is_there = off <= _CLOSE and looks_there
            return reached if is_there and isinstance(straight, Blocked) else straight
        at_aim = [np.array([self._aim.x, self._aim.y])]
        turned = self._turn_pushes(target, turn)
        if isinstance(turned, Blocked):
            places = at_aim + self._roomy_places(target)
            return self._turn_elsewhere(target, turn, places) or turned
        found, there = turned
        if self._distance_to_aim(there) <= self._within:
            return found
        going = self._straight_pushes(there)
        if isinstance(going, list):
            return found + going
        # After turns nothing is as foreseen to the millimetre; what follows is planned anew.
        if self._distance_to_aim(there) <= self._problem.defaults.turn_drift:
            return found
        return self._turn_elsewhere(target, turn, at_aim) or going

    def _distance_to_aim(self, target: SeenObject) -> float:
        """Distance of an object from the aim [m]."""
        return math.dist((self._aim.x, self._aim.y), (target.pose.x, target.pose.y))

    def _turn_to_aim(self, target: SeenObject) -> float:
        """Angle by which it has to turn [rad]."""
        return 0.0 if self._aim.yaw is None else self._aim.yaw - target.pose.yaw

    def _turn_pushes(
        self, target: SeenObject, turn: float
    ) -> tuple[list[PushCandidate], SeenObject] | Blocked:
        """The pushes that turn an object, and the object after them."""
        problem = self._problem
        if 1 not in problem.contact.fingers:
            return dead_end("turned_by_one", spans=problem.contact.spans, object=target.name)
        obstructed: Blocked | None = None
        denied: list[Blocked] = []
        for steps in self._turn_sequences(target, turn):
            met = turn_planner.turn_obstacle(
                target, steps, problem.state, self._apart, problem.defaults.clearance
            )
            if met is not None:
                where = "over the table's edge" if met == "table" else f"into the {met}"
                obstructed = obstructed or dead_end("turn_blocked", object=target.name, where=where)
                continue
            if denied and self._denied.cover_turn(target, steps):
                continue
            made = self._stroke_pushes(target, steps)
            if not isinstance(made, Blocked):
                return made
            denied.append(made)
            if len(denied) == _TURNS:
                break
        if denied:
            return denied[-1]
        return obstructed or dead_end("cannot_turn", object=target.name)

    def _turn_sequences(
        self, target: SeenObject, turn: float
    ) -> Iterator[tuple[turn_planner.TurnStroke, ...]]:
        """Ways to make a turn: the one that was begun, then all others."""
        if target is self._problem.target:
            begun = turn_planner.remaining_turn(target, turn, self._foreseen)
            if begun is not None:
                yield begun
        yield from turn_planner.turn_sequences(target, turn, self._aim)

    def _turn_elsewhere(
        self, target: SeenObject, turn: float, places: list[np.ndarray]
    ) -> list[PushCandidate] | None:
        """The way to one of some places, (2,) each [m], and the turn there; None if there is none.

        What is there by now is not turned there: that was looked at.
        """
        going = replace(self._problem, goal=replace(self._problem.goal, rotates=False))
        for place in places:
            if math.dist(place, target.pose.p_WB[:2]) <= self._within:
                continue
            turned = self._turn_pushes(object_at(target, place), turn)
            if isinstance(turned, Blocked):
                continue
            aim = Aim(x=float(place[0]), y=float(place[1]), yaw=target.pose.yaw)
            way = PushSequencePlanner(going, aim, self._search).pushes()
            if isinstance(way, list):
                return way + turned[0]
        return None

    def _roomy_places(self, target: SeenObject) -> list[np.ndarray]:
        """Some places near by, those with most room around first, shape (2,) each [m]."""
        found, state = [], self._problem.state
        if self._problem.motion.clear_of or self._problem.contact.region is not None:
            return []
        for heading in np.arange(8) * math.pi / 4.0:
            spot = (target.pose.p_WB + _ASIDE * unit(float(heading)))[:2]
            here = footprint(object_at(target, spot))
            rooms = [gap(here, footprint(state.objects[name])) for name in self._clearances]
            room = min([*rooms, room_to_edge(here, state.table)])
            if room > _ROOM:
                found.append((-round(room, 3), float(heading), spot))
        return [spot for *_, spot in sorted(found, key=lambda each: each[:2])[:_SPOTS]]

    def _stroke_pushes(
        self, target: SeenObject, steps: tuple[turn_planner.TurnStroke, ...]
    ) -> tuple[list[PushCandidate], SeenObject] | Blocked:
        """A push for each part of a turn, and the object after them."""
        contact = replace(self._problem.contact, fingers=(1,))
        found = []
        for stroke in steps:
            # The side is where it was on the object, which has turned since.
            normal = target.pose.R_WB @ np.array(stroke.side.face.normal)
            step = PushStep(
                self._problem.goal.outcome,
                heading=None,
                distance=0.0,
                swing=stroke.angle,
                lateral=stroke.lateral(target),
                side=replace(stroke.side, heading=heading_of(-normal)),
            )
            here = replace(self._problem.with_target(target), contact=contact)
            push = best_push(here, step, self._search)
            if isinstance(push, Blocked):
                if is_denied(push):
                    self._denied.note_stroke(target, stroke)
                return push
            found.append(push)
            target = stroke.target_after(target)
        return found, target

    def _straight_pushes(self, target: SeenObject) -> list[PushCandidate] | Blocked:
        """The pushes of the first path that the hand can make."""
        first: Blocked | None = None
        self._denied.forget_segments()
        first_stop = self._first_stops(target)
        free = (
            path
            for path in self._ordered_paths(target)
            if not self._denied.cover_path(target, path) and first_stop(path) is None
        )
        for path in islice(free, 5):  # free ways for which the hand's reach is asked
            made = self._path_pushes(target, path)
            # Paths that come later are longer.
            if isinstance(made, list) or made.reason == "out_of_time":
                return made
            first = first or made
        return first or self._dead_end(target, first_stop)

    def _paths_to_aim(self, target: SeenObject) -> Iterator[tuple[PathSegment, ...]]:
        """Paths to the aim: straight to it, around what stands there, and with a side step."""
        problem = self._problem
        straight = push_paths.direct_paths(target, self._aim, self._within, self._largest)
        if problem.goal.until == "moves":
            # It ends as it begins, so the first segment of a path is all of it.
            yield from (path[:1] for path in straight)
            return
        if problem.effort.oblique:
            yield from (path for path in straight if len(path) == 1)
            return
        yield from straight
        if problem.effort.direct or self._distance_to_aim(target) <= _CLOSE:
            return
        aside = push_paths.sidestep_paths(target, self._aim, self._within, self._largest)
        yield from sorted(
            [*self._detour_paths(target), *aside],
            # Length of a path, and what its pushes cost [m].
            key=lambda path: sum(s.distance for s in path) + push_paths.ANOTHER_PUSH * len(path),
        )

    def _ordered_paths(self, target: SeenObject) -> Iterator[tuple[PathSegment, ...]]:
        """Paths to the aim; first those on which what is met is met in the asked direction."""
        paths = self._paths_to_aim(target)
        goal = self._problem.goal
        if goal.meets is None or goal.heading is None:
            return paths
        other = footprint(self._problem.state.objects[goal.meets])
        most = _SURELY * self._problem.defaults.direction_tolerance
        met = {path: push_paths.heading_at_contact(target, path, other) for path in paths}
        off = {path: abs(angle_between(at, goal.heading)) for path, at in met.items()}
        return iter(sorted(off, key=lambda path: off[path] > most))

    def _detour_paths(self, target: SeenObject) -> Iterator[tuple[PathSegment, ...]]:
        headings = push_paths.push_headings(target, self._aim)
        if len(headings) < 2 or self._distance_to_aim(target) < _NEAR:
            return
        found = shortest_detour(
            target,
            (self._aim.x, self._aim.y),
            headings,
            self._problem.state,
            self._clearances,
            self._problem.defaults.clearance,
            push_paths.ANOTHER_PUSH,
        )
        if found is not None:
            yield tuple(PathSegment(heading, length) for heading, length in found)

    def _first_stops(self, target: SeenObject) -> FirstStop:
        """The query for the first thing that stands in a path of an object."""
        problem, margin = self._problem, self._problem.defaults.clearance
        way = Obstructions(target, problem.state, self._clearances, margin)
        if problem.goal.meets is None:
            return way.first_stop
        before = Obstructions(target, problem.state, self._apart, margin)
        return lambda path: before.first_stop(path[:-1]) or way.first_stop(path)

    def _dead_end(self, target: SeenObject, first_stop: FirstStop) -> Blocked:
        """Dead end since something stands in all paths: that of the first, the shortest."""
        path = next(self._paths_to_aim(target), None)
        if path is None:
            return dead_end("no_way", object=target.name)
        met = first_stop(path)
        assert met is not None, "a free path would have been taken"
        distance = sum(segment.distance for segment in path)
        # What is to be brought to a place would not be there after a shorter way.
        so_far = met.free > _LEAST and math.isfinite(self._problem.goal.distance)
        marks = (push_paths.free_length_mark(target, path, met),)
        if met.other is None:
            numbers = {"room": max(met.free, 0.0), "distance": distance}
            code = "off_the_table_so_far" if so_far else "off_the_table"
            return dead_end(code, numbers, marks=marks, object=target.name)
        numbers = {"free": met.free, "distance": distance}
        code = "in_the_way_so_far" if so_far else "in_the_way"
        return dead_end(code, numbers, marks=marks, object=target.name, other=met.other)

    def _path_pushes(
        self, target: SeenObject, path: tuple[PathSegment, ...]
    ) -> list[PushCandidate] | Blocked:
        """A push for each segment, or for parts of it where the hand cannot make it at one go."""
        problem = self._problem
        if why := why_not_in_time(problem, len(path)):
            return why
        segment, rest = path[0], path[1:]
        best = self._segment_push(target, segment, last=not rest)
        if isinstance(best, Blocked):
            denied = is_denied(best)
            if denied:
                self._denied.note_segment(target, segment)
            # A leg longer than this may be made by several pushes [m].
            far = denied and segment.distance > 0.12
            whole = problem.motion.duration is not None or problem.goal.until == "moves"
            if whole or not far:
                return best
            half = replace(segment, distance=0.5 * segment.distance)
            return self._path_pushes(target, (half, half, *rest))
        if not rest:
            return [best]
        others = self._path_pushes(push_paths.moved_along(target, segment), rest)
        return others if isinstance(others, Blocked) else [best, *others]

    def _segment_push(
        self, target: SeenObject, segment: PathSegment, *, last: bool
    ) -> PushCandidate | Blocked:
        goal = self._problem.goal
        turn = self._turn_to_aim(target) if target is self._problem.target else 0.0
        step = PushStep(
            goal.outcome,
            segment.heading,
            segment.distance,
            turn=turn if _SQUARE < abs(turn) <= _SQUARED_UP else 0.0,
            until=goal.until if last else None,
            meets=goal.meets if last else None,
        )
        return best_push(self._problem.with_target(target), step, self._search)


def why_not_in_time(problem: PushProblem, pushes: int) -> Blocked | None:
    """Several pushes take longer than allowed: the hand goes around the object between two."""
    motion = problem.motion
    if motion.duration is not None and pushes > 1:
        numbers = {"pushes": float(pushes), "max_time": motion.duration}
        return dead_end("several_pushes", numbers, spans=motion.spans, object=problem.target.name)
    return None
    return None


def path_clearances(problem: PushProblem) -> dict[str, float]:
    """Distance that the object keeps from each other one on its way [m]."""
    kept, said, near = {}, dict(problem.motion.clear_of), dict(problem.goal.near)
    meets = problem.goal.meets
    if meets is not None:
        near[meets] = gap(footprint(problem.target), footprint(problem.state.objects[meets]))
    for name, other in problem.others.items():
        # What it is to stand close to it may come as close to on the way, and what it stands close
        # to it must get away from.
        close = kept_gap(footprint(problem.target), footprint(other), problem.clearance(other))
        close = min(close, CLOSER * near.get(name, math.inf))
        kept[name] = max(close, said.get(name, -math.inf))
    return kept
