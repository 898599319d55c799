"""Over an edge: the push that topples or tilts an object, and what must come before it.

From where it stands, if one of its faces looks that way; if none does, it is turned first. Where
that does not go, it falls askew, if that is still to the side that is asked, or it is brought to a
place near by and falls there.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

from planner.problem.planning_problem import PushProblem, PushStep
from planner.pushing.contact_planner import PushCandidate, best_push
from planner.pushing.contact_sampling import straightest_side
from planner.pushing.push_paths import (
    Obstructions,
    PathSegment,
    moved_along,
    obliqueness,
    push_headings,
)
from planner.pushing.push_sequence import PushSequencePlanner, path_clearances
from planner.pushing.reach_search import ReachSearch
from planner.refusals.blocked import Blocked, dead_end, first_made
from planner.types.actions import Aim, Push
from planner.types.world_state import SeenObject

_ASKEW = math.radians(5.0)  # a fall less askew than this is not made straighter
_SURELY = math.radians(3.0)  # less askew by this, it falls to the side that is asked
_FORESIGHT = 0.015  # more room that a fall needs which is foreseen behind other pushes [m]
_CONTACTS = 2  # of each push for such a place that the reach is asked for
_ASIDE = (0.05, 0.10, 0.15, 0.20)  # ways to a place where it may fall instead [m]


class TopplePlanner:
    """Plans the pushes that make an object fall, or tilt.

    Args:
        problem: about the fall or the tilt.
        search: the budget of questions to the robot.
        foreseen: remaining pushes of the previous plan, tried first.
    """

    def __init__(
        self, problem: PushProblem, search: ReachSearch, foreseen: tuple[Push, ...] = ()
    ) -> None:
        self._problem, self._search, self._foreseen = problem, search, foreseen
        self._step = PushStep.from_goal(problem.goal)

    def pushes(self) -> list[PushCandidate] | Blocked:
        """The pushes that make it fall where it stands, square to the side that is asked."""
        problem, contact, heading = self._problem, self._problem.contact, self._step.heading
        askew = 0.0 if heading is None else obliqueness(problem.target, heading)
        if abs(askew) <= 0.5 * problem.defaults.side_tolerance or contact.face is not None:
            direct = best_push(problem, self._step, self._search)
            if not isinstance(direct, Blocked):
                return [direct]
            # Square to the direction it may still find room.
            if abs(askew) < _ASKEW or contact.face is not None or contact.region is not None:
                return direct
        if contact.region is not None:
            numbers, name = {"obliqueness": abs(askew)}, problem.target.name
            where = contact.region
            return dead_end("turn_first", numbers, spans=contact.spans, object=name, region=where)
        target, goal = self._problem.target, self._problem.goal
        square = target.pose.yaw + askew
        aim = Aim(x=target.pose.x, y=target.pose.y, yaw=square)
        on_its_base = replace(goal, outcome="slide", rotates=True, aims=(aim,), tilt=None)
        turning = replace(self._problem, goal=on_its_base)
        pushes = PushSequencePlanner(turning, aim, self._search, self._foreseen).pushes()
        if isinstance(pushes, Blocked):
            return pushes
        assert isinstance(pushes, list), "it stands askew"
        fall = self._fall_from(
            self._problem, replace(target, pose=replace(target.pose, yaw=square))
        )
        return fall if isinstance(fall, Blocked) else [*pushes, fall]

    def other_pushes(self) -> list[PushCandidate] | Blocked:
        """The pushes that make it fall askew or elsewhere."""
        return first_made(way() for way in (self._push_askew, self._pushes_elsewhere))

    def _fall_from(self, problem: PushProblem, there: SeenObject) -> PushCandidate | Blocked:
        """The last push from where others leave the object, which will not be there exactly."""
        defaults = problem.defaults
        careful = replace(
            defaults,
            clearance=defaults.clearance + _FORESIGHT,
            clearance_fragile=defaults.clearance_fragile + _FORESIGHT,
        )
        then = replace(problem.with_target(there), defaults=careful)
        return best_push(then, self._step, self._search)

    def _push_askew(self) -> list[PushCandidate] | Blocked:
        """The push over the face that is most square to the side, if it still falls there."""
        problem, heading = self._problem, self._step.heading
        largest = problem.defaults.side_tolerance - _SURELY
        if (
            heading is None
            or problem.contact.face is not None
            or abs(obliqueness(problem.target, heading)) > largest
        ):
            return dead_end("no_way", object=problem.target.name)
        step = replace(self._step, side=straightest_side(problem.target, heading))
        push = best_push(problem, step, self._search)
        return push if isinstance(push, Blocked) else [push]

    def _pushes_elsewhere(self) -> list[PushCandidate] | Blocked:
        """A push to a place near by, the nearest first, and the fall there."""
        # What is said about the contact holds for every push, and a tilt is about the place where
        # the object stands: neither is brought elsewhere.
        problem, contact = self._problem, self._problem.contact
        bound = contact.face or contact.region or self._step.tilt is not None
        if bound or problem.motion.duration:
            return dead_end("no_way", object=problem.target.name)
        few = replace(problem, effort=replace(problem.effort, contacts=_CONTACTS))
        margin = problem.defaults.clearance + _FORESIGHT
        way = Obstructions(problem.target, problem.state, path_clearances(problem), margin)
        # Pushes square to its faces, the shortest first.
        target = problem.target
        ahead = Aim(x=target.pose.x + 1.0, y=target.pose.y, yaw=target.pose.yaw)
        ways = itertools.product(_ASIDE, push_headings(target, ahead))
        segments = (PathSegment(heading, distance) for distance, heading in ways)
        falls = (
            self._push_and_fall(few, each) for each in segments if way.first_stop((each,)) is None
        )
        return first_made(itertools.chain(falls, [dead_end("no_way", object=target.name)]))

    def _push_and_fall(
        self, problem: PushProblem, segment: PathSegment
    ) -> list[PushCandidate] | Blocked:
        """A push along a segment, and the fall at its end, which is planned first."""
        fall = self._fall_from(problem, moved_along(problem.target, segment))
        if isinstance(fall, Blocked):
            return fall
        aside = replace(
            self._step, outcome="slide", heading=segment.heading, distance=segment.distance
        )
        push = best_push(problem, aside, self._search)
        return push if isinstance(push, Blocked) else [push, fall]
