"""Did it stop when it was to? One function per event that a push lasts until."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from grammar.frames import command as g
from nlcontrol.checks.bystander_checks import touched_others
from nlcontrol.checks.goal_checks import has_fallen, stands_on_base
from nlcontrol.checks.verdicts import Check, compare, object_name, place_check
from planner.geometry.directions import heading_of, unit
from planner.geometry.footprints import footprint, gap
from planner.problem.displacement_goals import goal_heading
from planner.problem.place_regions import region, table_region

if TYPE_CHECKING:
    from nlcontrol.checks.evidence import Evidence


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
