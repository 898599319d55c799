"""A refusal: why no plan is made; and the dead end that carries it inside the planner."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from types import TracebackType
from typing import Literal

from pydantic import Field

from planner.types.actions import Value
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
    """

    code: str
    reason: RefusalReason
    message: str
    numbers: dict[str, float] = Field(default_factory=dict)
    capability: str | None = None
    spans: tuple[tuple[int, int], ...] = ()
    suggestions: tuple[str, ...] = ()
    marks: tuple[Mark, ...] = ()

    @property
    def status(self) -> Literal["refused", "unsupported"]:
        """Outcome of planning: it cannot be done, or this robot lacks a capability for it."""
        return "unsupported" if self.reason == "unsupported" else "refused"


class NoPlanError(Exception):
    """A dead end of planning; it never leaves the planner.

    Attributes:
        refusal: why there is no plan.
        ends_search: whether the budget of questions to the robot is used up, so that no alternative
            is worth trying.
    """

    def __init__(self, refusal: Refusal, *, ends_search: bool = False) -> None:
        super().__init__(refusal.message)
        self.refusal = refusal
        self.ends_search = ends_search


class Alternatives:
    """Alternatives that are tried one after the other until one of them is no dead end.

    Example:
        alternatives = Alternatives()
        for path in paths:
            with alternatives:
                return push_along(path)
        raise alternatives.first
    """

    def __init__(self) -> None:
        self._dead_ends: list[NoPlanError] = []

    def __enter__(self) -> None:
        """Begin one more alternative."""

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> bool:
        """Keep a dead end, and go on unless it ends the search."""
        if not isinstance(error, NoPlanError) or error.ends_search:
            return False
        self._dead_ends.append(error)
        return True

    def __len__(self) -> int:
        """Number of dead ends so far."""
        return len(self._dead_ends)

    @property
    def first(self) -> NoPlanError:
        """Dead end of the first alternative, which is most often the one to be explained."""
        return self._dead_ends[0]

    @property
    def last(self) -> NoPlanError:
        """Dead end of the last alternative."""
        return self._dead_ends[-1]


@dataclass(frozen=True)
class Sentence:
    """Words of a refusal.

    Attributes:
        reason: the kind of obstacle.
        text: one plain sentence with the deciding numbers in it.
        instead: what would be possible, as plain phrases.
        capability: what is missing, if the reason is `unsupported`.
    """

    reason: RefusalReason
    text: str
    instead: tuple[str, ...]
    capability: str | None = None


impossible = partial(Sentence, "impossible")
out_of_reach = partial(Sentence, "out_of_reach")
blocked = partial(Sentence, "blocked")
too_uncertain = partial(Sentence, "too_uncertain")
out_of_time = partial(Sentence, "out_of_time")
too_small = partial(Sentence, "too_small")
unsupported = partial(Sentence, "unsupported")


def probability_text(probability: float) -> str:
    """A probability as people read it; 1 and 0 are told of none."""
    if probability > 0.999:
        return "over 0.999"
    return "below 0.001" if probability < 0.001 else f"{probability:.3f}"
