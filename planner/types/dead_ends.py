"""The one way in which planning fails, and alternatives of which one has to succeed."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import TracebackType

    from planner.types.refusal import Refusal


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
