"""Did what was asked come about? One function per kind of goal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from grammar.frames import command as g
from nlcontrol.checks import grasp_checks as handling
from nlcontrol.checks import trace_measures as measures
from nlcontrol.checks.verdicts import Check, Clause, compare, object_name, place_check, relation_of
from planner.problem.constraint_limits import tilt_goal
from planner.problem.directions import HEADINGS, angle_between, heading_of
from planner.problem.goal_poses import (
    goal_distance,
    goal_heading,
    is_orientation,
    turns_to_orientation,
)
from planner.problem.places import region, share_of_way

if TYPE_CHECKING:
    from nlcontrol.checks.evidence import Evidence
    from planner.types.defaults import Defaults


def has_fallen(clause: Clause, e: Evidence) -> Check:
    """It comes to rest on a side."""
    tilt, _ = measures.tilt_at_end(e.trace, e.name)
    return compare(clause, "at_least", "tilt at the end", e.defaults.toppled, tilt, 0.0, "rad")


def _falls(e: Evidence) -> bool:
    """True if it is to be pushed until it tips over."""
    return any(isinstance(c, g.Until) and c.event == "tips" for c in e.frame.constraints)


def _still_stands(clause: Clause, e: Evidence) -> Iterator[Check]:
    """It stands at the end, unless the sentence says so itself or wants it to fall."""
    if not _falls(e) and not e.has("no_topple"):
        yield handling.stands_on_base(clause, e)


def _displace(goal: g.Displace, e: Evidence) -> Iterator[Check]:
    d, own = e.defaults, e.start.objects[e.name]
    travel = e.trace.displacement(e.name)[:2]
    length = float(np.linalg.norm(travel))
    heading = goal_heading(goal, own, e.start, d)
    tipped = _tip_check(goal, heading, e)
    if tipped is not None:
        yield from tipped
        return
    along = length
    if heading is not None:
        along = float(travel @ [np.cos(heading), np.sin(heading)])
        # The heading of something that hardly moved is noise, and its distance fails anyway.
        asked, _ = goal_distance(goal, own, e.start, d, e.frame.constraints)
        hardly = d.tolerance_of(asked, d.distance_tolerance)
        went = heading_of(np.array([*travel, 0.0])) if length > hardly else heading
        off = abs(angle_between(went, heading))
        yield compare(
            goal, "at_most", "off the asked direction", 0.0, off, d.direction_tolerance, "rad"
        )
    # An event or a time says how far, if no distance does.
    said = goal.distance is not None or goal.fraction is not None or goal.amount is not None
    if said or not e.has("until", "duration"):
        yield from _distance(goal, along, e)
    if e.frame.action == "slide":
        tilt = e.largest_tilt
        yield compare(goal, "at_most", "largest tilt while sliding", d.no_tilt, tilt, 0.0, "rad")
    else:
        yield from _still_stands(goal, e)


def _tip_check(goal: g.Displace, heading: float | None, e: Evidence) -> list[Check] | None:
    """Check of where it fell or leant, if it is pushed until it tips or is about to; else None."""
    events = [c.event for c in e.frame.constraints if isinstance(c, g.Until)]
    if "tips" in events:
        sample, quantity = -1, "fell off the asked direction"
    elif "about_to_tip" in events:
        sample, quantity = int(np.argmax(e.trace.tilt(e.name))), "leant off the asked direction"
    else:
        return None
    if heading is None:
        return []
    went = measures.tilt_heading(e.trace, e.name, sample)
    return [_towards(goal, quantity, went, heading, e.defaults)]


def _distance(goal: g.Displace, along: float, e: Evidence) -> Iterator[Check]:
    d, own = e.defaults, e.start.objects[e.name]
    asked, _ = goal_distance(goal, own, e.start, d, e.frame.constraints)
    tolerance = d.tolerance_of(asked, d.distance_tolerance, goal.bound)
    quantity = "moved in the asked direction"
    yield compare(goal, relation_of(goal.bound), quantity, asked, along, tolerance, "m")
    yield from handling.done_at_all(goal, goal.bound, "moved", d.moves, along, "m")


def _place(goal: g.Place, e: Evidence) -> Iterator[Check]:
    start = e.start.objects[e.name]
    place = region(goal, e.end, e.defaults, start)
    assert place is not None, "a place in what is no open box is refused before"
    if goal.fraction is not None:
        place = share_of_way(place, goal.fraction, start, e.defaults)
    yield from (place_check(goal, one) for one in place.measures(e.end.objects[e.name]))
    if goal.relation in ("on", "in") and isinstance(goal.reference, tuple):
        yield from handling.set_on(goal, goal.reference[0].id or "", e)
    elif handling.by_hand(e):
        yield from handling.set_down_upright(goal, e)
    else:
        yield from _still_stands(goal, e)


def _rotate(goal: g.Rotate, e: Evidence) -> Iterator[Check]:
    d = e.defaults
    if is_orientation(goal):
        off = abs(turns_to_orientation(goal, e.end.objects[e.name], e.end)[0])
        yield compare(goal, "at_most", "off the asked heading", 0.0, off, d.turn_tolerance, "rad")
    else:
        yield from _turned(goal, e)
    drift = float(np.linalg.norm(e.trace.displacement(e.name)[:2]))
    yield compare(goal, "at_most", "moved while turning", 0.0, drift, d.turn_drift, "m")
    yield from _still_stands(goal, e)


def _turned(goal: g.Rotate, e: Evidence) -> Iterator[Check]:
    d = e.defaults
    turned = float(measures.turn(e.trace, e.name)[-1])
    measured = {"ccw": turned, "cw": -turned, None: abs(turned)}[goal.sense]
    by_default = {None: d.turn, "little": d.turn_little, "lot": d.turn_lot}
    asked = goal.angle or by_default[goal.amount]
    tolerance = d.tolerance_of(asked, d.turn_tolerance, goal.bound)
    quantity = "turned" + {"ccw": " to the left", "cw": " to the right", None: ""}[goal.sense]
    yield compare(goal, relation_of(goal.bound), quantity, asked, measured, tolerance, "rad")
    yield from handling.done_at_all(goal, goal.bound, "turned", d.aim_angle, measured, "rad")


def _tilt(goal: g.Tilt, e: Evidence) -> Iterator[Check]:
    d = e.defaults
    asked = goal.angle or tilt_goal(goal, e.model, d)[0]
    tolerance = d.tolerance_of(asked, d.tilt_tolerance, goal.bound)
    tilts = e.trace.tilt(e.name)
    most = int(np.argmax(tilts))
    yield compare(
        goal, relation_of(goal.bound), "largest tilt", asked, tilts[most], tolerance, "rad"
    )
    yield from handling.done_at_all(goal, goal.bound, "tilted", d.tips, tilts[most], "rad")
    if goal.direction:
        leant = measures.tilt_heading(e.trace, e.name, most)
        yield _towards(goal, "leant off the asked side", leant, HEADINGS[goal.direction], d)
    yield from _still_stands(goal, e)


def _topple(goal: g.Topple, e: Evidence) -> Iterator[Check]:
    yield has_fallen(goal, e)
    if goal.direction:
        fall = measures.tilt_heading(e.trace, e.name)
        asked = HEADINGS[goal.direction]
        yield _towards(goal, "fell off the asked side", fall, asked, e.defaults)


def _none(goal: g.NoGoal, e: Evidence) -> Iterator[Check]:
    touched: str | None = "touched" if measures.contacts(e.trace, e.name) else "never touched"
    if not e.trace.felt:
        touched = None
    yield object_name(goal, "contact", "touched", touched)
    yield from _still_stands(goal, e)


def _towards(clause: Clause, quantity: str, heading: float, asked: float, d: Defaults) -> Check:
    off = abs(angle_between(heading, asked))
    return compare(clause, "at_most", quantity, 0.0, off, d.side_tolerance, "rad")


GOALS: dict[str, Callable[..., Iterator[Check]]] = {
    "displace": _displace,
    "place": _place,
    "rotate": _rotate,
    "tilt": _tilt,
    "topple": _topple,
    "none": _none,
    "upright": handling.stands_up,
    "lift": handling.lift_check,
    "set_down": handling.set_down,
    "open": handling.opening_check,
    "close": handling.closing_check,
    "pour": handling.pour_check,
}
"""The check of each kind of goal; a kind that is missing cannot be checked."""
