"""What a place is: where an object may go, and how well it is there.

Frames: everything in W [m].
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Literal

from objectmodels.geometry.base_shapes import Array
from planner.types.world_state import SeenObject


@dataclass(frozen=True)
class Measure:
    """One quantity of a place, as it should be and as it is.

    Attributes:
        quantity: what is measured, in words.
        relation: how `measured` must stand to `expected`.
        expected: what it should be [m].
        measured: what it is [m].
        tolerance: by how much it may miss [m].
    """

    quantity: str
    relation: Literal["about", "at_most", "at_least"]
    expected: float
    measured: float
    tolerance: float

    @property
    def miss(self) -> float:
        """Distance from what it should be [m]; never negative."""
        excess = self.measured - self.expected
        return {
            "about": abs(excess), "at_most": max(excess, 0.0), "at_least": max(-excess, 0.0)
        }[self.relation]  # fmt: skip

    @property
    def ok(self) -> bool:
        """Return True if it is within its tolerance."""
        return self.miss <= self.tolerance


class Region(ABC):
    """A place: the poses in which an object is where a word says."""

    @abstractmethod
    def spots(self, own: SeenObject) -> list[Array]:
        """Positions of an object's origin in W at which it is in the middle of the place.

        Args:
            own: the object, with the heading that it will have there.

        Returns:
            Positions, shape (2,) each [m], the nearest to where it is first; none if there is no
            room for it.
        """

    @abstractmethod
    def measures(self, own: SeenObject) -> tuple[Measure, ...]:
        """Quantities of how well an object is there."""

    def holds(self, own: SeenObject) -> bool:
        """Return True if an object is there, within the tolerances."""
        return all(measure.ok for measure in self.measures(own))
