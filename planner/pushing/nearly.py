"""Places that only just count as the one to which an object is to be moved.

Model: a displacement holds if its length and its direction are within their tolerances. So an
object may end a little short of its aim, or beside it; how exactly the robot brings it there is
kept from the tolerance. The places nearest to the aim come first.

Frames: W's table plane.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

from planner.geometry.directions import unit
from planner.problem.goal_poses import here

if TYPE_CHECKING:
    from collections.abc import Iterator

    from planner.problem.push_problem import Asked
    from planner.types.defaults import Defaults
    from planner.types.plan import Aim
    from planner.types.world_state import SeenObject

_SHORT = (0.0, 0.5, 1.0)  # of the room that the tolerance of the distance leaves
_ASIDE = (0.0, 0.5, -0.5, 1.0, -1.0)  # of that of the direction, to the left of the way
_LEAST = 3.0  # of tolerances; of shorter ways a bound ("at least") keeps less than one to spare


def nearly(asked: Asked, target: SeenObject, defaults: Defaults) -> Iterator[tuple[Aim, str]]:
    """The places, each with a plain sentence about it; none of what is no displacement.

    Args:
        asked: with the heading and the distance, if it is a displacement.
        target: the object, where it stands at first.
        defaults: tolerances, and how exactly an object is brought somewhere.
    """
    if asked.heading is None or asked.until is not None or asked.rotates:
        return
    if not _LEAST * defaults.distance_tolerance <= asked.distance < math.inf:
        return
    spare = max(defaults.distance_tolerance - defaults.aim_position, 0.0)
    ahead, left = unit(asked.heading), unit(asked.heading + 0.5 * math.pi)
    shares = sorted(itertools.product(_SHORT, _ASIDE), key=lambda share: math.hypot(*share))
    for short, aside in ((spare * short, aside) for short, aside in shares[1:]):
        along = asked.distance - short
        slant = along * math.tan(defaults.direction_tolerance) - defaults.aim_position
        if slant <= 0.0:
            continue
        x, y, _ = (target.pose.p_WB + along * ahead + aside * slant * left).tolist()
        yield here(target, x, y), _told(short, aside * slant)


def _told(short: float, aside: float) -> str:
    ways = [f"{1e3 * short:.0f} mm too early"] if short else []
    if aside:
        ways.append(
            f"{1e3 * abs(aside):.0f} mm to the {'left' if aside > 0.0 else 'right'} of the way"
        )
    return f"it ends {' and '.join(ways)}, which the tolerances allow"
