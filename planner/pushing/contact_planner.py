"""One push: the contact whose predicted outcome satisfies a step with the largest margin.

The planning of a push is a pipeline: the sides that it may touch, contacts whose outcome is as
wanted whatever the finger transmits, those for which the allowed force suffices, those that the
exact tier confirms, the push at each, and last, in the order of their margins, the question whether
the hand gets there. The stage that leaves nothing is the reason of the refusal.

Frames: W is the world, B the object. Sources of the physics: `objectmodels`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from objectmodels.geometry.base_shapes import Disc
from planner.geometry.directions import face_name
from planner.problem.planning_problem import PushProblem, PushStep, Side
from planner.problem.tilt_goals import push_with_tilt
from planner.pushing import outcome_prediction
from planner.pushing.contact_diagnosis import contact_refusal, require_place
from planner.pushing.contact_sampling import Contact, Contacts, rate_contacts
from planner.pushing.reach_search import ContactQueries, ReachSearch
from planner.pushing.touchable_sides import push_direction, require_room, touchable_sides
from planner.pushing.turn_planner import turning_push
from planner.refusals.reach_refusals import no_push_reached
from planner.refusals.refusal_builder import no_plan
from planner.types.actions import FALLING, Push, PushAction, Vector3
from planner.types.plain_vectors import plain_vector
from planner.types.refusal import Alternatives, NoPlanError

_OF_A_CASE = 0.6  # share of the contacts asked for that may be equally sure
_FLAT = math.radians(85.0)  # a box that leans so far lies
_RATED, _CONFIRMED = 1, 3  # units of work of a face rated and of a contact confirmed
_SLACK = 0.03  # travel of a topple beyond what the model says, for what it does not know [m]


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


def best_push(problem: PushProblem, step: PushStep, search: ReachSearch) -> PushCandidate:
    """The push with the largest margin that the hand can make, from where the object stands then.

    Raises:
        NoPlanError: there is none.
    """
    sides = touchable_sides(problem, step)
    if step.outcome == "slide":
        return _best_candidate(problem, step, sides, search)
    free, crowded, no_room = [], [], Alternatives()
    for side in sides:
        with no_room:
            require_room(problem, step, side)
            free.append(side)
            continue
        crowded.append((side, no_room.last))
    if not free:
        raise no_room.first
    attempt = Alternatives()
    with attempt:
        return _best_candidate(problem, step, free, search)
    if attempt.first.refusal.reason in ("impossible", "too_uncertain"):
        for side, dead_end in crowded:
            # From there it would fall, if there were room.
            blocked = dead_end.refusal.reason == "blocked"
            fingers = problem.contact.fingers
            if blocked and any(any(rate_contacts(problem, step, [side], n)) for n in fingers):
                raise dead_end
    raise attempt.first


def _best_candidate(
    problem: PushProblem, step: PushStep, sides: list[Side], search: ReachSearch
) -> PushCandidate:
    """The contact with the largest margin that the hand reaches."""
    require_place(problem, step, sides)
    problem = _in_time(problem, step)
    queries = ContactQueries(search, problem)
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
            if not outcome_prediction.confirm_with_exact_tier(problem, step, contact):
                doubted = True
                continue
            if not queries.is_reached(push):
                queries.look_above(push, (_push_at(problem, step, each) for each in order[number:]))
            elif outcome_prediction.probability(problem, step, contact) < asked:
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
        raise no_push_reached(target.name, queries.denied, problem.spared)
    if least < force.min:
        numbers = {"needed_force": least, "min_force": force.min}
        raise no_plan("too_light", numbers, spans=force.spans, object=target.name)
    if math.isfinite(least) and not doubted:
        raise _too_weak(problem, step, least)
    raise NoPlanError(contact_refusal(problem, step, sides))


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


# -- how fast and how hard --------------------------------------------------------------------


def _in_time(problem: PushProblem, step: PushStep) -> PushProblem:
    """The problem with a speed that is high enough for the time that the push may take."""
    motion, defaults = problem.motion, problem.defaults
    if motion.duration is None or step.outcome != "slide" or step.swing:
        return problem
    said = all(used.name != "speed" for used in problem.defaults_used)
    fastest = motion.speed if said else defaults.speed_most
    least = defaults.push_overhead + step.distance / fastest
    if least > motion.duration:
        numbers, name = {"least_time": least, "max_time": motion.duration}, problem.target.name
        raise no_plan("too_slow", numbers, spans=motion.spans, object=name, distance=step.distance)
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
        needed = outcome_prediction.needed_forces(problem, step, contacts)
        least = min(least, float(needed.min()))
        enough = needed <= _largest_force(problem, contacts.fingers)
        enough &= needed >= problem.force.min
        if enough.any():
            strong.append(contacts.only(enough))
    return strong, least


def _too_weak(problem: PushProblem, step: PushStep, least: float) -> NoPlanError:
    """Dead end since more force is needed than the sentence allows, or than the fingers have."""
    force, allowed = problem.force, _largest_force(problem, max(problem.contact.fingers))
    said = force.max <= allowed
    return no_plan(
        "force_not_allowed" if said else "force_not_there",
        {"needed_force": least, "allowed_force": allowed},
        spans=force.spans if said else (),
        object=problem.target.name,
        doing="sliding" if step.outcome == "slide" else "toppling",
    )


# -- the push ---------------------------------------------------------------------------------


def _in_order(problem: PushProblem, step: PushStep, rated: list[Contacts]) -> list[Contact]:
    """Some contacts of all faces by rank, in turn over the faces."""
    order = []
    for number, contacts in enumerate(rated):
        # A fall that may go anywhere goes away from the robot if it can.
        aside = abs(contacts.side.heading) if step.heading is None else 0.0
        order += [(contact.rank, aside, number, contact) for contact in contacts]
    most = math.ceil(_OF_A_CASE * problem.effort.contacts)
    return [contact for *_, contact in sorted(order, key=lambda each: each[:3])][:most]


def _push_at(problem: PushProblem, step: PushStep, contact: Contact) -> Push:
    """The push at a contact."""
    target, force, side = problem.target, problem.force, contact.among.side
    outward = target.pose.R_WB @ np.array(side.face.normal)
    limit = outcome_prediction.needed_force(problem, step, contact) * (1.0 + force.reserve)
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
        return _push_with_swing(problem, step, contact, push)
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


def _push_with_swing(problem: PushProblem, step: PushStep, contact: Contact, push: Push) -> Push:
    """The push with a turn as its end."""
    found = turning_push(problem.target.model, contact.among.side.face, step.swing, push.p_BC[2])
    assert found is not None, "its side was chosen for that"
    changes = {
        "p_BC": found.point,
        "direction_W": plain_vector(problem.target.pose.R_WB @ np.array(found.direction)),
        "stroke": found.stroke,
        "ends_on": "turned",
        "turn": step.swing,
    }
    return push.model_copy(update=changes)


def _stroke_length(problem: PushProblem, step: PushStep, contact: Contact) -> float:
    """Travel of the fingertips [m]."""
    if step.outcome == "slide":
        return 0.0 if step.swing else step.distance
    model, inward = problem.target.model, contact.among.side.inward
    angle = model.angle_of_no_return(inward, sigmas=-contact.among.sigmas) + FALLING
    height = float(contact.point[2])
    return min(model.topple_stroke(inward, height, min(angle, _FLAT)) + _SLACK, step.distance)


# -- the candidate ----------------------------------------------------------------------------


def _push_candidate(
    problem: PushProblem, step: PushStep, contact: Contact, push: Push, refused: int
) -> PushCandidate:
    """A push that the hand can make, with what it will do; `refused` better ones it cannot."""
    predicted = outcome_prediction.prediction(problem, step, contact)
    known = {
        "prediction": predicted,
        "margins": outcome_prediction.margins(problem, step, contact, push.force_limit),
        "displacement": _predicted_displacement(problem, step, contact, push),
    }
    return PushCandidate(
        PushAction.model_validate({**dict(push), **known}),
        _outcome_event(problem, contact, push),
        considered=0,
        satisfying=0,
        notes=outcome_prediction.selection_notes(problem, contact, push, predicted, refused),
    )


def _outcome_event(problem: PushProblem, contact: Contact, push: Push) -> tuple[object, ...]:
    """Face, height and fingers; all sides of a round object are alike."""
    side = None if isinstance(problem.target.model.base, Disc) else contact.among.side.face.normal
    return side, round(push.p_BC[2], 3), push.fingers, push.ends_on


def _predicted_displacement(
    problem: PushProblem, step: PushStep, contact: Contact, push: Push
) -> Vector3 | None:
    """Predicted displacement of the object's origin in W [m]; None if the push tips the object."""
    if push.ends_on == "stroke":
        return plain_vector(push.stroke * np.array(push.direction_W))
    if push.ends_on != "turned":
        return None
    target = problem.target
    found = turning_push(target.model, contact.among.side.face, step.swing, float(contact.point[2]))
    assert found is not None, "its side was chosen for that"
    return plain_vector(target.pose.R_WB @ np.array([*found.pose[:2], 0.0]))
