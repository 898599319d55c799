"""The least amount of a change that can be told from nothing; less is refused before it is planned.

Model: an amount has a tolerance of at most a share of it (`Defaults.tolerance_of`), and the robot
brings an object to within an aim of what is asked (`Defaults.aim_position`, `aim_angle`). An
amount whose tolerance is smaller than that aim may end as nothing at all, so it is not promised. A
goal of place is a state, which may hold with nothing done, and has no least amount.
"""

from __future__ import annotations

import math

from grammar.frames import command as g
from planner.problem.constraint_limits import tilt_goal
from planner.problem.goal_poses import goal_distance, is_orientation
from planner.problem.places import region
from planner.problem.planning_problem import value_in_bound
from planner.refusals.blocked import Blocked, dead_end
from planner.types.defaults import Defaults
from planner.types.world_state import WorldState

_ROUNDING = 1e-9  # share by which an amount may seem smaller than it is said


def why_not_tellable(frame: g.Frame, state: WorldState, defaults: Defaults) -> Blocked | None:
    """What a frame asks for is no more than can come of nothing: the least amount that is."""
    found = _change(frame, state, defaults)
    if found is None:
        return None
    amount, aim, unit = found
    least = defaults.least_amount(aim, getattr(frame.goal, "bound", "exact"))
    if amount < (1.0 - _ROUNDING) * least:
        return dead_end(
            "too_small",
            {"asked_amount": amount, "least_amount": least},
            spans=frame.goal.spans,
            amount=_text(amount, unit),
            least=_text(least, unit),
        )
    return None


def _change(frame: g.Frame, state: WorldState, d: Defaults) -> tuple[float, float, str] | None:
    """Return how much a frame changes, to what the robot does that, and their unit.

    None where it asks for a state.
    """
    name = frame.object.id if frame.object is not None else None
    own = state.objects.get(name or "")
    if own is None:
        return None
    match frame.goal:
        case g.Displace() as goal:
            ends = [c for c in frame.constraints if isinstance(c, g.Until | g.Duration)]
            if ends and goal.distance is None and goal.fraction is None and goal.amount is None:
                return None
            asked, _ = goal_distance(goal, own, state, d, frame.constraints)
            return value_in_bound(asked, goal.bound, d.distance_tolerance), d.aim_position, "mm"
        case g.Rotate() as goal if not is_orientation(goal):
            by_default = {None: d.turn, "little": d.turn_little, "lot": d.turn_lot}
            asked = goal.angle or by_default[goal.amount]
            return value_in_bound(asked, goal.bound, d.turn_tolerance), d.aim_angle, "deg"
        case g.Tilt() as goal:
            return tilt_goal(goal, own.model, d)[0], d.aim_angle, "deg"
        case g.Lift(height=float(asked)) as goal if goal.above != "table":
            return value_in_bound(asked, goal.bound, d.distance_tolerance), d.aim_position, "mm"
        case g.Pour(volume=float(asked)):
            return asked, d.tolerance_share * d.pour_margin, "ml"
        case g.Pour(fraction=float(share)) if own.model.container is not None:
            return share * own.model.container.contents, d.tolerance_share * d.pour_margin, "ml"
        case g.Place(reference=(), distance=float(asked)):
            return asked, d.aim_position, "mm"
        case g.Place(fraction=float(share)) as goal:
            place = region(goal, state, d, own)
            spots = place.spots(own) if place is not None else []
            here = (own.pose.x, own.pose.y)
            return (share * math.dist(spots[0], here), d.aim_position, "mm") if spots else None
    return None


def _text(amount: float, unit: str) -> str:
    """An amount as people read it, small ones to a tenth."""
    scale, sign = {"mm": (1e3, " mm"), "deg": (math.degrees(1.0), "°"), "ml": (1e6, " ml")}[unit]
    return f"{scale * amount:.1f}".removesuffix(".0") + sign
