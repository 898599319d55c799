"""Why no contact on an object will do, with the heights and the probability that decide.

Model of a doubt: the probability of the outcome at a contact, once as the object is believed and
once with one of its parameters known as well as touching finds it out (`Defaults.found_to`). The
parameter whose knowledge decides most, one way or the other, is the one to be found out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from objectmodels.geometry.base_shapes import Disc
from planner.pushing.contact_sampling import EDGE, has_place, model_limited_by_hand
from planner.types.dead_ends import NoPlanError
from planner.types.refusal import Refusal, RefusalReason

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from objectmodels import ObjectModel
    from planner.problem.planning_problem import PushProblem
    from planner.pushing.touchable_sides import PushStep, Side
    from planner.types.defaults import Defaults
    from planner.types.world_state import SeenObject


_ASKED_FOR = {
    "friction": "find out how slippery the {name} is first",
    "com": "find out the centre of mass of the {name} first",
}
"""What to say to the robot, by the parameter."""

_CENTRE_FOUND = 0.001  # to which touching finds a centre of mass [m]


def _mm(length: float) -> str:
    return f"{1e3 * length:.0f} mm"


def require_place(problem: PushProblem, step: PushStep, sides: list[Side]) -> None:
    """Make sure that fingertips find a place on one of the sides, whatever the outcome there.

    Raises:
        NoPlanError: they find none.
    """
    if not has_place(problem, step, sides):
        raise NoPlanError(_no_place(problem, sides))


def _no_place(problem: PushProblem, sides: list[Side]) -> Refusal:
    target, asked, limits = problem.target, problem.contact, problem.robot.limits
    size, lowest = target.model.top, limits.lowest_height
    highest = size - limits.fingertip_radius
    if max(asked.low, lowest) <= min(asked.high, highest):
        return _too_narrow(problem, sides)
    numbers = {"lowest_height": lowest, "highest_height": highest}
    suggestions: tuple[str, ...] = ("leave out where to touch it",)
    reason: RefusalReason = "out_of_reach"
    if asked.region is None:
        message = f"the {target.name} is {_mm(size)} high; the fingers reach {_mm(lowest)} and more"
        suggestions = ()
    elif asked.low > highest:
        reason = "impossible"
        message = (
            f"{asked.region} means {_mm(asked.low)} or higher; the {target.name} is {_mm(size)} "
            f"high and fingertips find a place on it up to {_mm(highest)}"
        )
    elif asked.low > asked.high:
        reason, numbers = "impossible", {"lowest_asked": asked.low, "highest_asked": asked.high}
        message = (
            f"no contact is {asked.region}: one ends at {_mm(asked.high)}, the other starts at "
            f"{_mm(asked.low)}"
        )
    else:
        message = (
            f"{asked.region} means up to {_mm(asked.high)}; the lowest contact that the fingers "
            f"reach is {_mm(lowest)}"
        )
    return Refusal(
        reason=reason,
        message=message,
        numbers=numbers,
        spans=asked.spans,
        suggestions=suggestions,
    )


def _too_narrow(problem: PushProblem, sides: list[Side]) -> Refusal:
    asked, spreads = problem.contact, problem.robot.limits.finger_spreads
    width = max(side.face.width for side in sides)
    fingers = min(asked.fingers)
    needed = 2 * EDGE + (spreads[-1] if fingers == 2 else 0.0)
    tips = "two fingertips need" if fingers == 2 else "a fingertip needs"
    return Refusal(
        reason="impossible",
        message=f"the {problem.target.name} is {_mm(width)} wide there; {tips} {_mm(needed)}",
        numbers={"width": width, "needed_width": needed},
        spans=asked.spans,
        suggestions=("push it with one finger",) if fingers == 2 else (),
    )


def contact_refusal(problem: PushProblem, step: PushStep, sides: list[Side]) -> Refusal:
    """Refusal of a push because no contact that is allowed has the wanted outcome for sure."""
    model, limits, asked = problem.target.model, problem.robot.limits, problem.contact
    points = np.array([[*side.face.centre[:2], 0.5 * model.top] for side in sides])
    normals = np.array([side.face.normal for side in sides])
    worst = model.cone_thresholds(points, normals, sigmas=problem.defaults.sigmas, yaw=False)
    nominal = worst.critical_height
    if step.outcome == "slide":
        sure = min(float(worst.height_below.max()), model.top)
        refusal = _cannot_slide(problem, float(nominal.max()), sure)
        side, height = sides[int(np.argmax(nominal))], max(asked.low, limits.lowest_height)
    else:
        refusal = _cannot_topple(problem, float(nominal.min()))
        highest = model.top - limits.fingertip_radius
        side, height = sides[int(np.argmin(nominal))], min(asked.high, highest)
    if refusal.reason == "out_of_reach":
        return refusal
    touch = Touch(
        point=np.array([*side.face.centre[:2], height]),
        normal=side.face.normal,
        outcome=step.outcome,
        turns=2 not in asked.fingers and step.outcome == "slide",
    )
    if refusal.reason == "impossible":
        # As sure that it does not as a plan must be that it does.
        if outcome_probability(model, touch) < 1.0 - problem.effort.probability:
            return refusal
        refusal = refusal.model_copy(update={"reason": "too_uncertain"})
    # The last case that candidates are looked at for is that of the hand's stiffness.
    return _with_doubt(problem, refusal, model_limited_by_hand(model, limits), touch)


def _with_doubt(
    problem: PushProblem, refusal: Refusal, model: ObjectModel, touch: Touch
) -> Refusal:
    """The refusal with how likely it is, and with what would settle it."""
    probability, asked = outcome_probability(model, touch), problem.effort.probability
    learn, then = best_experiment(model, touch, problem.defaults)
    verb = "slides" if touch.outcome == "slide" else "topples"
    message = (
        f"{refusal.message}; pushed {_mm(touch.point[2])} up it {verb} with a probability of "
        f"{probability:.2f}, and {asked:.2f} is asked"
    )
    numbers = {"probability": probability, "probability_then": then}
    return refusal.model_copy(
        update={
            "message": message,
            "numbers": {**refusal.numbers, **numbers, "asked_probability": asked},
            "suggestions": (learn, *refusal.suggestions),
        }
    )


def _cannot_slide(problem: PushProblem, critical: float, sure: float) -> Refusal:
    """It would topple, or might, at every height that is allowed and reached.

    Args:
        problem: about the object.
        critical: height above which it topples, nominal; inf if never [m].
        sure: height below which it slides in the worst case; 0 if nowhere [m].
    """
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
        return Refusal(
            reason=reason,
            message=f"the {target.name} would not slide for sure: {certain}; "
            f"the lowest contact that the fingers reach is {_mm(lowest)}",
            numbers=numbers,
            suggestions=("topple it instead",),
        )
    numbers["lowest_asked"] = asked.low
    if asked.region == "at the top":
        numbers["lowest_top"] = asked.low
    upright = asked.high >= target.model.top
    heights = f"{_mm(asked.low)} or higher" if upright else f"{_mm(asked.low)} to {_mm(asked.high)}"
    reached = f", reached from {_mm(lowest)} up" if lowest > asked.low else ""
    verb = "tips" if lowest >= critical else "may tip"
    elsewhere = ("push it at the bottom",) if asked.low >= sure > reached_from else ()
    return Refusal(
        reason=reason,
        message=f"{asked.region} means {heights} on the {target.name}{reached}; "
        f"pushed there it {verb}, since {certain}",
        numbers=numbers,
        spans=asked.spans,
        suggestions=(*elsewhere, "leave out where to touch it"),
    )


def _slides_where(critical: float, sure: float) -> str:
    """Heights at which it slides and at which it topples, in words."""
    surely = f"only below {_mm(sure)}" if sure > 0.0 else "nowhere"
    if math.isinf(critical):
        return f"it is sure to slide {surely}"
    return f"above {_mm(critical)} it topples before it slides (for sure it slides {surely})"


def _other_side(target: SeenObject) -> tuple[str, ...]:
    """Suggestion of another side; none for a round object, which falls alike to all."""
    return () if isinstance(target.model.base, Disc) else ("topple it to another side",)


def _cannot_topple(problem: PushProblem, critical: float) -> Refusal:
    """It would slide, or might, at every height that is allowed; `critical` as for sliding."""
    asked, target = problem.contact, problem.target
    highest = min(asked.high, target.model.top - problem.robot.limits.fingertip_radius)
    numbers = {"highest_height": highest}
    if math.isinf(critical):
        return Refusal(
            reason="impossible",
            message=f"the {target.name} does not topple there: by what is known it slides "
            f"before it topples, even {_mm(highest)} above the table",
            numbers=numbers,
            spans=asked.spans,
            suggestions=_other_side(target),
        )
    numbers["critical_height"] = critical
    higher = ("push it at the top",) if asked.high < target.model.top else ()
    if critical > highest:
        return Refusal(
            reason="impossible",
            message=f"the {target.name} does not topple there: it slides before it topples below "
            f"{_mm(critical)}, and the highest contact is {_mm(highest)}",
            numbers=numbers,
            spans=asked.spans,
            suggestions=higher or _other_side(target),
        )
    return Refusal(
        reason="too_uncertain",
        message=f"the {target.name} should topple when pushed above {_mm(critical)}, but friction "
        f"and centre of mass are not known well enough to be sure up to {_mm(highest)}",
        numbers=numbers,
        spans=asked.spans,
        suggestions=higher,
    )


# -- which doubt leaves the outcome open ---------------------------------------------------------


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

    Args:
        model: of the object.
        touch: the contact and the outcome.
    """
    point, normal = touch.point[None], np.array([touch.normal])
    found = model.cone_thresholds(point, normal, sigmas=0.0, yaw=touch.turns)
    p = found.probability_slide if touch.outcome == "slide" else found.probability_topple
    return float(p[0])


def best_experiment(model: ObjectModel, touch: Touch, defaults: Defaults) -> tuple[str, float]:
    """The most useful thing to find out first, and the probability of the outcome then.

    Args:
        model: of the object.
        touch: the contact and the outcome.
        defaults: to what properties are found out.
    """
    found_to = defaults.found_to
    known: dict[str, dict[str, object]] = {
        "friction": {"friction_sd": min(model.friction_sd, found_to * model.friction)},
        "com": {"com_sd": tuple(min(sd, _CENTRE_FOUND) for sd in model.com_sd)},
    }
    then = {
        name: outcome_probability(model.model_copy(update=better), touch)
        for name, better in known.items()
    }
    best = max(then, key=lambda name: abs(then[name] - 0.5))
    return _ASKED_FOR[best].format(name=model.name), then[best]
