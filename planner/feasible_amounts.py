"""How much of what a frame asks can be done: the largest amount of its goal that has a plan.

What has a plan is taken to have one for less as well. First comes what people mean if they say no
amount. It is doubled while there is a plan; if there is none, the least amount decides whether to
look on. What lies between an amount that has a plan and one that has none is then bracketed.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from grammar.frames import command as g
from planner.types.defaults import DEFAULTS

_POURED_TO = DEFAULTS.tolerance_share * DEFAULTS.pour_margin  # so that the margin is the least

UNITS: dict[str, tuple[str, Callable[[int], float], float, float]] = {
    "displace": ("distance", lambda cm: cm / 100, DEFAULTS.distance, DEFAULTS.aim_position),
    "place": ("distance", lambda cm: cm / 100, DEFAULTS.distance_lot, DEFAULTS.aim_position),
    "lift": ("height", lambda cm: cm / 100, DEFAULTS.lift_height, DEFAULTS.aim_position),
    "rotate": ("angle", math.radians, DEFAULTS.turn, DEFAULTS.aim_angle),
    "tilt": ("angle", math.radians, DEFAULTS.tilt, DEFAULTS.aim_angle),
    "pour": ("volume", lambda cl: cl / 100_000, DEFAULTS.pour_little, _POURED_TO),
}
"""Field of a goal that says how much, by its kind, how many of the units in which people say that
are how much, a usual amount, and to what the robot does it [SI]."""

BRACKETS = 2
"""Times that the bracket is halved by its ratio: between n and 2 n, to a fifth of the most."""


def frame_with_less(frame: g.Frame, is_planned: Callable[[g.Frame], bool]) -> g.Frame | None:
    """The frame with a smaller amount that has a plan; None if none is found.

    Args:
        frame: what is asked.
        is_planned: whether a frame has a plan.
    """
    if frame.goal.kind not in UNITS:
        return None
    name, amount, usual, aim = UNITS[frame.goal.kind]
    asked = getattr(frame.goal, name)
    if not isinstance(asked, float):
        return None

    def with_amount(units: int) -> g.Frame:
        return frame.model_copy(
            update={"goal": frame.goal.model_copy(update={name: amount(units)})}
        )

    most = math.ceil(asked / amount(1) - 1e-9)
    least = min(round(usual / amount(1)), most // 2)
    # Less cannot be told from nothing, and is refused.
    first = math.ceil(DEFAULTS.least_amount(aim) / amount(1) - 1e-9)
    if least < first:
        return None
    if is_planned(with_amount(least)):
        while 2 * least < most and is_planned(with_amount(2 * least)):
            least *= 2
        most = min(most, 2 * least)
    elif least > first and is_planned(with_amount(first)):
        least, most = first, least
    else:
        return None
    for _ in range(BRACKETS):
        middle = round(math.sqrt(least * most))
        if not least < middle < most:
            break
        least, most = (middle, most) if is_planned(with_amount(middle)) else (least, middle)
    return with_amount(least)
