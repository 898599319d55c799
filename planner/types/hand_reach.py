"""The planner's questions to the robot about its whole hand; see `types.robot` for pushes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from planner.types.actions import HandlingPlan
    from planner.types.robot import ReachAnswer
    from planner.types.world_state import WorldState


@dataclass(frozen=True, eq=False)
class Grip:
    """How the hand closes about something of a width.

    Attributes:
        contacts: of the fingers that touch, the thumb first, in the plane across the closing
            direction, from the middle of the grasp: along the approach, and along
            approach × closing, shape (k, 2) [m].
        shares: of the squeeze that each of them bears; the thumb's is 1, the others' sum to 1,
            shape (k,).
        strongest: largest squeeze, with a tangential load as large beside it [N].
        room: free length beyond the fingers' side that the knuckles need, and beyond the thumb's,
            along the closing direction [m].
        ahead: how far the fingers reach beyond the middle, along the approach [m].
    """

    contacts: NDArray[np.float64]
    shares: NDArray[np.float64]
    strongest: float
    room: tuple[float, float]
    ahead: float = 0.0


class HandReach(Protocol):
    """What the hand can hold, and whether the arm can carry out a plan with it."""

    narrowest: float
    """Least width between thumb and fingers [m]."""

    widest: float
    """Largest width [m]."""

    lowest_level: float
    """Least height above the table of the middle of a grasp from beside [m]."""

    def grip(self, width: float) -> Grip | None:
        """How it closes about that width [m]; None if it does not."""
        ...

    def pinch(self, width: float) -> Grip | None:
        """How it closes about a knob or a cap of that width [m]; None if it does not."""
        ...

    def handles(self, plan: HandlingPlan, state: WorldState) -> ReachAnswer:
        """Whether arm and hand can carry out a plan, all of its way free."""
        ...
