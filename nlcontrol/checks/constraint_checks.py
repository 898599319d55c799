"""Checks of what was to hold on the way, and of when it was to stop; nothing else may be touched.

One function for each kind of constraint, and one for each event that a push lasts until. Every
command implies that nothing else is touched, unless the sentence asks for that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from grammar.frames import command as g
from nlcontrol.checks import trace_measures as measures
from nlcontrol.checks.goal_checks import by_hand, has_fallen, stands_on_base, stands_up
from nlcontrol.checks.verdicts import Check, Evidence, Relation, compare, object_name, place_check
from planner.problem.directions import face_name, heading_of, unit
from planner.problem.footprints import footprint, gap
from planner.problem.goal_poses import goal_heading
from planner.problem.places import region, table_region

if TYPE_CHECKING:
    from nlcontrol.checks.trace_measures import Array
    from sim.traces.trace import Trace


@dataclass(frozen=True)
class _Implied:
    """Clause that every command implies."""

    kind: str = "others"
    spans: g.Spans = ()


def touched_others(trace: Trace, one: str, other: str) -> bool:
    """True if two bodies began to touch."""
    return any({c.body_a, c.body_b} == {one, other} for c in trace.contacts)


def others(e: Evidence) -> Iterator[Check]:
    """Neither the object nor the robot touched anything else, nor did anything fall on it."""
    names = set(e.trace.poses)
    if len(names) < 2:
        return
    if not names.isdisjoint(e.unseen - {e.name}):
        yield object_name(_Implied(), "touched on the way", "none", None)
        return
    allowed = {frozenset((e.name, name)) for name in _to_be_touched(e)}
    touching = np.flatnonzero(measures.during(e.trace, ("touch", "push", "grasp", "lid")))
    begun = float(e.trace.time[touching[0]]) if len(touching) else float("inf")
    touched: set[str] = set()
    for contact in e.trace.contacts:
        pair = frozenset((contact.body_a, contact.body_b))
        objects = names & pair
        # Things that stand against each other begin to touch when the world does.
        together = len(objects) == 2 and contact.time < begun
        if pair not in allowed and not together:
            touched |= objects - {e.name}
    found = ", ".join(sorted(touched)) or "none"
    yield object_name(_Implied(), "touched on the way", "none", found)


def _to_be_touched(e: Evidence) -> Iterator[str]:
    """Objects that it stands on, that the sentence wants it to touch, or to be poured into."""
    goal, below = e.frame.goal, e.stood_on
    if below is not None:
        yield below
    if isinstance(goal, g.Pour) and goal.into is not None:
        yield goal.into.id or goal.into.text
    if isinstance(goal, g.Place) and goal.relation in ("touching", "on", "in"):
        assert isinstance(goal.reference, tuple)
        yield from (ref.id for ref in goal.reference if ref.id)
    for clause in e.frame.constraints:
        if isinstance(clause, g.Until) and clause.event == "touching" and clause.object:
            yield clause.object.id or clause.object.text


def until(clause: g.Until, e: Evidence) -> Iterator[Check]:
    """The checks of one event."""
    yield from _EVENTS[clause.event](clause, e)


def _touching(clause: g.Until, e: Evidence) -> Iterator[Check]:
    other = _other(clause)
    own, there = (footprint(e.end.objects[name]) for name in (e.name, other))
    touches = touched_others(e.trace, e.name, other) or gap(own, there) <= e.defaults.touching_gap
    yield object_name(clause, f"contact with {other}", "touched", "touched" if touches else "none")
    shoved = float(np.linalg.norm(e.trace.displacement(other)[:2]))
    limit = e.defaults.overrun
    yield compare(clause, "at_most", f"{other} was moved along by", 0.0, shoved, limit, "m")


def _next_to(clause: g.Until, e: Evidence) -> Iterator[Check]:
    assert clause.object is not None
    place = region(g.Place(relation="next_to", reference=(clause.object,)), e.end, e.defaults)
    assert place is not None
    yield from (place_check(clause, measure) for measure in place.measures(e.end.objects[e.name]))


def _in_line(clause: g.Until, e: Evidence) -> Iterator[Check]:
    other = _other(clause)
    goal, d = e.frame.goal, e.defaults
    heading = None
    if isinstance(goal, g.Displace):
        heading = goal_heading(goal, e.start.objects[e.name], e.start, d)
    if heading is None:
        heading = heading_of(e.trace.displacement(e.name))
    apart = e.end.objects[other].pose.p_WB - e.end.objects[e.name].pose.p_WB
    off = abs(float(apart @ unit(heading)))
    yield compare(clause, "at_most", f"off line with {other}", 0.0, off, d.in_line_tolerance, "m")


def _edge(clause: g.Until, e: Evidence) -> Iterator[Check]:
    place = table_region("edge", e.end.table, e.defaults)
    yield from (place_check(clause, measure) for measure in place.measures(e.end.objects[e.name]))


def _about_to_tip(clause: g.Until, e: Evidence) -> Iterator[Check]:
    tips = e.defaults.tips
    yield compare(clause, "at_least", "largest tilt", tips, e.largest_tilt, 0.0, "rad")
    yield stands_on_base(clause, e)


def _tips(clause: g.Until, e: Evidence) -> Iterator[Check]:
    yield has_fallen(clause, e)


def _moves(clause: g.Until, e: Evidence) -> Iterator[Check]:
    moved, d = float(np.linalg.norm(e.trace.displacement(e.name)[:2])), e.defaults
    yield compare(clause, "at_least", "moved in all", d.moves, moved, 0.0, "m")
    yield compare(clause, "at_most", "moved in all", d.moves, moved, d.overrun, "m")


def _other(clause: g.Until) -> str:
    assert clause.object is not None, "the language names an object with these events"
    return clause.object.id or clause.object.text


_EVENTS: dict[str, Callable[[g.Until, Evidence], Iterator[Check]]] = {
    "touching": _touching,
    "next_to": _next_to,
    "in_line": _in_line,
    "edge": _edge,
    "about_to_tip": _about_to_tip,
    "tips": _tips,
    "moves": _moves,
}


HAND_SIDE = "right"
"""The one hand of this robot is a right hand."""


def _no_topple(clause: g.NoTopple, e: Evidence) -> Iterator[Check]:
    if e.frame.goal.kind == "upright":
        yield from stands_up(clause, e)
        return
    if by_hand(e):
        yield from _kept_upright(clause, e)
        return
    # Half the way to falling is too far for what is to slide, not for what is to tilt.
    tilts = any(isinstance(c, g.Until) and c.event == "about_to_tip" for c in e.frame.constraints)
    if e.frame.goal.kind != "tilt" and not tilts:
        no_return = min(e.model.angle_of_no_return(face.normal) for face in e.model.faces())
        limit = e.defaults.no_topple_share * no_return
        yield compare(clause, "at_most", "largest tilt", limit, e.largest_tilt, 0.0, "rad")
    yield stands_on_base(clause, e)


def _kept_upright(clause: g.NoTopple | g.NoTilt, e: Evidence) -> Iterator[Check]:
    """An object in the hand is upright unless it is poured from, and upright at the end."""
    if e.frame.goal.kind != "pour":
        limit = e.defaults.upright
        yield compare(clause, "at_most", "largest tilt", limit, e.largest_tilt, 0.0, "rad")
    yield stands_on_base(clause, e, e.defaults.upright)


def _tilt_limit(clause: g.NoTilt | g.MaxTilt, e: Evidence) -> Iterator[Check]:
    limit = e.defaults.upright if by_hand(e) else e.defaults.no_tilt
    if isinstance(clause, g.MaxTilt):
        limit = clause.value
    yield compare(clause, "at_most", "largest tilt", limit, e.largest_tilt, 0.0, "rad")


def _turn_limit(clause: g.NoTurn | g.MaxTurn, e: Evidence) -> Iterator[Check]:
    turned = float(np.abs(measures.turn(e.trace, e.name)).max())
    limit = clause.value if isinstance(clause, g.MaxTurn) else e.defaults.no_turn
    yield compare(clause, "at_most", "turned at most", limit, turned, 0.0, "rad")


def _no_slide(clause: g.NoSlide, e: Evidence) -> Iterator[Check]:
    slid = measures.slip(e.trace, e.name, e.model.footprint.corners)
    yield compare(clause, "at_most", "slid on its base", e.defaults.no_slide, slid, 0.0, "m")


def _no_lift(clause: g.NoLift, e: Evidence) -> Iterator[Check]:
    rise = measures.rise(e.trace, e.name, e.model.footprint.corners)
    yield compare(clause, "at_most", "rose off the table", e.defaults.no_lift, rise, 0.0, "m")


def _no_spill(clause: g.NoSpill, e: Evidence) -> Iterator[Check]:
    contents = {name: volume[0] for name, volume in e.trace.contents.items()}
    # What holds nothing itself may still make others spill.
    held = contents.get(e.name, 0.0) or sum(contents.values())
    if held > 0.0:
        share = None if e.spilled is None else e.spilled / held
        quantity = "share of the contents that was spilled"
        yield compare(clause, "at_most", quantity, e.defaults.no_spill, share, 0.0, "")
    else:
        yield object_name(clause, "spilled", "nothing", "nothing")


def _no_touch(clause: g.NoTouch, e: Evidence) -> Iterator[Check]:
    names = tuple(name for name in e.trace.poses if name != e.name)
    what = "anything else"
    if clause.object is not None:
        what = clause.object.id or clause.object.text
        names = (what,)
    touched = [name for name in names if touched_others(e.trace, e.name, name)]
    found: str | None = ", ".join(touched) or "none"
    if not touched and not (e.unsure | e.unseen).isdisjoint(names):
        found = None
    yield object_name(clause, f"contact with {what}", "none", found)
    if clause.clearance is not None:
        kept = min((_least_gap(e, name) for name in names), default=clause.clearance)
        tolerance = e.defaults.clear_tolerance
        quantity = f"least distance from {what}"
        yield compare(clause, "at_least", quantity, clause.clearance, kept, tolerance, "m")


def _least_gap(e: Evidence, name: str) -> float:
    ways = zip(e.covered_outlines(e.name), e.covered_outlines(name), strict=True)
    return min(gap(own, other) for own, other in ways)


def _force(relation: Relation) -> Callable[..., Iterator[Check]]:
    def force_check(clause: g.MaxForce | g.MinForce | g.Force, e: Evidence) -> Iterator[Check]:
        felt, d = measures.largest_push_force(e.trace), e.defaults
        quantity = "largest push force felt"
        if by_hand(e):
            felt, quantity = measures.largest_squeeze(e.trace), "largest squeeze felt"
        tolerance = d.force_tolerance
        if relation == "about":
            tolerance = d.tolerance_of(clause.value, tolerance)
        yield compare(clause, relation, quantity, clause.value, felt, tolerance, "N")

    return force_check


def _hard(clause: g.Hard, e: Evidence) -> Iterator[Check]:
    ready = measures.largest_force_limit(e.trace)
    quantity = "force it was ready to push with"
    yield compare(clause, "at_least", quantity, e.defaults.force_hard, ready, 0.0, "N")


def _speed(
    relation: Relation, asked: Callable[[Any, Evidence], float]
) -> Callable[..., Iterator[Check]]:
    def speed_check(clause: Any, e: Evidence) -> Iterator[Check]:
        speed, d = measures.largest_push_speed(e.trace), e.defaults
        quantity = "largest speed of the push"
        if by_hand(e):
            quantity = "largest speed in the hand"
            speed = measures.largest_held_speed(e.trace, e.name)
        said, tolerance = asked(clause, e), d.speed_tolerance
        if relation != "at_most":
            tolerance = d.tolerance_of(said, tolerance)
        yield compare(clause, relation, quantity, said, speed, tolerance, "m/s")

    return speed_check


def _gentle(e: Evidence) -> float:
    return e.defaults.carry_speed_gentle if by_hand(e) else e.defaults.speed_gentle


def _duration(clause: g.MaxDuration | g.Duration, e: Evidence) -> Iterator[Check]:
    relation: Relation = "at_most" if isinstance(clause, g.MaxDuration) else "about"
    most = e.defaults.duration_tolerance
    tolerance = 0.0 if relation == "at_most" else e.defaults.tolerance_of(clause.value, most)
    took, quantity = measures.push_duration(e.trace), "time that it was pushed"
    yield compare(clause, relation, quantity, clause.value, took, tolerance, "s")


def _max_distance(clause: g.MaxDistance, e: Evidence) -> Iterator[Check]:
    length = float(np.linalg.norm(e.trace.displacement(e.name)[:2]))
    yield compare(clause, "at_most", "moved in all", clause.value, length, 0.0, "m")


def _contact(clause: g.ContactRegion, e: Evidence) -> Iterator[Check]:
    """The first push that touched it elsewhere, if there is one; else the first of all."""
    touches = measures.contacts(e.trace, e.name, ("grasp",) if by_hand(e) else ("push",))
    if not touches:
        yield object_name(clause, "contact", "touched", "never touched")
        return
    verdicts = [tuple(_touch_check(clause, p_BT, R_WB, e)) for p_BT, R_WB in touches]
    wrong = (checks for checks in verdicts if not all(check.ok for check in checks))
    yield from next(wrong, verdicts[0])


def _touch_check(clause: g.ContactRegion, p_BT: Array, R_WB: Array, e: Evidence) -> Iterator[Check]:
    tolerance, height = e.defaults.height_tolerance, e.model.top
    if clause.face is not None:
        faces = e.model.faces(np.arctan2(-p_BT[1], -p_BT[0]))
        outside = [np.subtract(p_BT, f.centre) @ f.normal for f in faces]
        touched = faces[int(np.argmax(outside))]
        name, _ = face_name(R_WB @ np.array(touched.normal))
        if p_BT[2] - height > max(outside):
            name = "top"
        yield object_name(clause, "face touched", clause.face, name)
    if clause.region is not None:
        low, high = {"bottom": (0, 1), "middle": (1, 2), "top": (2, 3)}[clause.region]
        if low:
            least = low * height / 3
            yield compare(clause, "at_least", "contact height", least, p_BT[2], tolerance, "m")
        if high < 3:
            most = high * height / 3
            yield compare(clause, "at_most", "contact height", most, p_BT[2], tolerance, "m")
    if clause.height is not None:
        value, upwards = clause.height.value, clause.height.origin == "table"
        assert isinstance(value, float)
        asked = value if upwards else height - value
        bound = clause.height.bound
        relation: Relation = "about"
        if bound != "exact":
            relation = "at_least" if (bound == "at_least") == upwards else "at_most"
        yield compare(clause, relation, "contact height", asked, p_BT[2], tolerance, "m")


def _effector(clause: g.Effector, e: Evidence) -> Iterator[Check]:
    if clause.side is not None:
        yield object_name(clause, "hand used", f"{clause.side} hand", f"{HAND_SIDE} hand")
    used = len(e.trace.tips)
    if clause.tool == "finger" and clause.count is not None:
        yield object_name(clause, "fingers used", str(clause.count), str(used) if used else None)
    elif clause.side is None:
        yield object_name(clause, "touched with", clause.tool, clause.tool if used else None)


CONSTRAINTS: dict[str, Callable[..., Iterator[Check]]] = {
    "no_topple": _no_topple,
    "no_tilt": _tilt_limit,
    "no_turn": _turn_limit,
    "no_slide": _no_slide,
    "no_lift": _no_lift,
    "no_spill": _no_spill,
    "no_touch": _no_touch,
    "max_tilt": _tilt_limit,
    "max_turn": _turn_limit,
    "max_force": _force("at_most"),
    "min_force": _force("at_least"),
    "force": _force("about"),
    "hard": _hard,
    "max_speed": _speed("at_most", lambda clause, _: clause.value),
    "min_speed": _speed("at_least", lambda clause, _: clause.value),
    "speed": _speed("about", lambda clause, _: clause.value),
    "gentle": _speed("at_most", lambda _, e: _gentle(e)),
    "slow": _speed("at_most", lambda _, e: _gentle(e)),
    "fast": _speed("at_least", lambda _, e: e.defaults.speed_fast),
    "max_duration": _duration,
    "duration": _duration,
    "max_distance": _max_distance,
    "contact": _contact,
    "effector": _effector,
    "until": until,
}
"""The check of each kind of constraint; a kind that is missing cannot be checked."""
