"""Predicted outcome of a push, and its margins to the outcomes that it must not have.

Frames: contacts and directions are in B; forces along the push.
"""

from __future__ import annotations

import functools
import math
from statistics import NormalDist
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from objectmodels import ObjectModel, Thresholds
from objectmodels.geometry.base_shapes import Array, Disc
from objectmodels.mechanics.friction_cone import contact_forces
from objectmodels.mechanics.push_outcomes import OUTCOMES, circle_corners
from objectmodels.mechanics.push_thresholds import slide_threshold, yaw_arm
from objectmodels.models.predictor import own_predictions
from planner.problem.planning_problem import PushProblem, PushStep
from planner.problem.tilt_goals import prediction_with_return
from planner.pushing.contact_sampling import Contact, Contacts, model_limited_by_hand
from planner.types.actions import Margins, Prediction, Push, Vector3
from planner.types.probability_text import probability_text

SURE = 0.999
"""Probability of a slide by the closed form that the exact tier does not lower by 0.0002."""

_SPINS = 0.15  # share of the force to tip a round object over which it may turn on its rim before
_CLEARLY = 0.6  # room to toppling as a share of the force to slide it that needs no second look
_CONFIRMING = 8  # directions on the friction cone's boundary that the exact tier looks at


def needed_force(problem: PushProblem, step: PushStep, contact: Contact) -> float:
    """Force along the push that the motion needs, with the probability that plans must have [N]."""
    return float(needed_forces(problem, step, contact.among)[contact.rank])


def needed_forces(problem: PushProblem, step: PushStep, contacts: Contacts) -> NDArray[np.float64]:
    """The same for all chosen contacts of a face, shape (k,)."""
    model = problem.target.model
    if step.outcome == "topple":
        largest = contacts.cone.topple_max[contacts.chosen]
        return np.asarray(largest * (1.0 + contacts.sigmas * model.mass_sd / model.mass))
    points, inward = contacts.points[contacts.chosen], contacts.side.inward[None]
    if contacts.fingers == 2:
        points = np.array([_point_of_pair(model, contact) for contact in contacts])
    nominal = _nominal_slides(model, tuple(points.ravel().tolist()), tuple(inward[0].tolist()))
    share = math.hypot(model.friction_sd / model.friction, model.mass_sd / model.mass)
    return nominal * (1.0 + NormalDist().inv_cdf(problem.effort.probability) * share)


@functools.lru_cache(maxsize=1024)
def _nominal_slides(
    model: ObjectModel, places: tuple[float, ...], inward: Vector3
) -> NDArray[np.float64]:
    """Forces at which nominal parameters slide at places, one after the other; kept, as below."""
    u = np.array([inward])
    arm = yaw_arm(np.reshape(places, (-1, 3)), u, np.array(model.com))
    return slide_threshold(u, arm, model.friction, model.friction_radius, model.weight)


def prediction(problem: PushProblem, step: PushStep, contact: Contact) -> Prediction:
    """Prediction of the object model for a push at a contact."""
    i, model, cone = contact.index, problem.target.model, contact.among.cone
    inward = contact.among.side.inward
    if contact.among.fingers == 1:
        nominal = _exact_thresholds(model, *_place(contact), 0.0)
    else:
        # Two fingers hold the object straight, and then the closed form is exact.
        nominal = model.thresholds(_point_of_pair(model, contact)[None], inward[None])
    worst = cone.height_below[i] if step.outcome == "slide" else cone.height_above[i]
    predicted = Prediction(
        outcome=step.outcome,
        onset=float(nominal.onset[0]),
        slide_force=_finite_or_none(nominal.slide[0]),
        topple_force=_finite_or_none(nominal.topple[0]),
        critical_height=_finite_or_none(cone.critical_height[i]),
        critical_height_worst=_finite_or_none(worst),
        probability=probability(problem, step, contact),
        stay_on_base_angle=model.angle_of_no_return(inward),
        tier="exact",
        friction="static",
    )
    if step.tilt is None:
        return predicted
    return prediction_with_return(predicted, model, inward, step.tilt, problem.defaults)


def probability(problem: PushProblem, step: PushStep, contact: Contact) -> float:
    """Probability of the wanted outcome, whatever the finger transmits, by the exact tier.

    The closed form's is as good for two fingers, which leave the object no turning, and within a
    thousandth for slides of which it is sure.
    """
    model = problem.target.model
    sure = step.outcome == "slide" and contact.probability >= SURE
    if sure or contact.among.fingers == 2:
        return contact.probability
    if contact.among.guarded:
        model = model_limited_by_hand(model, problem.robot.limits)
    return _exact_probability(model, *_place(contact), step.outcome, contact.among.turning)


def confirm_with_exact_tier(problem: PushProblem, step: PushStep, contact: Contact) -> bool:
    """Return True if the exact tier has the same outcome at a contact, all over the cone.

    The contacts were chosen by the closed form, whose friction limit may be off where the object
    turns as it slides; two fingers leave it no turning, and need no second look. Neither do
    contacts that are much farther from toppling than it is ever off (`benchmarks.accuracy`).
    """
    if contact.among.fingers == 2:
        return True
    cone = contact.among.cone
    if step.outcome == "slide":
        surely = cone.slide_margin > _CLEARLY * cone.slide_max
        if surely[contact.index]:
            return True
    model = problem.target.model
    grip = model.finger_friction
    if contact.among.guarded:
        grip = min(problem.robot.limits.force_skew, grip)
    if step.outcome == "topple" and isinstance(model.base, Disc):
        # On one point of its rim it spins before it tips, and still tips.
        t = _exact_thresholds(model, *_place(contact), grip)
        return bool((t.slide >= (1.0 - _SPINS) * t.topple).all())
    return bool((_exact_outcomes(model, *_place(contact), grip) == step.outcome).all())


def _point_of_pair(model: ObjectModel, contact: Contact) -> NDArray[np.float64]:
    """Point, shape (3,) [m], at which one finger turns the object as little as two would."""
    point, tangent = contact.point, np.array(contact.among.side.face.tangent)
    return np.asarray(point - ((point - np.array(model.com)) @ tangent) * tangent)


def _place(contact: Contact) -> tuple[Vector3, Vector3]:
    """The contact and the outward normal there, in B."""
    x, y, z = contact.point.tolist()
    return (x, y, z), contact.among.side.face.normal


# Kept, since models never change and the same contacts are asked for again and again.
@functools.lru_cache(maxsize=1024)
def _exact_probability(
    model: ObjectModel, point: Vector3, normal: Vector3, outcome: Literal["slide", "topple"],
    turning: bool,
) -> float:  # fmt: skip
    """Probability of an outcome at a contact for the worst force in the finger's cone.

    What turns the object presses on it sideways.
    """
    from objectmodels.exact.exact_probability import least_probability

    spins = outcome == "topple" and isinstance(model.base, Disc)
    topples_at = 1.0 - _SPINS if spins else 1.0
    return least_probability(
        model, np.array(point), np.array(normal), outcome, aside=turning, topples_at=topples_at
    )


@functools.lru_cache(maxsize=1024)
def _exact_thresholds(
    model: ObjectModel, point: Vector3, normal: Vector3, grip: float
) -> Thresholds:
    """Thresholds of the exact tier at a contact, for `_cone_pushes`."""
    return model.thresholds(*_cone_pushes(point, normal, grip), exact=True)


@functools.lru_cache(maxsize=1024)
def _exact_outcomes(
    model: ObjectModel, point: Vector3, normal: Vector3, grip: float
) -> NDArray[np.str_]:
    """Classes of the same pushes."""
    if own_predictions(type(model), ObjectModel):
        return _exact_thresholds(model, point, normal, grip).outcome
    from objectmodels.exact.exact_thresholds import exact_codes

    return np.asarray(OUTCOMES[exact_codes(model, *_cone_pushes(point, normal, grip))])


def _cone_pushes(point: Vector3, normal: Vector3, grip: float) -> tuple[Array, Array]:
    """Contacts and directions of a force straight in, and of forces around the cone, (n, 3) each.

    Without friction at the finger there is no cone.
    """
    around = circle_corners(_CONFIRMING) if grip else np.empty((0, 2))
    forces = contact_forces(np.array([normal]), grip * np.vstack((np.zeros((1, 2)), around)))
    u = forces / np.linalg.norm(forces, axis=1, keepdims=True)
    return np.tile(point, (len(u), 1)), u


def margins(problem: PushProblem, step: PushStep, contact: Contact, force_limit: float) -> Margins:
    """Distances of a contact from the outcome that it must not have."""
    i, cone, height = contact.index, contact.among.cone, problem.target.model.top
    z = float(contact.point[2])
    if step.outcome == "slide":
        force, room = float(cone.slide_margin[i]), min(float(cone.height_below[i]), height) - z
    else:
        force, room = float(cone.topple_margin[i]), z - max(float(cone.height_above[i]), 0.0)
    return Margins(
        # What never happens has no threshold: the object's weight is then far enough.
        force=min(force, problem.target.model.weight),
        height=room,
        lateral=float(contact.among.lateral[i]),
        sigmas=contact.among.sigmas,
        force_limit=force_limit - needed_force(problem, step, contact),
    )


def _finite_or_none(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def selection_notes(
    problem: PushProblem, contact: Contact, push: Push, predicted: Prediction, refused: int
) -> tuple[str, ...]:
    """Plain sentences on how the push was chosen; `refused` contacts were out of reach."""
    notes, limits, sigmas = [], problem.contact, problem.defaults.sigmas
    if limits.region is not None:
        notes.append(f"the sentence asks for a contact {limits.region}")
    if push.fingers == 1 and 2 in limits.fingers:
        notes.append("one finger, since two do not fit or do not reach it")
    if contact.among.sigmas < sigmas:
        near = (
            f"within {contact.among.sigmas:g} standard deviation{'s' * (contact.among.sigmas != 1)}"
            if contact.among.sigmas
            else "as believed"
        )
        notes.append(
            f"safe for parameters {near}, not for all within {sigmas:g} standard deviations; "
            f"over all of them its probability is {probability_text(predicted.probability)}"
        )
    if contact.among.guarded:
        notes.append(
            "safe for the directions of force that the hand's stiffness allows, not for every one "
            "that friction could pass on"
        )
    if refused:
        better = "contact was" if refused == 1 else "contacts were"
        notes.append(f"{refused} better {better} out of reach")
    return tuple(notes)
