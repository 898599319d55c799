"""From the parts of a clause to its frames: verb, object, goal, constraints, question, remark."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, cast

from grammar import frames as g
from grammar.clauses import clauses_of
from grammar.contradictions import require_consistent
from grammar.errors import ParseError
from grammar.frames import Span
from grammar.lexicon import Lexicon, Verb
from grammar.normalise import Normalised
from grammar.objectives import Clause, intended
from grammar.parts import (
    AmountPart,
    AnglePart,
    AskPart,
    AvoidPart,
    AwayFromPart,
    ConstraintPart,
    DirectionPart,
    ExplorePart,
    FillerPart,
    HeadingPart,
    IfPart,
    LengthPart,
    NotThisPart,
    Part,
    ParticlePart,
    PlacePart,
    PurposePart,
    RemarkPart,
    ResultPart,
    SensePart,
    SharePart,
    TherePart,
    ThingPart,
    TowardPart,
    VerbPart,
)
from grammar.restrictions import constraints_of, require_same
from grammar.things import described

_UP_AND_DOWN: dict[str, g.Direction] = {"up": "away", "down": "toward"}

_PUSHED = frozenset({"displace", "contact", "topple", "tilt"})
"""Goals of which "from the left" says that they go to the right, unless by pulling."""

_GOES_ON = (DirectionPart, HeadingPart, TowardPart, AwayFromPart, PlacePart, LengthPart, AnglePart,
            SensePart, AmountPart, SharePart)  # fmt: skip
"""Parts that say what should become of the object, also without a verb."""

_EVENTS: dict[str, g.Event] = {
    "moves": "moves",
    "slides": "slides",
    "tips": "tips",
    "tilts": "tilts",
    "turns": "turns",
}
_STOPS: dict[str, g.Event] = {"moves": "moves", "tips": "tips", "about_to_tip": "tips"}
_NOBODY = ThingPart((0, 0), g.ObjectRef(text="it", pronoun=True))

Parts = list[Part]


def frames_of(parts: Sequence[Part], lexicon: Lexicon, sentence: Normalised) -> tuple[g.Frame, ...]:
    """Puts the parts of a sentence together.

    Raises:
        ParseError: with the words that do not fit.
    """
    frames: list[g.Frame] = []
    previous: Parts = []
    for said in clauses_of(parts, sentence):
        headed = any(isinstance(p, VerbPart | ExplorePart | RemarkPart) for p in said)
        clause = said if headed or not frames else _elliptic(said, previous, sentence)
        frames += _Reader(clause, lexicon, sentence).frames()
        previous = clause
    return tuple(frames)


def _elliptic(clause: Parts, previous: Parts, sentence: Normalised) -> Parts:
    """A clause without its verb ("then to the left") goes on with verb and object of the last."""
    if not any(isinstance(part, _GOES_ON) for part in clause):
        raise _no_verb(sentence, clause)
    verb = [part for part in previous if isinstance(part, VerbPart | ParticlePart)][:2]
    named = any(isinstance(part, ThingPart) for part in clause)
    thing = [] if named else [part for part in previous if isinstance(part, ThingPart)][:1]
    return [*verb, *thing, *clause]


def _no_verb(sentence: Normalised, parts: Sequence[Part] = ()) -> ParseError:
    said = [part for part in parts if not isinstance(part, FillerPart)] or parts
    span = said[0].span if said else sentence.span(0, len(sentence.text))
    message = "the sentence does not say what to do"
    return ParseError("no_verb", message, span, ('say, for example, "push the box away"',))


class _Reader:
    """Reads one clause."""

    def __init__(self, parts: Sequence[Part], lexicon: Lexicon, sentence: Normalised) -> None:
        self._lexicon = lexicon
        self._sentence = sentence
        self._parts = described(parts, lexicon, sentence)

    def frames(self) -> list[g.Frame]:
        """The frames of the clause, one for each of its objects."""
        remarks, explore = self._take(RemarkPart), self._take(ExplorePart)
        if explore:
            return self._remarked([self._explored(explore[0])], remarks)
        ask = self._take(AskPart)
        verbs = [part for part in self._parts if isinstance(part, VerbPart)]
        self._require_there_is_clear(ask)
        if ask and remarks:
            raise self._unexpected(remarks[0])
        if ask and not verbs:
            return [self._asked(ask)]
        if ask and ask[0].query in ("value", "affordances"):
            raise self._unexpected(verbs[0])
        if not verbs:
            return [self._remark(remarks)]
        excluded = self._take(NotThisPart)
        things = self._things(ask, remarks)
        if not ask:
            self._require_no_condition()
        frames = [self._frame(verbs[0], thing, ask) for thing in things]
        return self._remarked(frames, remarks, excluded)

    def _remarked(
        self,
        frames: list[g.Frame],
        remarks: Sequence[RemarkPart],
        excluded: Sequence[NotThisPart] = (),
    ) -> list[g.Frame]:
        """The frames of a clause, with what its remarks do to them."""
        dialogue = self._dialogue(remarks)
        if dialogue in ("undo", "stop"):
            raise self._unexpected(remarks[0])
        restored = dialogue == "repeat" and frames[0].goal.kind == "upright"
        if restored:  # "stand it up again" repeats nothing
            dialogue = None
        spans = tuple(part.span for part in (*remarks, *excluded))
        return [
            frame.model_copy(update={"dialogue": dialogue, "spans": spans + frame.spans})
            for frame in frames
        ]

    # --- parts --------------------------------------------------------------------------------

    def _take(self, *kinds: type[Part]) -> list[Any]:
        taken = [part for part in self._parts if isinstance(part, kinds)]
        self._parts = [part for part in self._parts if not isinstance(part, kinds)]
        return taken

    def _unexpected(self, part: Part) -> ParseError:
        written = self._sentence.written(part.span)
        message = f'"{written}" is not understood here'
        return ParseError("unexpected_words", message, part.span, (f'leave out "{written}"',))

    def _require_there_is_clear(self, ask: Sequence[AskPart]) -> None:
        for part in self._take(TherePart):
            if not any(each.query == "why" for each in ask):
                written = self._sentence.written(part.span)
                raise ParseError(
                    "unexpected_words",
                    f'"{written}" does not say where',
                    part.span,
                    ("next to the mug", "to the middle of the table", "10 cm to the left"),
                )

    def _require_no_condition(self) -> None:
        """Lets "when you push it" follow a restriction; else a condition belongs to a question."""
        restricted = False
        for part in self._parts:
            restricted = restricted or isinstance(part, AvoidPart | ConstraintPart)
            if isinstance(part, IfPart) and not restricted:
                raise self._unexpected(part)

    # --- things -------------------------------------------------------------------------------

    def _things(self, ask: Sequence[AskPart], remarks: Sequence[RemarkPart]) -> list[ThingPart]:
        """What the clause is about: one object, or several of a list."""
        named = [part.thing for part in ask if part.thing is not None]
        things = self._take(ThingPart)
        if named and len(things) > 1:
            raise self._several(things[1])
        if named and named[0].ref.pronoun and things:
            return things
        if named and things and not things[0].ref.pronoun:
            require_same(named[0], things[0], ask[0], self._sentence)
        if named:
            spans = named[0].ref.spans + tuple(s for t in things for s in t.ref.spans)
            return [replace(named[0], ref=named[0].ref.model_copy(update={"spans": spans}))]
        if not things and (remarks or any(part.query == "why" for part in ask)):
            return [_NOBODY]
        if not things:
            raise self._no_object()
        verb = next(part for part in self._parts if isinstance(part, VerbPart))
        if not (verb.passive or remarks or ask) and things[0].span < verb.span:
            raise self._unexpected(things[0])
        if any(thing.ref.text.casefold() == "them" for thing in things):
            raise self._several(things[0])
        if things[0].ref.pronoun and (earlier := self._restricted_before(things[0])):
            return [earlier]
        if len(things) > 1 and not self._listed(things):
            raise self._several(things[1])
        return things

    def _restricted_before(self, thing: ThingPart) -> ThingPart | None:
        """What "it" stands for after "be careful not to topple the jar when you push it"."""
        named = [part.thing for part in self._parts if isinstance(part, AvoidPart)]
        named += [part.subject for part in self._parts if isinstance(part, ConstraintPart)]
        for other in named:
            if other is not None and not other.ref.pronoun and other.span < thing.span:
                spans = other.ref.spans + thing.ref.spans
                return replace(other, ref=other.ref.model_copy(update={"spans": spans}))
        return None

    def _no_object(self) -> ParseError:
        verb = next(part for part in self._parts if isinstance(part, VerbPart))
        after = [part for part in self._parts if part.span[0] >= verb.span[1]]
        return ParseError(
            "no_object",
            "the name of an object is missing",
            after[0].span if after else verb.span,
            (f'say what to {verb.word}: "{verb.word} the box"',),
        )

    def _listed(self, things: Sequence[ThingPart]) -> bool:
        """Whether things stand side by side, joined by "and"."""
        for one, other in pairwise(things):
            between = self._sentence.original[one.span[1] : other.span[0]].casefold()
            words = between.replace(",", " , ").split()
            joined = set(words) <= {",", "and", "&", *self._lexicon.terminals["THE"], "a", "an"}
            if not joined or not {",", "and"} & set(words):
                return False
        return True

    def _several(self, thing: ThingPart) -> ParseError:
        return ParseError(
            "several_objects",
            f'"{self._sentence.written(thing.span)}" is a second object',
            thing.span,
            ("say one command for each object",),
        )

    # --- frames -------------------------------------------------------------------------------

    def _frame(self, part: VerbPart, thing: ThingPart, ask: Sequence[AskPart]) -> g.Frame:
        """The frame of a clause with a verb."""
        query = next((each.query for each in ask), None)
        event = next((each.event for each in ask if each.event), None)
        rest = [p for p in self._parts if p is not part and not isinstance(p, IfPart)]
        rest = _stopping(rest)
        rest, constraints = constraints_of(rest, thing, self._lexicon, self._sentence)
        verb, name, spans, rest = self._verb(part, rest)
        outcomes = tuple(p.span for p in rest if isinstance(p, ResultPart | PurposePart))
        result, rest, asked = self._results(rest, thing, query, verb)
        event = event or asked
        spans += outcomes if asked else ()
        if query in ("how_hard", "where") and event is None:
            constraints, event, stops = _without_stops(constraints)
            spans += stops
        if thing.contents and verb.goal != "pour":
            message = f'the contents of a thing do not go with "{name}"'
            raise ParseError(
                "does_not_apply", message, thing.span, ("pour the contents of it into …",)
            )
        if verb.goal not in _PUSHED or verb.action == "pull":
            rest = [p for p in rest if not (isinstance(p, DirectionPart) and p.implied)]
        clause = Clause(rest, verb, self._sentence, spans[0])
        goal = intended(verb, result, clause)(clause)
        clause.finish(name)
        goal, thing = self._of_a_part(goal, thing)
        if result is not None:
            goal = goal.model_copy(update={"spans": tuple(sorted((*goal.spans, result.span)))})
        frame = g.Frame(
            action=cast(g.Action, verb.action),
            query=query,
            object=thing.ref,
            goal=goal,
            constraints=constraints,
            event=event,
            negated=any(each.negated for each in ask),
            spans=spans + tuple(each.span for each in ask),
        )
        pushed = verb.action == "push" and goal.kind == "displace" and not _says_more(goal)
        if pushed and _still(constraints):  # a push need not move what it pushes
            frame = frame.model_copy(update={"goal": g.NoGoal()})
        require_consistent(frame, self._sentence)
        return _with_it_bound(frame)

    def _results(
        self, rest: Parts, thing: ThingPart, query: g.Query | None, verb: Verb
    ) -> tuple[ResultPart | None, Parts, g.Event | None]:
        """What should come of it; in a question it is what is asked about."""
        results = [p for p in rest if isinstance(p, ResultPart | PurposePart)]
        rest = [p for p in rest if not isinstance(p, ResultPart | PurposePart)]
        if not results:
            return None, rest, None
        if len(results) > 1:
            raise self._unexpected(results[1])
        part = results[0]
        mention = part.subject if isinstance(part, ResultPart) else part.thing
        require_same(mention, thing, part, self._sentence)
        before = isinstance(part, PurposePart) and part.before
        if query in ("how_hard", "where") and part.event in _EVENTS:
            return None, rest, _EVENTS[part.event]
        if query in ("how_hard", "where") and part.event == "stays_upright":
            return None, rest, "stays_upright"
        if query or before or part.event == "stays_upright":
            raise self._unexpected(part)
        if isinstance(part, PurposePart):
            part = ResultPart(part.span, part.event, thing)
        elif part.amount:
            rest.append(AmountPart(part.span, part.amount))
        return part, rest, None

    def _of_a_part(self, goal: g.Goal, thing: ThingPart) -> tuple[g.Goal, ThingPart]:
        """Takes "the lid of the cup", when it is opened, for a part of the cup."""
        if not isinstance(goal, g.Open | g.Close):
            return goal, thing
        part, of, whole = thing.ref.text.partition(" of ")
        if not of or part.casefold() not in self._lexicon.parts:
            return goal, thing
        article, _, name = whole.partition(" ")
        start, end = thing.span
        if article.casefold() not in {"the", "a", "an", "my", "your", "our"}:
            name = whole
        span = end - len(name), end
        ref = g.ObjectRef(text=name, spans=(span,))
        spans = (*goal.spans, (start, start + len(part)))
        goal = goal.model_copy(update={"part": part.casefold(), "spans": spans})
        return goal, ThingPart(span, ref)

    def _verb(self, part: VerbPart, rest: Parts) -> tuple[Verb, str, tuple[Span, ...], Parts]:
        """Finds the verb with or without its particle; returns what it leaves of the rest."""
        lexicon = self._lexicon
        particle = next((p for p in rest if isinstance(p, ParticlePart)), None)
        alone = lexicon.verb(part.word)
        if particle is not None and particle.optional:
            topples = lexicon.verb(part.word, particle.word)
            if topples is None or (alone and alone.goal == "displace"):
                rest, particle = [p for p in rest if p is not particle], None
        if particle is not None:
            verb = lexicon.verb(part.word, particle.word)
            if verb is not None:
                left = [p for p in rest if p is not particle]
                spans = _joined([part.span, particle.span], self._sentence)
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
            direction = DirectionPart(particle.span, _UP_AND_DOWN[particle.word])
            rest = [direction if p is particle else p for p in rest]
        return alone, part.word, (part.span,), rest

    # --- questions and remarks ----------------------------------------------------------------

    def _explored(self, part: ExplorePart) -> g.Frame:
        frame = g.Frame(
            action="explore",
            object=part.thing.ref,
            goal=g.Parameters(which=part.which, spans=(part.span,)),
            spans=(part.span,),
        )
        rest, constraints = constraints_of(self._parts, part.thing, self._lexicon, self._sentence)
        Clause(rest, Verb("explore", "parameters"), self._sentence).finish("find out")
        return frame.model_copy(update={"constraints": constraints})

    def _asked(self, asks: Sequence[AskPart]) -> g.Frame:
        """A question without a verb: how heavy, what can you do with, why."""
        ask = asks[0]
        Clause(self._parts, Verb("push", "contact"), self._sentence).finish("this question")
        if not ask.whole:
            raise ParseError(
                "incomplete",
                "the question does not say what is done to the object",
                ask.span,
                ('ask, for example, "will it topple if you push it at the top?"',),
            )
        goal = g.Parameters(which=ask.which, spans=(ask.span,)) if ask.which else g.NoGoal()
        return g.Frame(
            query=ask.query,
            object=None if ask.thing is None else ask.thing.ref,
            goal=goal,
            spans=(ask.span,),
        )

    def _dialogue(self, remarks: Sequence[RemarkPart]) -> g.Dialogue | None:
        """What the remarks do together: "no, again" corrects."""
        said = {remark.dialogue for remark in remarks}
        for dialogue in ("correct", "undo", "stop", "repeat", "more"):
            if dialogue in said:
                return dialogue
        return None

    def _remark(self, remarks: Sequence[RemarkPart]) -> g.Frame:
        """A remark without a verb: undo that, a bit more to the left, no, the coffee box."""
        excluded = self._take(NotThisPart)
        things = self._take(ThingPart)
        dialogue = self._dialogue(remarks)
        if dialogue is None and excluded and things:
            dialogue = "correct"
        if dialogue is None:
            raise _no_verb(self._sentence, [*things, *self._parts])
        if len(things) > 1:
            raise self._several(things[1])
        thing = things[0] if things else _NOBODY
        rest, constraints = constraints_of(self._parts, thing, self._lexicon, self._sentence)
        rest = [p for p in rest if not (isinstance(p, ParticlePart) and p.optional)]
        content = [part for part in rest if not isinstance(part, FillerPart)]
        if dialogue in ("undo", "stop") and (content or constraints):
            raise self._unexpected((content or remarks)[0])
        if dialogue == "stop" and things:
            raise self._several(things[0])
        if dialogue in ("more", "repeat") and things:
            raise _no_verb(self._sentence, things)
        if dialogue == "correct" and not (content or constraints or things):
            raise ParseError(
                "incomplete",
                "the sentence does not say what was meant",
                remarks[0].span,
                ('say, for example, "no, the coffee box" or "no, to the left"',),
            )
        turns = any(isinstance(part, AnglePart | SensePart) for part in content)
        goal: g.Goal = g.NoGoal()
        clause = Clause(rest, Verb("turn" if turns else "push", ""), self._sentence)
        if clause.has(*_GOES_ON):
            kind = Verb("", "rotate") if turns else Verb("", "displace")
            goal = intended(kind, None, clause)(clause)
        clause.finish("")
        spans = [part.span for part in (*remarks, *excluded)]
        frame = g.Frame(
            dialogue=dialogue,
            object=things[0].ref if things else None,
            goal=goal,
            constraints=constraints,
            spans=tuple(sorted(spans)),
        )
        require_consistent(frame, self._sentence)
        return frame


def _with_it_bound(frame: g.Frame) -> g.Frame:
    """Takes "it" in "next to the mug without touching it" for the mug."""
    goal = frame.goal
    others: tuple[g.ObjectRef, ...] = ()
    if isinstance(goal, g.Place) and isinstance(goal.reference, tuple):
        others = goal.reference
    elif isinstance(goal, g.Displace) and isinstance(goal.toward, g.ObjectRef):
        others = (goal.toward,)
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


def _stopping(parts: Parts) -> Parts:
    """Takes "to the left so that it touches the mug" for a direction and where to stop."""
    ends = next((p for p in parts if isinstance(p, ResultPart) and p.event == "ends_up"), None)
    place = next((p for p in parts if isinstance(p, PlacePart)), None)
    directed = any(isinstance(p, DirectionPart | HeadingPart) for p in parts)
    if ends is None or place is None or not directed:
        return parts
    if place.relation not in ("touching", "next_to") or not isinstance(place.reference, tuple):
        return parts
    event = cast(Any, place.relation)
    stop = g.Until(event=event, object=place.reference[0], spans=(place.span,))
    until = ConstraintPart(place.span, stop, ends.subject)
    return [until if part is place else part for part in parts if part is not ends]


def _still(constraints: Sequence[g.Constraint]) -> bool:
    """Whether the object is to stay where it is."""
    return {"no_slide", "no_tilt", "no_turn"} <= {c.kind for c in constraints}


def _says_more(goal: g.Goal) -> bool:
    return goal != g.Displace() and bool(goal.spans)


def _joined(spans: list[Span], sentence: Normalised) -> tuple[Span, ...]:
    """One span if only space lies between."""
    (start, middle), (again, end) = sorted(spans)
    between = sentence.original[middle:again]
    return ((start, end),) if not between.strip() else ((start, middle), (again, end))
