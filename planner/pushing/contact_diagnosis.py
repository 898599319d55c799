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
from planner.pushing.contact_sampling import EDGE, as_held
from planner.types.refusal import Refusal, RefusalReason

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from objectmodels import ObjectModel
    from planner.problem.push_problem import Asked
    from planner.pushing.touchable_sides import Side
    from planner.types.defaults import Defaults
    from planner.types.robot import Reach
    from planner.types.world_state import SeenObject


_ASKED_FOR = {
    "friction": "find out how slippery the {name} is first",
    "com": "find out the centre of mass of the {name} first",
}
"""What to say to the robot, by the parameter."""

_CENTRE_FOUND = 0.001  # to which touching finds a centre of mass [m]


def _mm(length: float) -> str:
    return f"{1e3 * length:.0f} mm"


def no_place(asked: Asked, target: SeenObject, sides: list[Side], reach: Reach) -> Refusal:
    """The fingertips find no place on the face, whatever would come of it."""
    size, lowest = target.model.top, reach.lowest_height
    highest = size - reach.fingertip_radius
    if max(asked.low, lowest) <= min(asked.high, highest):
        return _too_narrow(asked, target, sides, reach)
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
        spans=asked.contact_spans,
        suggestions=suggestions,
    )


def _too_narrow(asked: Asked, target: SeenObject, sides: list[Side], reach: Reach) -> Refusal:
    width = max(side.face.width for side in sides)
    fingers = min(asked.fingers)
    needed = 2 * EDGE + (reach.finger_spreads[-1] if fingers == 2 else 0.0)
    tips = "two fingertips need" if fingers == 2 else "a fingertip needs"
    return Refusal(
        reason="impossible",
        message=f"the {target.name} is {_mm(width)} wide there; {tips} {_mm(needed)}",
        numbers={"width": width, "needed_width": needed},
        spans=asked.contact_spans,
        suggestions=("push it with one finger",) if fingers == 2 else (),
    )


def no_contact(
    asked: Asked, target: SeenObject, sides: list[Side], reach: Reach, defaults: Defaults
) -> Refusal:
    """No contact that is allowed has the wanted outcome for sure."""
    model = target.model
    points = np.array([[*side.face.centre[:2], 0.5 * model.top] for side in sides])
    normals = np.array([side.face.normal for side in sides])
    worst = model.cone_thresholds(points, normals, sigmas=defaults.sigmas, yaw=False)
    nominal = worst.critical_height
    if asked.outcome == "slide":
        sure = min(float(worst.height_below.max()), model.top)
        refusal = _cannot_slide(asked, target, float(nominal.max()), sure, reach)
        side, height = sides[int(np.argmax(nominal))], max(asked.low, reach.lowest_height)
    else:
        refusal = _cannot_topple(asked, target, float(nominal.min()), reach)
        highest = model.top - reach.fingertip_radius
        side, height = sides[int(np.argmin(nominal))], min(asked.high, highest)
    if refusal.reason == "out_of_reach":
        return refusal
    touch = Touch(
        point=np.array([*side.face.centre[:2], height]),
        normal=side.face.normal,
        outcome=asked.outcome,
        turns=2 not in asked.fingers and asked.outcome == "slide",
    )
    if refusal.reason == "impossible":
        # As sure that it does not as a plan must be that it does.
        if outcome_probability(model, touch) < 1.0 - defaults.probability:
            return refusal
        refusal = refusal.model_copy(update={"reason": "too_uncertain"})
    # The last case that candidates are looked at for is that of the hand's stiffness.
    return _with_doubt(refusal, as_held(model, reach), touch, defaults)


def _with_doubt(refusal: Refusal, model: ObjectModel, touch: Touch, d: Defaults) -> Refusal:
    """The refusal with how likely it is, and with what would settle it."""
    probability = outcome_probability(model, touch)
    learn, then = experiment(model, touch, d)
    verb = "slides" if touch.outcome == "slide" else "topples"
    message = (
        f"{refusal.message}; pushed {_mm(touch.point[2])} up it {verb} with a probability of "
        f"{probability:.2f}, and {d.probability:.2f} is asked"
    )
    numbers = {"probability": probability, "probability_then": then}
    return refusal.model_copy(
        update={
            "message": message,
            "numbers": {**refusal.numbers, **numbers, "asked_probability": d.probability},
            "suggestions": (learn, *refusal.suggestions),
        }
    )


def _cannot_slide(
    asked: Asked, target: SeenObject, critical: float, sure: float, reach: Reach
) -> Refusal:
    """It would topple, or might, at every height that is allowed and reached.

    Args:
        asked: what is asked.
        target: the object.
        critical: height above which it topples, nominal; inf if never [m].
        sure: height below which it slides in the worst case; 0 if nowhere [m].
        reach: the hand's reach.
    """
    lowest = max(asked.low, reach.lowest_height)
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
    elsewhere = ("push it at the bottom",) if asked.low >= sure > reach.lowest_height else ()
    return Refusal(
        reason=reason,
        message=f"{asked.region} means {heights} on the {target.name}{reached}; "
        f"pushed there it {verb}, since {certain}",
        numbers=numbers,
        spans=asked.contact_spans,
        suggestions=(*elsewhere, "leave out where to touch it"),
    )


def _slides_where(critical: float, sure: float) -> str:
    """Where it slides and where it topples, in words."""
    surely = f"only below {_mm(sure)}" if sure > 0.0 else "nowhere"
    if math.isinf(critical):
        return f"it is sure to slide {surely}"
    return f"above {_mm(critical)} it topples before it slides (for sure it slides {surely})"


def _other_side(target: SeenObject) -> tuple[str, ...]:
    """What is round falls alike to all sides."""
    return () if isinstance(target.model.base, Disc) else ("topple it to another side",)


def _cannot_topple(asked: Asked, target: SeenObject, critical: float, reach: Reach) -> Refusal:
    """It would slide, or might, at every height that is allowed; `critical` as for sliding."""
    highest = min(asked.high, target.model.top - reach.fingertip_radius)
    numbers = {"highest_height": highest}
    if math.isinf(critical):
        return Refusal(
            reason="impossible",
            message=f"the {target.name} does not topple there: by what is known it slides "
            f"before it topples, even {_mm(highest)} above the table",
            numbers=numbers,
            spans=asked.contact_spans,
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
            spans=asked.contact_spans,
            suggestions=higher or _other_side(target),
        )
    return Refusal(
        reason="too_uncertain",
        message=f"the {target.name} should topple when pushed above {_mm(critical)}, but friction "
        f"and centre of mass are not known well enough to be sure up to {_mm(highest)}",
        numbers=numbers,
        spans=asked.contact_spans,
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


def experiment(model: ObjectModel, touch: Touch, defaults: Defaults) -> tuple[str, float]:
    """What to find out first, as a sentence, and the probability of the outcome then.

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
