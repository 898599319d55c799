"""A refusal: why no plan is made, with the numbers that decide."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from planner.types.actions import Value

RefusalReason = Literal[
    "impossible",  # no push on this object does it, whoever pushes
    "out_of_reach",  # pushes exist, but the hand does not get there
    "blocked",  # pushes exist, but something stands in the way
    "too_uncertain",  # the model's uncertainty leaves the outcome open
    "out_of_time",  # it would take longer than allowed
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
    """

    code: str
    reason: RefusalReason
    message: str
    numbers: dict[str, float] = Field(default_factory=dict)
    capability: str | None = None
    spans: tuple[tuple[int, int], ...] = ()
    suggestions: tuple[str, ...] = ()

    @property
    def status(self) -> Literal["refused", "unsupported"]:
        """Whether the sentence cannot be done, or this robot lacks a capability."""
        return "unsupported" if self.reason == "unsupported" else "refused"
