"""Turning what is held over, as an action of a plan; see `planner.types.actions`."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from planner.types.frozen_value import Value


class TurnOver(Value):
    """Turns what is held about the middle of its grasp until another of its faces is below."""

    kind: Literal["turn_over"] = "turn_over"
    axis_W: tuple[float, float, float] = Field(description="of the turn, a unit vector in W")
    angle: float = Field(description="of the turn [rad]")
