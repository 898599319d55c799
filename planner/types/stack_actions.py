"""Putting one object on another or into it, as an action of a plan; see `planner.types.actions`."""

from __future__ import annotations

from typing import Literal

from planner.types.frozen_value import Value


class StandPrediction(Value):
    """An object that is put on another one, or into it.

    Attributes:
        margin: least distance of a centre of mass from the edges within which it must be, of what
            stands on each place of the stack [m].
        stands: least probability that the whole stack stands.
    """

    margin: float
    stands: float


class SetOn(Value):
    """Straight down until it stands on another object or in it, then as `set_down`.

    Attributes:
        onto: name of that object.
        height: over the table of where it stands then [m].
        inside: whether that is the floor of an open box.
        prediction: how surely it stands there.
    """

    kind: Literal["set_on"] = "set_on"
    onto: str
    height: float
    inside: bool = False
    prediction: StandPrediction
