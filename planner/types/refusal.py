"""A refusal: why no plan is made, and what would do instead."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from planner.types.actions import Value
from planner.types.cure import Cure
from planner.types.world_state import Mark

RefusalReason = Literal[
    "impossible",  # no push on this object does it, whoever pushes
    "out_of_reach",  # pushes exist, but the hand does not get there
    "blocked",  # pushes exist, but something stands in the way
    "too_uncertain",  # the model's uncertainty leaves the outcome open
    "out_of_time",  # it would take longer than allowed
    "too_small",  # less than can be told from nothing
    "unsupported",  # this robot, or this version, lacks a named capability
]


class Refusal(Value):
    """Why no plan is made, with the numbers that decide.

    Attributes:
        code: stable name of what decides, finer than the reason.
        reason: the kind of obstacle.
        message: one plain sentence with the deciding numbers in it, units in mm, N or degrees.
        numbers: the same numbers by name [SI].
        capability: what is missing, if the reason is `unsupported`.
        spans: the words that cannot be satisfied, `[start, end)` in the sentence.
        suggestions: what would be possible instead, as plain phrases.
        marks: where the numbers are on the table.
        cures: the suggestions as data; they are not written into documents.
    """

    code: str
    reason: RefusalReason
    message: str
    numbers: dict[str, float] = Field(default_factory=dict)
    capability: str | None = None
    spans: tuple[tuple[int, int], ...] = ()
    suggestions: tuple[str, ...] = ()
    marks: tuple[Mark, ...] = ()
    cures: tuple[Cure, ...] = Field(default=(), exclude=True, repr=False)

    @property
    def status(self) -> Literal["refused", "unsupported"]:
        """Outcome of planning: it cannot be done, or this robot lacks a capability for it."""
        return "unsupported" if self.reason == "unsupported" else "refused"


def probability_text(probability: float) -> str:
    """A probability as people read it; 1 and 0 are told of none."""
    if probability > 0.999:
        return "over 0.999"
    return "below 0.001" if probability < 0.001 else f"{probability:.3f}"
