"""Goals of clearing, of rows and exchanges, and of how a thing looks at the end."""

from __future__ import annotations

from typing import cast

from grammar.clauses.clause_parts import Clause
from grammar.frames import command as g
from grammar.phrases import phrase_parts as ph


def swap_goal(clause: Clause) -> g.Place:
    """Swap the mug and the box."""
    return g.Place(relation="place_of", reference=(), spans=clause.all_spans)


def clear_goal(clause: Clause) -> g.Place:
    """Clear a part of the table, or the place beside a thing; make room for one."""
    place, room = clause.take_place(), clause.take_only(ph.Room)
    if place is None and room is None:
        raise clause.no_place_error("what to clear", "the left half of the table")
    if place is None:
        assert room is not None
        return g.Place(relation="clear_of", reference=(room.target,), spans=clause.all_spans)
    # As much room as the thing for which it is made.
    length = None if room is None else g.RelativeLength(value=1.0, of=room.target, side="length")
    return g.Place(
        relation="clear_of", reference=place.reference, distance=length, spans=clause.all_spans
    )


def row_goal(clause: Clause) -> g.Place:
    """Line them up; with the box."""
    place = clause.take_place()
    reference = () if place is None or place.relation != "in_row" else place.reference
    return g.Place(relation="in_row", reference=reference, spans=clause.all_spans)


def stack_goal(clause: Clause) -> g.Place:
    """Stack the mug and the box: how they stand is said by the verb."""
    relation = cast(g.Relation, clause.verb.relation)
    return g.Place(relation=relation, reference=(), spans=clause.all_spans)


def straight_goal(clause: Clause) -> g.Rotate:
    """Straighten it; align it with the edge, with the box."""
    goal = orientation_goal(clause)
    return g.Rotate(parallel_to="edge", spans=clause.all_spans) if goal is None else goal


def orientation_goal(clause: Clause) -> g.Rotate | None:
    """Turn it towards the mug, parallel to the box; None if how it should look is not said."""
    facing, parallel = clause.take_only(ph.Facing), clause.take_only(ph.Parallel)
    if facing is not None and parallel is not None:
        raise clause.contradiction_error(*sorted((facing, parallel), key=lambda part: part.span))
    if facing is not None:
        return g.Rotate(facing=facing.target, spans=clause.all_spans)
    if parallel is not None:
        return g.Rotate(parallel_to=parallel.target, spans=clause.all_spans)
    toward = clause.first_part(ph.Toward)
    if toward is None or isinstance(toward.target, str):
        return None
    clause.take_only(ph.Toward)
    return g.Rotate(facing=toward.target, spans=clause.all_spans)
