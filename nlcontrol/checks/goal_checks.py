"""Did what was asked come about? One function per kind of goal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from grammar.frames import command as g
from nlcontrol.checks import trace_measures as measures
from nlcontrol.checks.verdicts import (
    Check,
    Clause,
    Unit,
    compare,
    object_name,
    place_check,
    relation_of,
)
from objectmodels.containers.lids import is_off
from objectmodels.models.object_parts import FlipLid, LiftOffLid, ScrewCap
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
    from nlcontrol.checks.verdicts import Evidence
    from planner.types.defaults import Defaults


# Did what a whole hand was to do come about? One function per kind of goal.
#
# Volumes and lids are those of the account that is checked: a share of the contents is one of
# what was in it by that account.


def by_hand(e: Evidence) -> bool:
    """True if the object was in the hand."""
    return bool(measures.during(e.trace, ("grasp", "lift", "carry", "pour", "set_down")).any())


def done_at_all(
    clause: Clause, bound: g.Bound, done: str, least: float, measured: float, unit: Unit
) -> Iterator[Check]:
    """Something was done: nothing at all keeps every “at most”."""
    if bound == "at_most":
        yield compare(clause, "at_least", f"{done} at all", least, measured, 0.0, unit)


def stands_on_base(clause: Clause, e: Evidence, limit: float | None = None) -> Check:
    """It comes to rest on its base, tilted by no more than a limit [rad] if one is given."""
    most = e.defaults.rest_tilt if limit is None else limit
    _, tilt = measures.tilt_at_end(e.trace, e.name)
    return compare(clause, "at_most", "tilt at the end", most, tilt, 0.0, "rad")


def set_down_upright(clause: Clause, e: Evidence) -> Iterator[Check]:
    """It was let go, and stands on the table on its base."""
    height, limit = float(e.trace.poses[e.name][-1, 6]), e.defaults.no_lift
    yield compare(clause, "at_most", "height over the table", 0.0, height, limit, "m")
    yield stands_on_base(clause, e)


def stands_up(clause: Clause, e: Evidence) -> Iterator[Check]:
    """It was let go, and stands on its own bottom, on whatever face it lay."""
    rest, pose = e.rests.get(e.name), e.trace.poses[e.name][-1]
    height, upwards = float(pose[6]), np.array([0.0, 0.0, 1.0])
    if rest is not None:
        upwards = rest.R_BN[2]
        height = float(rest.body_pose(measures.rotation(pose), pose[4:])[1][2])
    limit, most = e.defaults.no_lift, e.defaults.rest_tilt
    yield compare(clause, "at_most", "height over the table", 0.0, height, limit, "m")
    tilt = measures.axis_tilt_at_end(e.trace, e.name, upwards)
    yield compare(clause, "at_most", "tilt at the end", most, tilt, 0.0, "rad")


def set_on(clause: Clause, lower: str, e: Evidence) -> Iterator[Check]:
    """It was let go, and stands on its base on another object, which was not moved."""
    yield _stays_put(clause, lower, e)
    yield stands_on_base(clause, e)


def _stays_put(clause: Clause, name: str, e: Evidence) -> Check:
    moved = float(np.linalg.norm(e.trace.displacement(name)[:2]))
    quantity = "moved" if name == e.name else f"{name} was moved by"
    return compare(clause, "at_most", quantity, 0.0, moved, e.defaults.stays_put, "m")


def lift_check(goal: g.Lift, e: Evidence) -> Iterator[Check]:
    """It is up at the end, and upright."""
    d = e.defaults
    by_default = {None: d.lift_height, "little": d.lift_little, "lot": d.lift_lot}
    asked = by_default[goal.amount] if goal.height is None else goal.height
    assert isinstance(asked, float), "lengths are in metres by now"
    relation = relation_of(goal.bound)
    tolerance = d.tolerance_of(asked, d.lift_tolerance, goal.bound)
    rise, quantity = float(e.trace.displacement(e.name)[2]), "held higher at the end"
    if goal.above == "table":
        rise, quantity = float(e.trace.poses[e.name][-1, 6]), "held over the table at the end"
    yield compare(goal, relation, quantity, asked, rise, tolerance, "m")
    yield from done_at_all(goal, goal.bound, "lifted", d.no_lift, rise, "m")
    yield stands_on_base(goal, e, d.upright)


def set_down(goal: g.SetDown, e: Evidence) -> Iterator[Check]:
    """It stands where it was held, or on the table if it stood on another object."""
    if e.stood_on is None:
        moved = float(np.linalg.norm(e.trace.displacement(e.name)[:2]))
        limit = e.defaults.place_tolerance
        yield compare(goal, "at_most", "moved while it was set down", 0.0, moved, limit, "m")
    yield from set_down_upright(goal, e)


def opening_check(goal: g.Open, e: Evidence) -> Iterator[Check]:
    """Its lid is open, or off; the object stands where it stood."""
    lid, d = e.model.lid, e.defaults
    at_end = e.lid_at_end
    if isinstance(lid, FlipLid):
        quantity = "angle of its lid"
        yield compare(goal, "at_least", quantity, d.lid_opened, at_end, 0.0, "rad")
    elif lid is not None:
        yield object_name(goal, f"its {_lid_name(lid)}", "off", _state(lid, at_end))
    yield from _stood_still(goal, e)


def closing_check(goal: g.Close, e: Evidence) -> Iterator[Check]:
    """Its lid is shut, or on; the object stands where it stood."""
    lid, d = e.model.lid, e.defaults
    at_end = e.lid_at_end
    if isinstance(lid, LiftOffLid):
        yield object_name(goal, "its lid", "on", _state(lid, at_end))
    else:
        quantity = "angle of its lid" if isinstance(lid, FlipLid) else "turn of its cap"
        yield compare(goal, "at_most", quantity, d.lid_closed, at_end, 0.0, "rad")
    yield from _stood_still(goal, e)


def _lid_name(lid: LiftOffLid | ScrewCap) -> str:
    return "cap" if isinstance(lid, ScrewCap) else "lid"


def _state(lid: LiftOffLid | ScrewCap, at: float | None) -> str | None:
    if at is None:
        return None
    return "off" if is_off(lid, at) else "on"


def _stood_still(clause: Clause, e: Evidence) -> Iterator[Check]:
    yield _stays_put(clause, e.name, e)
    yield stands_on_base(clause, e)


def pour_check(goal: g.Pour, e: Evidence) -> Iterator[Check]:
    """So much arrived, hardly any was spilled, what it went into stands, the source is back."""
    assert goal.into is not None, "what is poured is poured into something"
    into, d = goal.into.id or goal.into.text, e.defaults
    before, last, first = e.contents(e.name, 0), e.contents(into, -1), e.contents(into, 0)
    received = None if last is None or first is None else last - first
    whole = goal.fill is None and goal.volume is None and goal.amount is None
    if whole and goal.fraction in (None, 1.0):
        least = d.pour_least * (before or 0.0)
        yield compare(goal, "at_least", f"arrived in the {into}", least, received, 0.0, "m³")
    else:
        asked = _asked_volume(goal, before or 0.0, into, e)
        tolerance = d.tolerance_of(asked, max(d.pour_share * asked, d.pour_margin))
        yield compare(goal, "about", f"arrived in the {into}", asked, received, tolerance, "m³")
    if not e.has("no_spill"):
        limit = d.spill_tolerance * (before or 0.0)
        yield compare(goal, "at_most", "spilled", limit, e.spilled, 0.0, "m³")
    yield _stays_put(goal, into, e)
    yield from set_down_upright(goal, e)


def _asked_volume(goal: g.Pour, before: float, into: str, e: Evidence) -> float:
    """The volume that is meant [m³]."""
    d = e.defaults
    if goal.volume is not None:
        return goal.volume
    if goal.fill is not None:
        vessel = e.start.objects[into].model.vessel
        assert vessel is not None, "what is filled is hollow"
        share = min(goal.fill, d.pour_fill)
        return share * vessel.capacity - (e.contents(into, 0) or 0.0)
    if goal.amount == "little":
        return min(d.pour_little, before)
    return (d.pour_lot if goal.amount == "lot" else goal.fraction or 1.0) * before


def has_fallen(clause: Clause, e: Evidence) -> Check:
    """It comes to rest on a side."""
    tilt, _ = measures.tilt_at_end(e.trace, e.name)
    return compare(clause, "at_least", "tilt at the end", e.defaults.toppled, tilt, 0.0, "rad")


def _still_stands(clause: Clause, e: Evidence) -> Iterator[Check]:
    """It stands at the end, unless the sentence says so itself or wants it to fall."""
    falls = any(isinstance(c, g.Until) and c.event == "tips" for c in e.frame.constraints)
    if not falls and not e.has("no_topple"):
        yield stands_on_base(clause, e)


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
    yield from done_at_all(goal, goal.bound, "moved", d.moves, along, "m")


def _place(goal: g.Place, e: Evidence) -> Iterator[Check]:
    start = e.start.objects[e.name]
    place = region(goal, e.end, e.defaults, start)
    assert place is not None, "a place in what is no open box is refused before"
    if goal.fraction is not None:
        place = share_of_way(place, goal.fraction, start, e.defaults)
    yield from (place_check(goal, one) for one in place.measures(e.end.objects[e.name]))
    if goal.relation in ("on", "in") and isinstance(goal.reference, tuple):
        yield from set_on(goal, goal.reference[0].id or "", e)
    elif by_hand(e):
        yield from set_down_upright(goal, e)
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
    yield from done_at_all(goal, goal.bound, "turned", d.aim_angle, measured, "rad")


def _tilt(goal: g.Tilt, e: Evidence) -> Iterator[Check]:
    d = e.defaults
    asked = goal.angle or tilt_goal(goal, e.model, d)[0]
    tolerance = d.tolerance_of(asked, d.tilt_tolerance, goal.bound)
    tilts = e.trace.tilt(e.name)
    most = int(np.argmax(tilts))
    yield compare(
        goal, relation_of(goal.bound), "largest tilt", asked, tilts[most], tolerance, "rad"
    )
    yield from done_at_all(goal, goal.bound, "tilted", d.tips, tilts[most], "rad")
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
    "upright": stands_up,
    "lift": lift_check,
    "set_down": set_down,
    "open": opening_check,
    "close": closing_check,
    "pour": pour_check,
}
"""The check of each kind of goal; a kind that is missing cannot be checked."""
