"""What can be done with an object by this robot, and if not, why not.

For each way of moving it (slide or topple to a side, tilt, turn) two answers: what the object
allows, from its model (from which face, at what least force, where it is sure), and what the robot
can do, which is whether the planner makes a plan for it.

Frames: contacts are places on a face of B; directions are the robot's.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from grammar import frames as g
from objectmodels.outcomemap import OutcomeMap, outcome_map
from planner.defaults import DEFAULTS, Defaults
from planner.directions import HEADINGS, angle_between, face_name, heading_of
from planner.plan import Plan
from planner.planning import plan

if TYPE_CHECKING:
    from collections.abc import Iterator

    from objectmodels import Face
    from planner.reach import Reach
    from planner.state import SeenObject, WorldState

SPACING = 0.01
"""Distance of the contacts that are looked at [m]."""

_ARM = 0.25  # a push turns an object if its arm is at least this share of the friction radius


@dataclass(frozen=True)
class Affordance:
    """One thing that may be done with an object.

    Attributes:
        outcome: `slide`, `topple`, `tilt` or `turn`.
        direction: `away`, `toward`, `left`, `right` (for `turn`: which way it turns).
        face: face that is pushed, as the robot calls it; None if there is none.
        possible: whether any contact on that face has this outcome at the onset.
        least_force: smallest force at which it begins, nominal [N].
        place: where that is, (lateral, height) on the face [m].
        heights: lowest and highest contact at which the outcome has the default probability [m];
            None if it is sure nowhere.
        can: whether this robot can do it now.
        reason: why not: a reason of a refusal, or `impossible` for the object.
        message: the same in words; what the plan is if it can.
        suggestions: what would be possible instead.
    """

    outcome: str
    direction: str
    face: str | None
    possible: bool
    least_force: float | None
    place: tuple[float, float] | None
    heights: tuple[float, float] | None
    can: bool
    reason: str | None
    message: str
    suggestions: tuple[str, ...] = ()


def affordances(
    target: SeenObject, state: WorldState, reach: Reach, *, defaults: Defaults = DEFAULTS
) -> tuple[Affordance, ...]:
    """What can be done with an object.

    Args:
        target: the object, in `state`.
        state: what the robot believes.
        reach: whether the hand gets somewhere.
        defaults: what a clause means when nothing more is said.
    """
    return tuple(_all(target, state, reach, defaults))


def _all(
    target: SeenObject, state: WorldState, reach: Reach, defaults: Defaults
) -> Iterator[Affordance]:
    faces = _faces(target)
    if not faces:
        message = f"the {target.name} has no side that is wide enough for a fingertip"
        none = False, None, None, None, False, "impossible", message
        yield from (Affordance("slide", way, None, *none) for way in HEADINGS)
        return
    straight = {way: outcome_map(target.model, face, spacing=SPACING, turning=False)
                for way, (_, face) in faces.items()}  # fmt: skip
    for outcome in ("slide", "topple", "tilt"):
        for way, chart in straight.items():
            shown = _on_the_object(
                chart, "slide" if outcome == "slide" else "topple", defaults.probability
            )
            yield _answered(outcome, way, faces[way][0], shown, target, state, reach, defaults)
    for sense in ("left", "right"):
        name, shown = _turning(target, faces, sense, defaults.probability)
        yield _answered("turn", sense, name, shown, target, state, reach, defaults)


def _faces(target: SeenObject) -> dict[str, tuple[str, Face]]:
    """The face to push for each of the robot's directions, with its name."""
    headings = np.array(list(HEADINGS.values())) - target.pose.yaw
    pushed: dict[str, tuple[str, Face]] = {}
    for way, heading in HEADINGS.items():
        outward = [
            (target.pose.R_WB @ np.array(face.normal), face)
            for face in target.model.faces(headings)
        ]
        if not outward:
            continue
        normal, face = min(
            outward, key=lambda pair: abs(angle_between(heading_of(-pair[0]), heading))
        )
        pushed[way] = (face_name(normal)[0], face)
    return pushed


Shown = tuple[float, tuple[float, float], tuple[float, float] | None]


def _on_the_object(chart: OutcomeMap, outcome: str, probability: float) -> Shown | None:
    """Least force, where, and the sure heights; None if no contact has the outcome."""
    first = chart.slide < chart.topple if outcome == "slide" else chart.topple < chart.slide
    (i,) = np.nonzero(first & np.isfinite(chart.force))
    if not i.size:
        return None
    # Of equal forces the place nearest to the middle of the face.
    aside = np.abs(chart.lateral[i])
    best = i[np.lexsort((aside, chart.force[i].round(6)))[0]]
    sure = chart.height[chart.safe(outcome, probability)]
    heights = (float(sure.min()), float(sure.max())) if sure.size else None
    return (
        float(chart.force[best]),
        (float(chart.lateral[best]), float(chart.height[best])),
        heights,
    )


def _turning(
    target: SeenObject, faces: dict[str, tuple[str, Face]], sense: str, probability: float
) -> tuple[str | None, Shown | None]:
    """The face on which the least force turns the object, and what it needs there."""
    best: tuple[str | None, Shown | None] = (None, None)
    sign = 1.0 if sense == "left" else -1.0
    for name, face in faces.values():
        chart = outcome_map(target.model, face, spacing=SPACING)
        r = chart.points - np.array(target.model.com)
        arm = r[:, 0] * chart.directions[:, 1] - r[:, 1] * chart.directions[:, 0]
        turns = sign * arm > _ARM * target.model.friction_radius
        (i,) = np.nonzero(turns & (chart.slide < chart.topple))
        if not i.size:
            continue
        k = i[np.argmin(chart.force[i])]
        sure = chart.height[chart.safe("slide", probability) & turns]
        heights = (float(sure.min()), float(sure.max())) if sure.size else None
        force = float(chart.force[k])
        if best[1] is None or force < best[1][0]:
            best = name, (force, (float(chart.lateral[k]), float(chart.height[k])), heights)
    return best


def _answered(
    outcome: str, way: str, face: str | None, shown: Shown | None,
    target: SeenObject, state: WorldState, reach: Reach, defaults: Defaults,
) -> Affordance:  # fmt: skip
    """What the object allows and what the robot can do."""
    if shown is None:
        verb = {"slide": "slides", "turn": "turns"}.get(outcome, "topples")
        message = f"pushed anywhere on that face, the {target.name} never {verb} first"
        return Affordance(outcome, way, face, False, None, None, None, False, "impossible", message)
    made = plan(_frame(outcome, way, target.name), state, reach, defaults=defaults)
    if isinstance(made, Plan):
        push = made.push
        fingers = "two fingers" if push.fingers == 2 else "one finger"
        message = (
            f"{fingers} {1e3 * push.p_BC[2]:.0f} mm up, at most {push.force_limit:.1f} N, "
            f"probability {made.prediction.probability:.2f}"
        )
        return Affordance(outcome, way, face, True, *shown, True, None, message)
    return Affordance(
        outcome, way, face, True, *shown, False, made.reason, made.message, made.suggestions
    )


def _frame(outcome: str, way: str, name: str) -> g.Frame:
    """What one would say to have it done."""
    ref = g.ObjectRef(text=name, id=name)
    if outcome == "slide":
        goal = g.Displace.model_validate({"direction": way})
        return g.Frame(action="push", object=ref, goal=goal, constraints=(g.NoTopple(),))
    if outcome == "topple":
        return g.Frame(
            action="topple", object=ref, goal=g.Topple.model_validate({"direction": way})
        )
    if outcome == "tilt":
        return g.Frame(action="tilt", object=ref, goal=g.Tilt.model_validate({"direction": way}))
    sense = "ccw" if way == "left" else "cw"
    return g.Frame(action="turn", object=ref, goal=g.Rotate.model_validate({"sense": sense}))
