"""What every command implies: nothing else is touched, unless the sentence asks for that."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from grammar.frames import command as g
from nlcontrol.checks import trace_measures as measures
from nlcontrol.checks.verdicts import Check, object_name

if TYPE_CHECKING:
    from nlcontrol.checks.evidence import Evidence
    from sim.traces.trace import Trace


@dataclass(frozen=True)
class _Implied:
    """What no words say."""

    kind: str = "others"
    spans: g.Spans = ()


def touched_others(trace: Trace, one: str, other: str) -> bool:
    """Whether two bodies began to touch."""
    return any({c.body_a, c.body_b} == {one, other} for c in trace.contacts)


def others(e: Evidence) -> Iterator[Check]:
    """Neither the object nor the robot touched anything else, nor did anything fall on it."""
    names = set(e.trace.poses)
    if len(names) < 2:
        return
    allowed = {frozenset((e.name, name)) for name in _to_be_touched(e)}
    begun = _new_contacts(e.trace)
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
    """Objects that the sentence wants the object to touch, or to be poured into."""
    goal = e.frame.goal
    if isinstance(goal, g.Pour) and goal.into is not None:
        yield goal.into.id or goal.into.text
    if isinstance(goal, g.Place) and goal.relation == "touching":
        assert isinstance(goal.reference, tuple)
        yield from (ref.id for ref in goal.reference if ref.id)
    for clause in e.frame.constraints:
        if isinstance(clause, g.Until) and clause.event == "touching" and clause.object:
            yield clause.object.id or clause.object.text


def _new_contacts(trace: Trace) -> float:
    """When the robot began to touch anything [s]."""
    touching = np.flatnonzero(measures.during(trace, ("touch", "push", "grasp", "lid")))
    return float(trace.time[touching[0]]) if len(touching) else float("inf")
