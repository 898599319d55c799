"""Refusals of pushes: which sentence it is, and the numbers that decide."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from planner.refusals.refusal_builder import Spans, no_plan, refusal
from planner.types.refusal import NoPlanError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from planner.types.refusal import Refusal
    from planner.types.robot import ReachAnswer
    from planner.types.world_state import SeenObject

_LEAST = 0.01  # a shorter way is not worth proposing [m]


def not_capable(capability: str, message: str, spans: Spans, *instead: str) -> NoPlanError:
    """Dead end because this robot, or this version, lacks a capability."""
    words: dict[str, Any] = {"capability": capability, "message": message}
    return NoPlanError(refusal("not_capable", spans=spans, instead=instead, **words))


def unsupported_while(what: str, doing: str, spans: Spans) -> NoPlanError:
    """Dead end because no hand of this version does something meanwhile."""
    return no_plan("not_while", spans=spans, what=what, doing=doing)


def unclear_face(target: SeenObject, face: str | None, off: float, spans: Spans) -> Refusal:
    """Refusal of an object that stands so that a face could bear two names."""
    return refusal("face_not_clear", {"turned": off}, spans=spans, object=target.name, face=face)


def object_lies(target: SeenObject) -> Refusal:
    """Refusal of an object that lies on another face than the one that it stands on."""
    face = target.lies_on
    side = face if face.startswith(("face", "nothing")) else f"its {face} side"
    return refusal("lies", object=target.name, side=side)


def hand_not_free(name: str) -> Refusal:
    """Refusal since the hand is not free."""
    return refusal("hand_not_free", object=name)


def no_side(target: SeenObject, face: str | None, spans: Spans) -> Refusal:
    """Refusal since nothing on the object, or on the side that is said, is wide enough."""
    where = "side" if face is None else f"{face} face"
    return refusal("no_side", spans=spans, object=target.name, where=where)


def too_oblique(
    target: SeenObject,
    face: str | None,
    direction: str,
    square: str,
    angle: float,
    largest: float,
    spans: Spans,
) -> Refusal:
    """Refusal since the face is not square enough to the direction; a push to `square` would be."""
    return refusal(
        "oblique_face" if face else "oblique",
        {"obliqueness": abs(angle), "largest_obliqueness": largest},
        spans=spans,
        object=target.name,
        face=f"its {face} face" if face else "its nearest face",
        direction=direction,
        square=square,
    )


def turned_first(target: SeenObject, angle: float, region: str, spans: Spans) -> Refusal:
    """Refusal since it would have to be turned before, which is done low on its sides."""
    numbers = {"obliqueness": abs(angle)}
    return refusal("turn_first", numbers, spans=spans, object=target.name, region=region)


def no_way(target: SeenObject) -> Refusal:
    """Refusal since it has no sides along which it could be pushed there."""
    return refusal("no_way", object=target.name)


def off_the_table(target: SeenObject, distance: float, room: float, *, bounded: bool) -> Refusal:
    """Refusal since the table ends before the distance does."""
    numbers = {"room": max(room, 0.0), "distance": distance}
    code = "off_the_table_so_far" if room > _LEAST and bounded else "off_the_table"
    return refusal(code, numbers, object=target.name)


def in_the_way(
    target: SeenObject, other: SeenObject, distance: float, free: float, *, bounded: bool
) -> Refusal:
    """Refusal since another object stands on the way."""
    # What is to be brought to a place would not be there after a shorter way.
    code = "in_the_way_so_far" if free > _LEAST and bounded else "in_the_way"
    numbers = {"free": free, "distance": distance}
    return refusal(code, numbers, object=target.name, other=other.name)


def unlikely_pushes(target: SeenObject, pushes: int, probability: float, asked: float) -> Refusal:
    """Refusal since each push is likely enough, but not all of them together."""
    numbers = {"probability": probability, "asked_probability": asked}
    return refusal("unlikely_pushes", numbers, object=target.name, pushes=pushes)


def turn_blocked(target: SeenObject, met: str) -> Refusal:
    """Refusal since it would hit something, or leave the table, as it turns."""
    where = "over the table's edge" if met == "table" else f"into the {met}"
    return refusal("turn_blocked", object=target.name, where=where)


def cannot_turn(target: SeenObject) -> Refusal:
    """Refusal since no finger on any of its sides turns it in this sense."""
    return refusal("cannot_turn", object=target.name)


def turned_by_one(target: SeenObject, spans: Spans) -> Refusal:
    """Refusal since two fingertips hold its heading."""
    return refusal("turned_by_one", spans=spans, object=target.name)


def falls_off(target: SeenObject) -> Refusal:
    """Refusal since it would land beyond the table's edge."""
    return refusal("falls_off", {"height": target.model.top}, object=target.name)


def falls_on(target: SeenObject, other: SeenObject) -> Refusal:
    """Refusal since it would land on another object."""
    numbers = {"height": target.model.top}
    return refusal("falls_on", numbers, object=target.name, other=other.name)


def too_weak(
    target: SeenObject, outcome: str, needed: float, limit: float, *, said: bool, spans: Spans
) -> Refusal:
    """Refusal since the force does not suffice; the limit is `said`, or what the fingers have."""
    return refusal(
        "force_not_allowed" if said else "force_not_there",
        {"needed_force": needed, "allowed_force": limit},
        spans=spans if said else (),
        object=target.name,
        doing="sliding" if outcome == "slide" else "toppling",
    )


def too_light(target: SeenObject, needed: float, least: float, spans: Spans) -> Refusal:
    """Refusal since it moves before as much force as is asked can be pressed on it."""
    numbers = {"needed_force": needed, "min_force": least}
    return refusal("too_light", numbers, spans=spans, object=target.name)


def too_slow(
    target: SeenObject, distance: float, least: float, most: float, spans: Spans
) -> Refusal:
    """Refusal since it takes longer than it may."""
    numbers = {"least_time": least, "max_time": most}
    return refusal("too_slow", numbers, spans=spans, object=target.name, distance=distance)


def several_pushes(target: SeenObject, pushes: int, most: float, spans: Spans) -> Refusal:
    """Refusal since the hand goes around between two pushes, which takes longer than it may."""
    numbers = {"pushes": float(pushes), "max_time": most}
    return refusal("several_pushes", numbers, spans=spans, object=target.name)


def no_reach(target: SeenObject, answers: Sequence[ReachAnswer]) -> Refusal:
    """Refusal since contacts exist, but the hand gets to none of them."""
    last, blocker = deciding_answer(answers)
    numbers = {"ways": float(len(answers)), **last.numbers}
    code = "no_push_reached" if blocker is None else "pushes_blocked"
    words: dict[str, Any] = {"object": target.name, "last": last.message, "blocker": blocker}
    return refusal(code, numbers, **words)


def given_up(target: SeenObject, answers: Sequence[ReachAnswer]) -> Refusal:
    """Refusal since the search ended before the hand could make a whole way."""
    failed = [answer for answer in answers if not answer.ok]
    last, blocker = deciding_answer(failed)
    numbers = {"looks": float(len(answers)), "out_of_reach": float(len(failed))}
    code = "search_given_up" if blocker is None else "search_blocked"
    words: dict[str, Any] = {"object": target.name, "last": last.message, "blocker": blocker}
    return refusal(code, numbers, **words)


def deciding_answer(answers: Sequence[ReachAnswer]) -> tuple[ReachAnswer, str | None]:
    """The first answer that names an obstacle, with its name; else the first, and None."""
    for answer in answers:
        if answer.reason == "obstacle" and answer.blocker:
            return answer, answer.blocker
    return answers[0], None
