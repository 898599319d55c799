"""Did it happen as it was said? One check per clause, from the frame and the trace alone.

The checker knows nothing of the plan. Besides frame and trace it takes the believed size of the
object where a clause is about it (the upper third of its height, the angle past which it falls),
and the table of defaults for what a clause means when the sentence says no more.

A clause without a check is an error, raised before anything is executed: no sentence is called
satisfied because a part of it was skipped.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from grammar import frames as g
from nlcontrol import measures
from nlcontrol.errors import error
from planner.defaults import DEFAULTS, Defaults
from planner.directions import HEADINGS, angle_between, bisector, face_name, heading_of

if TYPE_CHECKING:
    from nlcontrol.errors import ErrorInfo
    from objectmodels import ObjectModel
    from sim.trace import Trace

HAND_SIDE = "right"
"""The one hand of this robot is a right hand."""

Relation = Literal["about", "at_most", "at_least", "is"]
Unit = Literal["m", "rad", "N", "m/s", "s", ""]


class Check(BaseModel):
    """What one clause asked and what was measured, in SI units.

    Attributes:
        clause: kind of the goal or constraint.
        spans: the words it comes from, `[start, end)` in the sentence.
        quantity: what was measured, in words.
        relation: how `measured` must stand to `expected`.
        expected: asked value, or a name.
        measured: what the trace says.
        tolerance: by how much it may miss; None for names.
        unit: of the three values.
        ok: whether it holds.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    clause: str
    spans: g.Spans = ()
    quantity: str
    relation: Relation
    expected: float | str
    measured: float | str
    tolerance: float | None = None
    unit: Unit = ""
    ok: bool


@dataclass(frozen=True)
class Evidence:
    """What the checks of one frame look at."""

    trace: Trace
    name: str
    model: ObjectModel
    defaults: Defaults


def check(
    frame: g.Frame, trace: Trace, model: ObjectModel, *, defaults: Defaults = DEFAULTS
) -> tuple[Check, ...]:
    """Checks every clause of a frame.

    Args:
        frame: what was asked, its object resolved.
        trace: what happened.
        model: the believed model of the object, for its size and the angle of no return.
        defaults: what a clause means when the sentence does not say more.

    Raises:
        ControlError: `uncheckable` if a clause has no check.
    """
    require_checkable(frame)
    name = frame.object.id if frame.object and frame.object.id else trace.pushed
    e = Evidence(trace, name, model, defaults)
    checks = list(_GOALS[frame.goal.kind](frame, e))
    for clause in frame.constraints:
        checks += _CONSTRAINTS[clause.kind](clause, e)
    return tuple(checks)


def not_held(missed: Sequence[Check], trace: Trace, stuck: str | None = None) -> ErrorInfo:
    """The error of an execution in which some checks failed."""
    clauses = ", ".join(dict.fromkeys(c.clause.replace("_", " ") for c in missed))
    message = f"executed, but this did not hold: {clauses}"
    if trace.end not in {"stroke", "toppled", "turned", "returned", "event", "reached"}:
        message += f" (the push ended early: {trace.detail})"
    if stuck is not None:
        message += f" (then no further push was found: {stuck})"
    spans = missed[0].spans
    return error("clause_not_held", message, span=spans[0] if spans else None).info


def require_checkable(frame: g.Frame) -> None:
    """Refuses a frame with a clause that could not be checked afterwards.

    Raises:
        ControlError: `uncheckable`, with the words of the clause.
    """
    goal = frame.goal
    if goal.kind not in _GOALS:
        raise _uncheckable(goal.kind, goal.spans)
    if isinstance(goal, g.Displace) and (
        isinstance(goal.distance, g.RelativeLength) or goal.fraction is not None
    ):
        raise _uncheckable("distance relative to an object", goal.spans)
    for clause in frame.constraints:
        if clause.kind not in _CONSTRAINTS:
            raise _uncheckable(clause.kind, clause.spans)
        if isinstance(clause, g.NoTouch) and (clause.clearance is not None or not clause.object):
            raise _uncheckable("clearance", clause.spans)


def _uncheckable(what: str, spans: g.Spans) -> Exception:
    return error(
        "uncheckable",
        f"this version cannot check '{what.replace('_', ' ')}' after the execution, "
        "so it does not execute it",
        span=(spans[0][0], spans[-1][1]) if spans else None,
    )


def _compare(
    clause: Any,
    relation: Relation,
    quantity: str,
    expected: float,
    measured: float,
    tolerance: float,
    unit: Unit,
) -> Check:
    excess = measured - expected
    miss = {"about": abs(excess), "at_most": excess, "at_least": -excess}[relation]
    return Check(
        clause=clause.kind,
        spans=clause.spans,
        quantity=quantity,
        relation=relation,
        expected=float(expected),
        measured=float(measured),
        tolerance=tolerance,
        unit=unit,
        ok=bool(miss <= tolerance),
    )


def _is(clause: Any, quantity: str, expected: str, measured: str) -> Check:
    return Check(
        clause=clause.kind,
        spans=clause.spans,
        quantity=quantity,
        relation="is",
        expected=expected,
        measured=measured,
        ok=expected == measured,
    )


# --- goals -----------------------------------------------------------------------------------


def _displace(frame: g.Frame, e: Evidence) -> Iterator[Check]:
    goal = frame.goal
    assert isinstance(goal, g.Displace)
    d = e.defaults
    travel = e.trace.displacement(e.name)[:2]
    length = float(np.linalg.norm(travel))
    heading = _asked_heading(goal, e)
    along = length
    if heading is not None:
        along = float(travel @ [np.cos(heading), np.sin(heading)])
        # The heading of something that hardly moved is noise, and its distance fails anyway.
        went = heading_of(np.array([*travel, 0.0])) if length > d.distance_tolerance else heading
        off = abs(angle_between(went, heading))
        yield _compare(
            goal, "at_most", "off the asked direction", 0.0, off, d.direction_tolerance, "rad"
        )
    yield _distance(goal, along, d)
    if frame.action == "slide":
        tilt = float(e.trace.tilt(e.name).max())
        yield _compare(goal, "at_most", "largest tilt while sliding", d.no_tilt, tilt, 0.0, "rad")
    elif not any(isinstance(c, g.NoTopple) for c in frame.constraints):
        yield _stands(goal, e)


def _distance(goal: g.Displace, along: float, d: Defaults) -> Check:
    quantity = "moved in the asked direction"
    if isinstance(goal.distance, float):
        if goal.bound == "at_least":
            return _compare(goal, "at_least", quantity, goal.distance, along, 0.0, "m")
        if goal.bound == "at_most":
            return _compare(goal, "at_most", quantity, goal.distance, along, 0.0, "m")
        return _compare(goal, "about", quantity, goal.distance, along, d.distance_tolerance, "m")
    meant = {None: d.distance, "little": d.distance_little, "lot": d.distance_lot}[goal.amount]
    return _compare(goal, "about", quantity, meant, along, d.distance_tolerance, "m")


def _asked_heading(goal: g.Displace, e: Evidence) -> float | None:
    """Heading that the sentence asks for [rad], from where things stood at the start."""
    if goal.heading is not None:
        return goal.heading
    for other, sign in ((goal.toward, 1.0), (goal.away_from, -1.0)):
        if isinstance(other, g.ObjectRef) and other.id is not None:
            there, here = e.trace.poses[other.id][0, 4:], e.trace.poses[e.name][0, 4:]
            return heading_of(sign * (there - here))
    if isinstance(goal.direction, tuple):
        return bisector(goal.direction)
    return HEADINGS[goal.direction] if goal.direction else None


def _topple(frame: g.Frame, e: Evidence) -> Iterator[Check]:
    goal = frame.goal
    assert isinstance(goal, g.Topple)
    tilt, _ = measures.tilt_at_end(e.trace, e.name)
    yield _compare(goal, "at_least", "tilt at the end", e.defaults.toppled, tilt, 0.0, "rad")
    if goal.direction:
        asked = HEADINGS[goal.direction]
        off = abs(angle_between(measures.fall_heading(e.trace, e.name), asked))
        tolerance = e.defaults.side_tolerance
        yield _compare(goal, "at_most", "fell off the asked side", 0.0, off, tolerance, "rad")


# --- constraints -----------------------------------------------------------------------------


def _stands(clause: Any, e: Evidence) -> Check:
    _, tilt = measures.tilt_at_end(e.trace, e.name)
    return _compare(clause, "at_most", "tilt at the end", e.defaults.rest_tilt, tilt, 0.0, "rad")


def _no_topple(clause: g.NoTopple, e: Evidence) -> Iterator[Check]:
    no_return = min(e.model.angle_of_no_return(face.normal) for face in e.model.faces())
    limit = e.defaults.no_topple_share * no_return
    tilt = float(e.trace.tilt(e.name).max())
    yield _compare(clause, "at_most", "largest tilt", limit, tilt, 0.0, "rad")
    yield _stands(clause, e)


def _no_tilt(clause: g.NoTilt, e: Evidence) -> Iterator[Check]:
    tilt = float(e.trace.tilt(e.name).max())
    yield _compare(clause, "at_most", "largest tilt", e.defaults.no_tilt, tilt, 0.0, "rad")


def _no_turn(clause: g.NoTurn, e: Evidence) -> Iterator[Check]:
    turned = float(np.abs(e.trace.yaw(e.name)).max())
    yield _compare(clause, "at_most", "turned at most", e.defaults.no_turn, turned, 0.0, "rad")


def _no_touch(clause: g.NoTouch, e: Evidence) -> Iterator[Check]:
    assert clause.object is not None
    other = clause.object.id or clause.object.text
    pair = {e.name, other}
    touched = any({c.body_a, c.body_b} == pair for c in e.trace.contacts)
    yield _is(clause, f"contact with {other}", "none", "touched" if touched else "none")


def _max_force(clause: g.MaxForce, e: Evidence) -> Iterator[Check]:
    felt = measures.largest_push_force(e.trace)
    tolerance = e.defaults.force_tolerance
    yield _compare(clause, "at_most", "largest push force felt", clause.value, felt, tolerance, "N")


def _speed_below(clause: Any, limit: float, e: Evidence) -> Check:
    speed = measures.largest_push_speed(e.trace)
    tolerance = e.defaults.speed_tolerance
    return _compare(clause, "at_most", "largest speed of the push", limit, speed, tolerance, "m/s")


def _max_speed(clause: g.MaxSpeed, e: Evidence) -> Iterator[Check]:
    yield _speed_below(clause, clause.value, e)


def _gentle(clause: g.Gentle | g.Slow, e: Evidence) -> Iterator[Check]:
    yield _speed_below(clause, e.defaults.speed_gentle, e)


def _max_distance(clause: g.MaxDistance, e: Evidence) -> Iterator[Check]:
    length = float(np.linalg.norm(e.trace.displacement(e.name)[:2]))
    yield _compare(clause, "at_most", "moved in all", clause.value, length, 0.0, "m")


def _contact(clause: g.ContactRegion, e: Evidence) -> Iterator[Check]:
    contact = measures.first_contact(e.trace, e.name)
    if contact is None:
        yield _is(clause, "contact", "touched", "never touched")
        return
    p_BT, R_WB = contact
    tolerance = e.defaults.height_tolerance
    height = e.model.top
    if clause.face is not None:
        faces = e.model.faces(np.arctan2(-p_BT[1], -p_BT[0]))
        outside = [np.subtract(p_BT, f.centre) @ f.normal for f in faces]
        touched = faces[int(np.argmax(outside))]
        name, _ = face_name(R_WB @ np.array(touched.normal))
        yield _is(clause, "face touched", clause.face, name)
    if clause.region is not None:
        low, high = {"bottom": (0, 1), "middle": (1, 2), "top": (2, 3)}[clause.region]
        if low:
            least = low * height / 3
            yield _compare(clause, "at_least", "contact height", least, p_BT[2], tolerance, "m")
        if high < 3:
            most = high * height / 3
            yield _compare(clause, "at_most", "contact height", most, p_BT[2], tolerance, "m")
    if clause.height is not None:
        value, upwards = clause.height.value, clause.height.origin == "table"
        assert isinstance(value, float)
        asked = value if upwards else height - value
        bound = clause.height.bound
        relation: Relation = "about"
        if bound != "exact":
            relation = "at_least" if (bound == "at_least") == upwards else "at_most"
        yield _compare(clause, relation, "contact height", asked, p_BT[2], tolerance, "m")


def _effector(clause: g.Effector, e: Evidence) -> Iterator[Check]:
    if clause.side is not None:
        yield _is(clause, "hand used", f"{clause.side} hand", f"{HAND_SIDE} hand")
    used = len(e.trace.tips)
    if clause.tool == "finger" and clause.count is not None:
        yield _is(clause, "fingers used", str(clause.count), str(used))
    elif clause.side is None:
        yield _is(clause, "touched with", clause.tool, clause.tool if used else "nothing")


_GOALS: dict[str, Callable[[g.Frame, Evidence], Iterator[Check]]] = {
    "displace": _displace,
    "topple": _topple,
}
_CONSTRAINTS: dict[str, Callable[[Any, Evidence], Iterator[Check]]] = {
    "no_topple": _no_topple,
    "no_tilt": _no_tilt,
    "no_turn": _no_turn,
    "no_touch": _no_touch,
    "max_force": _max_force,
    "max_speed": _max_speed,
    "max_distance": _max_distance,
    "gentle": _gentle,
    "slow": _gentle,
    "contact": _contact,
    "effector": _effector,
}
