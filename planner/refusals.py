"""Why there is no plan: one sentence with the numbers that decide, and what would be possible."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from planner.directions import phrase
from planner.plan import Refusal, RefusalReason

if TYPE_CHECKING:
    from planner.asked import Asked
    from planner.candidates import Side
    from planner.defaults import Defaults
    from planner.reach import Reach, ReachAnswer
    from planner.state import SeenObject


def _mm(length: float) -> str:
    return f"{1e3 * length:.0f} mm"


def _deg(angle: float) -> str:
    return f"{math.degrees(abs(angle)):.0f}°"


def unclear_face(asked: Asked, target: SeenObject, off: float) -> Refusal:
    """The object stands so that a face could bear two names."""
    return Refusal(
        reason="unsupported",
        message=f"the {target.name} is turned by {_deg(off)}, "
        f"so it is not clear which of its faces is the {asked.face} one",
        numbers={"turned": off},
        capability="telling faces of a turned object apart",
        spans=asked.contact_spans,
        suggestions=("say the direction of the push instead of the face",),
    )


def oblique(asked: Asked, target: SeenObject, side: Side, angle: float) -> Refusal:
    """No face is square enough to the direction."""
    assert asked.heading is not None
    return Refusal(
        reason="unsupported",
        message=f"pushing the {target.name} {phrase(asked.heading)} would meet its nearest face at "
        f"{_deg(angle)} from square, where fingertips slip off (up to 17.5° would do)",
        numbers={"obliqueness": abs(angle), "largest_obliqueness": math.radians(17.5)},
        capability="turning an object first, or pushing it in several steps",
        spans=asked.contact_spans,
        suggestions=(f"push it {phrase(side.heading)}",),
    )


def off_the_table(asked: Asked, target: SeenObject, room: float) -> Refusal:
    """The table ends before the distance does."""
    left = max(room, 0.0)
    return Refusal(
        reason="impossible",
        message=f"the table ends after {_mm(left)} in that direction; {_mm(asked.distance)} would "
        f"push the {target.name} off it",
        numbers={"room": left, "distance": asked.distance},
        suggestions=(f"up to {100 * left:.0f} cm would do",) if left > 0.01 else (),
    )


def in_the_way(asked: Asked, target: SeenObject, other: SeenObject, free: float) -> Refusal:
    """Another object stands on the way."""
    return Refusal(
        reason="blocked",
        message=f"the {other.name} stands in the way of the {target.name} after {_mm(free)}; "
        f"{_mm(asked.distance)} are asked",
        numbers={"free": free, "distance": asked.distance},
        suggestions=(f"up to {100 * free:.0f} cm would do",) if free > 0.01 else (),
    )


def falls_off(target: SeenObject) -> Refusal:
    """It would land beyond the table's edge."""
    return Refusal(
        reason="impossible",
        message=f"the {target.name} would fall over the edge of the table",
        numbers={"height": target.model.size[2]},
        suggestions=("topple it to another side",),
    )


def falls_on(target: SeenObject, other: SeenObject) -> Refusal:
    """It would land on another object."""
    return Refusal(
        reason="blocked",
        message=f"the {target.name}, {_mm(target.model.size[2])} high, would fall on the "
        f"{other.name}",
        numbers={"height": target.model.size[2]},
        suggestions=("topple it to another side",),
    )


def too_weak(asked: Asked, target: SeenObject, needed: float, reach: Reach) -> Refusal:
    """The allowed force does not suffice."""
    fingers = max(asked.fingers)
    limit = min(asked.max_force, fingers * reach.max_force)
    said = asked.max_force <= fingers * reach.max_force
    verb = "sliding" if asked.outcome == "slide" else "toppling"
    who = "are allowed" if said else "is what the fingers can give"
    return Refusal(
        reason="impossible" if said else "out_of_reach",
        message=f"{verb} the {target.name} may take {needed:.1f} N; {limit:.1f} N {who}",
        numbers={"needed_force": needed, "allowed_force": limit},
        spans=asked.force_spans if said else (),
        suggestions=(f"allow {math.ceil(2 * needed) / 2:g} N",) if said else (),
    )


def no_contact(
    asked: Asked, target: SeenObject, sides: list[Side], reach: Reach, defaults: Defaults
) -> Refusal:
    """No contact that is allowed has the wanted outcome for sure."""
    model = target.model
    points = np.array([[*side.face.centre[:2], 0.5 * model.size[2]] for side in sides])
    normals = np.array([side.face.normal for side in sides])
    worst = model.cone_thresholds(points, normals, sigmas=defaults.sigmas, yaw=False)
    nominal = worst.critical_height
    if asked.outcome == "slide":
        return _cannot_slide(
            asked, target, float(nominal.max()), float(worst.height_below.max()), reach
        )
    return _cannot_topple(asked, target, float(nominal.min()), reach)


def _cannot_slide(
    asked: Asked, target: SeenObject, critical: float, worst: float, reach: Reach
) -> Refusal:
    """It would topple, or might, at every height that is allowed and reached."""
    lowest = max(asked.low, reach.lowest_height)
    numbers = {"lowest_height": lowest, "critical_height_worst": max(worst, 0.0)}
    if math.isfinite(critical):
        numbers["critical_height"] = critical
    certain = (
        f"above {_mm(critical)} it topples before it slides "
        f"(for sure it slides only below {_mm(max(worst, 0.0))})"
    )
    if asked.region is not None:
        numbers["lowest_asked"] = asked.low
        if asked.region.endswith("top"):
            numbers["lowest_top"] = asked.low
        impossible = asked.low >= critical
        verb = "tips" if impossible else "may tip"
        return Refusal(
            reason="impossible" if impossible else "too_uncertain",
            message=f"{asked.region} means {_mm(asked.low)} or higher on the {target.name}; "
            f"pushed there it {verb}, since {certain}",
            numbers=numbers,
            spans=asked.contact_spans,
            suggestions=("push it at the bottom", "leave out where to touch it"),
        )
    reason: RefusalReason = "out_of_reach" if worst < lowest <= critical else "impossible"
    return Refusal(
        reason=reason,
        message=f"the {target.name} would not slide for sure: {certain}; "
        f"the lowest contact that the fingers reach is {_mm(lowest)}",
        numbers=numbers,
        suggestions=("topple it instead",),
    )


def _cannot_topple(asked: Asked, target: SeenObject, critical: float, reach: Reach) -> Refusal:
    highest = min(asked.high, target.model.size[2] - reach.fingertip_radius)
    numbers = {"highest_height": highest}
    if math.isfinite(critical):
        numbers["critical_height"] = critical
    if critical > highest:
        why = (
            f"it slides before it topples below {_mm(critical)}"
            if math.isfinite(critical)
            else "it always slides before it topples"
        )
        return Refusal(
            reason="impossible",
            message=f"the {target.name} cannot be toppled there: {why}, "
            f"and the highest contact is {_mm(highest)}",
            numbers=numbers,
            spans=asked.contact_spans,
            suggestions=("push it at the top", "topple it to another side"),
        )
    return Refusal(
        reason="too_uncertain",
        message=f"the {target.name} should topple when pushed above {_mm(critical)}, but friction "
        f"and centre of mass are not known well enough to be sure up to {_mm(highest)}",
        numbers=numbers,
        spans=asked.contact_spans,
        suggestions=("find out its weight and friction first",),
    )


def no_reach(target: SeenObject, answers: list[ReachAnswer]) -> Refusal:
    """Contacts exist, but the hand gets to none of them."""
    last = answers[0]
    blockers = [a for a in answers if a.reason == "obstacle" and a.blocker]
    if blockers:
        last = blockers[0]
    return Refusal(
        reason="blocked" if blockers else "out_of_reach",
        message=f"{len(answers)} ways to push the {target.name} satisfy the sentence, "
        f"but the hand does not get there: {last.message}",
        numbers={"ways": float(len(answers)), **last.numbers},
        suggestions=("move the " + str(last.blocker),) if blockers else ("another direction",),
    )
