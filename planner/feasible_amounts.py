"""How much of what a frame asks can be done: the largest amount of its goal that has a plan.

The amount is halved until there is a plan, then bracketed between what has one and what has none.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from grammar.frames import command as g

UNITS: dict[str, tuple[str, float]] = {
    "displace": ("distance", 0.01),
    "place": ("distance", 0.01),
    "lift": ("height", 0.01),
    "rotate": ("angle", math.radians(1.0)),
    "tilt": ("angle", math.radians(1.0)),
    "pour": ("volume", 1e-5),
}
"""Field of a goal that says how much, by its kind, and the unit in which people say that [SI]."""

BRACKETS = 3
"""Times that the bracket is halved: what is found is within an eighth of the most."""


def frame_with_less(frame: g.Frame, is_planned: Callable[[g.Frame], bool]) -> g.Frame | None:
    """The frame with a smaller amount that has a plan; None if none is found.

    Args:
        frame: what is asked.
        is_planned: whether a frame has a plan.
    """
    name, unit = UNITS.get(frame.goal.kind, ("", 1.0))
    asked = getattr(frame.goal, name, None)
    if not isinstance(asked, float):
        return None

    def with_amount(units: int) -> g.Frame:
        goal = frame.goal.model_copy(update={name: units * unit})
        return frame.model_copy(update={"goal": goal})

    most, least = math.ceil(asked / unit - 1e-9), 0
    while least == 0:
        if most <= 1:
            return None
        if is_planned(with_amount(most // 2)):
            least = most // 2
        else:
            most //= 2
    for _ in range(BRACKETS):
        middle = (least + most) // 2
        if middle == least:
            break
        least, most = (middle, most) if is_planned(with_amount(middle)) else (least, middle)
    return with_amount(least)
