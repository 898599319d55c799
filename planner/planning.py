"""From a frame to a push whose predicted outcome satisfies it, or to a refusal with numbers.

The way: what is asked (`planner.asked`), the faces that a push in that direction touches, free way
on the table, contacts whose outcome is as wanted whatever the finger transmits
(`planner.candidates`), the force that they need, and last, in the order of their margins, whether
the hand gets there. What a step leaves empty is the reason of the refusal.

Frames: W is the world, B the object. Sources of the physics: `objectmodels`.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from planner import refusals, tilts
from planner.asked import Asked, RefusedError, read
from planner.candidates import Contacts, Side, grid, rated
from planner.defaults import DEFAULTS, Defaults
from planner.directions import HEADINGS, angle_between, face_name, heading_of, unit
from planner.footprints import footprint, free_travel, landing_strip, overlaps, travel_to_edge
from planner.forecast import confirmed, margins, needed_force, prediction, remarks
from planner.plan import Plan, Push, Refusal

if TYPE_CHECKING:
    from grammar.frames import Frame
    from planner.reach import Reach, ReachAnswer
    from planner.state import SeenObject, WorldState

OBLIQUE = math.radians(17.5)
"""Largest angle between a push and the inward normal of the face, if friction allows it."""

UNCLEAR_FACE = math.radians(40.0)
"""A face turned by more from the direction of its name is within 5° of the next name."""

CLEARANCE = 0.01
"""Distance that a moving object keeps from others and from the table's edge [m]."""

_ASKED = 6  # contacts of one case that the reach is asked for
_ASKED_IN_ALL = 18  # after so many with a number of fingers it counts as out of reach
_FALLING = math.radians(11.0)  # beyond the angle of no return a toppling box is let go
_FLAT = math.radians(85.0)  # a box that leans so far lies
_SLACK = 0.03  # travel of a topple beyond what the model says, for what it does not know [m]


def plan(
    frame: Frame, state: WorldState, reach: Reach, *, defaults: Defaults = DEFAULTS
) -> Plan | Refusal:
    """Finds the push that satisfies a frame with the largest margin.

    Args:
        frame: what is asked, its objects resolved to names in `state`.
        state: what the robot believes.
        reach: whether the hand gets somewhere.
        defaults: what a clause means when the sentence does not say more.

    Returns:
        A plan, or the reason why there is none.
    """
    try:
        asked = read(frame, state, defaults)
        assert frame.object is not None
        assert frame.object.id is not None
        target = state.objects[frame.object.id]
        if target.lies_on != "bottom":
            raise RefusedError(refusals.lies(target))
        sides = _sides(asked, target, defaults)
        sides = _with_free_way(sides, asked, target, state, defaults)
        return _best(sides, asked, target, state, reach, defaults)
    except RefusedError as refused:
        return refused.refusal


def _best(
    sides: list[Side],
    asked: Asked,
    target: SeenObject,
    state: WorldState,
    reach: Reach,
    defaults: Defaults,
) -> Plan | Refusal:
    """The contact with the largest margin that the hand reaches, or what stops it."""
    if not any(len(grid(s, n, asked, reach)[0]) for s in sides for n in asked.fingers):
        return refusals.no_place(asked, target, sides, reach)
    answers: list[ReachAnswer] = []
    tried = {1: 0, 2: 0}
    least, doubted = math.inf, False
    for found in rated(target.model, sides, asked, reach, defaults):
        strong, needed = _strong_enough(found, asked, target, reach, defaults)
        least = min(least, needed)
        for contacts, k in _in_order(strong, asked):
            if not confirmed(contacts, k, asked, target, reach):
                doubted = True
                continue
            push = _push(contacts, k, asked, target, reach, defaults)
            if tried[push.fingers] == _ASKED_IN_ALL:
                break
            answer = reach(push, state)
            if answer.ok:
                predicted = prediction(contacts, k, asked, target)
                return Plan(
                    push=push,
                    prediction=predicted,
                    margins=margins(contacts, k, asked, target, push, defaults),
                    displacement=_displacement(push),
                    defaults=asked.defaults,
                    considered=sum(len(each.points) for each in found),
                    satisfying=sum(len(each.chosen) for each in found),
                    notes=remarks(contacts, push, predicted, asked, len(answers), defaults),
                )
            answers.append(answer)
            tried[push.fingers] += 1
    if answers:
        return refusals.no_reach(target, answers)
    if math.isfinite(least) and not doubted:
        return refusals.too_weak(asked, target, least, reach)
    return refusals.no_contact(asked, target, sides, reach, defaults)


# -- where ------------------------------------------------------------------------------------


def _sides(asked: Asked, target: SeenObject, defaults: Defaults) -> list[Side]:
    """Faces that a push as asked may touch, the straightest first."""
    sides, unclear = [], None
    for face in target.model.faces(_pushed_along(asked) - target.pose.yaw):
        outward = target.pose.R_WB @ np.array(face.normal)
        name, off = face_name(outward)
        if asked.face is not None:
            if abs(off) > UNCLEAR_FACE:
                unclear = off
                continue
            if name != asked.face:
                continue
        sides.append(Side(face, heading_of(-outward)))
    if not sides and unclear is not None:
        raise RefusedError(refusals.unclear_face(asked, target, unclear))
    if not sides:
        raise RefusedError(refusals.no_side(asked, target))
    if asked.heading is None:
        return sides
    straightest = min(sides, key=lambda s: abs(angle_between(s.heading, asked.heading or 0.0)))
    oblique = angle_between(asked.heading, straightest.heading)
    # An object that slides straight presses back along the push: that must be in the friction cone.
    model = target.model
    grip = model.finger_friction - defaults.sigmas * model.finger_friction_sd
    largest = min(OBLIQUE, math.atan(max(grip, 0.0)))
    if abs(oblique) > largest:
        raise RefusedError(refusals.oblique(asked, target, straightest, oblique, largest))
    return [straightest]


def _pushed_along(asked: Asked) -> np.ndarray:
    """Headings in W along which a round object may be pushed: the one asked, else the robot's four.

    Shape (k,) [rad].
    """
    if asked.heading is not None:
        return np.array([asked.heading])
    return np.array(list(HEADINGS.values()))


def _direction(asked: Asked, side: Side) -> np.ndarray:
    """Unit direction of the push in W; a topple is pushed square to the face."""
    if asked.outcome == "slide" and asked.heading is not None:
        return unit(asked.heading)
    return unit(side.heading)


def _with_free_way(
    sides: list[Side], asked: Asked, target: SeenObject, state: WorldState, defaults: Defaults
) -> list[Side]:
    """The faces from which the object moves or falls without hitting anything."""
    free, refusal = [], None
    for side in sides:
        u = _direction(asked, side)
        if asked.outcome == "slide":
            refusal = _slide_blocked(asked, target, state, u)
        elif asked.tilt is not None:
            refusal = tilts.hindered(target, state, side.face.normal, u, asked.tilt, defaults)
        else:
            refusal = _fall_blocked(target, state, u)
        if refusal is None:
            free.append(side)
    if not free:
        assert refusal is not None
        raise RefusedError(refusal)
    return free


def _slide_blocked(
    asked: Asked, target: SeenObject, state: WorldState, u: np.ndarray
) -> Refusal | None:
    here = footprint(target)
    room = travel_to_edge(here, state.table, u[:2], CLEARANCE)
    if room < asked.distance:
        return refusals.off_the_table(asked, target, room)
    for other in _others(target, state):
        free = free_travel(here, footprint(other), u[:2], CLEARANCE)
        if free < asked.distance:
            return refusals.in_the_way(asked, target, other, free)
    return None


def _fall_blocked(target: SeenObject, state: WorldState, u: np.ndarray) -> Refusal | None:
    strip = landing_strip(target, u)
    if travel_to_edge(strip, state.table, u[:2], 0.0) < CLEARANCE:
        return refusals.falls_off(target)
    for other in _others(target, state):
        if overlaps(strip, footprint(other), CLEARANCE):
            return refusals.falls_on(target, other)
    return None


def _others(target: SeenObject, state: WorldState) -> list[SeenObject]:
    return [seen for name, seen in state.objects.items() if name != target.name]


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
        if enough.any():
            chosen, probability = contacts.chosen[enough], contacts.probability[enough]
            strong.append(replace(contacts, chosen=chosen, probability=probability))
    return strong, least


# -- the push ---------------------------------------------------------------------------------


def _in_order(found: list[Contacts], asked: Asked) -> list[tuple[Contacts, int]]:
    """Contacts of all faces by rank, in turn over the faces, as many as the reach is asked for."""
    order = []
    for number, contacts in enumerate(found):
        # A fall that may go anywhere goes away from the robot if it can.
        aside = abs(contacts.side.heading) if asked.heading is None else 0.0
        order += [(rank, aside, number) for rank in range(len(contacts.chosen))]
    return [(found[number], rank) for rank, _, number in sorted(order)][:_ASKED]


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
        needed * (1.0 + asked.reserve),
        asked.max_force,
        contacts.fingers * reach.max_force,
    )
    push = Push(
        object=target.name,
        face=face_name(outward)[0],
        p_BC=_triple(contacts.points[i]),
        normal_W=_triple(outward),
        direction_W=_triple(_direction(asked, contacts.side)),
        force_limit=limit,
        speed=asked.speed,
        stroke=_stroke(contacts, i, asked, target),
        fingers=contacts.fingers,
        spread=reach.finger_spread if contacts.fingers == 2 else 0.0,
        ends_on="stroke" if asked.outcome == "slide" else "toppled",
    )
    if asked.tilt is None:
        return push
    inward = -np.array(contacts.side.face.normal)
    return tilts.tilted(push, target.model, inward, asked.tilt, asked.until, defaults)


def _stroke(contacts: Contacts, i: int, asked: Asked, target: SeenObject) -> float:
    if asked.outcome == "slide":
        return asked.distance
    inward = -np.array(contacts.side.face.normal)
    angle = target.model.angle_of_no_return(inward, sigmas=-contacts.sigmas) + _FALLING
    angle = min(angle, _FLAT)
    height = float(contacts.points[i, 2])
    return min(target.model.topple_stroke(inward, height, angle) + _SLACK, asked.distance)


def _displacement(push: Push) -> tuple[float, float, float] | None:
    if push.ends_on != "stroke":
        return None
    return _triple(push.stroke * np.array(push.direction_W))


def _triple(v: np.ndarray) -> tuple[float, float, float]:
    x, y, z = v.tolist()
    return x, y, z
