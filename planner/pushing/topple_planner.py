"""Over an edge: the push that topples or tilts an object, and what must come before it.

From where it stands, if one of its faces looks that way; if none does, it is turned first. Where
that does not go, it falls askew, if that is still to the side that is asked, or it is brought to a
place near by and falls there.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import TYPE_CHECKING

from planner.pushing.contact_planner import Found, best_push
from planner.pushing.push_paths import Leg, displaced, headings, obliqueness, stop
from planner.pushing.push_sequence import Journey, clearances
from planner.pushing.touchable_sides import straightest
from planner.refusals import push_refusals as refusals
from planner.types.actions import Aim, Push
from planner.types.plan import Reached
from planner.types.refusal import Refusal

if TYPE_CHECKING:
    from collections.abc import Iterator

    from planner.problem.push_problem import Asked
    from planner.types.defaults import Defaults
    from planner.types.robot import Reach
    from planner.types.world_state import SeenObject, WorldState

_ASKEW = math.radians(5.0)  # a fall less askew than this is not made straighter
_SURELY = math.radians(3.0)  # less askew by this, it falls to the side that is asked
_FORESIGHT = 0.015  # more room that a fall needs which is foreseen behind other pushes [m]
_CONTACTS = 2  # of each push for such a place that the reach is asked for
_ASIDE = (0.05, 0.10, 0.15, 0.20)  # ways to a place where it may fall instead [m]


class Fall:
    """A fall or a tilt of an object.

    Args:
        asked: the fall or the tilt.
        target: the object.
        state: what is believed.
        reach: whether the hand gets somewhere.
        defaults: margins, and what a clause means when nothing more is said.
        foreseen: pushes that a plan before this one had meant to come now.
    """

    def __init__(
        self,
        asked: Asked,
        target: SeenObject,
        state: WorldState,
        reach: Reach,
        defaults: Defaults,
        foreseen: tuple[Push, ...] = (),
    ) -> None:
        self._asked, self._target, self._state = asked, target, state
        self._reach, self._defaults, self._foreseen = reach, defaults, foreseen

    def pushes(self) -> list[Found] | Refusal:
        """The pushes that make it fall where it stands, square to the side that is asked."""
        asked, target = self._asked, self._target
        askew = 0.0 if asked.heading is None else obliqueness(target, asked.heading)
        if abs(askew) <= 0.5 * self._defaults.side_tolerance or asked.face is not None:
            direct = best_push(asked, target, self._state, self._reach, self._defaults)
            if not isinstance(direct, Refusal):
                return [direct]
            # Square to the direction it may still find room.
            if abs(askew) < _ASKEW or asked.face is not None or asked.region is not None:
                return direct
        if asked.region is not None:
            return refusals.turned_first(asked, target, askew)
        return self._turned_first(askew)

    def otherwise(self) -> list[Found] | None:
        """The pushes that make it fall askew or elsewhere; None if there are none."""
        return self._askew() or self._elsewhere()

    def _turned_first(self, askew: float) -> list[Found] | Refusal:
        target = self._target
        square = target.pose.yaw + askew
        aim = Aim(x=target.pose.x, y=target.pose.y, yaw=square)
        on_its_base = replace(self._asked, outcome="slide", rotates=True, aims=(aim,), tilt=None)
        pushes = Journey(
            on_its_base, aim, target, self._state, self._reach, self._defaults, self._foreseen
        ).pushes()
        assert not isinstance(pushes, Reached), "it stands askew"
        if isinstance(pushes, Refusal):
            return pushes
        there = replace(target, pose=replace(target.pose, yaw=square))
        then = self._then(there, self._defaults)
        return then if isinstance(then, Refusal) else [*pushes, then]

    def _then(self, there: SeenObject, defaults: Defaults) -> Found | Refusal:
        """The last push from where others leave the object, which will not be there exactly."""
        after = replace(self._state, objects={**self._state.objects, there.name: there})
        careful = replace(
            defaults,
            clearance=defaults.clearance + _FORESIGHT,
            clearance_fragile=defaults.clearance_fragile + _FORESIGHT,
        )
        return best_push(self._asked, there, after, self._reach, careful)

    def _askew(self) -> list[Found] | None:
        """The push over the face that is most square to the side, if it still falls there."""
        asked, target = self._asked, self._target
        if asked.heading is None or asked.face is not None:
            return None
        if abs(obliqueness(target, asked.heading)) > self._defaults.side_tolerance - _SURELY:
            return None
        side = straightest(target, asked.heading)
        found = best_push(asked, target, self._state, self._reach, self._defaults, side)
        return None if isinstance(found, Refusal) else [found]

    def _elsewhere(self) -> list[Found] | None:
        """A push to a place near by, the nearest first, and the fall there.

        What is said about the contact holds for every push, and a tilt is about the place where
        the object stands: neither is brought elsewhere.
        """
        asked, target, state = self._asked, self._target, self._state
        bound = asked.face or asked.region or asked.tilt is not None or asked.limits.duration
        if bound:
            return None
        few = replace(self._defaults, most_contacts=_CONTACTS)
        kept = clearances(asked, target, state, self._defaults)
        for leg in _ways_aside(target):
            if stop(target, (leg,), state, kept, self._defaults.clearance + _FORESIGHT) is not None:
                continue
            then = self._then(displaced(target, leg), few)
            if isinstance(then, Refusal):
                continue
            aside = replace(asked, outcome="slide", heading=leg.heading, distance=leg.distance)
            first = best_push(aside, target, state, self._reach, few)
            if not isinstance(first, Refusal):
                return [first, then]
        return None


def _ways_aside(target: SeenObject) -> Iterator[Leg]:
    """Pushes square to its faces, the shortest first."""
    ahead = Aim(x=target.pose.x + 1.0, y=target.pose.y, yaw=target.pose.yaw)
    for distance, heading in itertools.product(_ASIDE, headings(target, ahead)):
        yield Leg(heading, distance)
