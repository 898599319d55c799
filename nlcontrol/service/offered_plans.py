"""Plans that wait to be approved: each is used once, and for so long only."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from textwrap import shorten
from threading import RLock
from typing import TYPE_CHECKING, NamedTuple

from nlcontrol.errors import ControlError, error
from objectmodels.errors import printable

if TYPE_CHECKING:
    from nlcontrol.session.proposals import Proposal
    from planner.types.world_state import WorldState

LIFE = 600.0
"""Time for which a plan can be carried out [s]: a person looks at it, and nothing else has."""

MOST_OFFERED = 100
"""Plans that wait at a time; before one more, the oldest expires."""

_DROPPED = "the session was stopped or reset since"
_MOST_PAST = 10_000
"""Identifiers of plans that are over, of which it is still told why."""


class OfferedPlan(NamedTuple):
    """A plan that waits.

    Attributes:
        proposal: the sentence as it was planned.
        text: the sentence as it was given; "" if frames came without one.
        state: what was believed then.
        until: when it expires, on the clock [s].
    """

    proposal: Proposal
    text: str
    state: WorldState
    until: float


class OfferedPlans:
    """Plans of a session by their identifiers.

    Threads may share it; no method waits.

    Args:
        clock: by which they expire [s].

    Attributes:
        era: how often all of them were dropped; a plan that was asked for in an earlier one is
            none any more.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self.era = 0
        self._clock = clock
        self._turn = RLock()
        self._waiting: dict[str, OfferedPlan] = {}
        self._past: dict[str, ControlError] = {}

    def offer(self, proposal: Proposal, text: str, state: WorldState, era: int) -> str:
        """Offers the plan of a text that was asked for in an era, and returns its identifier."""
        plan_id = f"plan-{secrets.token_hex(8)}"
        with self._turn:
            while len(self._waiting) >= MOST_OFFERED:
                self._end(next(iter(self._waiting)), _expired("newer plans have taken its place"))
            self._waiting[plan_id] = OfferedPlan(proposal, text, state, self._clock() + LIFE)
            if era != self.era:
                self._end(plan_id, _expired(_DROPPED))
        return plan_id

    def waiting(self, plan_id: str) -> OfferedPlan:
        """The plan of an identifier.

        Raises:
            ControlError: `unknown_plan`, `used_plan`, `expired_plan`.
        """
        with self._turn:
            plan = self._waiting.get(plan_id)
            if plan is not None and plan.until > self._clock():
                return plan
            if plan is not None:
                self._end(plan_id, _expired(f"it was made more than {LIFE / 60:g} min ago"))
            past = self._past.get(plan_id)
        raise past or error(
            "unknown_plan",
            "no plan of that identifier was made in this session",
            suggestions=("plan the sentence, and execute the `plan_id` of that offer",),
        )

    def approved(self, plan_id: str, text: str | None) -> OfferedPlan:
        """The plan of an identifier, approved under a text; None approves it by its name alone.

        Raises:
            ControlError: `other_sentence`; as `waiting`.
        """
        plan = self.waiting(plan_id)
        if text is not None and text != plan.text:
            raise error(
                "other_sentence",
                f"this plan is for {_quoted(plan.text)}, and {_quoted(text)} was approved",
                suggestions=(
                    f"plan {_quoted(text)}, and execute the `plan_id` of that offer",
                    f"approve this plan with the text {_quoted(plan.text)}",
                ),
            )
        return plan

    def use(self, plan_id: str) -> None:
        """Notes that a plan is carried out."""
        told = error(
            "used_plan",
            "this plan was carried out before, and a plan is carried out once",
            suggestions=("plan the sentence again, and execute the `plan_id` of that offer",),
        )
        with self._turn:
            self._end(plan_id, told)

    def drop(self) -> None:
        """Lets all plans expire, and those that are being made."""
        with self._turn:
            self.era += 1
            for plan_id in list(self._waiting):
                self._end(plan_id, _expired(_DROPPED))

    def _end(self, plan_id: str, reason: ControlError) -> None:
        self._waiting.pop(plan_id, None)
        self._past[plan_id] = reason
        if len(self._past) > _MOST_PAST:
            del self._past[next(iter(self._past))]


def _quoted(text: str) -> str:
    return f"“{shorten(printable(text), 200)}”"


def _expired(why: str) -> ControlError:
    return error(
        "expired_plan",
        f"this plan has expired: {why}",
        suggestions=("plan the sentence again, and execute the `plan_id` of that offer",),
    )
