"""From a frame and a predicted outcome to a push, or to a refusal with its numbers."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

import nlcontrol_former_names  # noqa: F401 – serves former names

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


def __getattr__(name: str) -> object:
    """Load a public name on first use, so that what needs one room loads no other."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value: object = getattr(importlib.import_module(_HOMES[name]), name)
    globals()[name] = value
    return value
