"""Why no contact on an object will do, with the heights and the probability that decide.

Model of a doubt: the probability of the outcome at a contact, once as the object is believed
and once with one of its parameters known as well as touching finds it out
(`Defaults.found_to`). The parameter whose knowledge decides most, one way or the other, is the
one to be found out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from objectmodels import ObjectModel
from planner.problem.planning_problem import PushProblem, PushStep, Side
from planner.pushing.contact_sampling import EDGE, model_limited_by_hand
from planner.refusals.blocked import Blocked, dead_end
from planner.types.defaults import Defaults
from planner.types.refusal import RefusalReason, probability_text
from planner.types.world_state import HeightMark


def _mm(length: float) -> str:
    return f"{1e3 * length:.0f} mm"


def no_place(problem: PushProblem, sides: list[Side]) -> Blocked:
    """Dead end since no side has room for fingers where they may touch it."""
    target, asked, limits = problem.target, problem.contact, problem.robot.limits
    size, lowest = target.model.top, limits.lowest_height
    highest = size - limits.fingertip_radius
    if max(asked.low, lowest) <= min(asked.high, highest):
        two = min(asked.fingers) == 2
        needed = 2 * EDGE + (limits.finger_spreads[-1] if two else 0.0)
        code = "too_narrow_for_two" if two else "too_narrow_for_one"
        numbers = {"width": max(side.face.width for side in sides), "needed_width": needed}
        return dead_end(code, numbers, spans=asked.spans, object=target.name)
    numbers = {"lowest_height": lowest, "highest_height": highest}
    if asked.region is None:
        code = "out_of_fingers_reach"
    elif asked.low > highest:
        code = "region_too_high"
    elif asked.low > asked.high:
        code, numbers = "no_such_contact", {"lowest_asked": asked.low, "highest_asked": asked.high}
    else:
        code = "region_too_low"
    return dead_end(
        code,
        numbers,
        spans=asked.spans,
        object=target.name,
        size=size,
        region=asked.region,
        low=asked.low,
        high=asked.high,
    )


def unsuited_contacts(problem: PushProblem, step: PushStep, sides: list[Side]) -> Blocked:
    """Dead end since no contact that is allowed has the wanted outcome for sure."""
    model, limits, asked = problem.target.model, problem.robot.limits, problem.contact
    points = np.array([[*side.face.centre[:2], 0.5 * model.top] for side in sides])
    normals = np.array([side.face.normal for side in sides])
    worst = model.cone_thresholds(points, normals, sigmas=problem.defaults.sigmas, yaw=False)
    nominal = worst.critical_height
    if step.outcome == "slide":
        sure = min(float(worst.height_below.max()), model.top)
        refused = _cannot_slide(problem, float(nominal.max()), sure)
        side, height = sides[int(np.argmax(nominal))], max(asked.low, limits.lowest_height)
    else:
        refused = _cannot_topple(problem, float(nominal.min()))
        highest = model.top - limits.fingertip_radius
        side, height = sides[int(np.argmin(nominal))], min(asked.high, highest)
    if refused.reason == "out_of_reach":
        return refused
    touch = Touch(
        point=np.array([*side.face.centre[:2], height]),
        normal=side.face.normal,
        outcome=step.outcome,
        turns=2 not in asked.fingers and step.outcome == "slide",
    )
    if refused.reason == "impossible":
        # As sure that it does not as a plan must be that it does.
        if outcome_probability(model, touch) < 1.0 - problem.effort.probability:
            return refused
        refused = replace(refused, reason="too_uncertain")
    # The last case that candidates are looked at for is that of the hand's stiffness.
    return _with_doubt(problem, refused, model_limited_by_hand(model, limits), touch)


def _with_doubt(
    problem: PushProblem, refused: Blocked, model: ObjectModel, touch: Touch
) -> Blocked:
    """The dead end with how likely it is, and with what would settle it."""
    probability, asked = outcome_probability(model, touch), problem.effort.probability
    learn, then = best_experiment(model, touch, problem.defaults)
    verb, height = "slides" if touch.outcome == "slide" else "topples", float(touch.point[2])
    mark = HeightMark(
        object=problem.target.name,
        height=height,
        about="asked",
        text=f"pushed at {_mm(height)} it {verb} with probability {probability_text(probability)}",
    )
    doubt = {"probability": probability, "probability_then": then, "asked_probability": asked}
    words = {"at": height, "does": verb, "model": model.name}
    return replace(refused.with_fact(f"doubt.{learn}", doubt, **words), marks=(mark,))


def _cannot_slide(problem: PushProblem, critical: float, sure: float) -> Blocked:
    """It would topple, or might, at every height that is allowed and reached."""
    asked, target = problem.contact, problem.target
    reached_from = problem.robot.limits.lowest_height
    lowest = max(asked.low, reached_from)
    numbers = {"lowest_height": lowest, "critical_height_worst": sure}
    if math.isfinite(critical):
        numbers["critical_height"] = critical
    certain = _slides_where(critical, sure)
    reason: RefusalReason = "too_uncertain"
    if asked.low >= critical:
        reason = "impossible"
    elif lowest >= critical or asked.low < sure < lowest:
        reason = "out_of_reach"
    if asked.region is None:
        name = target.name
        return dead_end("may_not_slide", numbers, reason=reason, object=name, certain=certain)
    numbers["lowest_asked"] = asked.low
    if asked.region == "at the top":
        numbers["lowest_top"] = asked.low
    upright = asked.high >= target.model.top
    heights = f"{_mm(asked.low)} or higher" if upright else f"{_mm(asked.low)} to {_mm(asked.high)}"
    reached = f", reached from {_mm(lowest)} up" if lowest > asked.low else ""
    verb = "tips" if lowest >= critical else "may tip"
    lower = asked.low >= sure > reached_from
    return dead_end(
        "may_not_slide_up_there" if lower else "may_not_slide_there",
        numbers,
        spans=asked.spans,
        reason=reason,
        object=target.name,
        region=asked.region,
        heights=heights,
        reached=reached,
        verb=verb,
        certain=certain,
    )


def _slides_where(critical: float, sure: float) -> str:
    """Heights at which it slides and at which it topples, in words."""
    surely = f"only below {_mm(sure)}" if sure > 0.0 else "nowhere"
    if math.isinf(critical):
        return f"it is sure to slide {surely}"
    return f"above {_mm(critical)} it topples before it slides (for sure it slides {surely})"


def _cannot_topple(problem: PushProblem, critical: float) -> Blocked:
    """It would slide, or might, at every height that is allowed; `critical` as for sliding."""
    asked, target = problem.contact, problem.target
    highest = min(asked.high, target.model.top - problem.robot.limits.fingertip_radius)
    numbers = {"highest_height": highest}
    spans, name = asked.spans, target.name
    # What is round falls alike to all sides.
    other = "" if target.model.base.is_round else ".side"
    if math.isinf(critical):
        return dead_end(f"never_topples{other}", numbers, spans=spans, object=name)
    numbers["critical_height"] = critical
    higher = ".higher" if asked.high < target.model.top else ""
    key = f"slides_below{higher or other}" if critical > highest else f"may_not_topple{higher}"
    return dead_end(key, numbers, spans=spans, object=name)


@dataclass(frozen=True)
class Touch:
    """A contact from which something is wanted.

    Attributes:
        point: p_BC, shape (3,) [m].
        normal: outward unit normal there.
        outcome: that is wanted at the onset.
        turns: whether the object may turn as it slides; two fingertips hold it straight.
    """

    point: NDArray[np.float64]
    normal: tuple[float, float, float]
    outcome: Literal["slide", "topple"]
    turns: bool = False


def outcome_probability(model: ObjectModel, touch: Touch) -> float:
    """Probability of an outcome at a contact, whatever the finger transmits.

    By the exact tier, with which the closed form agrees where the object does not turn.
    """
    if touch.turns:
        from objectmodels.exact.exact_probability import least_probability

        return least_probability(model, touch.point, np.array(touch.normal), touch.outcome)
    point, normal = touch.point[None], np.array([touch.normal])
    found = model.cone_thresholds(point, normal, sigmas=0.0, yaw=False)
    p = found.probability_slide if touch.outcome == "slide" else found.probability_topple
    return float(p[0])


def best_experiment(model: ObjectModel, touch: Touch, defaults: Defaults) -> tuple[str, float]:
    """The parameter most useful to be known, and the probability of the outcome then."""
    found_to = defaults.found_to
    known: dict[str, dict[str, object]] = {
        "friction": {"friction_sd": min(model.friction_sd, found_to * model.friction)},
        # Touching finds a centre of mass to a millimetre.
        "com": {"com_sd": tuple(min(sd, 0.001) for sd in model.com_sd)},
    }
    then = {
        name: outcome_probability(model.model_copy(update=better), touch)
        for name, better in known.items()
    }
    best = max(then, key=lambda name: abs(then[name] - 0.5))
    return best, then[best]
