"""One push: the contact whose predicted outcome satisfies what is asked with the largest margin.

The way: the faces that a push in that direction touches, contacts whose outcome is as wanted
whatever the finger transmits (`planner.pushing.contact_sampling`), the force that they need, and
last, in the order of their margins, whether the hand gets there. What a step leaves empty is the
reason of the refusal.

Frames: W is the world, B the object. Sources of the physics: `objectmodels`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.base_shapes import Disc
from objectmodels.mechanics.turning_push import best_turn
from planner.geometry.directions import face_name
from planner.problem import tilt_goals as tilts
from planner.pushing import contact_diagnosis as misplaced
from planner.pushing.contact_sampling import Contacts, grid, rated
from planner.pushing.outcome_prediction import confirmed, margins, needed_force, prediction, remarks
from planner.pushing.touchable_sides import Side, direction, hindered, touchable
from planner.refusals import push_refusals as refusals
from planner.refusals.push_refusals import NoPlanError
from planner.types.actions import Push, PushAction, Vector3
from planner.types.refusal import Refusal

if TYPE_CHECKING:
    from objectmodels.geometry.side_faces import Face
    from planner.problem.push_problem import Asked
    from planner.types.defaults import Defaults
    from planner.types.robot import Reach, ReachAnswer
    from planner.types.world_state import SeenObject, WorldState

_OF_A_CASE = 0.6  # share of the contacts asked for that may be equally sure
_FALLING = math.radians(11.0)  # beyond the angle of no return a toppling box is let go
_FLAT = math.radians(85.0)  # a box that leans so far lies
_SLACK = 0.03  # travel of a topple beyond what the model says, for what it does not know [m]


@dataclass(frozen=True)
class Found:
    """A push and how it was found.

    Attributes:
        move: the push, its prediction and margins.
        displacement: of the object in W, as predicted [m]; None for a topple or tilt.
        event: what its outcome depends on besides the parameters; equal ones have equal outcomes.
        considered: how many candidates were evaluated.
        satisfying: how many of them satisfied what is asked.
        notes: plain sentences on how it was chosen.
    """

    move: PushAction
    displacement: Vector3 | None
    event: tuple[object, ...]
    considered: int
    satisfying: int
    notes: tuple[str, ...]


def best_push(
    asked: Asked,
    target: SeenObject,
    state: WorldState,
    reach: Reach,
    defaults: Defaults,
    side: Side | None = None,
) -> Found | Refusal:
    """The push with the largest margin that the hand can make, or why there is none.

    Args:
        asked: heading, distance and limits of this push.
        target: the object, where it stands when the push begins.
        state: what is believed then.
        reach: whether the hand gets somewhere.
        defaults: margins, and what a clause means when nothing more is said.
        side: that is to be touched, if that is settled.
    """
    try:
        sides = touchable(asked, target, defaults) if side is None else [side]
        if asked.outcome == "slide":
            return _best(sides, asked, target, state, reach, defaults)
        return _over(sides, asked, target, state, reach, defaults)
    except NoPlanError as refused:
        return refused.refusal


def _over(
    sides: list[Side],
    asked: Asked,
    target: SeenObject,
    state: WorldState,
    reach: Reach,
    defaults: Defaults,
) -> Found | Refusal:
    """The best contact on a face from which the object falls, or leans over, hitting nothing."""
    free, without_room = [], []
    for side in sides:
        refusal = hindered(side, asked, target, state, defaults)
        if refusal is None:
            free.append(side)
        else:
            without_room.append((side, refusal))
    if not free:
        return without_room[0][1]
    found = _best(free, asked, target, state, reach, defaults)
    if isinstance(found, Refusal) and found.reason in ("impossible", "too_uncertain"):
        for side, refusal in without_room:
            # From there it would fall, if there were room.
            if refusal.reason == "blocked" and any(
                rated(target.model, [side], asked, reach, defaults)
            ):
                return refusal
    return found


def _best(
    sides: list[Side],
    asked: Asked,
    target: SeenObject,
    state: WorldState,
    reach: Reach,
    defaults: Defaults,
) -> Found | Refusal:
    """The contact with the largest margin that the hand reaches, or what stops it."""
    model = target.model
    if not any(len(grid(model, s, n, asked, reach)[0]) for s in sides for n in asked.fingers):
        return misplaced.no_place(asked, target, sides, reach)
    asked = _in_time(asked, target, defaults)
    answers: list[ReachAnswer] = []
    asking = _Asking(reach, state, defaults.most_contacts)
    least, doubted = math.inf, False
    for found in rated(model, sides, asked, reach, defaults):
        strong, needed = _strong_enough(found, asked, target, reach, defaults)
        least = min(least, needed)
        for contacts, k in _in_order(strong, asked, math.ceil(_OF_A_CASE * defaults.most_contacts)):
            if not confirmed(contacts, k, asked, target, reach):
                doubted = True
                continue
            push = _push(contacts, k, asked, target, reach, defaults)
            answer = asking.answer(push)
            if answer is None:
                continue
            if answer.ok:
                move = _move(contacts, k, push, asked, target, reach, defaults)
                return Found(
                    move,
                    _displacement(contacts, k, asked, target, push),
                    _event(contacts, push, target),
                    considered=sum(len(each.points) for each in found),
                    satisfying=sum(len(each.chosen) for each in found),
                    notes=remarks(contacts, push, move.prediction, asked, len(answers), defaults),
                )
            answers.append(answer)
    if answers:
        return refusals.no_reach(target, answers)
    if least < asked.min_force:
        return refusals.too_light(asked, target, least)
    if math.isfinite(least) and not doubted:
        return refusals.too_weak(asked, target, least, reach)
    return misplaced.no_contact(asked, target, sides, reach, defaults)


def _event(contacts: Contacts, push: Push, target: SeenObject) -> tuple[object, ...]:
    """Face, height and fingers; all sides of a round object are alike."""
    side = None if isinstance(target.model.base, Disc) else contacts.side.face.normal
    return side, round(push.p_BC[2], 3), push.fingers, push.ends_on


class _Asking:
    """Questions to the reach: no contact twice, no more than are worth it.

    Args:
        reach: that is asked.
        state: in which.
        most: contacts with as many fingertips.
    """

    def __init__(self, reach: Reach, state: WorldState, most: int) -> None:
        self._reach, self._state, self._most = reach, state, most
        self._asked: dict[int, set[Vector3]] = {1: set(), 2: set()}
        self._hopeless: set[int] = set()

    def answer(self, push: Push) -> ReachAnswer | None:
        """The answer for a push; None if it is not worth asking for."""
        before = self._asked[push.fingers]
        if push.p_BC in before or len(before) == self._most:
            return None
        if self._reach.prospect(push, self._state) == 0.0:
            # A glance is not sure, so one such push is asked for.
            if push.fingers in self._hopeless:
                return None
            self._hopeless.add(push.fingers)
        before.add(push.p_BC)
        return self._reach(push, self._state)


def _move(
    contacts: Contacts,
    k: int,
    push: Push,
    asked: Asked,
    target: SeenObject,
    reach: Reach,
    defaults: Defaults,
) -> PushAction:
    predicted = prediction(contacts, k, asked, target, reach)
    if asked.tilt is not None:
        inward = -np.array(contacts.side.face.normal)
        predicted = tilts.returning(predicted, target.model, inward, asked.tilt, defaults)
    safe = margins(contacts, k, asked, target, push, defaults)
    return PushAction.model_validate({**dict(push), "prediction": predicted, "margins": safe})


def _in_time(asked: Asked, target: SeenObject, defaults: Defaults) -> Asked:
    """What is asked, fast enough for the time that it may take.

    Raises:
        NoPlanError: it cannot be fast enough.
    """
    most = asked.limits.duration
    if most is None or asked.outcome != "slide" or asked.swing:
        return asked
    said = all(used.name != "speed" for used in asked.defaults)
    fastest = asked.speed if said else defaults.speed_most
    least = defaults.push_overhead + asked.distance / fastest
    if least > most:
        raise NoPlanError(refusals.too_slow(asked, target, least, most))
    return replace(asked, speed=max(asked.speed, asked.distance / (most - defaults.push_overhead)))


# -- how hard ---------------------------------------------------------------------------------


def _strong_enough(
    found: list[Contacts], asked: Asked, target: SeenObject, reach: Reach, d: Defaults
) -> tuple[list[Contacts], float]:
    """The contacts at which the allowed force suffices, and the least force needed at any [N]."""
    strong, least = [], math.inf
    for contacts in found:
        needed = np.array([needed_force(contacts, i, asked, target, d) for i in contacts.chosen])
        least = min(least, float(needed.min()))
        enough = needed <= min(asked.max_force, contacts.fingers * reach.max_force)
        enough &= needed >= asked.min_force
        if enough.any():
            chosen, probability = contacts.chosen[enough], contacts.probability[enough]
            strong.append(replace(contacts, chosen=chosen, probability=probability))
    return strong, least


# -- the push ---------------------------------------------------------------------------------


def _in_order(found: list[Contacts], asked: Asked, most: int) -> list[tuple[Contacts, int]]:
    """So many contacts of all faces by rank, in turn over the faces."""
    order = []
    for number, contacts in enumerate(found):
        # A fall that may go anywhere goes away from the robot if it can.
        aside = abs(contacts.side.heading) if asked.heading is None else 0.0
        order += [(rank, aside, number) for rank in range(len(contacts.chosen))]
    return [(found[number], rank) for rank, _, number in sorted(order)][:most]


def _push(
    contacts: Contacts,
    k: int,
    asked: Asked,
    target: SeenObject,
    reach: Reach,
    defaults: Defaults,
) -> Push:
    i = int(contacts.chosen[k])
    outward = target.pose.R_WB @ np.array(contacts.side.face.normal)
    needed = needed_force(contacts, i, asked, target, defaults)
    limit = min(
        max(needed * (1.0 + asked.reserve), asked.least_limit),
        asked.max_force,
        contacts.fingers * reach.max_force,
    )
    push = Push(
        object=target.name,
        face=face_name(outward)[0],
        p_BC=_touched(contacts, i, reach),
        normal_W=_triple(outward),
        direction_W=_triple(direction(asked, contacts.side)),
        force_limit=limit,
        speed=asked.speed,
        stroke=_stroke(contacts, i, asked, target),
        fingers=contacts.fingers,
        spread=contacts.spread,
        ends_on="stroke" if asked.outcome == "slide" else "toppled",
        turn=asked.turn,
        until=asked.until,
        meets=asked.meets,
        limits=asked.limits,
    )
    face = contacts.side.face
    if asked.swing:
        return _turning(push, face, asked.swing, target)
    if asked.tilt is not None:
        inward = -np.array(face.normal)
        return tilts.tilted(push, target.model, inward, asked.tilt, defaults)
    return push


def _touched(contacts: Contacts, i: int, reach: Reach) -> Vector3:
    """The contact; that of two fingertips on a round side lies between them, inside of it [m]."""
    face, point = contacts.side.face, contacts.points[i]
    if contacts.fingers == 1 or not face.curvature:
        return _triple(point)
    tip, radius = reach.fingertip_radius, 1.0 / face.curvature
    inside = radius + tip - math.sqrt((radius + tip) ** 2 - (contacts.spread / 2.0) ** 2)
    return _triple(point - inside * np.array(face.normal))


def _turning(push: Push, face: Face, angle: float, target: SeenObject) -> Push:
    """The push with a turn as its end."""
    found = best_turn(target.model, face, angle, push.p_BC[2])
    assert found is not None, "its side was chosen for that"
    changes = {
        "p_BC": found.point,
        "direction_W": _triple(target.pose.R_WB @ np.array(found.direction)),
        "stroke": found.stroke,
        "ends_on": "turned",
        "turn": angle,
    }
    return push.model_copy(update=changes)


def _displacement(
    contacts: Contacts, k: int, asked: Asked, target: SeenObject, push: Push
) -> Vector3 | None:
    """Where the push takes the object's origin in W [m]; None if it tips it."""
    if push.ends_on == "stroke":
        return _triple(push.stroke * np.array(push.direction_W))
    if push.ends_on != "turned":
        return None
    height = float(contacts.points[contacts.chosen[k], 2])
    found = best_turn(target.model, contacts.side.face, asked.swing, height)
    assert found is not None, "its side was chosen for that"
    return _triple(target.pose.R_WB @ np.array([*found.pose[:2], 0.0]))


def _stroke(contacts: Contacts, i: int, asked: Asked, target: SeenObject) -> float:
    if asked.outcome == "slide":
        return 0.0 if asked.swing else asked.distance
    inward = -np.array(contacts.side.face.normal)
    angle = target.model.angle_of_no_return(inward, sigmas=-contacts.sigmas) + _FALLING
    angle = min(angle, _FLAT)
    height = float(contacts.points[i, 2])
    return min(target.model.topple_stroke(inward, height, angle) + _SLACK, asked.distance)


def _triple(v: np.ndarray) -> tuple[float, float, float]:
    x, y, z = v.tolist()
    return x, y, z
