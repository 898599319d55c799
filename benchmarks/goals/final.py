"""How far off a step ended, on the true poses.

What a sentence leaves open has no error: the distance of "at least 10 cm", the heading at a place,
where an object comes up against another (the plan aims beyond that; that they touch is a clause).
Lengths are in metres, angles in radians.

| goal | errors |
|---|---|
| displace | `along` and `across` the asked direction, `yaw` from the heading at the start |
| place | `off` from the place, the point that was said or that the plan aimed at, and its `yaw` |
| rotate | `turn` beyond the asked angle, `drift` of B's origin |
| topple | `side`: angle between the fall and the asked side; absent if it did not fall |
| tilt | `angle`: largest tilt beyond the asked one, `back` at the end; `drift` in the last push |
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from grammar.frames import command as g
from nlcontrol.checks import trace_measures as measures
from planner.problem.directions import HEADINGS, angle_between, bisector, heading_of, unit
from planner.types.defaults import DEFAULTS

if TYPE_CHECKING:
    from planner.types.plan import Plan
    from sim.traces.trace import Trace

_LYING = math.radians(45.0)  # an object that is tilted so far at the end has no heading [rad]


def final(frame: g.Frame, trace: Trace, plan: Plan, *, turns: bool = True) -> dict[str, float]:
    """Errors of a step by name; none where nothing definite was asked.

    Args:
        frame: what was asked, its objects resolved.
        trace: of the whole step.
        plan: the first one, for what it aimed at.
        turns: whether the object has a heading at all; a round one has none.
    """
    errors = _errors(frame, trace, plan)
    return errors if turns else {key: value for key, value in errors.items() if key != "yaw"}


def _errors(frame: g.Frame, trace: Trace, plan: Plan) -> dict[str, float]:
    if any(isinstance(clause, g.Until) for clause in frame.constraints):
        return {}
    name = plan.object
    lies = measures.tilt_at_end(trace, name)[1] > _LYING
    match frame.goal:
        case g.Topple(direction=direction):
            if direction is None or not lies:
                return {}
            fell = measures.tilt_heading(trace, name)
            return {"side": abs(angle_between(fell, HEADINGS[direction]))}
        case _ if lies:
            return {}
        case g.Displace() as goal:
            return _displaced(goal, trace, name)
        case g.Place(relation="touching"):
            return {}
        case g.Place() as goal:
            return _placed(goal, trace, plan)
        case g.Rotate(angle=float(angle), sense=sense, bound="exact"):
            turned = float(trace.yaw(name)[-1])
            asked = math.copysign(angle, turned) if sense is None else _SENSES[sense] * angle
            return {"turn": turned - asked, "drift": _drift(trace, name)}
        case g.Tilt(angle=float(angle), bound="exact"):
            most = float(trace.tilt(name).max())
            back = measures.tilt_at_end(trace, name)[1]
            # It may have been turned first, so that a face looks to the asked side.
            begin = [0, *(push[0] for push in measures.stretches(trace, ("push",)))][-1]
            drift = float(np.linalg.norm(np.subtract(*trace.poses[name][[-1, begin], 4:6])))
            return {"angle": most - angle, "back": back, "drift": drift}
    return {}


_SENSES = {"ccw": 1.0, "cw": -1.0}


def _drift(trace: Trace, name: str) -> float:
    return float(np.linalg.norm(trace.displacement(name)[:2]))


def _displaced(goal: g.Displace, trace: Trace, name: str) -> dict[str, float]:
    heading = _heading(goal, trace, name)
    if heading is None:
        return {}
    u, travel = unit(heading), trace.displacement(name)
    errors = {
        "across": float(u[0] * travel[1] - u[1] * travel[0]),
        "yaw": float(trace.yaw(name)[-1]),
    }
    distance = _distance(goal)
    return errors if distance is None else {"along": float(travel @ u) - distance, **errors}


def _heading(goal: g.Displace, trace: Trace, name: str) -> float | None:
    if goal.heading is not None:
        return goal.heading
    for other, sign in ((goal.toward, 1.0), (goal.away_from, -1.0)):
        if isinstance(other, g.ObjectRef) and other.id is not None:
            there, here = trace.poses[other.id][0, 4:], trace.poses[name][0, 4:]
            return heading_of(sign * (there - here))
    if isinstance(goal.direction, tuple):
        return bisector(goal.direction)
    return HEADINGS[goal.direction] if goal.direction else None


def _distance(goal: g.Displace) -> float | None:
    """Asked distance, if it is one in metres [m]."""
    if goal.bound != "exact" or goal.fraction is not None:
        return None
    if goal.distance is None:
        sizes = {"little": DEFAULTS.distance_little, "lot": DEFAULTS.distance_lot}
        return sizes[goal.amount] if goal.amount else DEFAULTS.distance
    return goal.distance if isinstance(goal.distance, float) else None


def _placed(goal: g.Place, trace: Trace, plan: Plan) -> dict[str, float]:
    pose = trace.poses[plan.object][-1]
    x, y = pose[4:6].tolist()
    aim = plan.aim
    if isinstance(goal.reference, g.Point) and goal.fraction is None:
        off = {"off": math.hypot(x - goal.reference.x, y - goal.reference.y)}
    elif aim is not None:
        off = {"off": math.hypot(x - aim.x, y - aim.y)}
    else:
        return {}
    if aim is None or aim.yaw is None:
        return off
    R_WB = measures.rotation(pose)
    return off | {"yaw": angle_between(math.atan2(R_WB[1, 0], R_WB[0, 0]), aim.yaw)}
