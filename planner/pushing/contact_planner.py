"""One push: the contact whose predicted outcome satisfies a step with the largest margin.

The planning of a push is a pipeline: the sides that it may touch, contacts whose outcome is as
wanted whatever the finger transmits, those for which the allowed force suffices, those that the
exact tier confirms, the push at each, and last, in the order of their margins, the question whether
the hand gets there. The stage that leaves nothing is the reason of the refusal.

Frames: W is the world, B the object. Sources of the physics: `objectmodels`.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from statistics import NormalDist
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from objectmodels import ObjectModel, Thresholds
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.friction_cone import contact_forces
from objectmodels.mechanics.push_motion import best_turn
from objectmodels.mechanics.push_outcomes import OUTCOMES, circle_corners
from objectmodels.mechanics.push_thresholds import slide_threshold, yaw_arm
from objectmodels.models.predictor import own_predictions
from planner.problem.constraint_limits import prediction_with_return, push_with_tilt
from planner.problem.directions import face_name
from planner.problem.planning_problem import PushProblem, PushStep, Side
from planner.pushing.contact_refusals import no_place, unsuited_contacts
from planner.pushing.contact_sampling import (
    Contact,
    Contacts,
    has_place,
    model_limited_by_hand,
    push_direction,
    rate_contacts,
    touchable_sides,
    why_no_room,
)
from planner.pushing.reach_search import ContactQueries, ReachSearch
from planner.refusals.blocked import Blocked, dead_end, no_push_reached
from planner.types.actions import (
    FALLING,
    Margins,
    Prediction,
    Push,
    PushAction,
    Vector3,
    finite_or_none,
)
from planner.types.refusal import probability_text
from planner.types.world_state import plain_vector

SURE = 0.999
"""Probability of a slide by the closed form that the exact tier does not lower by 0.0002."""

_FLAT = math.radians(85.0)  # a box that leans so far lies
_RATED, _CONFIRMED = 1, 3  # units of work of a face rated and of a contact confirmed
_SLACK = 0.03  # travel of a topple beyond what the model says, for what it does not know [m]
_SPINS = 0.15  # share of the force to tip a round object over which it may turn on its rim before


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
        slide_force=finite_or_none(nominal.slide[0]),
        topple_force=finite_or_none(nominal.topple[0]),
        critical_height=finite_or_none(cone.critical_height[i]),
        critical_height_worst=finite_or_none(worst),
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
    contacts that are much farther from toppling than it is ever off (`benchmarks.calibration`).
    """
    if contact.among.fingers == 2:
        return True
    cone = contact.among.cone
    if step.outcome == "slide":
        # Room to toppling as a share of the force to slide it that needs no second look.
        surely = cone.slide_margin > 0.6 * cone.slide_max
        if surely[contact.index]:
            return True
    model = problem.target.model
    grip = model.finger_friction
    if contact.among.guarded:
        grip = min(problem.robot.limits.force_skew, grip)
    if step.outcome == "topple" and model.base.is_round:
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
    model: ObjectModel,
    point: Vector3,
    normal: Vector3,
    outcome: Literal["slide", "topple"],
    turning: bool,
) -> float:
    """Probability of an outcome at a contact for the worst force in the finger's cone.

    What turns the object presses on it sideways.
    """
    from objectmodels.exact.exact_probability import least_probability

    spins = outcome == "topple" and model.base.is_round
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
    # Directions on the friction cone's boundary that the exact tier looks at.
    around = circle_corners(8) if grip else np.empty((0, 2))
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


@dataclass(frozen=True)
class PushCandidate:
    """A push and how it was found.

    Attributes:
        push: the push, its prediction and margins, and the predicted displacement.
        event: what its outcome depends on besides the parameters; equal ones have equal outcomes.
        considered: how many candidates were evaluated.
        satisfying: how many of them satisfied what is asked.
        notes: plain sentences on how it was chosen.
    """

    push: PushAction
    event: tuple[object, ...]
    considered: int
    satisfying: int
    notes: tuple[str, ...]


def best_push(problem: PushProblem, step: PushStep, search: ReachSearch) -> PushCandidate | Blocked:
    """The push with the largest margin that the hand can make from where the object stands then."""
    sides = touchable_sides(problem, step)
    if isinstance(sides, Blocked):
        return sides
    if step.outcome == "slide":
        return _best_candidate(problem, step, sides, search)
    free, crowded = [], []
    for side in sides:
        if why := why_no_room(problem, step, side):
            crowded.append((side, why))
        else:
            free.append(side)
    if not free:
        return crowded[0][1]
    made = _best_candidate(problem, step, free, search)
    if isinstance(made, Blocked) and made.reason in ("impossible", "too_uncertain"):
        fingers = problem.contact.fingers
        for side, why in crowded:
            if why.reason != "blocked":
                continue
            # From there it would fall, if there were room.
            if any(any(rate_contacts(problem, step, [side], n)) for n in fingers):
                return why
    return made


def _best_candidate(
    problem: PushProblem, step: PushStep, sides: list[Side], search: ReachSearch
) -> PushCandidate | Blocked:
    """The contact with the largest margin that the hand reaches."""
    if not has_place(problem, step, sides):
        return no_place(problem, sides)
    timely = _in_time(problem, step)
    if isinstance(timely, Blocked):
        return timely
    problem, queries = timely, ContactQueries(search, timely)
    least, doubted, asked = math.inf, False, problem.effort.probability
    for rated in _rated_cases(problem, step, sides, queries):
        strong, needed = _strong_enough(problem, step, rated)
        least = min(least, needed)
        problem.budget.spend(_RATED * len(sides))
        order = _in_order(problem, step, strong)
        for number, contact in enumerate(order):
            problem.budget.require_rest(problem.target.name, len(order) - number)
            push = _push_at(problem, step, contact)
            if not queries.is_open(push):
                continue
            problem.budget.spend(_CONFIRMED)
            if not confirm_with_exact_tier(problem, step, contact):
                doubted = True
                continue
            if not queries.is_reached(push):
                queries.look_above(push, (_push_at(problem, step, each) for each in order[number:]))
            elif probability(problem, step, contact) < asked:
                doubted = True
                queries.forget(push)  # less may be asked of it in another case
            else:
                found = _push_candidate(problem, step, contact, push, len(queries.denied))
                return replace(
                    found,
                    considered=sum(len(each.points) for each in rated),
                    satisfying=sum(len(each.chosen) for each in rated),
                )
    target, force = problem.target, problem.force
    if queries.denied:
        return no_push_reached(target.name, queries.denied, problem.spared)
    if least < force.min:
        numbers = {"needed_force": least, "min_force": force.min}
        return dead_end("too_light", numbers, spans=force.spans, object=target.name)
    if math.isfinite(least) and not doubted:
        allowed = _largest_force(problem, max(problem.contact.fingers))
        said = force.max <= allowed
        return dead_end(
            "force_not_allowed" if said else "force_not_there",
            {"needed_force": least, "allowed_force": allowed},
            spans=force.spans if said else (),
            object=problem.target.name,
            doing="sliding" if step.outcome == "slide" else "toppling",
        )
    return unsuited_contacts(problem, step, sides)


def _rated_cases(
    problem: PushProblem, step: PushStep, sides: list[Side], queries: ContactQueries
) -> Iterator[list[Contacts]]:
    """Contacts of all cases, the surest first, as long as any more are asked for.

    Two fingers come before one, since they hold the object's heading by themselves.
    """
    for fingers in problem.contact.fingers:
        for rated in rate_contacts(problem, step, sides, fingers):
            yield rated
            if queries.are_used_up(fingers):
                break


def _in_time(problem: PushProblem, step: PushStep) -> PushProblem | Blocked:
    """The problem with a speed that is high enough for the time that the push may take."""
    motion, defaults = problem.motion, problem.defaults
    if motion.duration is None or step.outcome != "slide" or step.swing:
        return problem
    said = all(used.name != "speed" for used in problem.defaults_used)
    fastest = motion.speed if said else defaults.speed_most
    least = defaults.push_overhead + step.distance / fastest
    if least > motion.duration:
        numbers, name = {"least_time": least, "max_time": motion.duration}, problem.target.name
        return dead_end(
            "too_slow", numbers, spans=motion.spans, object=name, distance=step.distance
        )
    needed = step.distance / (motion.duration - defaults.push_overhead)
    return replace(problem, motion=replace(motion, speed=max(motion.speed, needed)))


def _largest_force(problem: PushProblem, fingers: int) -> float:
    """Force that sentence and fingertips allow [N]."""
    return min(problem.force.max, fingers * problem.robot.limits.max_force)


def _strong_enough(
    problem: PushProblem, step: PushStep, rated: list[Contacts]
) -> tuple[list[Contacts], float]:
    """The contacts at which the allowed force suffices, and the least force needed at any [N]."""
    strong, least = [], math.inf
    for contacts in rated:
        needed = needed_forces(problem, step, contacts)
        least = min(least, float(needed.min()))
        enough = needed <= _largest_force(problem, contacts.fingers)
        enough &= needed >= problem.force.min
        if enough.any():
            strong.append(contacts.only(enough))
    return strong, least


def _in_order(problem: PushProblem, step: PushStep, rated: list[Contacts]) -> list[Contact]:
    """Some contacts of all faces by rank, in turn over the faces."""
    order = []
    for number, contacts in enumerate(rated):
        # A fall that may go anywhere goes away from the robot if it can.
        aside = abs(contacts.side.heading) if step.heading is None else 0.0
        order += [(contact.rank, aside, number, contact) for contact in contacts]
    # So many of the contacts that are asked for may be equally sure.
    most = math.ceil(0.6 * problem.effort.contacts)
    return [contact for *_, contact in sorted(order, key=lambda each: each[:3])][:most]


def _push_at(problem: PushProblem, step: PushStep, contact: Contact) -> Push:
    """The push at a contact."""
    target, force, side = problem.target, problem.force, contact.among.side
    outward = target.pose.R_WB @ np.array(side.face.normal)
    limit = needed_force(problem, step, contact) * (1.0 + force.reserve)
    push = Push(
        object=target.name,
        face=face_name(outward)[0],
        p_BC=_touched_point(problem, contact),
        normal_W=plain_vector(outward),
        direction_W=plain_vector(push_direction(step, side)),
        force_limit=min(
            max(limit, force.least_limit), _largest_force(problem, contact.among.fingers)
        ),
        speed=problem.motion.speed,
        stroke=_stroke_length(problem, step, contact),
        fingers=contact.among.fingers,
        spread=contact.among.spread,
        ends_on="stroke" if step.outcome == "slide" else "toppled",
        turn=step.turn,
        until=step.until,
        meets=step.meets,
        limits=problem.motion.guards,
    )
    if step.swing:
        found = best_turn(problem.target.model, contact.among.side.face, step.swing, push.p_BC[2])
        assert found is not None, "its side was chosen for that"
        changes = {
            "p_BC": found.point,
            "direction_W": plain_vector(problem.target.pose.R_WB @ np.array(found.direction)),
            "stroke": found.stroke,
            "ends_on": "turned",
            "turn": step.swing,
        }
        return push.model_copy(update=changes)
    if step.tilt is not None:
        return push_with_tilt(push, target.model, side.inward, step.tilt, problem.defaults)
    return push


def _touched_point(problem: PushProblem, contact: Contact) -> Vector3:
    """The contact; that of two fingertips on a round side lies between them, inside of it [m]."""
    face = contact.among.side.face
    if contact.among.fingers == 1 or not face.curvature:
        return plain_vector(contact.point)
    tip, radius = problem.robot.limits.fingertip_radius, 1.0 / face.curvature
    inside = radius + tip - math.sqrt((radius + tip) ** 2 - (contact.among.spread / 2.0) ** 2)
    return plain_vector(contact.point + inside * contact.among.side.inward)


def _stroke_length(problem: PushProblem, step: PushStep, contact: Contact) -> float:
    """Travel of the fingertips [m]."""
    if step.outcome == "slide":
        return 0.0 if step.swing else step.distance
    model, inward = problem.target.model, contact.among.side.inward
    angle = model.angle_of_no_return(inward, sigmas=-contact.among.sigmas) + FALLING
    height = float(contact.point[2])
    return min(model.topple_stroke(inward, height, min(angle, _FLAT)) + _SLACK, step.distance)


def _push_candidate(
    problem: PushProblem, step: PushStep, contact: Contact, push: Push, refused: int
) -> PushCandidate:
    """A push that the hand can make, with what it will do; `refused` better ones it cannot."""
    predicted = prediction(problem, step, contact)
    known = {
        "prediction": predicted,
        "margins": margins(problem, step, contact, push.force_limit),
        "displacement": _predicted_displacement(problem, step, contact, push),
    }
    # All sides of a round object are alike.
    side = None if problem.target.model.base.is_round else contact.among.side.face.normal
    return PushCandidate(
        PushAction.model_validate({**dict(push), **known}),
        (side, round(push.p_BC[2], 3), push.fingers, push.ends_on),
        considered=0,
        satisfying=0,
        notes=selection_notes(problem, contact, push, predicted, refused),
    )


def _predicted_displacement(
    problem: PushProblem, step: PushStep, contact: Contact, push: Push
) -> Vector3 | None:
    """Predicted displacement of the object's origin in W [m]; None if the push tips the object."""
    if push.ends_on == "stroke":
        return plain_vector(push.stroke * np.array(push.direction_W))
    if push.ends_on != "turned":
        return None
    target = problem.target
    found = best_turn(target.model, contact.among.side.face, step.swing, float(contact.point[2]))
    assert found is not None, "its side was chosen for that"
    return plain_vector(target.pose.R_WB @ np.array([*found.pose[:2], 0.0]))
