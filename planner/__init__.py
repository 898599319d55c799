"""From a frame and a predicted outcome to a push, or to a refusal with its numbers."""

import planner.types.plan as _values  # its name is the function's below, so it is bound first
from planner.planning import plan

Plan = _values.Plan
Refusal = _values.Refusal

__all__ = ["Plan", "Refusal", "plan"]
