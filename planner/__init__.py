"""From a frame and a predicted outcome to a push, or to a refusal with its numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from objectmodels.lazy import lazy_names

if TYPE_CHECKING:
    from planner.planning import plan as plan
    from planner.types.plan import Plan as Plan
    from planner.types.refusal import Refusal as Refusal

_HOMES = {
    "planning": ["plan"],
    "types.plan": ["Plan"],
    "types.refusal": ["Refusal"],
}

__all__ = [name for names in _HOMES.values() for name in names]
__getattr__ = lazy_names(__name__, _HOMES)
