"""Which goal takes which parts of a clause.

Every part must find its place; a part that its verb has no use for is an error, never dropped.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, cast

from grammar.clauses import arrangement_goals as arranged
from grammar.clauses.clause_parts import ON_THE_TABLE, Clause
from grammar.clauses.constraint_builder import can_be_same
from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.frames.goals import GOALS
from grammar.phrases import phrase_parts as ph
from grammar.words.lexicon import Verb

_APART = "apart"
_MEASURED = ("from", "toward")
"""Words for both ways in which a length before "to the left edge" may be meant."""

_SOURCES = {"off": "off", "out_of": "out_of", "from": "off"}
"""Relation → that of a place from which a thing is taken."""

_NO_GAP = frozenset({
    "touching", "on", "between", "at", "in", "out_of", "off", "in_row", "together", "stacked",
    "place_of", "back",
})  # fmt: skip
"""Relations that leave no gap to be said."""

_SENSES: dict[g.Direction, g.Sense] = {"left": "ccw", "right": "cw"}


def _displace_goal(clause: Clause) -> g.Displace | g.Place:
    clause.take_all(ph.LetGo)
    if clause.verb.direction == "toward":
        clause.take_all(ph.FromTable)
    source = clause.first_part(ph.Place)
    fetched = clause.verb.direction == "toward" and not clause.has_part(ph.Length, ph.Share)
    if fetched and source is not None and source.relation in _SOURCES:
        return _taking_goal(clause)
    place = _place_or_separation(clause)
    if place is not None and place.relation not in ("away_from", "to"):
        return _place_goal_at(clause, place)
    share = clause.take_only(ph.Share)
    if place is not None and place.relation == "to" and share is None:
        return _place_goal_at(clause, place)
    whole = share is not None and share.of_way and share.value == 1.0
    if whole and place is None and clause.has_part(ph.Direction):
        return g.Place(relation="at", reference=_edge_of(clause), spans=clause.all_spans)
    return _displacement(clause, place, share)


def _displacement(clause: Clause, place: ph.Place | None, share: ph.Share | None) -> g.Displace:
    """A way over the table; `place` is a thing to go to in part, or to go away from."""
    heading, toward = clause.take_only(ph.Heading), clause.take_only(ph.Toward)
    me, off = clause.take_only(ph.Me), clause.take_only(ph.AwayFrom)
    said = [part for part in (heading, toward, place, me, off) if part is not None]
    if said:
        clause.drop_implied()
    if len(said) > 1 or (said and clause.has_part(ph.Direction)):
        other = said[1] if len(said) > 1 else clause.take_all(ph.Direction)[0]
        raise clause.contradiction_error(*sorted((said[0], other), key=lambda part: part.span))
    directions = clause.take_directions()
    if me is not None or (clause.verb.direction and not said and not directions):
        directions = (cast(g.Direction, clause.verb.direction or "toward"),)
    target = None if toward is None else toward.target
    away_from: g.ObjectRef | g.TableRegion | None = None if off is None else off.region
    if place is not None:
        if not isinstance(place.reference, tuple):
            raise clause.does_not_apply_error(place, "names no object", "away from the mug")
        if place.relation == "to":
            target = place.reference[0]
        else:
            away_from = place.reference[0]
    if share is not None and not share.of_way:
        raise clause.does_not_apply_error(share, "is no single object", "say it for each object")
    if share is not None and target is None and clause.verb.goal:
        raise clause.does_not_apply_error(share, "needs to say where to", "halfway to the mug")
    amount = clause.take_amount()
    length = clause.take_only(ph.Length)
    if share is not None and length is not None:
        raise clause.said_twice_error(share, length)
    if amount is None and length is None and share is None:
        amount = cast(g.Amount | None, clause.verb.amount)
    return g.Displace(
        direction=cast(Any, directions if len(directions) > 1 else next(iter(directions), None)),
        heading=None if heading is None else heading.value,
        toward=target,
        away_from=away_from,
        distance=None if length is None else length.value,
        bound="exact" if length is None else length.bound,
        fraction=None if share is None else share.value,
        amount=amount,
        spans=clause.all_spans,
    )


def _edge_of(clause: Clause) -> g.TableRegion:
    """The edge or the corner at which "all the way to the left" ends."""
    sides = tuple({"away": "back", "toward": "front"}.get(d, d) for d in clause.take_directions())
    return cast(g.TableRegion, "_".join((*sides, "edge" if len(sides) == 1 else "corner")))


def _place_or_separation(clause: Clause) -> ph.Place | None:
    """The place to go to, or for what is separated, the thing to go away from."""
    place = clause.take_place()
    if clause.verb.direction != _APART:
        return place
    if place is None or place.relation not in ("from", "away_from"):
        raise clause.no_place_error("what it should be moved away from", "from the mug")
    return replace(place, relation="away_from")


def _place_goal(clause: Clause) -> g.Displace | g.Place | g.SetDown:
    if clause.has_part(ph.Toward):
        return _displace_goal(clause)
    place, table = clause.take_place(), clause.take_only(ph.Table)
    if place is None and table is not None:
        return g.SetDown(spans=clause.all_spans)
    if place is not None and (aside := _side_of(place)) is not None:
        return g.Displace(direction=aside, spans=clause.all_spans)  # "put it on the left"
    way = clause.first_part(ph.Direction)
    said = "" if place is not None or way is None else clause.quote(way).casefold()
    if said == '"back"':
        clause.take_only(ph.Direction)
        return g.Place(relation="back", reference=(), spans=clause.all_spans)
    if said.startswith('"to '):
        return _displace_goal(clause)
    if place is None and clause.verb.relation:
        return arranged.stack_goal(clause)
    if place is None:
        hints = ("next to the mug", "to the middle of the table", "to x 0.6 y -0.1")
        raise clause.no_place_error("where to put it", *hints)
    return _place_goal_at(clause, place)


def _side_of(place: ph.Place) -> g.Direction | None:
    match place:
        case ph.Place(relation="on", reference=(g.ObjectRef(text="left" | "right" as side),)):
            return side
    return None


def _place_goal_at(clause: Clause, place: ph.Place) -> g.Place:
    length, share = clause.take_only(ph.Length), clause.take_only(ph.Share)
    way = clause.first_part(ph.Direction)
    if length is not None and way is not None and clause.quote(way) == '"away"':
        clause.take_only(ph.Direction)  # "left of the mug, 10 cm away"
    if place.relation == "from" and length is None:
        raise clause.does_not_apply_error(place, "needs a distance", "10 cm from the mug")
    objects, relation = isinstance(place.reference, tuple), place.relation
    if relation == "under":
        message = "is no place that this robot gets to"
        raise clause.does_not_apply_error(place, message, "in front of the mug")
    words = clause.quote(place).strip('"').partition(" ")
    if length is not None and not objects and words[0].casefold() == "to":
        ways = (f"{clause.quote(length)} {way} {words[2]}".replace('"', "") for way in _MEASURED)
        raise clause.does_not_apply_error(length, "may be measured from there or from here", *ways)
    if relation in ("from", "away_from", "to") or (relation == "off" and length is not None):
        relation = "next_to" if objects else "at"
    relation = ON_THE_TABLE.get(relation, relation)
    edge = str(place.reference).endswith("edge")
    apart = edge or relation not in _NO_GAP
    bounded = length is not None and length.bound in ("at_least", "at_most")
    if length is not None and (not apart or bounded or length.most):
        raise clause.does_not_apply_error(
            length, "does not go with this place", "10 cm from the mug"
        )
    if share is not None and (objects or relation == "over" or not share.of_way):
        raise clause.does_not_apply_error(
            share, "does not go with this place", "halfway to the left edge"
        )
    clause.drop_implied()
    return g.Place(
        relation=cast(g.Relation, relation),
        reference=place.reference,
        distance=None if length is None else length.value,
        fraction=None if share is None or share.value == 1.0 else share.value,
        spans=clause.all_spans,
    )


def _rotate_goal(clause: Clause) -> g.Rotate:
    if (oriented := arranged.orientation_goal(clause)) is not None:
        return oriented
    sense = clause.take_only(ph.Sense)
    aside = clause.first_part(ph.Direction)
    direction = clause.take_direction()
    turned = _SENSES.get(direction) if direction else None
    if aside is not None and not aside.implied and (turned is None or sense is not None):
        message = "says the sense of turning twice" if sense else "is no way to turn"
        raise clause.does_not_apply_error(
            aside, message, "to the left", "to the right", "clockwise"
        )
    amount = clause.take_amount()
    angle, bound = clause.take_measure(ph.Angle)
    if angle is None and clause.verb.turns is not None:
        angle = math.tau * clause.verb.turns
    return g.Rotate(
        angle=angle,
        sense=turned if sense is None else cast(g.Sense, sense.value),
        bound=bound,
        amount=amount,
        spans=clause.all_spans,
    )


def _tilt_goal(clause: Clause) -> g.Tilt:
    clause.take_all(ph.Settles)
    clause.take_all(ph.LetGo)
    direction, amount = clause.take_direction(), clause.take_amount()
    angle, bound = clause.take_measure(ph.Angle)
    return g.Tilt(
        angle=angle, direction=direction, bound=bound, amount=amount, spans=clause.all_spans
    )


def _topple_goal(clause: Clause) -> g.Topple:
    return g.Topple(direction=clause.take_direction(), spans=clause.all_spans)


def _hand_over_goal(clause: Clause) -> g.HandOver:
    clause.take_all(ph.FromTable)
    clause.take_only(ph.Me)
    if clause.has_part(ph.Direction) and clause.take_direction() != "toward":
        raise ParseError(
            "does_not_apply",
            "things are handed to the one who speaks",
            clause.spans[-1],
            ("to me",),
        )
    return g.HandOver(spans=clause.all_spans)


def _contact_goal(clause: Clause) -> g.Displace | g.Place | g.NoGoal:
    moves = (ph.Direction, ph.Heading, ph.Toward, ph.AwayFrom, ph.Place, ph.Length,
             ph.Amount, ph.Share)  # fmt: skip
    if clause.has_part(*moves, ph.Me):
        return _displace_goal(clause)
    # The side that is touched says where to push, but a touch need not move anything.
    clause.take_all(ph.Direction)
    return g.NoGoal()


def _upright_goal(clause: Clause) -> g.Upright:
    clause.take_all(ph.Table)
    clause.take_all(ph.FromTable)
    return g.Upright(spans=clause.all_spans)


def _set_down_goal(clause: Clause) -> g.Displace | g.Place | g.SetDown:
    if clause.has_part(ph.Place, ph.Table):
        return _place_goal(clause)
    return g.SetDown()


def _parameters_goal(clause: Clause) -> g.Parameters:
    which = (clause.verb.which,) if clause.verb.which else ()
    method = clause.take_value(ph.Method)
    return g.Parameters(which=which, method=method, spans=clause.all_spans)


# --- goals of the whole hand -------------------------------------------------------------------


def lift_goal(clause: Clause) -> g.Goal:
    """Lift the mug by 10 cm; take it off the book, out of the box; lift it onto the book."""
    place = clause.first_part(ph.Place)
    if place is not None and place.relation in (*_SOURCES, "on", "in"):
        return _taking_goal(clause) if place.relation in _SOURCES else _place_goal(clause)
    clause.take_all(ph.FromTable)
    length = clause.first_part(ph.Length)
    above = None if length is None else length.above
    amount, (height, bound) = clause.take_amount(), clause.take_measure(ph.Length)
    return g.Lift(height=height, above=above, bound=bound, amount=amount, spans=clause.all_spans)


def remove_goal(clause: Clause) -> g.Open | g.Place:
    """Remove the lid; remove the mug from the book."""
    part = clause.take_value(ph.Lid)
    return g.Open(part=part, spans=clause.all_spans) if part else _taking_goal(clause)


def _taking_goal(clause: Clause) -> g.Place:
    place = clause.take_place()
    if place is None:
        hints = ("from the book", "leave it there, and push it away")
        raise clause.no_place_error("what it should be taken from", *hints)
    if place.relation not in _SOURCES or not isinstance(place.reference, tuple):
        message = "is no thing to take it from"
        raise clause.does_not_apply_error(place, message, "off the book", "out of the box")
    relation = cast(g.Relation, _SOURCES[place.relation])
    return g.Place(relation=relation, reference=place.reference, spans=clause.all_spans)


def open_goal(clause: Clause) -> g.Open:
    """Take the lid off the jar; open it all the way, which it is anyway."""
    _take_whole_way(clause)
    return g.Open(part=clause.take_value(ph.Lid), spans=clause.all_spans)


def _take_whole_way(clause: Clause) -> None:
    share = clause.first_part(ph.Share)
    if share is not None and share.of_way and share.value == 1.0:
        clause.take_only(ph.Share)


def close_goal(clause: Clause) -> g.Close:
    """Put the lid back on the jar."""
    _take_whole_way(clause)
    return g.Close(part=clause.take_value(ph.Lid), spans=clause.all_spans)


def pour_goal(clause: Clause) -> g.Pour:
    """Pour half of the ice tea into the mug; until it is half full."""
    full, said = clause.take_only(ph.Full), clause.how_much()
    into, amount = clause.take_only(ph.Into), clause.take_amount()
    share, volume = clause.take_only(ph.Share), clause.take_value(ph.Volume)
    if share is not None and share.of_way:
        raise clause.does_not_apply_error(share, "is no part of a liquid", "half of the water")
    if full is not None and full.subject and into and not can_be_same(full.subject, into.target):
        raise clause.does_not_apply_error(full, "is about something else", "until it is half full")
    if full is not None and into is None:
        raise clause.does_not_apply_error(full, "needs to say what is filled", "into the mug")
    if full is not None and said:
        raise clause.said_twice_error(*sorted((full, said[0]), key=lambda part: part.span))
    if len(said) > 1:
        raise clause.said_twice_error(said[0], said[1])
    return g.Pour(
        into=None if into is None else into.target,
        amount=amount,
        fraction=None if share is None else share.value,
        volume=volume,
        fill=None if full is None else full.value,
        spans=clause.all_spans,
    )


def fill_goal(clause: Clause) -> g.Pour:
    """Fill the mug with ice tea: to the brim, if nothing else is said."""
    into, share = clause.first_part(ph.Into), clause.first_part(ph.Share)
    if into and share and share.span < into.span and not share.of_way:
        clause.replace_part(share, ph.Full(share.span, share.value))  # fill half of the mug
    clause.take_only(ph.FilledWith)
    goal = pour_goal(clause)
    said = (goal.amount, goal.fraction, goal.volume, goal.fill)
    return goal if any(said) else goal.model_copy(update={"fill": 1.0})


# --- which goal --------------------------------------------------------------------------------

GOAL_BUILDERS: dict[str, Callable[[Clause], g.Goal]] = {
    "displace": _displace_goal,
    "contact": _contact_goal,
    "place": _place_goal,
    "rotate": _rotate_goal,
    "straighten": arranged.straight_goal,
    "clear": arranged.clear_goal,
    "swap": arranged.swap_goal,
    "line_up": arranged.row_goal,
    "tilt": _tilt_goal,
    "topple": _topple_goal,
    "upright": _upright_goal,
    "lift": lift_goal,
    "remove": remove_goal,
    "set_down": _set_down_goal,
    "open": open_goal,
    "close": close_goal,
    "pour": pour_goal,
    "fill": fill_goal,
    "hand_over": _hand_over_goal,
    "parameters": _parameters_goal,
}

_OUTCOMES = {event: kind for kind, goal in GOALS.items() for event in goal.words.outcomes}
"""Event that is wanted → goal."""


def goal_builder_for(
    verb: Verb, result: ph.Result | None, clause: Clause
) -> Callable[[Clause], g.Goal]:
    """The goal that takes the parts of a clause: the verb's, or that of "so that it falls".

    Raises:
        ParseError: `does_not_apply` if the verb cannot have that outcome.
    """
    if result is None:
        return GOAL_BUILDERS[verb.goal]
    goal = _OUTCOMES.get(result.event)
    allowed = verb.goal in ("displace", "contact") or goal == verb.goal
    if goal is None or not allowed:
        raise clause.does_not_apply_error(
            result, "is no outcome of this", "so that it moves", "so that it falls"
        )
    return GOAL_BUILDERS[goal]
