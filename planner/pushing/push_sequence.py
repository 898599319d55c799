"""The way of an object to an aim: turned first, then pushed along its faces.

Every push is planned from where the one before it is predicted to leave the object. The first way
on which all pushes are free, likely and within the hand's reach is taken; what stops the first of
them is told if there is none.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from planner.geometry.directions import heading_of, unit
from planner.geometry.footprints import footprint, gap, travel_to_edge
from planner.problem.place_regions import moved
from planner.problem.push_problem import Asked
from planner.pushing import turn_planner as turns
from planner.pushing.contact_planner import Found, best_push
from planner.pushing.push_paths import (
    ANOTHER_PUSH,
    Leg,
    Stop,
    around,
    displaced,
    grip,
    headings,
    stop,
    ways,
)
from planner.pushing.turn_planner import Swing
from planner.refusals import push_refusals as refusals
from planner.types.actions import Aim, Push
from planner.types.plan import Reached
from planner.types.refusal import Refusal

if TYPE_CHECKING:
    from collections.abc import Iterator

    from planner.types.defaults import Defaults
    from planner.types.robot import Reach
    from planner.types.world_state import SeenObject, WorldState

_WAYS = 5  # free ways for which the hand's reach is asked
_ASIDE = 0.15  # way to a place where it may be turned instead [m]
_ROOM = 0.05  # room that such a place has around [m]
_SPOTS = 2  # such places that are looked at
_CLOSER = 0.7  # share of a gap that is asked for that is kept on the way
_NEAR = 0.02  # what is nearer to its aim is not led around anything [m]
_PARTED = 0.12  # a leg longer than this may be made by several pushes [m]
_TURNS = 12  # ways to part a turn for which it is asked
_CLOSE = 0.004  # what is nearer is corrected by a push right there, or counts as there [m]
_SQUARED_UP = math.radians(6.0)  # a turn up to this is made while the object is pushed straight
_SQUARE = math.radians(0.2)  # a turn below this is not


class Journey:
    """The way of an object to an aim.

    Args:
        asked: limits that every push keeps.
        aim: where the object should be.
        target: the object, as it stands now; its heading is not wrapped.
        state: what is believed.
        reach: whether the hand gets somewhere.
        defaults: margins and tolerances.
        foreseen: pushes that a plan before this one had meant to come now.
    """

    def __init__(
        self,
        asked: Asked,
        aim: Aim,
        target: SeenObject,
        state: WorldState,
        reach: Reach,
        defaults: Defaults,
        foreseen: tuple[Push, ...] = (),
    ) -> None:
        self._foreseen = foreseen
        self._asked, self._aim, self._target, self._state = asked, aim, target, state
        self._reach, self._defaults = reach, defaults
        self._largest = grip(target, defaults.sigmas, steep=asked.steep)
        self._apart = clearances(asked, target, state, defaults)
        # What it is to meet is come near only by the push that ends as they touch.
        self._clearances = {k: apart for k, apart in self._apart.items() if k != asked.meets}
        # What is turned may be displaced a little more than what is brought somewhere.
        self._within = defaults.aim_drift if asked.rotates else defaults.aim_position

    def pushes(self) -> list[Found] | Reached | Refusal:
        """The pushes, that it is there already, or why it does not get there."""
        target = self._target
        off, turn = self._off(target), self._turn(target)
        reached = Reached(aim=self._aim, off=off, turned_off=abs(turn))
        looks_there = abs(turn) <= self._defaults.aim_angle
        if 1 not in self._asked.fingers and not self._asked.rotates:
            looks_there = abs(turn) <= _SQUARED_UP  # one finger alone turns
        if off <= self._within and looks_there:
            return reached
        if abs(turn) <= _SQUARED_UP and off > self._within:
            straight = self._straight(target)
            stuck = isinstance(straight, Refusal) and off <= _CLOSE and looks_there
            return reached if stuck else straight
        swung = self._swung(target, turn)
        if isinstance(swung, Refusal):
            return self._turned_elsewhere(target, turn) or swung
        found, there = swung
        if self._off(there) <= self._within:
            return found
        then = self._straight(there)
        if isinstance(then, Refusal):
            # After turns nothing is as foreseen to the millimetre; what follows is planned anew.
            return found if self._off(there) <= self._defaults.turn_drift else then
        return found + then

    def _off(self, target: SeenObject) -> float:
        """Distance of an object from the aim [m]."""
        return math.dist((self._aim.x, self._aim.y), (target.pose.x, target.pose.y))

    def _turn(self, target: SeenObject) -> float:
        """Angle by which it has to turn [rad]."""
        return 0.0 if self._aim.yaw is None else self._aim.yaw - target.pose.yaw

    def _with(self, target: SeenObject) -> WorldState:
        """What is believed once the object is somewhere else."""
        return replace(self._state, objects={**self._state.objects, target.name: target})

    # -- turning -------------------------------------------------------------------------------

    def _swung(self, target: SeenObject, turn: float) -> tuple[list[Found], SeenObject] | Refusal:
        """The pushes that turn an object, and the object after them."""
        if 1 not in self._asked.fingers:
            return refusals.turned_by_one(self._asked, target)
        refusal: Refusal | None = None
        tried = 0
        for steps in self._partings(target, turn):
            met = turns.free(target, steps, self._state, self._apart, self._defaults.clearance)
            if met is not None:
                refusal = refusal or refusals.turn_blocked(target, met)
                continue
            made = self._swings(target, steps)
            if not isinstance(made, Refusal):
                return made
            refusal = made
            tried += 1
            if tried == _TURNS:
                break
        return refusal or refusals.cannot_turn(target)

    def _partings(self, target: SeenObject, turn: float) -> Iterator[tuple[Swing, ...]]:
        """Ways to make a turn: the one that was begun, then all others."""
        if target is self._target:
            begun = turns.continued(target, turn, self._foreseen)
            if begun is not None:
                yield begun
        yield from turns.swings(target, turn, self._aim)

    def _turned_elsewhere(self, target: SeenObject, turn: float) -> list[Found] | None:
        """The way to a place near by with room to turn, and the turn; None if there is none."""
        if self._asked.limits.clear_of or self._asked.region is not None:
            return None
        for spot in self._roomy(target):
            there = moved(target, spot)
            swung = self._swung(there, turn)
            if isinstance(swung, Refusal):
                continue
            aim = Aim(x=float(spot[0]), y=float(spot[1]), yaw=target.pose.yaw)
            asked = replace(self._asked, rotates=False)
            way = Journey(asked, aim, target, self._state, self._reach, self._defaults).pushes()
            if isinstance(way, list):
                return way + swung[0]
        return None

    def _roomy(self, target: SeenObject) -> list[np.ndarray]:
        """Some places near by, those with most room around first, shape (2,) each [m]."""
        found = []
        for heading in np.arange(8) * math.pi / 4.0:
            spot = (target.pose.p_WB + _ASIDE * unit(float(heading)))[:2]
            here = footprint(moved(target, spot))
            rooms = [gap(here, footprint(self._state.objects[name])) for name in self._clearances]
            edges = [
                travel_to_edge(here, self._state.table, unit(quarter * math.pi / 2.0)[:2], 0.0)
                for quarter in range(4)
            ]
            room = min([*rooms, *edges])
            if room > _ROOM:
                found.append((-round(room, 3), float(heading), spot))
        return [spot for *_, spot in sorted(found, key=lambda each: each[:2])[:_SPOTS]]

    def _swings(
        self, target: SeenObject, steps: tuple[Swing, ...]
    ) -> tuple[list[Found], SeenObject] | Refusal:
        found = []
        for step in steps:
            asked = replace(
                self._asked,
                heading=None,
                distance=0.0,
                fingers=(1,),
                swing=step.angle,
                lateral=step.lateral(target),
                until=None,
                meets=None,
            )
            # The side is where it was on the object, which has turned since.
            normal = target.pose.R_WB @ np.array(step.side.face.normal)
            side = replace(step.side, heading=heading_of(-normal))
            best = best_push(asked, target, self._with(target), self._reach, self._defaults, side)
            if isinstance(best, Refusal):
                return best
            found.append(best)
            target = step.left(target)
        return found, target

    # -- going straight ------------------------------------------------------------------------

    def _straight(self, target: SeenObject) -> list[Found] | Refusal:
        """The pushes of the first way that the hand can make."""
        refusal: Refusal | None = None
        free = (way for way in self._ways(target) if self._stop(target, way) is None)
        for way in islice(free, _WAYS):
            found = self._legs(target, way)
            # Ways that come later are longer.
            if not isinstance(found, Refusal) or found.reason == "out_of_time":
                return found
            refusal = refusal or found
        return refusal or self._blocked(target)

    def _ways(self, target: SeenObject) -> Iterator[tuple[Leg, ...]]:
        """Ways to the aim: straight to it, around what stands there, and some with a side step."""
        if self._asked.until == "moves":
            # It ends as it begins, so the first leg of a way is all of it.
            for way in ways(target, self._aim, self._within, self._largest):
                yield way[:1]
            return
        straight = ways(target, self._aim, self._within, self._largest)
        if self._asked.steep:
            yield from (way for way in straight if len(way) == 1)
            return
        yield from straight
        if self._asked.direct or self._off(target) <= _CLOSE:
            return
        led = [*self._detour(target), *around(target, self._aim, self._within, self._largest)]
        yield from sorted(led, key=_cost)

    def _detour(self, target: SeenObject) -> Iterator[tuple[Leg, ...]]:
        along = headings(target, self._aim)
        if len(along) < 2 or self._off(target) < _NEAR:
            return
        from planner.geometry.visibility_graph import shortest_detour

        found = shortest_detour(
            target,
            (self._aim.x, self._aim.y),
            along,
            self._state,
            self._clearances,
            self._defaults.clearance,
            ANOTHER_PUSH,
        )
        if found is not None:
            yield tuple(Leg(heading, length) for heading, length in found)

    def _stop(self, target: SeenObject, way: tuple[Leg, ...]) -> Stop | None:
        met, margin = None, self._defaults.clearance
        if self._asked.meets is not None:
            met = stop(target, way[:-1], self._state, self._apart, margin)
        return met or stop(target, way, self._state, self._clearances, margin)

    def _blocked(self, target: SeenObject) -> Refusal:
        """What stands in all ways: told of the first, which is the shortest."""
        way = next(self._ways(target), None)
        if way is None:
            return refusals.no_way(target)
        met = self._stop(target, way)
        assert met is not None, "a free way would have been taken"
        distance = sum(leg.distance for leg in way)
        if met.other is None:
            return refusals.off_the_table(self._asked, target, distance, met.free)
        other = self._state.objects[met.other]
        return refusals.in_the_way(self._asked, target, other, distance, met.free)

    def _legs(self, target: SeenObject, way: tuple[Leg, ...]) -> list[Found] | Refusal:
        """A push for each leg, or for parts of it where the hand cannot make it at one go."""
        if self._asked.limits.duration is not None and len(way) > 1:
            return refusals.several_pushes(self._asked, target, len(way))
        leg, rest = way[0], way[1:]
        best = self._leg(target, leg, last=not rest)
        if isinstance(best, Refusal):
            far = leg.distance > _PARTED and best.reason in ("out_of_reach", "blocked")
            whole = self._asked.limits.duration is not None or self._asked.until == "moves"
            if whole or not far:
                return best
            half = replace(leg, distance=0.5 * leg.distance)
            return self._legs(target, (half, half, *rest))
        if not rest:
            return [best]
        then = self._legs(displaced(target, leg), rest)
        return then if isinstance(then, Refusal) else [best, *then]

    def _leg(self, target: SeenObject, leg: Leg, *, last: bool) -> Found | Refusal:
        turn = self._turn(target) if target is self._target else 0.0
        asked = replace(
            self._asked,
            heading=leg.heading,
            distance=leg.distance,
            turn=turn if _SQUARE < abs(turn) <= _SQUARED_UP else 0.0,
            until=self._asked.until if last else None,
            meets=self._asked.meets if last else None,
        )
        return best_push(asked, target, self._with(target), self._reach, self._defaults)


def _cost(way: tuple[Leg, ...]) -> float:
    """Length of a way, and what its pushes cost [m]."""
    return sum(leg.distance for leg in way) + ANOTHER_PUSH * len(way)


def clearances(
    asked: Asked, target: SeenObject, state: WorldState, defaults: Defaults
) -> dict[str, float]:
    """Distance that an object keeps from each other one on its way [m]."""
    kept, said, near = {}, dict(asked.limits.clear_of), dict(asked.near)
    if asked.meets is not None:
        near[asked.meets] = gap(footprint(target), footprint(state.objects[asked.meets]))
    for name, other in state.objects.items():
        usual = defaults.clearance_fragile if other.fragile else defaults.clearance
        # What it is to stand close to it may come as close to on the way.
        usual = min(usual, _CLOSER * near.get(name, math.inf))
        kept[name] = max(usual, said.get(name, 0.0))
    return {name: apart for name, apart in kept.items() if name != target.name}
