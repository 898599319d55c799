"""Attempts to do by pushes what is asked, each with more effort than the one before.

First as usual. Where the hand did not get to what would do, it looks thoroughly. What has begun
goes on less surely. Last come ways of less precision: a steep push, a place that only just counts
as the one that is asked, a fall askew or elsewhere.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from planner.geometry.directions import unit
from planner.problem.goal_poses import here
from planner.pushing.push_sequence import Journey
from planner.pushing.topple_planner import Fall
from planner.refusals import push_refusals as refusals
from planner.types.actions import Aim, Limits, Push
from planner.types.plan import Plan, PlanTask, Reached
from planner.types.refusal import Refusal
from planner.types.robot import GivenUpError, Patient

if TYPE_CHECKING:
    from collections.abc import Iterator

    from planner.problem.push_problem import Asked
    from planner.pushing.contact_planner import Found
    from planner.types.defaults import Defaults
    from planner.types.world_state import SeenObject, WorldState

_TASKS: dict[str, PlanTask] = {"toppled": "topple", "tilted": "tilt"}  # by the last push's end
_SHORT = (0.0, 0.5, 1.0)  # of the room that the tolerance of the distance leaves
_ASIDE = (0.0, 0.5, -0.5, 1.0, -1.0)  # of that of the direction, to the left of the way
_LEAST = 3.0  # of tolerances; of shorter ways a bound ("at least") keeps less than one to spare
_IN_THE_WAY = ("impossible", "blocked")  # refusals that a place near by may avoid


def persistently(usual: Attempt) -> Plan | Reached | Refusal:
    """The plan of an attempt, or of one with more effort, or why none makes one."""
    attempt, made = usual, usual.made()
    denied = usual.reach.denied
    if isinstance(made, Refusal) and denied:
        attempt = usual.thorough()
        again = attempt.made()
        # A search that was given up says less than one that came to its end.
        if not isinstance(again, Refusal) or again.reason != "out_of_time":
            made = again
    if isinstance(made, Refusal) and made.reason == "too_uncertain" and usual.before:
        made = attempt.bolder().made()
    if isinstance(made, Refusal):
        found = usual.imprecisely(made, denied=denied)
        if found is not None:
            why = f"another way, since {made.message}"
            return found.model_copy(update={"notes": (why, *found.notes)})
    return made


@dataclass(frozen=True)
class Attempt:
    """One attempt.

    Attributes:
        asked: what is to be done.
        target: the object.
        state: what is believed.
        reach: whether the hand gets somewhere.
        defaults: margins, and what a clause means when nothing more is said.
        before: the plan whose first push was made last.
    """

    asked: Asked
    target: SeenObject
    state: WorldState
    reach: Patient
    defaults: Defaults
    before: Plan | None

    def made(self) -> Plan | Reached | Refusal:
        """The plan, or why there is none."""
        try:
            if self.asked.aims:
                return self._to_an_aim()
            found = self._fall().pushes()
            return found if isinstance(found, Refusal) else self._together(found, None)
        except GivenUpError as given_up:
            return refusals.given_up(self.target, given_up.answers)

    def thorough(self) -> Attempt:
        """The same with more contacts, for which the hand looks longer."""
        return replace(
            self,
            reach=self.reach.thorough(self.defaults.most_looks_last),
            defaults=replace(self.defaults, most_contacts=self.defaults.most_contacts_last),
        )

    def bolder(self) -> Attempt:
        """The same with the probability that what is left of a plan must have."""
        probability = min(self.defaults.probability, self.defaults.probability_on)
        defaults = replace(self.defaults, probability=probability)
        return replace(self, defaults=defaults, reach=self.reach.again())

    def imprecisely(self, refusal: Refusal, *, denied: bool) -> Plan | None:
        """The plan of less precision, if there is one.

        Args:
            refusal: of what is as precise as usual.
            denied: whether the hand did not get to something.
        """
        found: Plan | Reached | Refusal | None
        if not self.asked.aims:
            found = replace(self, reach=self.reach.thorough())._fallen_otherwise()
        elif denied or self.asked.limits.duration is not None:
            found = replace(self, reach=self.reach.thorough())._steeply()
        elif self.before is None and refusal.reason in _IN_THE_WAY:
            found = replace(self, reach=self.reach.again())._nearly()
        else:
            return None
        return found if isinstance(found, Plan) else None

    def _steeply(self) -> Plan | Reached | Refusal | None:
        """One push straight to an aim, steep to the face, if two fingertips may make it."""
        if 2 not in self.asked.fingers or self.asked.rotates:
            return None
        steep = replace(self.asked, steep=True, fingers=(2,))
        return replace(self, asked=steep).made()

    def _nearly(self) -> Plan | None:
        """Straight to a place that only just counts as the one that is asked."""
        told = dict(nearly(self.asked, self.target, self.defaults))
        if not told:
            return None
        made = replace(self, asked=replace(self.asked, aims=tuple(told), direct=True)).made()
        if not isinstance(made, Plan) or made.aim is None:
            return None
        return made.model_copy(update={"notes": (told[made.aim], *made.notes)})

    def _fallen_otherwise(self) -> Plan | Refusal | None:
        """The fall of what does not fall square to the side where it stands, if there is one."""
        try:
            found = self._fall().otherwise()
        except GivenUpError:
            return None
        return None if found is None else self._together(found, None)

    @property
    def _foreseen(self) -> tuple[Push, ...]:
        """Pushes that the plan before had meant to come now."""
        return () if self.before is None else self.before.pushes[1:]

    def _fall(self) -> Fall:
        return Fall(self.asked, self.target, self.state, self.reach, self.defaults, self._foreseen)

    def _to_an_aim(self) -> Plan | Reached | Refusal:
        """The plan to the first aim for which there is one."""
        kept = None if self.before is None else self.before.aim
        refusal: Refusal | None = None
        for aim in self.asked.aims if kept is None else (kept,):
            found = Journey(
                self.asked, aim, self.target, self.state, self.reach, self.defaults, self._foreseen
            ).pushes()
            if isinstance(found, Reached):
                return found
            if not isinstance(found, Refusal):
                made = self._together(found, aim)
                if isinstance(made, Plan):
                    return made
                found = made
            refusal = refusal or found
        assert refusal is not None, "there is an aim"
        return refusal

    def _together(self, found: list[Found], aim: Aim | None) -> Plan | Refusal:
        """Pushes one after another as a plan, if they are likely enough together."""
        asked, target = self.asked, self.target
        if asked.limits.duration is not None and len(found) > 1:
            return refusals.several_pushes(asked, target, len(found))
        first, *later = pushes = [each.move for each in found]
        # At least so likely, however the outcomes hang together; those of equal pushes are equal.
        doubts: dict[tuple[object, ...], float] = {}
        for each in found:
            doubt = 1.0 - each.move.prediction.probability
            doubts[each.event] = max(doubt, doubts.get(each.event, 0.0))
        probability = max(1.0 - sum(doubts.values()), 0.0)
        if probability < self.defaults.probability:
            return refusals.unlikely(target, len(found), probability, self.defaults)
        # What must be done in time is pushed faster than by default.
        quick = any(push.speed != asked.speed for push in pushes)
        return Plan(
            object=target.name,
            task=_TASKS.get(pushes[-1].ends_on, "push"),
            actions=(first.model_copy(update={"displacement": found[0].displacement}), *later),
            committed=1,
            limits=_shared([push.limits for push in pushes]),
            aim=aim,
            probability=probability,
            defaults=tuple(d for d in asked.defaults if d.name != "speed" or not quick),
            considered=sum(each.considered for each in found),
            satisfying=sum(each.satisfying for each in found),
            notes=tuple(_notes(found)),
        )


def _shared(limits: list[Limits]) -> Limits:
    """What all pushes of a plan keep."""
    common = set(limits[0]).intersection(*limits[1:])
    return Limits(**dict(common))


def _notes(found: list[Found]) -> Iterator[str]:
    """How each push was chosen; of several with the number of the push."""
    for number, each in enumerate(found, start=1):
        for note in each.notes:
            yield note if len(found) == 1 else f"push {number}: {note}"


# -- places that only just count ----------------------------------------------------------------


def nearly(asked: Asked, target: SeenObject, defaults: Defaults) -> Iterator[tuple[Aim, str]]:
    """The places, each with a plain sentence about it; none of what is no displacement.

    Args:
        asked: with the heading and the distance, if it is a displacement.
        target: the object, where it stands at first.
        defaults: tolerances, and how exactly an object is brought somewhere.
    """
    if asked.heading is None or asked.until is not None or asked.rotates:
        return
    if not _LEAST * defaults.distance_tolerance <= asked.distance < math.inf:
        return
    spare = max(defaults.distance_tolerance - defaults.aim_position, 0.0)
    ahead, left = unit(asked.heading), unit(asked.heading + 0.5 * math.pi)
    shares = sorted(itertools.product(_SHORT, _ASIDE), key=lambda share: math.hypot(*share))
    for short, aside in ((spare * short, aside) for short, aside in shares[1:]):
        along = asked.distance - short
        slant = along * math.tan(defaults.direction_tolerance) - defaults.aim_position
        if slant <= 0.0:
            continue
        x, y, _ = (target.pose.p_WB + along * ahead + aside * slant * left).tolist()
        yield here(target, x, y), _place_note(short, aside * slant)


def _place_note(short: float, aside: float) -> str:
    ways = [f"{1e3 * short:.0f} mm too early"] if short else []
    if aside:
        ways.append(
            f"{1e3 * abs(aside):.0f} mm to the {'left' if aside > 0.0 else 'right'} of the way"
        )
    return f"it ends {' and '.join(ways)}, which the tolerances allow"
