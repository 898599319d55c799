"""From a frame and a predicted outcome to a push, or to a refusal with its numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from objectmodels.lazy_names import lazy_names

if TYPE_CHECKING:
    from planner.planning import plan
    from planner.types.plan import Plan
    from planner.types.refusal import Refusal

__all__ = [
    "Plan",
    "Refusal",
    "plan",
]

_HOMES = {
    "Plan": "planner.types.plan",
    "Refusal": "planner.types.refusal",
    "plan": "planner.planning",
}

__getattr__ = lazy_names(__name__, _HOMES)
