"""Why there is no plan: one sentence with the numbers that decide, and what would be possible."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from planner.geometry.directions import phrase
from planner.types.dead_ends import NoPlanError
from planner.types.refusal import Refusal

if TYPE_CHECKING:
    from planner.types.robot import ReachAnswer
    from planner.types.world_state import SeenObject


Spans = tuple[tuple[int, int], ...]


def unsupported(
    capability: str, message: str, spans: tuple[tuple[int, int], ...], *instead: str
) -> NoPlanError:
    """A refusal because this robot, or this version, lacks a capability."""
    return NoPlanError(
        Refusal(
            reason="unsupported",
            message=message,
            capability=capability,
            spans=spans,
            suggestions=instead,
        )
    )


def unsupported_while(what: str, doing: str, spans: Spans) -> NoPlanError:
    """The sentence asks for something that no hand of this version does meanwhile."""
    message = f"this version of the robot is not capable of {what} while {doing}"
    return unsupported(f"{what} while {doing}", message, spans, "leave that out")


def _mm(length: float) -> str:
    return f"{1e3 * length:.0f} mm"


def _deg(angle: float) -> str:
    return f"{math.degrees(abs(angle)):.0f}°"


def unclear_face(target: SeenObject, face: str | None, off: float, spans: Spans) -> Refusal:
    """The object stands so that a face could bear two names."""
    return Refusal(
        reason="unsupported",
        message=f"the {target.name} is turned by {_deg(off)}, "
        f"so it is not clear which of its faces is the {face} one",
        numbers={"turned": off},
        capability="telling faces of a turned object apart",
        spans=spans,
        suggestions=("say the direction of the push instead of the face",),
    )


def lies(target: SeenObject) -> Refusal:
    """It lies on another face than the one that it stands on."""
    return Refusal(
        reason="unsupported",
        message=f"the {target.name} lies on {_side(target.lies_on)}; "
        "this version of the robot moves only what stands",
        capability="moving an object that lies",
        suggestions=("set it upright first",),
    )


def holds(name: str) -> Refusal:
    """The hand is not free."""
    return Refusal(
        reason="blocked",
        message=f"the hand holds the {name}: put it down first",
        suggestions=(f"put the {name} down",),
    )


def _side(face: str) -> str:
    return face if face.startswith(("face", "nothing")) else f"its {face} side"


def no_side(target: SeenObject, face: str | None, spans: Spans) -> Refusal:
    """Nothing on the object, or on the side that is said, is wide enough to be touched."""
    where = "side" if face is None else f"{face} face"
    return Refusal(
        reason="impossible",
        message=f"the {target.name} has no {where} that is wide enough for a fingertip",
        spans=spans,
    )


def askew(
    target: SeenObject,
    face: str | None,
    heading: float,
    square: float,
    angle: float,
    largest: float,
    spans: Spans,
) -> Refusal:
    """The face that is said is not square enough to the heading; a push to `square` would be."""
    meets = f"its {face} face" if face else "its nearest face"
    return Refusal(
        reason="impossible",
        message=f"pushing the {target.name} {phrase(heading)} would meet {meets} at "
        f"{_deg(angle)} from square, where fingertips slip off (up to "
        f"{math.degrees(largest):.1f}° would do)",
        numbers={"obliqueness": abs(angle), "largest_obliqueness": largest},
        spans=spans,
        suggestions=(
            f"push it {phrase(square)}",
            *(("leave out where to touch it",) if face else ()),
        ),
    )


def turned_first(target: SeenObject, angle: float, region: str, spans: Spans) -> Refusal:
    """It would have to be turned before, which is done low on its sides."""
    return Refusal(
        reason="impossible",
        message=f"none of the {target.name}'s faces looks that way: it would have to be turned by "
        f"{_deg(angle)} first, and is not turned by touching it {region}",
        numbers={"obliqueness": abs(angle)},
        spans=spans,
        suggestions=("turn it first", "leave out where to touch it"),
    )


def no_way(target: SeenObject) -> Refusal:
    """It has no sides along which it could be pushed there."""
    return Refusal(
        reason="impossible",
        message=f"the {target.name} has no sides, square to the way and wide enough for a "
        "fingertip, along which it could be pushed there",
    )


def off_the_table(target: SeenObject, distance: float, room: float, *, bounded: bool) -> Refusal:
    """The table ends before the distance does."""
    left = max(room, 0.0)
    shorter = left > 0.01 and bounded
    return Refusal(
        reason="impossible",
        message=f"the table ends after {_mm(left)} in that direction; {_mm(distance)} would "
        f"push the {target.name} off it",
        numbers={"room": left, "distance": distance},
        suggestions=(f"up to {100 * left:.0f} cm would do",) if shorter else (),
    )


def in_the_way(
    target: SeenObject, other: SeenObject, distance: float, free: float, *, bounded: bool
) -> Refusal:
    """Another object stands on the way."""
    # What is to be brought to a place would not be there after a shorter way.
    shorter = free > 0.01 and bounded
    instead = f"up to {100 * free:.0f} cm would do"
    return Refusal(
        reason="blocked",
        message=f"the {other.name} stands in the way of the {target.name} after {_mm(free)}; "
        f"{_mm(distance)} are asked",
        numbers={"free": free, "distance": distance},
        suggestions=(instead if shorter else f"push the {other.name} out of the way first",),
    )


def unlikely(target: SeenObject, pushes: int, probability: float, asked: float) -> Refusal:
    """Each push is likely enough, but not all of them together."""
    return Refusal(
        reason="too_uncertain",
        message=f"{pushes} pushes are needed, and all of them succeed with a probability of "
        f"{probability:.2f}; {asked:.2f} is asked",
        numbers={"probability": probability, "asked_probability": asked},
        suggestions=(f"find out the weight and the friction of the {target.name} first",),
    )


def turn_blocked(target: SeenObject, met: str) -> Refusal:
    """It would hit something, or leave the table, as it turns."""
    what = "over the table's edge" if met == "table" else f"into the {met}"
    return Refusal(
        reason="blocked",
        message=f"turning here, the {target.name} would swing {what}",
        suggestions=("move it away from there first",),
    )


def cannot_turn(target: SeenObject) -> Refusal:
    """No finger on any of its sides turns it in this sense."""
    return Refusal(
        reason="impossible",
        message=f"no push on a side of the {target.name} surely turns it: the finger would slip",
        suggestions=(f"find out the friction of the {target.name} first",),
    )


def turned_by_one(target: SeenObject, spans: Spans) -> Refusal:
    """Two fingertips hold its heading."""
    return Refusal(
        reason="unsupported",
        message=f"two fingertips side by side keep the {target.name} from turning; "
        "this robot turns objects with one",
        capability="turning an object with two fingers",
        spans=spans,
        suggestions=("say “with one finger”, or leave it out",),
    )


def falls_off(target: SeenObject) -> Refusal:
    """It would land beyond the table's edge."""
    return Refusal(
        reason="impossible",
        message=f"the {target.name} would fall over the edge of the table",
        numbers={"height": target.model.top},
        suggestions=("topple it to another side",),
    )


def falls_on(target: SeenObject, other: SeenObject) -> Refusal:
    """It would land on another object."""
    return Refusal(
        reason="blocked",
        message=f"the {target.name}, {_mm(target.model.top)} high, would fall on the {other.name}",
        numbers={"height": target.model.top},
        suggestions=("topple it to another side",),
    )


def too_weak(
    target: SeenObject, outcome: str, needed: float, limit: float, *, said: bool, spans: Spans
) -> Refusal:
    """The allowed force does not suffice; it is `said`, or what the fingers have."""
    verb = "sliding" if outcome == "slide" else "toppling"
    who = "are allowed" if said else "is what the fingers can give"
    return Refusal(
        reason="impossible" if said else "out_of_reach",
        message=f"{verb} the {target.name} may take {needed:.1f} N; {limit:.1f} N {who}",
        numbers={"needed_force": needed, "allowed_force": limit},
        spans=spans if said else (),
        suggestions=(f"allow {math.ceil(2 * needed) / 2:g} N",) if said else (),
    )


def too_light(target: SeenObject, needed: float, least: float, spans: Spans) -> Refusal:
    """It moves before as much force as is asked can be pressed on it."""
    return Refusal(
        reason="impossible",
        message=f"the {target.name} gives way at {needed:.1f} N at most, so that no push presses "
        f"{least:.1f} N on it",
        numbers={"needed_force": needed, "min_force": least},
        spans=spans,
        suggestions=(f"ask for no more than {needed:.1f} N",),
    )


def too_slow(
    target: SeenObject, distance: float, least: float, most: float, spans: Spans
) -> Refusal:
    """It takes longer than it may."""
    return Refusal(
        reason="out_of_time",
        message=f"pushing the {target.name} over {_mm(distance)} takes {least:.1f} s; "
        f"{most:.1f} s are allowed",
        numbers={"least_time": least, "max_time": most},
        spans=spans,
        suggestions=(f"allow {math.ceil(2 * least) / 2:g} s",),
    )


def several_pushes(target: SeenObject, pushes: int, most: float, spans: Spans) -> Refusal:
    """Between two pushes the hand goes around the object, which takes longer than it may."""
    return Refusal(
        reason="out_of_time",
        message=f"it takes {pushes} pushes to bring the {target.name} there, and the hand must go "
        f"around it in between; {most:.1f} s are allowed",
        numbers={"pushes": float(pushes), "max_time": most},
        spans=spans,
        suggestions=("leave out how long it may take",),
    )


def no_reach(target: SeenObject, answers: list[ReachAnswer]) -> Refusal:
    """Contacts exist, but the hand gets to none of them."""
    blockers = [a for a in answers if a.reason == "obstacle" and a.blocker]
    last = (blockers or answers)[0]
    return Refusal(
        reason="blocked" if blockers else "out_of_reach",
        message=f"{len(answers)} ways to push the {target.name} satisfy the sentence, "
        f"but the hand does not get there: {last.message}",
        numbers={"ways": float(len(answers)), **last.numbers},
        suggestions=(f"move the {blockers[0].blocker}",) if blockers else ("another direction",),
    )


def given_up(target: SeenObject, answers: list[ReachAnswer]) -> Refusal:
    """Many pushes were looked at, and the search ended before the hand could make a whole way."""
    failed = [a for a in answers if not a.ok]
    blockers = [a for a in failed if a.reason == "obstacle" and a.blocker]
    last = (blockers or failed)[0]
    return Refusal(
        reason="out_of_time",
        message=f"the search was given up after {len(answers)} pushes of the {target.name}; "
        f"{len(failed)} of them are out of the hand's reach, the first since {last.message}",
        numbers={"looks": float(len(answers)), "out_of_reach": float(len(failed))},
        suggestions=(f"move the {blockers[0].blocker}",) if blockers else ("another direction",),
    )
