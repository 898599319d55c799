"""What may be asked of a whole hand, by shape, weight and plain geometry.

- What is lifted stands upright and has two parallel sides, or a round one, about which the hand
  closes. The squeeze that holds it `RESERVE` times over by nominal parameters is one that the hand
  has and the object bears, and its lift is between `LIFTS`.
- Beside one such pair of sides no more stands than the fingers pass over: within `FINGERS` of them,
  over the breadth of a hand, nothing is higher than half the object. So it is where it is put down.
- What is opened has a lid that is on, and nothing stands within `BESIDE` of it.

No grasp is looked for, and no arm.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from grammar.frames import command as g
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.push_thresholds import GRAVITY
from planner.problem.footprints import footprint, gap, overlaps
from planner.types.world_state import SeenObject, WorldState
from sim.robots.robots import HAND

RESERVE = 1.5
"""Squeeze allowed over the one that holds a weight by friction alone."""
LIFTS = (0.03, 0.25)
"""Least and largest lift that is asked for [m]."""
FINGERS = 0.06
"""Room that closing fingers need beside a side [m]."""
BREADTH = 0.08
"""Breadth of the hand along the sides [m]."""
BESIDE = 0.08
"""Room about what is opened [m]."""

_HEADINGS = np.radians(np.arange(0.0, 180.0, 22.5))  # in W, across which a round side is held
_PARALLEL = 1e-6


def may_be_handled(frame: g.Frame, state: WorldState) -> bool:
    """Whether a person would ask it of a hand: a lift, a carry from where it stands, an opening."""
    assert frame.object is not None, "what is read has an object"
    target = state.objects[frame.object.id or ""]
    match frame.goal:
        case g.Open():
            others = (other for name, other in state.objects.items() if name != target.name)
            here = footprint(target)
            return target.model.lid is not None and all(
                gap(here, footprint(other)) >= BESIDE for other in others
            )
        case g.Lift(height=float(height)):
            return LIFTS[0] <= height <= LIFTS[1] and may_be_held(target, state)
        case g.Lift() | g.Place():
            return may_be_held(target, state)
    return False


def may_be_held(target: SeenObject, state: WorldState) -> bool:
    """Whether a hand closes about an object where it stands, and may bear it."""
    return target.lies_on == "bottom" and may_be_held_lying(target, state)


def may_be_held_lying(target: SeenObject, state: WorldState) -> bool:
    """Whether a hand closes about an object as it lies, and may bear it."""
    if target.fixed:
        return False
    others = [other for name, other in state.objects.items() if name != target.name]
    high = [footprint(other) for other in others if other.bulk()[1] > 0.5 * target.model.top]
    return any(
        _is_strong_enough(target, width) and not any(overlaps(swept, each, 0.0) for each in high)
        for width, swept in _pairs(target)
    )


def _pairs(target: SeenObject) -> Iterator[tuple[float, Array]]:
    """Width across pairs of opposite sides, and where fingers come to them, shape (4, 2) [m]."""
    faces = target.model.faces(_HEADINGS - target.pose.yaw)
    R_WB, p_WB = target.pose.R_WB, target.pose.p_WB
    for one, other in itertools.product(faces, faces):
        n, m = np.array(one.normal), np.array(other.normal)
        if one.curvature and one is other:
            middle, width = np.array(one.centre) - n / one.curvature, 2.0 / one.curvature
        elif not one.curvature and n @ m < _PARALLEL - 1.0 and abs(n[2]) < _PARALLEL:
            middle = 0.5 * (np.array(one.centre) + np.array(other.centre))
            width = float((np.array(one.centre) - np.array(other.centre)) @ n)
        else:
            continue
        closing = (R_WB @ n)[:2]
        a = (0.5 * width + FINGERS) * closing
        b = 0.5 * BREADTH * np.array([-closing[1], closing[0]])
        at = (R_WB @ middle + p_WB)[:2]
        yield width, np.array([at + a + b, at - a + b, at - a - b, at + a - b])


def _is_strong_enough(target: SeenObject, width: float) -> bool:
    narrowest, widest = HAND.grasp_widths
    posture = HAND.grasp_posture(width) if narrowest <= width <= widest else None
    if posture is None:
        return False
    model = target.model
    friction = model.finger_friction_kinetic or model.finger_friction
    needed = RESERVE * GRAVITY * model.mass / (2.0 * friction)
    borne = np.inf if model.grasp is None else model.grasp.crush
    return bool(needed <= min(posture.grip.strongest, borne))
