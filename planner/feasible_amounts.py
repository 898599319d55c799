"""How much of what a frame asks can be done: the largest amount of its goal that has a plan.

First comes what people mean if they say no amount. It is doubled while there is a plan, or halved
until there is one, then bracketed between what has one and what has none: a plan that there is is
found sooner than it is found that there is none.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from grammar.frames import command as g
from planner.types.defaults import DEFAULTS

UNITS: dict[str, tuple[str, float, float]] = {
    "displace": ("distance", 0.01, DEFAULTS.distance),
    "place": ("distance", 0.01, DEFAULTS.distance_lot),
    "lift": ("height", 0.01, DEFAULTS.lift_height),
    "rotate": ("angle", math.radians(1.0), DEFAULTS.turn),
    "tilt": ("angle", math.radians(1.0), DEFAULTS.tilt),
    "pour": ("volume", 1e-5, DEFAULTS.pour_little),
}
"""Field of a goal that says how much, by its kind, the unit in which people say that, and a usual
amount [SI]."""

BRACKETS = 3
"""Times that the bracket is halved: what is found is within an eighth of the most."""


def frame_with_less(frame: g.Frame, is_planned: Callable[[g.Frame], bool]) -> g.Frame | None:
    """The frame with a smaller amount that has a plan; None if none is found.

    Args:
        frame: what is asked.
        is_planned: whether a frame has a plan.
    """
    name, unit, usual = UNITS.get(frame.goal.kind, ("", 1.0, 1.0))
    asked = getattr(frame.goal, name, None)
    if not isinstance(asked, float):
        return None

    def with_amount(units: int) -> g.Frame:
        goal = frame.goal.model_copy(update={name: units * unit})
        return frame.model_copy(update={"goal": goal})

    most, least = math.ceil(asked / unit - 1e-9), 0
    tried = min(round(usual / unit), most // 2)
    while 0 < tried < most and (least == 0 or tried > least):
        if is_planned(with_amount(tried)):
            least, tried = tried, 2 * tried
        else:
            most, tried = tried, tried // 2
    if least == 0:
        return None
    for _ in range(BRACKETS):
        middle = (least + most) // 2
        if middle == least:
            break
        least, most = (middle, most) if is_planned(with_amount(middle)) else (least, middle)
    return with_amount(least)
