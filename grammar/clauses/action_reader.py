"""A clause with a verb: the action, what should come of it, and what must hold on the way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

from grammar.clauses.clause_parts import Clause, Parts, unexpected_part
from grammar.clauses.consistency import is_still, require_consistent
from grammar.clauses.constraint_builder import constraints_of, require_same
from grammar.clauses.goal_builder import goal_builder_for
from grammar.clauses.owned_parts import part_and_owner
from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.frames.command import Span
from grammar.phrases import phrase_parts as ph
from grammar.words.lexicon import Lexicon, Verb
from grammar.words.normalisation import Normalised

_UP_AND_DOWN: dict[str, g.Direction] = {"up": "away", "down": "toward"}

_TOLD_WHERE = (ph.Place, ph.Into, ph.Toward, ph.AwayFrom, ph.Direction, ph.Heading, ph.Me)
"""Parts that say where to put an object."""

_PUSHED = frozenset({"displace", "contact", "topple", "tilt"})
"""Goals of which "from the left" says that they go to the right, unless by pulling."""

_EVENTS = frozenset({"moves", "slides", "tips", "tilts", "turns", "stays_upright"})
"""Events that a question may be about."""

_STOPS: dict[str, g.Event] = {"moves": "moves", "tips": "tips", "about_to_tip": "tips"}

_ASK_FOR_EVENTS = ("how_hard", "where")
"""Questions that may ask about an event."""


class ActionReader:
    """Reads the clause of a verb, and what is asked if it is a question.

    The things that the clause is about are left out of its parts.
    """

    def __init__(
        self,
        parts: Sequence[ph.Part],
        asks: Sequence[ph.Ask],
        lexicon: Lexicon,
        sentence: Normalised,
    ) -> None:
        self._parts = [p for p in parts if not isinstance(p, ph.Verb | ph.If)]
        self._head = next(part for part in parts if isinstance(part, ph.Verb))
        self._asks = asks
        self._query = next((each.query for each in asks), None)
        self._lexicon = lexicon
        self._sentence = sentence

    def frame_about(self, thing: ph.Thing) -> g.Frame:
        """The frame of the clause as it is about a thing.

        Raises:
            ParseError: with the words that do not fit.
        """
        self._require_one_way()
        rest, constraints = constraints_of(
            _with_stop_as_constraint(self._with_line_as_stop()),
            thing,
            self._lexicon,
            self._sentence,
        )
        verb, name, spans, rest = self._find_verb(self._head, rest, thing)
        result, rest, event, asked = self._result_and_event(rest, thing)
        if self._query in _ASK_FOR_EVENTS and event is None:
            constraints, event, asked = _without_stops(constraints)
        if verb.goal == "place":
            self._require_no_touch(constraints, any(isinstance(p, _TOLD_WHERE) for p in rest))
        self._require_clear_side(constraints, rest)
        self._require_no_later(constraints)
        goal = self._goal_of_parts(verb, name, result, rest, thing, spans[0])
        goal, thing = self._of_a_part(goal, thing)
        if verb.action == "push" and is_still(constraints) and not _says_more(goal):
            goal = g.NoGoal()  # a push need not move what it pushes
        action = goal.kind if isinstance(goal, g.Open | g.Close) else verb.action
        if action == "lift" and isinstance(goal, g.Place) and goal.relation in ("on", "in"):
            action = "place"  # "lift it onto the book"
        frame = g.Frame(
            action=cast(g.Action, action),
            query=self._query,
            object=thing.ref,
            goal=goal,
            constraints=constraints,
            event=event,
            negated=any(each.negated for each in self._asks),
            spans=spans + asked + tuple(each.span for each in self._asks),
        )
        require_consistent(frame, self._sentence)
        return _with_it_bound(frame)

    def _with_line_as_stop(self) -> Parts:
        """Takes "until it is aligned with the mug" for a stop, unless the verb turns things."""
        verb = self._lexicon.find_verb(self._head.word)
        if verb is None or verb.goal in ("rotate", "straighten", "place"):
            return self._parts
        return [
            ph.Constraint(p.span, g.Until(event="in_line", object=p.target, spans=(p.span,)))
            if isinstance(p, ph.Parallel) and isinstance(p.target, g.ObjectRef)
            and self._sentence.words_as_written(p.span).casefold().startswith("until")
            else p
            for p in self._parts
        ]  # fmt: skip

    def _require_one_way(self) -> None:
        """Refuse "away until it touches the mug right": a way, where to stop, and another way."""
        before = stopped = False
        for part in self._parts:
            way = isinstance(part, ph.Direction) and not part.implied
            if way and stopped:
                message = "is a second direction, behind where to stop"
                raise self._sentence.error_at(
                    part.span, "does_not_apply", message, "away and to the right until …"
                )
            before = before or way
            stop = isinstance(part, ph.Constraint) and isinstance(part.constraint, g.Until)
            stopped = stopped or (before and stop)

    def _require_no_touch(self, constraints: Sequence[g.Constraint], placed: bool) -> None:
        """Refuse where to touch an object in place of where to put it: "put it on its left side".

        A face behind a place may be that of the thing that was named last.
        """
        for clause in constraints:
            if not isinstance(clause, g.ContactRegion):
                continue
            before = self._sentence.original[: clause.spans[0][0]].rstrip()
            said = self._sentence.words_as_written(clause.spans[0]).casefold()
            beside = clause.face != "top" and said.startswith("on the ")
            if not placed or (clause.face and (beside or before.endswith(","))):
                message = "says where to touch it, and not where to put it"
                raise self._sentence.error_at(
                    clause.spans[0], "does_not_apply", message, "left of the mug", "on the left"
                )

    def _require_clear_side(self, constraints: Sequence[g.Constraint], rest: Parts) -> None:
        """Refuse a side behind the thing next to which it goes: "next to the jar on the left side".

        It may be where to touch, or the side of that thing.
        """
        ends = [p.span[1] for p in rest if isinstance(p, ph.Place) and p.relation == "next_to"]
        for clause in constraints:
            if not isinstance(clause, g.ContactRegion) or clause.face in (None, "top"):
                continue
            start, end = clause.spans[0]
            side = self._sentence.original[start:end].casefold().startswith("on ")
            if side and any(
                not self._sentence.original[e:start].strip(" ,") for e in ends if e < start
            ):
                message = "may be where to touch it, or a side of what it goes to"
                hints = f"{clause.face} of the mug", f"from the {clause.face}"
                raise self._sentence.error_at((start, end), "does_not_apply", message, *hints)

    def _require_no_later(self, constraints: Sequence[g.Constraint]) -> None:
        """Refuse "in 5 seconds" before the verb, which says when to begin, and not how long."""
        for clause in constraints:
            (start, end), *_ = clause.spans or (self._head.span,)
            said = self._sentence.original[start:end].casefold()
            if (
                clause.kind == "max_duration"
                and start < self._head.span[0]
                and said.startswith("in ")
            ):
                message = "says when, and nothing is done later"
                raise self._sentence.error_at(
                    (start, end), "unbound_words", message, "within 5 seconds"
                )

    def _goal_of_parts(
        self,
        verb: Verb,
        name: str,
        result: ph.Result | None,
        rest: Parts,
        thing: ph.Thing,
        span: Span,
    ) -> g.Goal:
        """Build the goal; every part that is left finds its place in it."""
        if thing.contents and verb.goal not in ("pour", "fill"):
            message = f'the contents of a thing do not go with "{name}"'
            raise ParseError(
                "does_not_apply", message, thing.span, ("pour the contents of it into …",)
            )
        if verb.goal not in _PUSHED or verb.action == "pull":
            rest = [p for p in rest if not (isinstance(p, ph.Direction) and p.implied)]
        poured = verb.goal in ("pour", "fill")
        rest = [_into_or_place(part, poured) for part in rest]
        clause = Clause(rest, verb, self._sentence, span)
        goal = goal_builder_for(verb, result, clause)(clause)
        clause.require_all_taken(name)
        if result is None:
            return goal
        return goal.model_copy(update={"spans": tuple(sorted((*goal.spans, result.span)))})

    def _result_and_event(
        self, rest: Parts, thing: ph.Thing
    ) -> tuple[ph.Result | None, Parts, g.Event | None, g.Spans]:
        """Find the wanted result, or the event that a question asks about, with its words."""
        event = next((each.event for each in self._asks if each.event), None)
        results = [p for p in rest if isinstance(p, ph.Result | ph.Purpose)]
        rest = [p for p in rest if not isinstance(p, ph.Result | ph.Purpose)]
        if not results:
            return None, rest, event, ()
        if len(results) > 1:
            raise unexpected_part(results[1], self._sentence)
        part = results[0]
        mention = part.subject if isinstance(part, ph.Result) else part.thing
        require_same(mention, thing, part, self._sentence)
        before = isinstance(part, ph.Purpose) and part.before
        if self._query in _ASK_FOR_EVENTS and part.event in _EVENTS:
            return None, rest, event or cast(g.Event, part.event), (part.span,)
        if self._query or before or part.event == "stays_upright":
            raise unexpected_part(part, self._sentence)
        if isinstance(part, ph.Purpose):
            part = ph.Result(part.span, part.event, thing)
        elif part.amount:
            rest.append(ph.Amount(part.span, part.amount))
        return part, rest, event, ()

    def _of_a_part(self, goal: g.Goal, thing: ph.Thing) -> tuple[g.Goal, ph.Thing]:
        """Takes "the lid of the cup", when it is opened, for a part of the cup."""
        if not isinstance(goal, g.Open | g.Close):
            return goal, thing
        parted = part_and_owner(thing, self._lexicon, self._sentence)
        if parted is None or parted[0] not in self._lexicon.parts:
            return goal, thing
        part, span, whole = parted
        return goal.model_copy(update={"part": part, "spans": (*goal.spans, span)}), whole

    def _find_verb(
        self, part: ph.Verb, rest: Parts, thing: ph.Thing
    ) -> tuple[Verb, str, tuple[Span, ...], Parts]:
        """Finds the verb with or without its particle; returns what it leaves of the rest."""
        lexicon = self._lexicon
        particle = next((p for p in rest if isinstance(p, ph.Particle)), None)
        alone = lexicon.find_verb(part.word)
        if particle is not None and particle.optional:
            topples = lexicon.find_verb(part.word, particle.word)
            if topples is None or (alone and alone.goal == "displace"):
                spare = [p for p in rest if isinstance(p, ph.Particle) and p.optional]
                rest, particle = [p for p in rest if p not in spare], None
        if particle is not None:
            verb = lexicon.find_verb(part.word, particle.word)
            if verb is not None:
                left = [p for p in rest if p is not particle]
                spans = _join_spans([part.span, particle.span], self._sentence)
                return verb, f"{part.word} {particle.word}", spans, left
        if alone is not None and part.completed is not None:
            return alone, part.word, (part.span, part.completed), rest
        if alone is None:
            whole = tuple(sorted(v for v in lexicon.verbs if v.startswith(f"{part.word} ")))
            raise ParseError(
                "unknown_verb",
                f'"{part.word}" alone is no action; it needs its particle',
                part.span,
                tuple(f"did you mean '{phrase}'?" for phrase in whole),
            )
        moves = alone.goal in ("displace", "contact")
        if particle is not None and moves and particle.word in _UP_AND_DOWN:
            if particle.span < thing.span:  # "bring down the jar" says nothing of the table's plane
                raise unexpected_part(particle, self._sentence)
            kinds = {type(each) for each in rest}
            if ph.Length in kinds and ph.Direction not in kinds:  # not "down and left by 4 cm"
                return self._moved_up(part, particle, rest)
            direction = ph.Direction(particle.span, _UP_AND_DOWN[particle.word])
            rest = [direction if p is particle else p for p in rest]
        return alone, part.word, (part.span,), rest

    def _moved_up(
        self, part: ph.Verb, particle: ph.Particle, rest: Parts
    ) -> tuple[Verb, str, tuple[Span, ...], Parts]:
        """Takes "move it up by 8 cm" for a lift: with a length, "up" is a height."""
        lift = self._lexicon.find_verb(part.word, particle.word) or self._lexicon.find_verb("lift")
        alone = self._lexicon.find_verb(part.word)
        if particle.word != "up" or lift is None or alone is None or alone.action != "move":
            message = "is a height, where it says how far; nothing is pushed there"
            hints = "away by 5 cm", "toward me by 5 cm", "lift it by 5 cm"
            raise self._sentence.error_at(particle.span, "does_not_apply", message, *hints)
        left = [p for p in rest if p is not particle]
        return lift, part.word, _join_spans([part.span, particle.span], self._sentence), left


def _with_it_bound(frame: g.Frame) -> g.Frame:
    """Takes "it" in "next to the mug without touching it" for the mug."""
    goal = frame.goal
    others: tuple[g.ObjectRef, ...] = ()
    if isinstance(goal, g.Place) and isinstance(goal.reference, tuple):
        others = goal.reference
    elif isinstance(goal, g.Displace) and isinstance(goal.toward, g.ObjectRef):
        others = (goal.toward,)
    elif isinstance(goal, g.Pour) and goal.into is not None:
        others = (goal.into,)
    if len(others) != 1:
        return frame
    bound = tuple(
        clause.model_copy(update={"object": others[0]})
        if isinstance(clause, g.NoTouch) and clause.object and clause.object.pronoun
        else clause
        for clause in frame.constraints
    )
    return frame.model_copy(update={"constraints": bound})


def _without_stops(
    constraints: tuple[g.Constraint, ...],
) -> tuple[tuple[g.Constraint, ...], g.Event | None, g.Spans]:
    """Takes "how hard … until it tips" for a question about tipping."""
    for stop in constraints:
        if isinstance(stop, g.Until) and stop.event in _STOPS:
            kept = tuple(c for c in constraints if c is not stop)
            return kept, _STOPS[stop.event], stop.spans
    return constraints, None, ()


def _with_stop_as_constraint(parts: Parts) -> Parts:
    """Takes "to the left so that it touches the mug" for a direction and where to stop."""
    ends = next((p for p in parts if isinstance(p, ph.Result) and p.event == "ends_up"), None)
    place = next((p for p in parts if isinstance(p, ph.Place)), None)
    directed = any(isinstance(p, ph.Direction | ph.Heading) for p in parts)
    if ends is None or place is None or not directed:
        return parts
    if place.relation not in ("touching", "next_to") or not isinstance(place.reference, tuple):
        return parts
    event = cast(Any, place.relation)
    stop = g.Until(event=event, object=place.reference[0], spans=(place.span,))
    until = ph.Constraint(place.span, stop, ends.subject)
    return [until if part is place else part for part in parts if part is not ends]


def _into_or_place(part: ph.Part, poured: bool) -> ph.Part:
    """Takes "pour it in the mug" for into the mug, "put it into the mug" for a place."""
    if poured and isinstance(part, ph.Place) and part.relation in ("to", "in", "on"):
        return ph.Into(part.span, cast("tuple[g.ObjectRef, ...]", part.reference)[0])
    if not poured and isinstance(part, ph.Into):
        return ph.Place(part.span, "in", (part.target,))
    return part


def _says_more(goal: g.Goal) -> bool:
    return goal != g.Displace() and bool(goal.spans)


def _join_spans(spans: list[Span], sentence: Normalised) -> tuple[Span, ...]:
    """One span if only space lies between."""
    (start, middle), (again, end) = sorted(spans)
    between = sentence.original[middle:again]
    return ((start, end),) if not between.strip() else ((start, middle), (again, end))
