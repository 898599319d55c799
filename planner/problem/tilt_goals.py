"""Tilting an object and letting it back onto its base: how far, and whether it surely comes back.

Model: the object pivots about the far edge of its base; see
`objectmodels.mechanics.push_thresholds`. It must come back with the probability that plans need,
from the asked angle and from what the control may miss it by. It leans over by sin θ times its
height on the way.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from grammar.frames.command import Tilt
from objectmodels import ObjectModel
from objectmodels.mechanics.push_thresholds import largest_return, return_probability
from planner.geometry.footprints import footprint, free_travel, leading_point
from planner.problem.planning_problem import PushProblem, value_in_bound
from planner.refusals.refusal_builder import QUANTITIES, no_plan, refusal
from planner.refusals.refusal_marks import length_mark, tilt_mark
from planner.types.actions import Limits, Prediction, Push
from planner.types.defaults import Defaults
from planner.types.refusal import NoPlanError, Refusal
from planner.types.world_state import SeenObject

CLEARANCE = 0.01
"""Distance that a leaning object keeps from others [m]."""

_HEADINGS = 24  # to which what is tilted may lean
_SLACK = 0.015  # travel beyond what the model says, for what it does not know [m]


def tilt_goal(goal: Tilt, model: ObjectModel, defaults: Defaults) -> tuple[float, str | None]:
    """The angle to plan for [rad], and why it is a default, if it is one."""
    if goal.angle is not None:
        return value_in_bound(goal.angle, goal.bound, defaults.tilt_tolerance), None
    most = almost_tips(model, defaults)
    if goal.amount == "lot":
        return most, "“a lot”"
    if goal.amount == "little":
        return min(defaults.tilt_little, most), "“a little”"
    return min(defaults.tilt, most), "no angle said"


def almost_tips(model: ObjectModel, defaults: Defaults) -> float:
    """A tilt well short of the angle of no return, whichever way it is tilted [rad]."""
    least = min(model.angle_of_no_return(face.normal) for face in model.faces())
    return defaults.tilt_lot * least


def most_tilt(angle: float, defaults: Defaults) -> float:
    """The largest tilt that an asked one may become, angles in rad."""
    return angle + defaults.tolerance_of(angle, defaults.tilt_tolerance)


def spill_tilt(target: SeenObject, sigmas: float) -> float | None:
    """Least tilt at which an object may begin to spill [rad]; None if nothing can run out.

    There may be more in it than is believed, by `sigmas` standard deviations.
    """
    container, vessel = target.model.container, target.model.vessel
    if container is None or vessel is None or target.is_covered:
        return None
    volume = container.contents + sigmas * container.contents_sd
    if volume <= 0.0:
        return None
    headings = np.linspace(-np.pi, np.pi, _HEADINGS, endpoint=False)
    return float(vessel.spill_angle(volume, headings).min())


def require_free_tilt(
    problem: PushProblem, normal: ArrayLike, u: NDArray[np.float64], angle: float
) -> None:
    """Make sure that a tilt neither ends in a fall nor hits anything.

    Args:
        problem: about the object.
        normal: outward normal of the face in B, shape (3,).
        u: unit direction of the push in W, shape (3,).
        angle: by which it is to be tilted [rad].

    Raises:
        NoPlanError: it may fall, or something stands where it leans to.
    """
    target = problem.target
    most = most_tilt(angle, problem.defaults)
    inward = -np.asarray(normal)
    if return_probability(target.model, inward, most) < problem.effort.probability:
        raise NoPlanError(_may_fall(problem, inward, angle))
    leans = target.model.top * math.sin(most)
    here = footprint(target)
    for name, other in problem.others.items():
        free = free_travel(here, footprint(other), u[:2], CLEARANCE)
        if free < leans:
            text = f"{1e3 * free:.0f} mm to the {name}; it leans over by {1e3 * leans:.0f} mm"
            raise no_plan(
                "leans_on",
                {"free": free, "leans_over": leans},
                marks=(length_mark(leading_point(target, u), u, free, text, leans),),
                object=target.name,
                other=name,
                tilt=angle,
                room=max(free, 0.0),
            )


def push_with_tilt(
    push: Push,
    model: ObjectModel,
    inward: NDArray[np.float64],
    angle: float,
    defaults: Defaults,
) -> Push:
    """The push, high on a face with an inward normal in B (3,), that ends on a tilt [rad]."""
    most = most_tilt(angle, defaults)
    stroke = model.topple_stroke(inward, push.p_BC[2], most) + _SLACK
    changes = {
        "ends_on": "tilted", "tilt": angle, "stroke": stroke,
        "limits": Limits(tilt=most),
    }  # fmt: skip
    return push.model_copy(update=changes)


def prediction_with_return(
    predicted: Prediction,
    model: ObjectModel,
    inward: NDArray[np.float64],
    angle: float,
    defaults: Defaults,
) -> Prediction:
    """The prediction with the chance that the object also comes back from a tilt."""
    back = return_probability(model, inward, most_tilt(angle, defaults))
    # At least so likely, however the two hang together.
    both = max(predicted.probability + back - 1.0, 0.0)
    return predicted.model_copy(update={"probability": both})


def _may_fall(problem: PushProblem, inward: NDArray[np.float64], angle: float) -> Refusal:
    """It would not surely come back."""
    target, defaults = problem.target, problem.defaults
    no_return = target.model.angle_of_no_return(inward)
    sure = largest_return(target.model, inward, problem.effort.probability)
    possible = max(sure - defaults.tilt_tolerance, 0.0)
    impossible = angle >= no_return
    ways = (
        (f"up to {QUANTITIES['deg_floor'](possible)} would do",)
        if possible > math.radians(1.0)
        else ()
    )
    learn = () if impossible else ("find out where its centre of mass is first",)
    u = target.pose.R_WB @ inward
    text = f"beyond {QUANTITIES['deg_exact'](no_return)} it falls by itself"
    mark = tilt_mark(target.name, leading_point(target, u), u, no_return, text)
    return refusal(
        "no_return" if impossible else "may_not_return",
        {"tilt": angle, "stay_on_base_angle": no_return, "sure_return": sure},
        instead=(*ways, *learn),
        marks=(mark,),
        object=target.name,
        tolerance=defaults.tilt_tolerance,
    )
