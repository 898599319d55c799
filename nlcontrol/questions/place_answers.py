"""Where objects are seen to stand to each other: how far apart, beside what, upright or not."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from grammar.frames import command as g
from nlcontrol.errors import error
from nlcontrol.questions.answer import Answer
from nlcontrol.questions.asked_push import target_of
from nlcontrol.questions.property_values import standing_text
from nlcontrol.references.disambiguation_text import relation_text
from nlcontrol.references.object_attributes import gap_between, stands_in_relation
from nlcontrol.text_format import enumeration, quantity
from planner.problem.footprints import footprint

if TYPE_CHECKING:
    from planner.types.world_state import SeenObject, WorldState


def distance_answer(frame: g.Frame, state: WorldState) -> Answer:
    """How far an object stands from another one: the gap, and from middle to middle."""
    assert isinstance(frame.goal, g.Parameters)
    one, (other,) = target_of(frame, state), _seen(frame.goal.than, state)
    gap = gap_between(one, other)
    apart = math.dist(one.pose.p_WB[:2], other.pose.p_WB[:2])
    text = (
        f"Between the {one.name} and the {other.name} there are {quantity(gap, 'm')}; "
        f"their middles are {quantity(apart, 'm')} apart."
    )
    return Answer(query="value", text=text, numbers={"gap": gap, "middles": apart})


def far_answer(frame: g.Frame, state: WorldState) -> Answer:
    """How far an object stands from the robot, which is at the origin: away from it, and aside."""
    target = target_of(frame, state)
    away, left = float(target.pose.x), float(target.pose.y)
    side = "left" if left > 0 else "right"
    text = (
        f"The middle of the {target.name} is {quantity(away, 'm')} away from the robot, "
        f"{quantity(abs(left), 'm')} to the {side}."
    )
    return Answer(query="value", text=text, numbers={"away": away, "left": left})


def state_answer(frame: g.Frame, state: WorldState) -> Answer:
    """Whether an object stands upright, on the table itself, or in a relation to others."""
    target, goal = target_of(frame, state), frame.goal
    if isinstance(goal, g.Place):
        assert isinstance(goal.reference, tuple)
        return _relation_answer(target, goal.relation, _seen(goal.reference, state))
    if isinstance(goal, g.SetDown):
        text = (
            f"{_said(target.on is None)}, the {target.name} stands {standing_text(target, state)}."
        )
        return Answer(query="value", text=text, yes=target.on is None)
    if isinstance(goal, g.Open | g.Close):
        return _lid_answer(target, asks_open=isinstance(goal, g.Open))
    upright = target.lies_on == "bottom"
    yes = upright is isinstance(goal, g.Upright)
    how = "stands upright" if upright else f"lies on {target.side_below}"
    return Answer(query="value", text=f"{_said(yes)}, the {target.name} {how}.", yes=yes)


def edge_answer(frame: g.Frame, state: WorldState) -> Answer:
    """How far an object stands from an edge of the table; from the nearest, if any edge is meant.

    Raises:
        ControlError: `unsupported` for another part of the table.
    """
    target, goal = target_of(frame, state), frame.goal
    assert isinstance(goal, g.Displace)
    corners, table = footprint(target), state.table
    (x_min, y_min), (x_max, y_max) = corners.min(axis=0), corners.max(axis=0)
    gaps = {
        "front_edge": float(x_min - table.x_min),
        "back_edge": float(table.x_max - x_max),
        "right_edge": float(y_min - table.y_min),
        "left_edge": float(table.y_max - y_max),
    }
    where = min(gaps, key=lambda edge: gaps[edge]) if goal.away_from == "edge" else goal.away_from
    if not isinstance(where, str) or where not in gaps:
        raise error(
            "unsupported",
            "only how far it is from an edge of the table is told",
            capability="telling the distance from a part of the table",
            suggestions=("how far is it from the left edge?",),
        )
    side, gap = where.removesuffix("_edge"), gaps[where]
    text = f"The {target.name} is {quantity(gap, 'm')} away from the {side} edge of the table."
    return Answer(query="value", text=text, numbers={"gap": gap})


def _lid_answer(target: SeenObject, *, asks_open: bool) -> Answer:
    if target.model.lid is None:
        text = f"The {target.name} has no lid that I know of."
        return Answer(query="value", text=text)
    closed = target.is_covered
    yes = closed is not asks_open
    is_so = "closed, its lid on" if closed else "open"
    return Answer(query="value", text=f"{_said(yes)}, the {target.name} is {is_so}.", yes=yes)


def _relation_answer(
    target: SeenObject, relation: g.Relation, others: tuple[SeenObject, ...]
) -> Answer:
    yes = stands_in_relation(relation, target, others)
    where = f"{relation_text(relation)} {enumeration([f'the {each.name}' for each in others])}"
    gaps = [gap_between(target, each) for each in others]
    apart = enumeration([quantity(gap, "m") for gap in gaps])
    text = f"{_said(yes)}, the {target.name} is {'' if yes else 'not '}{where}: {apart} apart."
    return Answer(query="value", text=text, numbers={"gap": max(gaps)}, yes=yes)


def _said(yes: bool) -> str:
    return "Yes" if yes else "No"


def _seen(references: tuple[g.ObjectRef, ...], state: WorldState) -> tuple[SeenObject, ...]:
    return tuple(state.objects[ref.id] for ref in references if ref.id is not None)
